/* acquire_monitor.c: shows an indenter's readings without a run: nothing is moved, set or recorded. */
#define _POSIX_C_SOURCE 200809L
#include "acquire_session.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static const char NAME[] = "acquire";
static const double SHOW_S = 0.1; /* of the device */

typedef struct monitor {
    bool terminal, shown;
    uint32_t shown_tick;
} monitor;

static void print(const session *s, const palp_wire_samples *b, const monitor *m) {
    const palp_wire_status *now = &s->device.status;
    const double place_mm = s->scale.count_mm * b->position[0], contact_mm = s->scale.count_mm * now->contact;
    const double time_s = s->scale.tick_s * b->tick, force_N = acquire_force_N(&s->scale, b->adc);
    const double error_um = 1e3 * s->scale.count_mm * b->error[0], winding_C = 1e-2 * now->winding_cC;
    char depth[32] = "";
    if (now->contact_known)
        snprintf(depth, sizeof depth, "%.3f", place_mm - contact_mm);
    if (m->terminal)
        printf("\r\033[K%-8s %8.3f N  %s %8.3f mm  error %6.1f um  case %.1f C  motor %.1f C  %s",
               palp_wire_state_name(b->state), force_N, now->contact_known ? "depth" : "below home",
               now->contact_known ? place_mm - contact_mm : place_mm, error_um, s->case_C, winding_C,
               now->fault ? palp_wire_fault_name(now->fault) : "");
    else
        printf("%.3f,%.3f,%s,%.5f,%.1f,%.2f,%.2f,%s,%s\n", time_s, place_mm, depth, force_N, error_um,
               s->case_C, winding_C, palp_wire_state_name(b->state), palp_wire_fault_name(now->fault));
}

static void heard(const session *s, const palp_wire_message *message, void *context) {
    monitor *m = context;
    const palp_wire_samples *b = &message->as.samples;
    if (message->type != PALP_WIRE_TYPE_SAMPLES || b->count == 0)
        return;
    if (m->shown && s->scale.tick_s * (b->tick - m->shown_tick) < SHOW_S)
        return;
    m->shown = true;
    m->shown_tick = b->tick;
    print(s, b, m);
    fflush(stdout);
}

static outcome watch(session *s) {
    outcome end = session_read_scale(s);
    end = end ? end : session_stream(s, true);
    while ((end == GOES_ON || end == FAULTED) && session_stops() == 0 && !ferror(stdout))
        end = session_listen(s);
    return end;
}

int acquire_monitor(const acquire_options *options) {
    static const acquire_plan none;
    monitor m = {.terminal = isatty(STDOUT_FILENO) == 1};
    char words[ACQUIRE_WORDS];
    session *s = session_open(options, &none);
    if (!s)
        return CLI_FAILURE;
    snprintf(s->doing, sizeof s->doing, "watching");
    s->reconnect = options->reconnect_s > 0 ? session_reconnect : NULL;
    if (!m.terminal)
        puts("time_s,place_mm,depth_mm,force_N,error_um,case_C,winding_C,state,fault");
    s->watcher = (session_watcher){heard, NULL, NULL, &m};
    outcome end = watch(s);
    s->watcher.heard = NULL;
    if (m.terminal)
        putchar('\n');
    int code = CLI_OK;
    if (end != GOES_ON && end != STOPPED && end != FAULTED) {
        session_words(s, end, words);
        code = cli_failure(NAME, "%s", words);
    }
    if (end != GONE)
        session_stream(s, false);
    session_close(s);
    return code;
}
