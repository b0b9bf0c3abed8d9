/* cmd_panel.c: palpate panel: a page in the browser to drive an indenter by. */
#include "panel.h"
#include "shared/commands.h"

#include <stdlib.h>
#include <string.h>

static const char NAME[] = "panel";

typedef struct choice {
    acquire_setup setup;
    size_t page_port;
} choice;

static size_t page_options(choice *c, cli_option *list) {
    acquire_options *o = &c->setup.session;
    const cli_option all[] = {
        cli_heading("Page and output"),
        cli_count("page-port", "N", 0, 65535, &c->page_port,
                  "port of the page (default 0: one that is free)"),
        cli_text("out", "DIR", &o->out, "folder of the recordings; made if need be"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static int parse(int argc, char **argv, choice *c) {
    cli_option options[3 * ACQUIRE_SETUP_OPTIONS + RIG_OPTIONS];
    size_t n = acquire_setup_device(&c->setup, options), words;
    n += acquire_setup_specimen(&c->setup, options + n);
    n += page_options(c, options + n);
    n += acquire_setup_columns(&c->setup, options + n);
    rig_options_list(&c->setup.rig, options + n);
    const cli_command command = {NAME,
                                 "--port PORT --out DIR [options]",
                                 "Serves a page that drives an indenter, to the browsers of this machine "
                                 "only. The page shows force, depth and\n"
                                 "faults as they come; it homes, tares, moves the plate, starts runs and "
                                 "has an emergency stop. Prints the\n"
                                 "page's address with a token; a request without the token is refused. "
                                 "Closing the page ends nothing; Ctrl-C\n"
                                 "withdraws the plate and ends.",
                                 "  palpate panel --port rig --out runs\n"
                                 "  palpate panel --port /dev/ttyACM0 --specimen-height-mm 24 --out runs\n",
                                 options,
                                 n + RIG_OPTIONS};
    return cli_parse(&command, argc, argv, NULL, 0, &words);
}

static int serve(choice *c, panel *p, session *s) {
    p->setup = &c->setup;
    p->device = &s->device;
    pthread_mutex_init(&p->lock, NULL);
    panel_server *server = panel_server_open(NAME, p, (unsigned)c->page_port);
    if (!server)
        return CLI_FAILURE;
    printf("http://127.0.0.1:%u/?token=%s\n", p->port, p->token);
    fflush(stdout);
    fputs("palpate panel: open this address in a browser of this machine; Ctrl-C ends\n", stderr);
    int code = panel_own(p, s);
    panel_server_close(server);
    panel_job_close(p);
    pthread_mutex_destroy(&p->lock);
    return code;
}

static int run(choice *c) {
    panel *p = calloc(1, sizeof *p);
    acquire_plan *none = calloc(1, sizeof *none);
    session *s = p && none ? session_open(&c->setup.session, none) : NULL;
    int code = s ? serve(c, p, s) : p && none ? CLI_FAILURE : cli_failure(NAME, "out of memory");
    if (s)
        session_close(s);
    free(none);
    free(p);
    return code;
}

int cmd_panel(int argc, char **argv) {
    choice c = {.setup = acquire_setup_default()};
    int code = parse(argc, argv, &c);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    code = panel_server_there(NAME) ? acquire_setup_check(NAME, &c.setup) : CLI_FAILURE;
    code = code ? code : acquire_setup_prepare(NAME, &c.setup);
    c.setup.settings.paced = true; /* somebody looks on */
    code = code ? code : cli_folder(NAME, c.setup.session.out);
    code = code ? code : acquire_setup_open(NAME, &c.setup);
    if (code)
        return code;
    code = run(&c);
    int closed = acquire_setup_close(&c.setup);
    return code ? code : closed;
}
