/* self_test.c: the generator's physics against closed forms, and its judge against what must hold. */
#include "hidden.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846, H = 0.02, K = 8, STEP = 0.001;

static int failures;

static void check(const char *what, double got, double wanted, double allowed) {
    bool good = fabs(got - wanted) <= allowed;
    printf("%-58s %12.6g  %12.6g%s\n", what, got, wanted, good ? "" : "   WRONG");
    failures += !good;
}

/* A linear spring, no arms. */
static world spring(void) {
    return (world){.height = H, .radius = H / 2, .law = {K}};
}

static world maxwell(void) {
    world w = spring();
    w.n_arms = 1;
    w.arms[0] = (arm){3, 0.7};
    return w;
}

/* From the surface at speed to depth, sharp corners; 1000 samples a second. */
static run press(double depth, double speed) {
    run r = {.kind = "ramp_hold", .Hz = 1000, .n = 3001};
    path_start(&r, 0);
    path_to(&r, depth, speed);
    return r;
}

static double force_at(const world *w, const run *r, double t) {
    double *force = malloc(r->n * sizeof *force);
    if (!force)
        abort();
    world_run(w, r, STEP, false, NULL, NULL, force);
    double f = force[(size_t)floor(t * r->Hz + 0.5)];
    free(force);
    return f;
}

static void test_path(void) {
    run r = press(5e-3, 5e-3);
    double d, v, a, d2, v2, a2, worst = 0, t = 0.005;
    path_wait(&r, 1);
    r.corner = 0.2;
    for (size_t h1 = 0, h2 = 0; t < 1.99; t += 0.01) {
        path_at(&r, t, &h1, &d, &v, &a);
        path_at(&r, t + 1e-6, &h2, &d2, &v2, &a2);
        worst = fmax(worst, fabs((d2 - d) / 1e-6 - v) + 0.01 * fabs((v2 - v) / 1e-6 - a));
    }
    check("path: speed and acceleration are derivatives", worst, 0, 1e-6);
    size_t hint = 0;
    path_at(&r, 1.5, &hint, &d, &v, &a);
    check("path: arrives", d, 5e-3, 1e-12);
}

static void test_arm(void) {
    world w = maxwell();
    run r = press(4e-3, 4e-3);
    path_wait(&r, 2);
    double e = 0.2, rise = 3 * 0.7 * e * (1 - exp(-1 / 0.7));
    check("arm: end of the ramp", force_at(&w, &r, 1), K * e + rise, 1e-5);
    check("arm: 1 s later", force_at(&w, &r, 2), K * e + rise * exp(-1 / 0.7), 1e-5);
    w.n_arms = 0;
    w.value[RELAXATION_ARM][0] = 3;
    w.value[RELAXATION_ARM][1] = 0.7;
    check("relaxation_arm: the same as an effect", force_at(&w, &r, 2), K * e + rise * exp(-1 / 0.7), 1e-5);
}

static void test_springpot(void) {
    world w = spring();
    run r = press(4e-3, 4e-3);
    double c = 2, a = 0.3;
    path_wait(&r, 2);
    w.value[POWER_LAW_RELAXATION][0] = c;
    w.value[POWER_LAW_RELAXATION][1] = a;
    check("power_law: end of the ramp", force_at(&w, &r, 1), 0.2 * (K + c / tgamma(2 - a)), 1e-9);
    check("power_law: 1 s later", force_at(&w, &r, 2), 0.2 * (K + c / tgamma(2 - a) * (pow(2, 1 - a) - 1)),
          1e-9);
    r.Hz = 50;
    r.n = 151;
    check("power_law: with steps between the samples", force_at(&w, &r, 2),
          0.2 * (K + c / tgamma(2 - a) * (pow(2, 1 - a) - 1)), 1e-9);
}

/* Integral of the consolidation modulus from 0 to t. */
static double drained(double time, double t) {
    double sum = 0;
    for (int n = 1; n < 400; n += 2)
        sum += time / pow(n, 4) * -expm1(-n * n * t / time);
    return t > 0 ? 8 / (pi * pi) * sum : 0;
}

static void test_pores(void) {
    world w = spring();
    run r = press(4e-3, 4e-3);
    path_wait(&r, 2);
    w.value[POROELASTIC][0] = 2;
    for (double time = 0.3; time < 100; time *= 5) {
        w.value[POROELASTIC][1] = time;
        check("poroelastic: end of the ramp", force_at(&w, &r, 1), 0.2 * (K + 2 * drained(time, 1)), 2e-4);
        check("poroelastic: 1 s later", force_at(&w, &r, 2),
              0.2 * (K + 2 * (drained(time, 2) - drained(time, 1))), 2e-4);
    }
}

static void test_memory(void) {
    world w = spring();
    run r = press(4e-3, 4e-3);
    path_to(&r, 0, 4e-3);
    path_wait(&r, 1);
    w.value[DAMAGE_SOFTENING][0] = 0.3;
    w.value[DAMAGE_SOFTENING][1] = 0.5;
    check("damage: loading", force_at(&w, &r, 0.5), K * 0.1, 1e-9);
    check("damage: unloading", force_at(&w, &r, 1.5), K * 0.1 * (1 - 0.3 * erf(0.75 / 0.5)), 1e-9);
    w = spring();
    w.value[PERMANENT_SET][0] = 0.25;
    check("set: loading", force_at(&w, &r, 0.5), K * 0.1, 1e-9);
    check("set: unloading", force_at(&w, &r, 1.5), K * (0.1 - 0.05) / 0.75, 1e-9);
    check("set: below the set", force_at(&w, &r, 1.8), 0, 1e-9);
    w = maxwell();
    w.value[STRAIN_DEPENDENT_ARM][0] = 4;
    r = press(4e-3, 4);
    path_wait(&r, 2.5);
    w.value[STRAIN_DEPENDENT_ARM][1] = 3;
    double q = 3 * (0.2 + 4 * 0.02); /* of a fast ramp: K (e + beta e^2 / 2) */
    check("strain_dependent: fast ramp", force_at(&w, &r, 0.002), K * 0.2 + q, 0.01);
    check("strain_dependent: 1 s later", force_at(&w, &r, 1), K * 0.2 + q * exp(-1 / (0.7 * 1.6)), 0.01);
}

static void test_rate(void) {
    world w = spring();
    run r = press(4e-3, 4e-3);
    path_wait(&r, 2);
    w.value[RATE_STIFFENING][0] = 0.1;
    check("rate_stiffening: ramp", force_at(&w, &r, 0.5), K * 0.1 * (1 + 0.1 * log10(1 + 0.2 / 0.01)), 1e-9);
    check("rate_stiffening: hold", force_at(&w, &r, 2), K * 0.2, 1e-9);
}

static void test_contact(void) {
    world w = spring();
    run r = press(4e-3, 4e-3);
    path_to(&r, -2e-3, 4e-3);
    path_wait(&r, 1);
    w.value[FRAME_COMPLIANCE][0] = 3e-4;
    check("frame_compliance", force_at(&w, &r, 0.5), K * 0.1 / (1 + K * 3e-4 / H), 1e-9);
    w = spring();
    w.value[TOE_REGION][0] = 1e-3;
    check("toe_region", force_at(&w, &r, 0.5), K * (2 + expm1(-2)) * 1e-3 / H, 1e-9);
    w = spring();
    w.value[CONTACT_OFFSET][0] = 5e-4;
    check("contact_offset", force_at(&w, &r, 0.5), K * 1.5e-3 / H, 1e-9);
    w = spring();
    w.value[ADHESION][0] = 0.2; /* lets go at -0.5 mm */
    check("adhesion: pulls", force_at(&w, &r, 2.1), -K * 0.4e-3 / H, 1e-9);
    check("adhesion: has let go", force_at(&w, &r, 2.15), 0, 1e-12);
    w.value[ADHESION][0] = 0;
    check("no adhesion: does not pull", force_at(&w, &r, 2.1), 0, 1e-12);
}

/* The surface that a fast plate left behind: e0 exp(-t K / (tau (K + K1))); met again by a fast plate. */
static void test_recovery(void) {
    world w = maxwell();
    run r = press(4e-3, 4);
    path_wait(&r, 1);
    path_to(&r, -4e-3, 8);
    path_wait(&r, 0.5);
    path_to(&r, 3e-3, 7);
    path_wait(&r, 1);
    double q = 3 * 0.2 * exp(-1 / 0.7), left = (3 * 0.2 - q) / (K + 3);
    double now = left * exp(-0.5 / 0.7 * K / (K + 3));
    double met = (K + 3) * (0.15 - now), at = 1.503;
    check("recovery: in air", force_at(&w, &r, 1.3), 0, 1e-12);
    check("recovery: met again", force_at(&w, &r, at), met, 0.01);
}

static void test_instrument(void) {
    world w = spring();
    run r = press(4e-3, 4e-3);
    path_wait(&r, 2);
    w.value[SENSOR_LAG][0] = 0.05;
    check("sensor_lag", force_at(&w, &r, 0.5), K * (0.1 - 0.2 * 0.05 * (1 - exp(-10))), 1e-6);
    w.value[SENSOR_LAG][0] = 0;
    w.value[SENSOR_GAIN][0] = 0.1;
    w.value[SENSOR_BIAS][0] = 0.3;
    w.value[SENSOR_DRIFT][0] = 0.02;
    w.value[COULOMB_FRICTION][0] = 0.05;
    check("gain, friction, bias, drift", force_at(&w, &r, 0.5), 1.1 * K * 0.1 + 0.3 + 0.01 + 0.05 * 4 / 4.01,
          1e-9);
    w.value[FORCE_SATURATION][0] = 1;
    check("force_saturation", force_at(&w, &r, 0.9), 1, 1e-12);
    w = spring();
    r.session = 1800;
    w.value[SESSION_AGEING][0] = 0.1 / 3600;
    check("session_ageing", force_at(&w, &r, 0.5), K * 0.1 * 1.05, 1e-9);
    w = spring();
    w.value[DRIVE_RIPPLE][0] = 0.1;
    w.value[DRIVE_RIPPLE][1] = 1.6e-3;
    w.value[DRIVE_RIPPLE][2] = 0.4;
    w.value[MAINS_HUM][0] = 0.2;
    w.value[MAINS_HUM][1] = 50.3;
    r.hum_phase = 1;
    check("ripple and hum", force_at(&w, &r, 0.5),
          K * 0.1 + 0.1 * sin(2 * pi * 2 / 1.6 + 0.4) + 0.2 * sin(2 * pi * 50.3 * 0.5 + 1), 1e-9);
    w = spring();
    r.corner = 0.4;
    w.value[PLATE_INERTIA][0] = 2;
    size_t hint = 0;
    double d, v, a;
    path_at(&r, 0.9, &hint, &d, &v, &a);
    check("plate_inertia", force_at(&w, &r, 0.9), K * d / H + 2 * a, 1e-9);
}

/* ---- the cube against all of its particles, without its symmetry ---- */

enum { NODES = 27 };

/* In newtons times spacings. */
static double energy_of_all(const world *w, double x[NODES][3]) {
    double sum = 0;
    for (int a = 0; a < NODES; a++)
        for (int b = 0; b < a; b++) {
            int apart[3] = {a / 9 - b / 9, a / 3 % 3 - b / 3 % 3, a % 3 - b % 3};
            if (abs(apart[0]) > 1 || abs(apart[1]) > 1 || abs(apart[2]) > 1)
                continue;
            double rest = sqrt(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]);
            double d[3] = {x[a][0] - x[b][0], x[a][1] - x[b][1], x[a][2] - x[b][2]};
            double e = fabs(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / rest - 1);
            for (int i = 0; i < LAW; i++)
                sum += rest * w->law[i] * pow(e, i + 2) / (i + 2);
        }
    return sum;
}

static void place_all(const cube *c, double e, double x[NODES][3]) {
    for (int a = 0; a < NODES; a++) {
        int i = a / 9 - 1, k = a % 3 - 1;
        double bulge = a / 3 % 3 != 1 ? 0 : i && k ? c->bulge[1] : c->bulge[0];
        x[a][0] = i * (1 + bulge);
        x[a][1] = (a / 3 % 3) * (1 - e);
        x[a][2] = k * (1 + bulge);
    }
}

/* -d energy / d position of one node, or of all the upper plate's (node -1). */
static double push_on(const world *w, double x[NODES][3], int node, int axis) {
    double energy[2], h = 1e-5;
    for (int side = 0; side < 2; side++) {
        double moved[NODES][3];
        memcpy(moved, x, sizeof moved);
        for (int a = 0; a < NODES; a++)
            if (a == node || (node < 0 && a / 3 % 3 == 2))
                moved[a][axis] += side ? h : -h;
        energy[side] = energy_of_all(w, moved);
    }
    return (energy[0] - energy[1]) / (2 * h);
}

static void test_cube(void) {
    world w = {.height = H, .cube = true, .law = {0.4, 0.3, 2, 1, 5}};
    cube rest = {.bulge = {0, 0}}, end;
    for (double e = 0.1; e < 0.35; e += 0.1) {
        double x[NODES][3], worst = 0, force = cube_press(&w, &rest, 0, e, &end);
        place_all(&end, e, x);
        for (int a = 3; a < NODES; a++)
            for (int axis = 0; axis < 3 && a / 3 % 3 == 1; axis++)
                worst = fmax(worst, fabs(push_on(&w, x, a, axis)));
        check("cube: the largest force on a free particle", worst, 0, 1e-7);
        check("cube: the force on the plate, from all the energy", force, push_on(&w, x, -1, 1), 1e-7);
    }
    w = maxwell();
    w.cube = true;
    run r = press(4e-3, 4); /* springs and arms in proportion: the shape stays while it relaxes */
    path_wait(&r, 2.5);
    double after = force_at(&w, &r, 1);
    w.n_arms = 0;
    double spring_alone = force_at(&w, &r, 1);
    check("cube: relaxed for 1 s", after / spring_alone, 1 + 3 / K * exp(-0.9995 / 0.7), 2e-5);
    path_to(&r, 0, 4e-3);
    check("cube: springs alone unload as they load", force_at(&w, &r, 3),
          cube_press(&w, &rest, 0, 0.1002, &end), 1e-9);
}

/* With steps as written and finer ones, rms of the peak. */
static double step_error(const judge *j, const session *s, const world *w) {
    double *as_written = malloc(2 * s->n * sizeof *as_written),
           *finer = as_written ? as_written + s->n : NULL;
    if (!as_written)
        abort();
    world_session(w, s, 0.006, false, NULL, as_written);
    world_session(w, s, 0.002, false, NULL, finer);
    for (size_t i = 0; i < s->n; i++)
        finer[i] -= as_written[i];
    double rms = judge_rms(j, finer) / j->peak;
    free(as_written);
    return rms;
}

/* Every effect on a whole session, and the cube. */
static void test_steps(const judge *j, const session *s) {
    double shape[VALUES];
    for (int id = 0; id < EFFECTS; id++) {
        char name[96];
        world w = *j->plain;
        const effect_kind *kind = &effect_kinds[id];
        for (size_t k = 0; k < VALUES; k++)
            shape[k] = k == 0 ? 1 : 0.5 * (kind->low[k] + kind->high[k]);
        judge_put(j, &w, id, shape, 0.1);
        snprintf(name, sizeof name, "%s: rms of a third of the step, of the peak", kind->id);
        check(name, step_error(j, s, &w), 0, id == RATE_STIFFENING ? 5e-4 : 1e-4);
    }
    world w = *j->plain;
    w.cube = true;
    check("cube: rms of a third of the step, of the peak", step_error(j, s, &w), 0, 1e-4);
}

static void test_judge(void) {
    random_state rng = random_make(3, 4);
    world plain = {.height = H, .law = {6, 2, 30, 10, 40}, .n_arms = 2, .arms = {{2, 0.5}, {1.5, 30}}};
    static const double shape[VALUES] = {1, 0, 0};
    double cosine[EFFECTS], *y;
    session s;
    judge j;
    session_rich(&s, &rng, plain.height, 0.5);
    if (!judge_make(&j, &plain, &s, 0.02) || !(y = malloc(s.n * sizeof *y)))
        abort();
    test_steps(&j, &s);
    world w = plain;
    w.law[1] *= 1.5;
    w.arms[0].time *= 1.4;
    visible seen = judge_visible(&j, &w, NULL);
    check("judge: other numbers leave nothing", seen.left / seen.raw, 0, 0.01);
    world nearest;
    judge_fit(&j, &w, &nearest);
    check("judge: and are found", nearest.arms[0].time, w.arms[0].time, 0.01 * w.arms[0].time);
    w = plain;
    judge_put(&j, &w, SENSOR_GAIN, shape, 0.2);
    seen = judge_visible(&j, &w, NULL);
    check("judge: a gain leaves nothing", seen.left / seen.raw, 0, 0.01);
    w = plain;
    seen = judge_strengthen(&j, &w, SENSOR_BIAS, shape, 0.01 * j.peak, false);
    check("judge: strength", seen.left / j.peak, 0.0103, 0.0004);
    judge_visible(&j, &w, y);
    judge_alike(&j, y, 0, NULL, cosine);
    check("judge: an effect is like itself", cosine[SENSOR_BIAS], 1, 5e-3);
    w = plain;
    judge_put(&j, &w, FRAME_COMPLIANCE, shape, 0.4);
    seen = judge_visible(&j, &w, NULL);
    check("judge: a frame is like itself", judge_frame(&j, &w, seen.left), 1, 0.02);
    free(y);
    judge_free(&j);
}

int self_test(void) {
    printf("%-58s %12s  %12s\n", "", "got", "wanted");
    test_path();
    test_arm();
    test_springpot();
    test_pores();
    test_memory();
    test_rate();
    test_contact();
    test_recovery();
    test_instrument();
    test_cube();
    test_judge();
    printf("%d wrong\n", failures);
    return failures;
}
