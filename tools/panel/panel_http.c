/* panel_http.c: the server, on this machine only: who may ask, and the bytes of a request. A thread for each
 * connection: none waits for another, which the emergency stop needs. */
#define _POSIX_C_SOURCE 200809L
#include "panel.h"

#include <stdlib.h>
#include <string.h>

#ifdef PALPATE_HTTP
#include <arpa/inet.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>

enum { BODY_MAX = 1 << 20, CONNECTIONS = 64, IDLE_S = 60 };

struct panel_server {
    panel *panel;
    struct MHD_Daemon *daemon;
};

/* What has come of a request so far. */
typedef struct arriving {
    size_t n;
    bool too_long;
    char body[BODY_MAX + 1];
} arriving;

/* ---- who may ask ---- */

/* In a time that does not tell how much of it is right. */
static bool is_token(const panel *p, const char *text) {
    unsigned different = 0;
    if (!text || strlen(text) != PANEL_TOKEN - 1)
        return false;
    for (size_t i = 0; i < PANEL_TOKEN - 1; i++)
        different |= (unsigned char)(text[i] ^ p->token[i]);
    return different == 0;
}

/* A page of another site may send a request here, by a name of its own that leads to this machine; never with
 * our names. */
static bool is_here(const panel *p, const char *text, const char *scheme) {
    char here[64];
    for (int i = 0; i < 2; i++) {
        snprintf(here, sizeof here, "%s%s:%u", scheme, i ? "localhost" : "127.0.0.1", p->port);
        if (text && strcmp(text, here) == 0)
            return true;
    }
    return false;
}

static bool is_allowed(const panel *p, struct MHD_Connection *c) {
    const char *origin = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Origin");
    const char *token = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "X-Palpate-Token");
    if (!token)
        token = MHD_lookup_connection_value(c, MHD_GET_ARGUMENT_KIND, "token");
    return is_here(p, MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Host"), "") &&
           (!origin || is_here(p, origin, "http://")) && is_token(p, token);
}

/* ---- answering ---- */

static enum MHD_Result send_reply(struct MHD_Connection *c, const panel_reply *reply) {
    static const char *const headers[][2] = {
        {"Cache-Control", "no-store"},
        {"Referrer-Policy", "no-referrer"},
        {"X-Content-Type-Options", "nosniff"},
        {"X-Frame-Options", "DENY"},
        {"Content-Security-Policy",
         "default-src 'none'; connect-src 'self'; script-src 'unsafe-inline'; "
         "style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'; base-uri 'none'; "
         "form-action 'none'"},
    };
    struct MHD_Response *response =
        MHD_create_response_from_buffer(reply->n, reply->text, MHD_RESPMEM_MUST_FREE);
    if (!response) {
        free(reply->text);
        return MHD_NO;
    }
    MHD_add_response_header(response, "Content-Type", reply->type);
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
        MHD_add_response_header(response, headers[i][0], headers[i][1]);
    enum MHD_Result result = MHD_queue_response(c, reply->code, response);
    MHD_destroy_response(response);
    return result;
}

static enum MHD_Result refuse(struct MHD_Connection *c, unsigned code, const char *why) {
    panel_reply reply = {code, "text/plain; charset=utf-8", strdup(why), strlen(why)};
    return reply.text ? send_reply(c, &reply) : MHD_NO;
}

static const char *query(void *context, const char *key) {
    return MHD_lookup_connection_value(context, MHD_GET_ARGUMENT_KIND, key);
}

static bool take_body(arriving *a, const char *data, size_t *size) {
    a->too_long = a->too_long || *size > BODY_MAX - a->n;
    if (!a->too_long) {
        memcpy(a->body + a->n, data, *size);
        a->n += *size;
    }
    bool more = *size > 0;
    *size = 0;
    return more;
}

static enum MHD_Result handle(void *context, struct MHD_Connection *c, const char *url, const char *method,
                              const char *version, const char *data, size_t *size, void **own) {
    panel *p = ((panel_server *)context)->panel;
    arriving *a = *own;
    (void)version;
    if (!a) { /* the headers: what is not allowed is not even read */
        if (!is_allowed(p, c))
            return refuse(c, MHD_HTTP_FORBIDDEN,
                          "Open the address that palpate panel printed, with its token.\n");
        *own = calloc(1, sizeof *a);
        return *own ? MHD_YES : MHD_NO;
    }
    if (take_body(a, data, size))
        return MHD_YES;
    bool post = strcmp(method, "POST") == 0;
    if (a->too_long)
        return refuse(c, MHD_HTTP_CONTENT_TOO_LARGE, "That is too long.\n");
    if (!post && strcmp(method, "GET") != 0)
        return refuse(c, MHD_HTTP_METHOD_NOT_ALLOWED, "GET and POST only.\n");
    panel_request request = {.post = post, .path = url, .body = a->body, .query = query, .context = c};
    panel_reply reply = panel_answer(p, &request);
    return reply.text ? send_reply(c, &reply) : refuse(c, MHD_HTTP_INTERNAL_SERVER_ERROR, "out of memory\n");
}

static void forget(void *context, struct MHD_Connection *c, void **own,
                   enum MHD_RequestTerminationCode code) {
    (void)context;
    (void)c;
    (void)code;
    free(*own);
    *own = NULL;
}

/* ---- opening ---- */

static bool make_token(char token[PANEL_TOKEN]) {
    unsigned char byte[(PANEL_TOKEN - 1) / 2];
    FILE *from = fopen("/dev/urandom", "rb");
    bool good = from && fread(byte, sizeof byte, 1, from) == 1;
    if (from)
        fclose(from);
    for (size_t i = 0; i < sizeof byte; i++)
        snprintf(token + 2 * i, 3, "%02x", byte[i]);
    return good;
}

/* Its threads hear no Ctrl-C: that is for the one that owns the indenter. */
static struct MHD_Daemon *start(panel_server *s, unsigned port) {
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    sigset_t all, before;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    struct MHD_Daemon *d = MHD_start_daemon(
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_THREAD_PER_CONNECTION, (uint16_t)port, NULL, NULL, handle,
        s, MHD_OPTION_SOCK_ADDR, (struct sockaddr *)&here, MHD_OPTION_CONNECTION_LIMIT, (unsigned)CONNECTIONS,
        MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE_S, MHD_OPTION_NOTIFY_COMPLETED, forget, NULL,
        MHD_OPTION_LISTENING_ADDRESS_REUSE, 1U, MHD_OPTION_END);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return d;
}

panel_server *panel_server_open(const char *name, panel *p, unsigned port) {
    panel_server *s = calloc(1, sizeof *s);
    if (!s || !make_token(p->token)) {
        free(s);
        cli_failure(name, s ? "/dev/urandom gives no random numbers" : "out of memory");
        return NULL;
    }
    s->panel = p;
    s->daemon = start(s, port);
    const union MHD_DaemonInfo *info =
        s->daemon ? MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_BIND_PORT) : NULL;
    if (!info) {
        cli_failure(
            name, "port %u of this machine cannot be used for the page; choose another by --page-port", port);
        free(s);
        return NULL;
    }
    p->port = info->port;
    return s;
}

void panel_server_close(panel_server *s) {
    MHD_stop_daemon(s->daemon);
    free(s);
}

bool panel_server_there(const char *name) {
    (void)name;
    return true;
}

#else

bool panel_server_there(const char *name) {
    cli_failure(
        name, "this palpate was built without libmicrohttpd, which the page needs; install libmicrohttpd-dev "
              "and build it again");
    return false;
}

panel_server *panel_server_open(const char *name, panel *p, unsigned port) {
    (void)name;
    (void)p;
    (void)port;
    return NULL;
}

void panel_server_close(panel_server *s) {
    (void)s;
}

#endif
