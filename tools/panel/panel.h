/* panel.h: the parts of palpate panel: the data its threads share, the thread that owns the indenter, the
 * requests of the pages. */
#ifndef PALPATE_PANEL_H
#define PALPATE_PANEL_H

#include "acquire/acquire_session.h"
#include "acquire/acquire_setup.h"

#include <jansson.h>
#include <pthread.h>

enum { PANEL_POINTS = 1 << 16, PANEL_NOTES = 64, PANEL_TOKEN = 33, PANEL_SHOWN = 4000 };

typedef enum panel_what {
    PANEL_NOTHING,
    PANEL_PREPARE,
    PANEL_HOME,
    PANEL_TARE,
    PANEL_CONTACT,
    PANEL_HOLD,
    PANEL_RELEASE,
    PANEL_JOG,
    PANEL_CLEAR,
    PANEL_START
} panel_what;

typedef struct panel_command {
    panel_what what;
    double by_mm, rate_mm_s; /* of JOG; by: positive = down */
    char file[CLI_PATH_MAX]; /* of START: the protocol */
} panel_command;

/* A point of the plots: the mean of a block of samples. */
typedef struct panel_point {
    double time_s;             /* of the device */
    double place_mm, depth_mm; /* below home; below contact, NAN = not known */
    double force_N, error_mm;
    unsigned run; /* 0 = not of a recording */
} panel_point;

/* The newest state that the owner has seen. */
typedef struct panel_view {
    palp_wire_status status;
    palp_wire_limits_now limits;
    palp_wire_info info;
    uint32_t calibration; /* its id; 0: not known yet */
    double calibration_day;
    char doing[64], run[ACQUIRE_NAME];
    size_t number, of, samples, lost;
    double elapsed_s, length_s;
    double place_mm;
    bool recording, gone;
    uint8_t state;
    double case_C;
    unsigned runs; /* recorded since it was started */
} panel_view;

typedef struct panel_note {
    char text[ACQUIRE_WORDS];
    bool bad;
} panel_note;

/* A calculation: it takes long and moves nothing. */
enum { PANEL_JOB_RUNS = 256 };
typedef enum panel_job_what { PANEL_FIT, PANEL_EXPLAIN, PANEL_REPORT } panel_job_what;

typedef struct panel_job {
    panel_job_what what;
    bool started, running, cancelled; /* started: its thread must be joined */
    bool good;                        /* the last one */
    size_t done;                      /* jobs that have ended */
    double next_s;                    /* time for the experiment that explain designs; 0: explain's own */
    pthread_t thread;
    pid_t child; /* 0 = none */
    size_t n;
    char run[PANEL_JOB_RUNS][ACQUIRE_NAME + 8];
} panel_job;

/* One thread owns the indenter. The threads of the requests ask it by the fields that the lock guards. */
typedef struct panel {
    acquire_setup *setup;
    device *device; /* for device_halt alone */
    char token[PANEL_TOKEN];
    unsigned port;
    pthread_mutex_t lock;
    panel_command command;
    bool waiting, busy; /* a command waits to be taken; one is being carried out */
    bool stop;          /* the command that is being carried out must end */
    panel_view view;
    size_t notes; /* counted from the start; the last PANEL_NOTES are kept */
    panel_note note[PANEL_NOTES];
    size_t points; /* likewise */
    panel_point point[PANEL_POINTS];
    panel_job job;
} panel;

/* ---- what is shared (panel_state.c) ---- */

/* False while another command has not ended: a command is never kept for later. */
bool panel_ask(panel *p, const panel_command *command);
void panel_stop(panel *p); /* ends the command in progress; the plate withdraws */
bool panel_take(panel *p, panel_command *command);
void panel_done(panel *p);
bool panel_is_to_stop(panel *p);
void panel_say(panel *p, bool bad, const char *format, ...);
void panel_add(panel *p, const panel_point *point, const panel_view *view);
void panel_see(panel *p, const panel_view *view);
/* State, and the points and notes after those numbers. The caller frees it. */
json_t *panel_live(panel *p, size_t point, size_t note);

/* Takes the current from the motor, whatever the owner is doing. True once the device has confirmed that it
 * stopped. */
bool panel_emergency(panel *p);

/* ---- the owner (panel_owner.c) ---- */

/* Connects, and does what the pages ask for, until Ctrl-C. Returns an exit code. */
int panel_own(panel *p, session *s);

/* ---- requests (panel_answer.c) ---- */

typedef struct panel_request {
    bool post;
    const char *path, *body; /* body: "" where there is none */
    const char *(*query)(void *context, const char *key);
    void *context;
} panel_request;

typedef struct panel_reply {
    unsigned code;
    const char *type;
    char *text; /* from malloc */
    size_t n;
} panel_reply;

panel_reply panel_answer(panel *p, const panel_request *request);

/* ---- the page, and other programs (panel_page.c, panel_child.c) ---- */

char *panel_page(size_t *n); /* from malloc; NULL = out of memory */

/* Runs this program with these arguments until it ends. Returns its exit code, -1 where it did not start.
 * out, words: its stdout and stderr, from malloc. argv ends with NULL; argv[0] is set here. job: notes the
 * child there; may be NULL. */
int panel_child(const char **argv, char **out, char **words, panel *job);

/* ---- what is in the folder (panel_runs.c) ---- */

/* The path of a file in the output folder whose name ends so and has no folder in it. folder: "" or "fits/".
 */
bool panel_file(const panel *p, const char *folder, const char *name, const char *end,
                char path[CLI_PATH_MAX]);
json_t *panel_runs(const panel *p);
json_t *panel_curve(const char *path, char why[ACQUIRE_TEXT]); /* NULL and why */

/* ---- fits, explain, the report (panel_job.c) ---- */

#define PANEL_MODEL "all_runs.json" /* of all chosen runs together, in fits/ */

/* runs: names between commas. next_s: time for the experiment that explain designs; 0: explain's own. False,
 * and why, where no calculation can begin now. */
bool panel_job_start(panel *p, panel_job_what what, const char *runs, double next_s, char why[ACQUIRE_TEXT]);
void panel_job_cancel(panel *p);
void panel_job_close(panel *p);

/* ---- the server (panel_http.c) ---- */

typedef struct panel_server panel_server;

bool panel_server_there(
    const char *name); /* false: this program was built without a server; prints this to stderr */

/* Listens on 127.0.0.1 (port 0 = any that is free), sets p->port; NULL after one line on stderr. */
panel_server *panel_server_open(const char *name, panel *p, unsigned port);
void panel_server_close(panel_server *server);

#endif
