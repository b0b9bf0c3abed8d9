/* rig.c: the virtual indenter: the firmware and the plant in lockstep, record by record. */
#define _POSIX_C_SOURCE 200809L
#include "rig.h"
#include "shared/cli.h"
#include "rig_internal.h"
#include "rig_port.h"

#include "app.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { TICK_NS = 1000000 };

typedef struct loop {
    const char *name;
    const rig_settings *settings;
    const volatile int *stop;
    void (*on_port)(const char *port, void *context);
    void *context;
    plant *plant;
    rig_process process;
    rig_feed feed;
    palp_file log;
    bool booted;
    rig_port port;
    char port_name[RIG_NOTE];
    plant_in in; /* the last record sent to the firmware */
    int64_t start_ns;
    rig_figures figures;
} loop;

rig_settings rig_settings_default(void) {
    return (rig_settings){.plant = plant_settings_default(), .port = "pty", .patience_s = 15};
}

static int64_t now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Waits for the tick's time, or counts by how much it is late. */
static void pace(loop *l) {
    int64_t due_ns = l->start_ns + (int64_t)l->in.tick * TICK_NS, late_ns = now_ns() - due_ns;
    struct timespec due = {.tv_sec = (time_t)(due_ns / 1000000000), .tv_nsec = (long)(due_ns % 1000000000)};
    while (!*l->stop && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL) == EINTR) {
    }
    l->figures.late += late_ns > TICK_NS;
    l->figures.worst_s = fmax(l->figures.worst_s, 1e-9 * (double)late_ns);
}

static int open_log(loop *l) {
    const char *path = l->settings->log;
    if (!path)
        return CLI_OK;
    int code = cli_file_open(l->name, path, &l->log);
    if (code)
        return code;
    fputs("time_s,carriage_mm,velocity_mm_s,depth_mm,force_N,winding_C,case_C,current_A,duty,motor_on,"
          "trigger_out\n",
          l->log.stream);
    return CLI_OK;
}

static void log_tick(loop *l, const plant_out *out) {
    if (l->log.stream) {
        plant_truth t = plant_look(l->plant);
        fprintf(l->log.stream, "%.3f,%.7g,%.6g,%.7g,%.7g,%.6g,%.6g,%.6g,%.5g,%d,%d\n", t.time_s,
                1e3 * t.carriage_m, 1e3 * t.velocity_m_s, 1e3 * t.depth_m, t.force_N, t.winding_C, t.case_C,
                t.current_A, out->duty / 32767.0, out->motor == PLANT_MOTOR_ON, out->trigger);
    }
}

/* Keeps the rows up to a failure of the run. */
static int close_log(loop *l, int code) {
    int closed = l->log.stream ? cli_file_close(l->name, &l->log) : CLI_OK;
    return code ? code : closed;
}

static int firmware_ended(loop *l) {
    return cli_failure(l->name, "the firmware has ended%s%s", l->process.last[0] ? ": " : "",
                       l->process.last);
}

/* The firmware's next record. CLI_OK with *got false: stopped. */
static int receive(loop *l, plant_out *out, bool *got) {
    uint8_t byte[PLANT_LINK_OUT];
    size_t n = 0;
    int64_t until_ns = now_ns() + (int64_t)(1e9 * l->settings->patience_s);
    *got = false;
    while (n < sizeof byte && !*l->stop) {
        struct pollfd wait[2] = {{.fd = l->process.from, .events = POLLIN},
                                 {.fd = l->process.text, .events = POLLIN}};
        int64_t left_ms = (until_ns - now_ns()) / 1000000;
        int ready = poll(wait, 2, left_ms > 0 ? (int)left_ms : 0);
        if (ready == 0)
            return cli_failure(l->name, "the firmware does not answer%s%s", l->process.last[0] ? ": " : "",
                               l->process.last);
        ssize_t some = ready > 0 && wait[0].revents ? read(l->process.from, byte + n, sizeof byte - n) : 0;
        n += some > 0 ? (size_t)some : 0;
        if (ready > 0 && wait[1].revents && !rig_process_listen(&l->process) && n < sizeof byte)
            return firmware_ended(l);
    }
    *got = n == sizeof byte;
    plant_link_get_out(byte, out);
    return CLI_OK;
}

static int feed(loop *l) {
    uint8_t byte[PLANT_LINK_IN];
    plant_link_put_in(&l->in, byte);
    return write(l->process.to, byte, sizeof byte) == (ssize_t)sizeof byte
               ? CLI_OK
               : cli_failure(l->name, "the firmware takes no records");
}

/* Why the board restarted: by the event that the plant asked for. */
static uint8_t reset_cause(const loop *l) {
    const uint8_t events = l->booted ? l->in.events : 0;
    return (events & PLANT_EVENT_HANG)        ? APP_RESET_WATCHDOG
           : (events & PLANT_EVENT_BROWN_OUT) ? APP_RESET_BROWN_OUT
                                              : APP_RESET_POWER;
}

/* What the board senses when it starts. */
static void boot(loop *l) {
    const uint8_t cause = reset_cause(l);
    if (!l->booted)
        rig_feed_plant(&l->feed, 0, l->plant);
    plant_first(l->plant, &l->in);
    l->in.reset_cause = cause;
    l->figures.restarts += l->booted;
    if (!l->booted && l->on_port)
        l->on_port(l->port_name, l->context);
    l->booted = true;
}

static int advance(loop *l, const plant_out *out) {
    palp_error error = {PALP_OK, ""};
    if (out->version != PLANT_LINK_VERSION)
        return cli_failure(
            l->name, "the firmware's link to the plant has version %d, not %d; rebuild it with make firmware",
            out->version, PLANT_LINK_VERSION);
    bool all = rig_port_write(&l->port, out->tx, out->tx_count);
    if (out->boot || !l->booted) {
        boot(l);
    } else {
        rig_feed_plant(&l->feed, l->in.tick + 1, l->plant);
        palp_status status = plant_step(l->plant, out, &l->in, &error);
        if (status)
            return cli_status(l->name, status, &error);
    }
    l->figures.ticks = l->in.tick;
    l->figures.cost = out->cost > l->figures.cost ? out->cost : l->figures.cost;
    log_tick(l, out);
    rig_feed_record(&l->feed, l->plant, &l->in);
    l->in.rx_count +=
        (uint8_t)rig_port_read(&l->port, l->in.rx + l->in.rx_count, PLANT_LINK_RX - l->in.rx_count);
    l->in.events |= all ? 0 : PLANT_EVENT_STALL_TX;
    return CLI_OK;
}

/* Bytes for the host that were still in the firmware at the end. */
static int take_rest(loop *l) {
    static const volatile int never;
    plant_out out = {.tx_count = 0};
    bool got = true;
    int code = CLI_OK;
    l->stop = &never;
    do {
        code = receive(l, &out, &got);
    } while (code == CLI_OK && got && rig_port_write(&l->port, out.tx, out.tx_count) && out.tx_count > 0);
    return code;
}

static int run(loop *l) {
    bool got = true;
    plant_out out;
    int code = CLI_OK;
    uint32_t last = l->settings->until_s > 0 ? (uint32_t)llround(1e3 * l->settings->until_s) : UINT32_MAX;
    while (code == CLI_OK && !(l->in.events & PLANT_EVENT_QUIT)) {
        code = receive(l, &out, &got);
        if (code == CLI_OK && got)
            code = advance(l, &out);
        if (l->settings->paced && code == CLI_OK && got) {
            l->start_ns = l->in.tick == 0 ? now_ns() : l->start_ns;
            pace(l);
        }
        if (*l->stop || (l->booted && l->in.tick >= last))
            l->in.events |= PLANT_EVENT_QUIT;
        if (code == CLI_OK)
            code = feed(l);
    }
    return code == CLI_OK ? take_rest(l) : code;
}

static int run_plant(loop *l) {
    palp_error error = {PALP_OK, ""};
    palp_status status = plant_create(&l->settings->plant, &l->plant, &error);
    int code = status ? cli_status(l->name, status, &error) : rig_feed_open(l->name, l->settings, &l->feed);
    code = code ? code : open_log(l);
    code =
        code ? code : rig_port_open(l->name, l->settings->port, &l->port, l->port_name, sizeof l->port_name);
    if (code == CLI_OK) {
        int64_t start_ns = now_ns();
        code = rig_process_start(l->name, l->settings, &l->process);
        code = code ? code : run(l);
        rig_process_end(&l->process);
        l->figures.elapsed_s = 1e-9 * (double)(now_ns() - start_ns);
    }
    code = close_log(l, code);
    int closed = rig_port_close(&l->port);
    code = code ? code : closed;
    rig_feed_free(&l->feed);
    plant_free(l->plant);
    return code;
}

int rig_run(const char *name, const rig_settings *settings, const volatile int *stop,
            void (*on_port)(const char *port, void *context), void *context, rig_figures *figures) {
    rig_settings own = *settings;
    char note[RIG_NOTE];
    if (!own.image[0] && !rig_find(&own, note))
        return cli_failure(name, "%s", note);
    loop l = {.name = name, .settings = &own, .stop = stop, .on_port = on_port, .context = context};
    l.port = (rig_port){.listener = -1, .connection = -1};
    int code = run_plant(&l);
    if (figures)
        *figures = l.figures;
    return code;
}
