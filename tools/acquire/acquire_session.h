/* acquire_session.h: the parts of a session: orders to the device, waiting, runs, messages. */
#ifndef PALPATE_ACQUIRE_SESSION_H
#define PALPATE_ACQUIRE_SESSION_H

#include "acquire.h"

#include <time.h>

/* Why a session ended or continues. FAILED_SAID: the message is already on stderr. */
typedef enum outcome { GOES_ON, STOPPED, GONE, FAULTED, FAILED, FAILED_SAID } outcome;

typedef struct session session;

enum { ACQUIRE_WORDS = CLI_PATH_MAX + 2 * ACQUIRE_TEXT };

/* An observer, or NULL: called for every message, and asked often whether to stop. */
typedef struct session_watcher {
    void (*heard)(const session *s, const palp_wire_message *m, void *context);
    bool (*stops)(const session *s, void *context);
    void (*told)(bool warning, const char *text, void *context);
    void *context;
} session_watcher;

struct session {
    session_watcher watcher;
    const acquire_options *options;
    const acquire_plan *plan;
    device device;
    acquire_scale scale;
    palp_wire_limits_now limits;   /* in force */
    device_parameters calibration; /* the first of them */
    acquire_file file;             /* of the run in progress */
    acquire_live live;
    const acquire_run *run;
    time_t began;
    size_t number;  /* of the run, from 1 */
    char doing[64]; /* "run 2 of 4" */
    /* as heard last */
    uint8_t state;
    uint32_t tick, status_tick;
    double case_C;
    double heard_s, asked_s;          /* wall clock; asked: last status request or samples */
    bool quiet;                       /* the device was asked to send no samples */
    outcome (*reconnect)(session *s); /* session_reconnect if a broken link is waited for, or NULL */
    bool stopping;                    /* the device is being stopped */
    int stops_seen;
    size_t lossy;     /* runs with too many samples missing; why names the first */
    double faulted_s; /* ticks in the recording; -1 = none */
    char why[ACQUIRE_TEXT];
    json_t *done; /* figures of each run, for the summary */
};

/* Opens the device and catches Ctrl-C; NULL after one line on stderr. */
session *session_open(const acquire_options *options, const acquire_plan *plan);
void session_close(session *s);

/* Commands and queries. what completes "it does not ...". */
outcome session_order(session *s, palp_wire_message *command, const char *what);
outcome session_ask(session *s, palp_wire_message *question, palp_wire_message *answer);
outcome session_status(session *s);
outcome session_from_device(session *s, device_result result, const char *what);
outcome session_segments(session *s, const acquire_run *run);
outcome session_fail(session *s, const char *format, ...); /* keeps the words */

bool session_moving(const session *s);
/* Waits for the end of the motion, or for a time; both in seconds of the device, limit_s at most. */
outcome session_settle(session *s, double limit_s);
outcome session_wait(session *s, double seconds);
outcome session_stream(session *s, bool on);
int session_stops(void); /* number of stop requests */

bool session_is_to_stop(const session *s);

outcome session_listen(session *s); /* receives the frames of a moment */

/* Reopens a broken link (acquire_reconnect.c): one attempt; attempts for options->reconnect_s. */
bool session_reopen(session *s);
outcome session_reconnect(session *s);

/* Preparations of a run (acquire_ready.c). Each writes its name into s->doing. */
outcome session_end_last(session *s);  /* an interrupted session may have left it moving */
outcome session_configure(session *s); /* sets limits, calibration and gains, and turns samples on */
outcome session_read_scale(session *s);
outcome session_home(session *s);
outcome session_tare(session *s);
outcome session_find_contact(session *s); /* the contact is in the status */
/* Checks a run in advance, as the device will. */
outcome session_check_run(session *s, const acquire_run *run);
outcome session_make_ready(session *s); /* all of these, for the whole plan */

/* Run i of the plan, with the pause before it and its file (acquire_run.c). */
outcome session_run(session *s, size_t i);
/* Withdraws the plate in any state; samples until then are recorded. */
outcome session_withdraw(session *s, outcome end);
/* The result in one line; empty on success. Returns the exit code. */
int session_words(const session *s, outcome end, char words[ACQUIRE_WORDS]);

/* Texts (acquire_say.c). */
json_t *session_header(const session *s); /* of the run in progress */
void session_note_run(session *s, const char *cause);
json_t *session_summary(session *s, const char *cause);
void session_tell(const session *s, bool warning, const char *format,
                  ...);                                       /* a line on stderr and to the observer */
void session_line(const session *s, char line[ACQUIRE_TEXT]); /* for the terminal */

#endif
