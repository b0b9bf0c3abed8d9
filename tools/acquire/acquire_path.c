/* acquire_path.c: the planned motion of the plate: a table, and the path as points. */
#include "acquire.h"

#include <math.h>

enum { CYCLES = 200, PERIODS = 40, WAVE = 24, WAVE_MOST = 2000 }; /* most periods that are drawn exactly */

void acquire_plan_print(const acquire_plan *plan, FILE *to) {
    fprintf(to, "%-28s %-10s %10s %10s %10s\n", "run", "kind", "deepest_mm", "length_s", "rest_s");
    for (size_t i = 0; i < plan->n; i++) {
        const acquire_run *r = &plan->run[i];
        fprintf(to, "%-28s %-10s %10.4g %10.4g %10.4g\n", r->name, acquire_kind_name(r->kind), r->deepest_mm,
                acquire_run_length_s(r), isnan(r->motion.rest_s) ? 0 : r->motion.rest_s);
    }
}

typedef struct path {
    double time_s, depth_mm;
    json_t *depth, *force;
} path;

static void add(json_t *to, double x, double y) {
    json_array_append_new(to, json_pack("[ff]", x, y));
}

static void go(path *p, double seconds, double depth_mm) {
    p->time_s += seconds;
    p->depth_mm = depth_mm;
    add(p->depth, p->time_s, depth_mm);
}

static void add_cycles(path *p, const palp_wire_segment *s, double target_mm, double rate_mm_s) {
    const double from_mm = p->depth_mm, way_s = fabs(target_mm - from_mm) / rate_mm_s;
    const unsigned shown = s->cycles < CYCLES ? s->cycles : CYCLES;
    const double each_s =
        way_s * s->cycles / shown; /* more periods would not be visible, so they are drawn wider */
    for (unsigned i = 0; i < shown; i++) {
        go(p, each_s, target_mm);
        go(p, each_s, from_mm);
    }
}

/* The phase after t seconds of a sweep whose frequency rises exponentially, in periods. */
static double sweep_phase(double f0_Hz, double f1_Hz, double length_s, double t) {
    const double rise = log(f1_Hz / f0_Hz) / length_s;
    return fabs(rise * length_s) < 1e-9 ? f0_Hz * t : f0_Hz * expm1(rise * t) / rise;
}

static void add_waves(path *p, const palp_wire_segment *s, double amplitude_mm) {
    const bool sweep = s->kind == PALP_WIRE_SEGMENT_SWEEP;
    const double f0_Hz = 1e-3 * s->frequency_mHz, f1_Hz = sweep ? 1e-3 * s->frequency_end_mHz : f0_Hz;
    const double length_s = sweep ? 1e-3 * s->duration_ms : s->cycles / f0_Hz, from_s = p->time_s;
    const double periods = sweep_phase(f0_Hz, f1_Hz, length_s, length_s), middle_mm = p->depth_mm;
    const double points = fmin(fmax(WAVE * fmin(periods, PERIODS), WAVE), WAVE_MOST);
    for (int i = 1; i <= points; i++) {
        double t = length_s * i / points;
        add(p->depth, from_s + t,
            middle_mm + amplitude_mm * sin(2 * acos(-1) * sweep_phase(f0_Hz, f1_Hz, length_s, t)));
    }
    p->time_s = from_s + length_s;
}

/* The depth under force control is not known in advance: it is drawn constant. */
static void add_force(path *p, const palp_wire_segment *s, double force_N) {
    const double rate_N_s = 1e-6 * s->rate_nm_s;
    if (json_array_size(p->force) == 0)
        add(p->force, p->time_s, 0);
    go(p, fmax(-p->depth_mm, 0) / ACQUIRE_SEEK_MM_S, fmax(p->depth_mm, 0));
    p->time_s += rate_N_s > 0 ? fabs(force_N) / rate_N_s : 0;
    add(p->force, p->time_s, force_N);
    p->time_s += 1e-3 * s->duration_ms;
    add(p->force, p->time_s, force_N);
}

static void add_segment(path *p, const palp_wire_segment *s) {
    const double target = 1e-6 * s->target_nm, rate_mm_s = 1e-6 * s->rate_nm_s;
    switch (s->kind & ~PALP_WIRE_SEGMENT_SMOOTH) {
    case PALP_WIRE_SEGMENT_MOVE:
        go(p, fabs(target - p->depth_mm) / rate_mm_s, target);
        break;
    case PALP_WIRE_SEGMENT_HOLD:
        go(p, 1e-3 * s->duration_ms, p->depth_mm);
        break;
    case PALP_WIRE_SEGMENT_CYCLE:
        add_cycles(p, s, target, rate_mm_s);
        break;
    case PALP_WIRE_SEGMENT_FORCE:
        add_force(p, s, target);
        break;
    default:
        add_waves(p, s, target);
    }
}

static json_t *run_json(const acquire_run *r) {
    path p = {.depth = json_array(), .force = json_array()};
    go(&p, 0, r->start_mm);
    go(&p, r->motion.air_s, r->start_mm);
    for (size_t i = 0; i < r->n_segments; i++)
        add_segment(&p, &r->segment[i]);
    go(&p, fabs(p.depth_mm - r->start_mm) / ACQUIRE_BACK_MM_S, r->start_mm);
    go(&p, r->motion.after_s, r->start_mm);
    return json_pack("{ss ss sf sf sf sb so so}", "name", r->name, "kind", acquire_kind_name(r->kind),
                     "deepest_mm", r->deepest_mm, "length_s", acquire_run_length_s(r), "rest_s",
                     isnan(r->motion.rest_s) ? 0.0 : r->motion.rest_s, "repeat", r->repeat, "path", p.depth,
                     "force", p.force);
}

double acquire_plan_time_s(const acquire_plan *plan) {
    double time_s = 0;
    for (size_t i = 0; i < plan->n; i++)
        time_s += acquire_run_length_s(&plan->run[i]) +
                  (plan->run[i].motion.rest_s > 0 ? plan->run[i].motion.rest_s : 0);
    return time_s;
}

json_t *acquire_plan_json(const acquire_plan *plan) {
    json_t *runs = json_array();
    for (size_t i = 0; i < plan->n; i++)
        json_array_append_new(runs, run_json(&plan->run[i]));
    return json_pack("{s{si} sf so}", "palpate", "plan", 1, "length_s", acquire_plan_time_s(plan), "runs",
                     runs);
}
