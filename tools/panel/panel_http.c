/* panel_http.c: the server, on this machine only: who may ask, and the bytes of a request. Each connection
 * has a thread, so that no request waits for another: the emergency stop must be answered at once. */
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

/* Connections that have not shown the token are few and short. A newcomer closes the oldest of them, so that
 * the emergency stop always finds a place. The reserve is for closed ones whose thread has not ended yet. */
enum {
    BODY_MAX = 1 << 20,
    UNKNOWN_MAX = 32,
    UNKNOWN_IDLE_S = 5,
    KNOWN_MAX = 64,
    KNOWN_IDLE_S = 60,
    RESERVE = 32
};
enum { CONNECTIONS = UNKNOWN_MAX + KNOWN_MAX + RESERVE };

typedef struct visitor {
    int fd;              /* of its connection */
    unsigned long since; /* its number among all connections; 0 = this place is free */
    bool known;          /* it has shown the token */
    bool closing;        /* it was told to go */
} visitor;

struct panel_server {
    panel *panel;
    struct MHD_Daemon *daemon;
    pthread_mutex_t lock; /* of what follows */
    unsigned long came;
    visitor visitor[CONNECTIONS];
};

/* The part of a request that has arrived so far. */
typedef struct arriving {
    size_t n;
    bool too_long;
    char body[BODY_MAX + 1];
} arriving;

/* Takes the same time for every wrong token, so that a guess learns nothing from it. */
static bool is_token(const panel *p, const char *text) {
    unsigned different = 0;
    if (!text || strlen(text) != PANEL_TOKEN - 1)
        return false;
    for (size_t i = 0; i < PANEL_TOKEN - 1; i++)
        different |= (unsigned char)(text[i] ^ p->token[i]);
    return different == 0;
}

/* Whether a request was sent to this machine by one of its own names; the port is that of a tunnel perhaps. A
 * page of another site can reach this server only by a name of its own site, which the browser puts here. */
static bool is_this_machine(const char *host) {
    static const char *const names[] = {"127.0.0.1", "localhost"};
    const size_t n = host ? strcspn(host, ":") : 0;
    const char *port = host && host[n] ? host + n + 1 : "80";
    bool numeric = *port && strspn(port, "0123456789") == strlen(port) && strtoul(port, NULL, 10) <= 65535;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (numeric && strlen(names[i]) == n && strncmp(host, names[i], n) == 0)
            return true;
    return false;
}

/* A page that asks must come from the same host and port as its request goes to. */
static bool is_same_origin(const char *origin, const char *host) {
    static const char scheme[] = "http://";
    return !origin ||
           (strncmp(origin, scheme, sizeof scheme - 1) == 0 && strcmp(origin + sizeof scheme - 1, host) == 0);
}

static bool is_allowed(const panel *p, struct MHD_Connection *c) {
    const char *host = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Host");
    const char *token = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "X-Palpate-Token");
    if (!token)
        token = MHD_lookup_connection_value(c, MHD_GET_ARGUMENT_KIND, "token");
    return is_this_machine(host) &&
           is_same_origin(MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Origin"), host) &&
           is_token(p, token);
}

static void close_oldest_unknown(panel_server *s) {
    visitor *oldest = NULL;
    size_t n = 0;
    for (visitor *v = s->visitor; v < s->visitor + CONNECTIONS; v++) {
        if (!v->since || v->known || v->closing)
            continue;
        n++;
        oldest = !oldest || v->since < oldest->since ? v : oldest;
    }
    if (n >= UNKNOWN_MAX) {
        oldest->closing = true;
        shutdown(oldest->fd, SHUT_RDWR);
    }
}

static visitor *free_place(panel_server *s) {
    visitor *v = s->visitor;
    while (v < s->visitor + CONNECTIONS && v->since)
        v++;
    return v < s->visitor + CONNECTIONS ? v : NULL;
}

/* At a connection's begin and end; the descriptor is closed after the call at its end. */
static void count_visitor(void *context, struct MHD_Connection *c, void **own,
                          enum MHD_ConnectionNotificationCode code) {
    panel_server *s = context;
    pthread_mutex_lock(&s->lock);
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
        close_oldest_unknown(s);
        visitor *v = *own = free_place(s);
        if (v)
            *v = (visitor){.fd = MHD_get_connection_info(c, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd,
                           .since = ++s->came};
    } else if (*own) {
        *(visitor *)*own = (visitor){.since = 0};
    }
    pthread_mutex_unlock(&s->lock);
}

/* After the token was seen. False where too many have shown it: the places left are the emergency stop's. */
static bool admit(panel_server *s, struct MHD_Connection *c, bool emergency) {
    visitor *own = MHD_get_connection_info(c, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
    size_t n = 0;
    pthread_mutex_lock(&s->lock);
    for (size_t i = 0; i < CONNECTIONS; i++)
        n += s->visitor[i].since && s->visitor[i].known;
    bool admitted = own && (own->known || emergency || n < KNOWN_MAX);
    if (admitted)
        own->known = true;
    pthread_mutex_unlock(&s->lock);
    if (admitted)
        MHD_set_connection_option(c, MHD_CONNECTION_OPTION_TIMEOUT, (unsigned)KNOWN_IDLE_S);
    return admitted;
}

/* last: the connection ends with it. */
static enum MHD_Result send_reply(struct MHD_Connection *c, const panel_reply *reply, bool last) {
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
    if (last)
        MHD_add_response_header(response, "Connection", "close");
    enum MHD_Result result = MHD_queue_response(c, reply->code, response);
    MHD_destroy_response(response);
    return result;
}

static enum MHD_Result refuse(struct MHD_Connection *c, unsigned code, const char *why) {
    panel_reply reply = {code, "text/plain; charset=utf-8", strdup(why), strlen(why)};
    return reply.text ? send_reply(c, &reply, true) : MHD_NO;
}

static const char *query(void *context, const char *key) {
    return MHD_lookup_connection_value(context, MHD_GET_ARGUMENT_KIND, key);
}

static bool take_body(arriving *a, const char *data, size_t *size) {
    if (*size == 0) /* the end: there are no data then */
        return false;
    a->too_long = a->too_long || *size > BODY_MAX - a->n;
    if (!a->too_long) {
        memcpy(a->body + a->n, data, *size);
        a->n += *size;
    }
    *size = 0;
    return true;
}

static enum MHD_Result handle(void *context, struct MHD_Connection *c, const char *url, const char *method,
                              const char *version, const char *data, size_t *size, void **own) {
    panel_server *s = context;
    panel *p = s->panel;
    arriving *a = *own;
    (void)version;
    if (!a) { /* the headers: the body of a refused request is not even read */
        if (!is_allowed(p, c))
            return refuse(c, MHD_HTTP_FORBIDDEN,
                          "Open the address that palpate panel printed, with its token.\n");
        if (!admit(s, c, strcmp(url, "/emergency") == 0))
            return refuse(c, MHD_HTTP_SERVICE_UNAVAILABLE, "Too many pages are open; close some.\n");
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
    return reply.text ? send_reply(c, &reply, false)
                      : refuse(c, MHD_HTTP_INTERNAL_SERVER_ERROR, "out of memory\n");
}

static void forget(void *context, struct MHD_Connection *c, void **own,
                   enum MHD_RequestTerminationCode code) {
    (void)context;
    (void)c;
    (void)code;
    free(*own);
    *own = NULL;
}

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

/* Ctrl-C is blocked in its threads: the thread that owns the indenter takes it. */
static struct MHD_Daemon *start(panel_server *s, unsigned port) {
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    sigset_t all, before;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    struct MHD_Daemon *d = MHD_start_daemon(
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_THREAD_PER_CONNECTION | MHD_USE_ITC, (uint16_t)port, NULL,
        NULL, handle, s, MHD_OPTION_SOCK_ADDR, (struct sockaddr *)&here, MHD_OPTION_CONNECTION_LIMIT,
        (unsigned)CONNECTIONS, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)UNKNOWN_IDLE_S,
        MHD_OPTION_NOTIFY_COMPLETED, forget, NULL, MHD_OPTION_NOTIFY_CONNECTION, count_visitor, s,
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
    pthread_mutex_init(&s->lock, NULL);
    s->daemon = start(s, port);
    const union MHD_DaemonInfo *info =
        s->daemon ? MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_BIND_PORT) : NULL;
    if (!info) {
        cli_failure(
            name, "port %u of this machine cannot be used for the page; choose another by --page-port", port);
        pthread_mutex_destroy(&s->lock);
        free(s);
        return NULL;
    }
    p->port = info->port;
    return s;
}

void panel_server_close(panel_server *s) {
    MHD_stop_daemon(s->daemon);
    pthread_mutex_destroy(&s->lock);
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
