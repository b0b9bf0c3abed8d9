/* haptic_loop.c: a 1 kHz thread steps a network and renders its force; a 60 Hz loop reads positions to draw.
 * They share no lock: frames are handed over in a triple buffer. haptic_loop NETWORK.json [SECONDS] */
/* link: -pthread */
#define _POSIX_C_SOURCE 200809L
#include <palpate/palpate.h>

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TICK_NS = 1000000, FRAME_NS = 16666667, FRESH = 4 };

/* What the drawing needs of one tick. */
typedef struct frame {
    double time_s, force_N[3];
    double *positions_m; /* [3 n_nodes] */
} frame;

/* Three frames: the writer fills one, the reader draws one, the third waits in the middle. Each side
 * exchanges its own for the middle one, which is the only thing they both touch; FRESH marks one that was not
 * read yet. */
typedef struct triple_buffer {
    frame frames[3];
    int back, front; /* writer's, reader's */
    int middle;      /* atomic */
} triple_buffer;

typedef struct haptics {
    palp_network *network;
    palp_realtime *realtime;
    palp_tool tool;
    double top_m, height_m;
    long ticks, late;
    triple_buffer buffer;
    palp_status status;
    int running; /* atomic */
} haptics;

/* ---- the hand-over ------------------------------------------------------------------------------- */

static void publish(triple_buffer *b) {
    b->back = __atomic_exchange_n(&b->middle, b->back | FRESH, __ATOMIC_ACQ_REL) & 3;
}

/* The latest frame; the same again if there is no newer one. */
static const frame *latest(triple_buffer *b) {
    if (__atomic_load_n(&b->middle, __ATOMIC_RELAXED) & FRESH)
        b->front = __atomic_exchange_n(&b->middle, b->front, __ATOMIC_ACQ_REL) & 3;
    return &b->frames[b->front];
}

/* ---- the device, which this example plays itself -------------------------------------------------- */

/* Presses a tenth of the height deep and slides to and fro. */
static void read_device(const haptics *h, double time_s, palp_tool *tool) {
    const double press = 0.1 * h->height_m * fmin(time_s / 0.5, 1.0);
    *tool = h->tool;
    tool->position_m[1] = h->top_m + tool->radius_m - press;
    tool->position_m[0] += 0.1 * h->height_m * sin(fmax(time_s - 0.5, 0.0) * 4.0);
}

static void render_force(const double force_N[3]) {
    (void)force_N; /* here the device's driver takes it */
}

/* ---- 1 kHz ---------------------------------------------------------------------------------------- */

static void wait_until(struct timespec *next, long step_ns) {
    next->tv_nsec += step_ns;
    next->tv_sec += next->tv_nsec / 1000000000;
    next->tv_nsec %= 1000000000;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, next, NULL);
}

static int is_past(const struct timespec *deadline, long by_ns) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (now.tv_sec - deadline->tv_sec) * 1000000000 + now.tv_nsec - deadline->tv_nsec > by_ns;
}

static void *haptic_thread(void *user) {
    haptics *h = (haptics *)user;
    const size_t bytes = 3 * palp_mesh_node_count(palp_network_mesh(h->network)) * sizeof(double);
    const palp_budget budget = {0.7e-3, 0, 1e-3}; /* 0.7 ms, or an estimated error of 0.1 % of the force */
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    while (__atomic_load_n(&h->running, __ATOMIC_RELAXED) && !h->status) {
        palp_tool tool;
        palp_tool_force force;
        frame *f = &h->buffer.frames[h->buffer.back];
        wait_until(&next, TICK_NS);
        read_device(h, 1e-3 * (double)h->ticks, &tool);
        palp_network_set_tools(h->network, 1, &tool);
        h->status = palp_realtime_step(h->realtime, 0, 1e-3, &budget, NULL);
        palp_network_tool_force(h->network, &force);
        render_force(force.force_N);
        f->time_s = palp_network_time(h->network);
        memcpy(f->force_N, force.force_N, sizeof f->force_N);
        memcpy(f->positions_m, palp_network_positions(h->network), bytes);
        publish(&h->buffer);
        h->ticks++;
        h->late += is_past(&next, TICK_NS);
    }
    return NULL;
}

/* ---- 60 Hz ---------------------------------------------------------------------------------------- */

/* Here a window would be drawn; this one prints ten lines a second. */
static void draw(const frame *f, long count) {
    if (count % 6 == 0)
        printf("%6.3f s  force %7.4f %7.4f %7.4f N\n", f->time_s, f->force_N[0], f->force_N[1],
               f->force_N[2]);
}

static void draw_loop(haptics *h, double seconds) {
    const long frames = lround(seconds * 60.0);
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    for (long i = 1; i <= frames; i++) {
        wait_until(&next, FRAME_NS);
        draw(latest(&h->buffer), i);
    }
}

/* ---- setting up ----------------------------------------------------------------------------------- */

static int fail(const char *why) {
    fprintf(stderr, "haptic_loop: %s\n", why);
    return 1;
}

/* Puts the middle of the tissue's bottom at the origin, y up. Another rotation would turn it. */
static palp_status place(palp_mesh *mesh) {
    const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double low[3], high[3];
    palp_mesh_bounds(mesh, low, high);
    const double shift[3] = {-(low[0] + high[0]) / 2, -low[1], -(low[2] + high[2]) / 2};
    return palp_mesh_transform(mesh, upright, shift);
}

static palp_status load(const char *path, palp_network **network, palp_error *error) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_mesh *mesh = NULL;
    palp_model model;
    palp_mesh_source source;
    palp_status status = palp_model_read(path, &model, &source, error);
    if (!status)
        status = palp_model_mesh(&model, &mesh, error);
    if (!status)
        status = place(mesh);
    if (!status)
        status = palp_network_from_model(&model, mesh, 1, &bottom, NULL, network, error);
    palp_mesh_free(mesh);
    return status;
}

static palp_status prepare(haptics *h) {
    const palp_contact_settings contact = palp_contact_settings_default();
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const size_t values = 3 * palp_mesh_node_count(palp_network_mesh(h->network));
    double low[3], high[3];
    palp_mesh_bounds(palp_network_mesh(h->network), low, high);
    h->top_m = high[1];
    h->height_m = high[1] - low[1];
    h->tool.shape = PALP_TOOL_SPHERE;
    h->tool.radius_m = h->height_m / 5;
    h->tool.friction = 0.3;
    for (int i = 0; i < 3; i++) {
        h->buffer.frames[i].positions_m = (double *)calloc(values, sizeof(double));
        if (!h->buffer.frames[i].positions_m)
            return PALP_ERR_NO_MEMORY;
    }
    h->buffer.back = 0;
    h->buffer.middle = 1;
    h->buffer.front = 2;
    palp_status status = palp_network_enable_tools(h->network, 1, 0, &contact);
    return status ? status : palp_realtime_create(h->network, &settings, &h->realtime);
}

int main(int argc, char **argv) {
    const double seconds = argc > 2 ? atof(argv[2]) : 2.0;
    palp_error error = {PALP_OK, "usage: haptic_loop NETWORK.json [SECONDS]"};
    pthread_t thread;
    haptics h;
    memset(&h, 0, sizeof h);
    h.running = 1;
    if (argc < 2 || load(argv[1], &h.network, &error))
        return fail(error.text);
    h.status = prepare(&h);
    if (!h.status && pthread_create(&thread, NULL, haptic_thread, &h) == 0) {
        draw_loop(&h, seconds);
        __atomic_store_n(&h.running, 0, __ATOMIC_RELAXED);
        pthread_join(thread, NULL);
        printf("%ld ticks, %ld late\n", h.ticks, h.late);
    }
    palp_realtime_free(h.realtime);
    palp_network_free(h.network);
    for (int i = 0; i < 3; i++)
        free(h.buffer.frames[i].positions_m);
    return h.status ? fail(palp_status_text(h.status)) : 0;
}
