/* acquire_session.h: the inside of a session: orders to the device, waiting, what is said of it. */
#ifndef PALPATE_ACQUIRE_SESSION_H
#define PALPATE_ACQUIRE_SESSION_H

#include "acquire.h"

#include <time.h>

/* Why a step did not go on. FAILED_SAID: its line is on stderr already. */
typedef enum outcome { GOES_ON, STOPPED, GONE, FAULTED, FAILED, FAILED_SAID } outcome;

typedef struct session {
    const acquire_options *options;
    const acquire_plan *plan;
    device device;
    acquire_scale scale;
    palp_wire_limits_now limits; /* in force */
    acquire_file file; /* of the run in progress */
    acquire_live live;
    const acquire_run *run;
    time_t began;
    size_t number;  /* of the run, from 1 */
    char doing[64]; /* "run 2 of 4" */
    /* as heard last */
    uint8_t state;
    uint32_t tick, status_tick;
    double case_C;
    double heard_s, asked_s; /* wall clock; asked: also when samples came */
    bool quiet;              /* it is to send no samples */
    bool stopping;           /* a wish to stop is being obeyed */
    int stops_seen;
    size_t lossy;     /* runs of which too much is missing; the first of them in why */
    double faulted_s; /* into the recording; -1 = not in one */
    char why[ACQUIRE_TEXT];
    json_t *done; /* what is said of each run */
} session;

/* Opens the device and catches Ctrl-C; NULL after one line on stderr. */
session *session_open(const acquire_options *options, const acquire_plan *plan);
void session_close(session *s);

/* Orders and questions. what completes "it does not ...". */
outcome session_order(session *s, palp_wire_message *command, const char *what);
outcome session_ask(session *s, palp_wire_message *question, palp_wire_message *answer);
outcome session_status(session *s);
outcome session_segments(session *s, const acquire_run *run);
outcome session_fail(session *s, const char *format, ...); /* keeps the words */

bool session_moving(const session *s);
/* Until the motion that was ordered is over; both in seconds of the device, limit_s bounds it. */
outcome session_settle(session *s, double limit_s);
outcome session_wait(session *s, double seconds);
outcome session_stream(session *s, bool on);
int session_stops(void); /* how often somebody wished to stop */

/* What is said of it (acquire_say.c). */
json_t *session_header(const session *s); /* of the run in progress */
void session_note_run(session *s, const char *cause);
json_t *session_summary(session *s, const char *cause);
void session_line(const session *s, char line[ACQUIRE_TEXT]); /* for the terminal */

#endif
