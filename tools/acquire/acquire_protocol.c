/* acquire_protocol.c: the runs of a session: defaults of each, the protocol of the thesis, their order. */
#include "acquire.h"

#include <math.h>
#include <palpate/random.h>
#include <string.h>

static const char *const kinds[ACQUIRE_KINDS] = {"static", "ramp_hold", "cyclic", "sine",
                                                 "sweep",  "segments",  "free"};

const char *acquire_kind_name(acquire_kind kind) {
    return kinds[kind];
}

acquire_motion acquire_motion_none(void) {
    acquire_motion m;
#define ACQUIRE_NONE(name, mask, zero, most) m.name = NAN;
    ACQUIRE_FIGURES(ACQUIRE_NONE)
#undef ACQUIRE_NONE
    return m;
}

static bool has_ramp(acquire_kind kind) {
    return kind == ACQUIRE_RAMP_HOLD || kind == ACQUIRE_FREE;
}

void acquire_motion_inherit(acquire_kind kind, acquire_motion *m, const acquire_motion *from) {
    acquire_motion next = *from;
    if (has_ramp(kind) && (!isnan(m->rate_mm_s) || !isnan(m->ramp_s)))
        next.rate_mm_s = next.ramp_s = NAN;
#define ACQUIRE_TAKE(name, mask, zero, most) m->name = isnan(m->name) ? next.name : m->name;
    ACQUIRE_FIGURES(ACQUIRE_TAKE)
#undef ACQUIRE_TAKE
}

/* What nobody says. */
static acquire_motion built_in(acquire_kind kind, double depth_mm) {
    acquire_motion m = acquire_motion_none();
    bool waves = kind == ACQUIRE_SINE || kind == ACQUIRE_SWEEP;
    m.rate_mm_s = kind == ACQUIRE_STATIC ? 0.1 : kind == ACQUIRE_CYCLIC || waves ? 1 : NAN;
    m.ramp_s = kind == ACQUIRE_RAMP_HOLD || kind == ACQUIRE_FREE ? 1 : NAN;
    m.depth_mm = kind == ACQUIRE_FREE ? 0 : NAN;
    m.hold_s = kind == ACQUIRE_RAMP_HOLD ? 200 : 10;
    m.cycles = kind == ACQUIRE_SINE ? 10 : 3;
    m.amplitude_mm = 0.1 * depth_mm;
    m.frequency_Hz = kind == ACQUIRE_SWEEP ? 0.1 : 1;
    m.frequency_end_Hz = 10;
    m.duration_s = 60;
    m.acceleration_mm_s2 = 500;
    m.air_mm = m.air_s = m.after_s = 1;
    return m;
}

/* Fills in the motion and removes parameters that the kind does not have. */
static void complete(acquire_run *r) {
    acquire_motion *m = &r->motion, rest = built_in(r->kind, m->depth_mm);
    acquire_motion_inherit(r->kind, m, &rest);
    if (has_ramp(r->kind)) {
        m->rate_mm_s = isnan(m->ramp_s) ? m->rate_mm_s : m->depth_mm / m->ramp_s;
        m->ramp_s = m->depth_mm / m->rate_mm_s;
    }
#define ACQUIRE_KEEP(name, mask, zero, most) m->name = ((mask) >> r->kind & 1) ? m->name : NAN;
    ACQUIRE_FIGURES(ACQUIRE_KEEP)
#undef ACQUIRE_KEEP
}

static void name_run(acquire_run *r, const char *name) {
    if (name)
        snprintf(r->name, sizeof r->name, "%s", name);
    else if (r->motion.depth_mm > 0 && r->kind != ACQUIRE_FREE)
        snprintf(r->name, sizeof r->name, "%s_%gmm", kinds[r->kind], r->motion.depth_mm);
    else
        snprintf(r->name, sizeof r->name, "%s", r->kind == ACQUIRE_FREE ? "air" : kinds[r->kind]);
}

acquire_run *acquire_plan_add(acquire_plan *plan, acquire_kind kind, const acquire_motion *motion,
                              const char *name, char why[ACQUIRE_TEXT]) {
    if (plan->n == ACQUIRE_RUNS) {
        snprintf(why, ACQUIRE_TEXT, "is too many: a protocol has at most %d runs", ACQUIRE_RUNS);
        return NULL;
    }
    if (kind != ACQUIRE_FREE && kind != ACQUIRE_SEGMENTS && !(motion->depth_mm > 0)) {
        snprintf(why, ACQUIRE_TEXT, "needs depth_mm, above 0");
        return NULL;
    }
    acquire_run *r = &plan->run[plan->n++];
    *r = (acquire_run){.kind = kind, .motion = *motion, .smooth = plan->smooth};
    complete(r);
    name_run(r, name);
    acquire_segments_make(r);
    return r;
}

/* ---- the thesis' protocol (Section 4.2) ---- */

static bool add_seed(acquire_plan *plan, acquire_kind kind, double depth_mm, const acquire_motion *defaults,
                     char why[ACQUIRE_TEXT]) {
    acquire_motion m = acquire_motion_none();
    m.depth_mm = depth_mm;
    acquire_motion_inherit(kind, &m, defaults);
    return acquire_plan_add(plan, kind, &m, NULL, why) != NULL;
}

/* A ramp in air at the speed of the middle ramp shows inertia and drift. */
static bool add_air(acquire_plan *plan, const char *name, const acquire_motion *defaults,
                    char why[ACQUIRE_TEXT]) {
    acquire_motion m = acquire_motion_none();
    m.depth_mm = 4;
    m.hold_s = 10;
    acquire_motion_inherit(ACQUIRE_FREE, &m, defaults);
    return acquire_plan_add(plan, ACQUIRE_FREE, &m, name, why) != NULL;
}

bool acquire_plan_seed(acquire_plan *plan, const acquire_motion *defaults, char why[ACQUIRE_TEXT]) {
    bool good = add_air(plan, "air_before", defaults, why);
    for (int i = 0; good && i < 12; i++)
        good = add_seed(plan, ACQUIRE_RAMP_HOLD, 1.5 + 0.5 * i, defaults, why);
    plan->random = plan->random < 0 ? 1 : plan->random;
    plan->repeat_first = plan->repeat_first < 0 ? 1 : plan->repeat_first;
    return good && add_seed(plan, ACQUIRE_STATIC, 9.7, defaults, why) &&
           add_air(plan, "air_after", defaults, why);
}

static void shuffle(acquire_plan *plan, const size_t *press, size_t n) {
    uint64_t state = (uint64_t)plan->seed;
    for (size_t i = n; i > 1; i--) {
        acquire_run *a = &plan->run[press[i - 1]], *b = &plan->run[press[palp_random_next(&state) % i]];
        acquire_run moved = *a;
        *a = *b;
        *b = moved;
    }
}

static bool repeat_first(acquire_plan *plan, size_t first, size_t last) {
    if (plan->n == ACQUIRE_RUNS)
        return false;
    memmove(&plan->run[last + 2], &plan->run[last + 1], (plan->n - last - 1) * sizeof plan->run[0]);
    plan->n++;
    acquire_run *r = &plan->run[last + 1];
    *r = plan->run[first];
    r->repeat = true;
    r->name[ACQUIRE_NAME - 16] = '\0';
    strcat(r->name, "_repeat");
    return true;
}

static bool taken(const acquire_plan *plan, size_t i) {
    size_t j = 0;
    while (j < i && strcmp(plan->run[j].name, plan->run[i].name) != 0)
        j++;
    return j < i;
}

/* Numbers a name that exists already. */
static void number_names(acquire_plan *plan) {
    for (size_t i = 0; i < plan->n; i++) {
        char *name = plan->run[i].name;
        size_t length = strlen(name) < ACQUIRE_NAME - 8 ? strlen(name) : ACQUIRE_NAME - 8;
        for (unsigned k = 2; taken(plan, i); k++)
            snprintf(name + length, ACQUIRE_NAME - length, "_%u", k % 1000);
    }
}

/* A specimen recovers a little more slowly than it relaxes. So it rests as long as the last press took, and
 * at least until the phantom of the thesis has recovered to 0.5 %. */
static void fill_rests(acquire_plan *plan) {
    const double least_s = 200;
    double needed_s = 0;
    for (size_t i = 0; i < plan->n; i++) {
        acquire_run *r = &plan->run[i];
        if (r->kind != ACQUIRE_FREE) {
            r->motion.rest_s = needed_s > 0 && !isnan(r->motion.rest_s) ? r->motion.rest_s : needed_s;
            needed_s = fmax(r->press_s, least_s);
        }
    }
}

bool acquire_plan_arrange(acquire_plan *plan) {
    size_t press[ACQUIRE_RUNS], n = 0;
    for (size_t i = 0; i < plan->n; i++)
        if (plan->run[i].kind != ACQUIRE_FREE)
            press[n++] = i;
    plan->seed = isnan(plan->seed) ? 1 : plan->seed;
    if (plan->random == 1)
        shuffle(plan, press, n);
    if (plan->repeat_first == 1 && n > 0 && !repeat_first(plan, press[0], press[n - 1]))
        return false;
    number_names(plan);
    fill_rests(plan);
    return true;
}
