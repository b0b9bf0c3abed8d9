/* self_test.c: the physics against closed forms, the evidence against noise of which it is known. */
#include "worlds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int failures;

static void check(const char *what, double got, double wanted, double allowed) {
    bool good = fabs(got - wanted) <= allowed;
    printf("%-66s %12.6g  %12.6g%s\n", what, got, wanted, good ? "" : "   WRONG");
    failures += !good;
}

/* A linear spring of 10 N at a strain of 0.2, and an arm; height 20 mm, 100 samples a second. */
static solid linear(void) {
    solid s = {.height = 0.02, .top = 0.2, .size = 10, .n_arms = 1};
    s.arms[0] = (arm){30, 0.5};
    return s;
}

static run press(double depth, double hold) {
    run r = {.kind = "ramp_hold", .Hz = 100, .rate = depth};
    path_start(&r, 0);
    path_to(&r, depth, depth);
    path_wait(&r, hold);
    r.n = (size_t)((1 + hold) * r.Hz) + 1;
    return r;
}

static double force_at(const solid *s, const run *r, double t) {
    double *force = malloc(r->n * sizeof *force);
    if (!force)
        abort();
    solid_press(s, r, 0, force);
    double f = force[(size_t)floor(t * r->Hz + 0.5)];
    free(force);
    return f;
}

static void test_laws(void) {
    static const char *const names[] = {"quadratic", "Fung", "piecewise", "Hertz"};
    for (int k = QUADRATIC; k <= HERTZ; k++) {
        solid s = linear();
        char what[64];
        s.law = (enum law_kind)k;
        s.shape = 0.6;
        snprintf(what, sizeof what, "law, %s: force at the full travel", names[k]);
        check(what, solid_spring(&s, 0.2), 10, 1e-9);
        snprintf(what, sizeof what, "law, %s: force is the slope of the energy", names[k]);
        check(what, (solid_energy(&s, 0.1501) - solid_energy(&s, 0.1499)) / 0.0002, solid_spring(&s, 0.15),
              1e-4);
    }
}

static void test_press(void) {
    solid s = linear();
    run r = press(4e-3, 2);
    double rise = 30 * 0.5 * 0.2 * (1 - exp(-2)); /* of the arm at the end of the ramp of 1 s */
    check("arm: end of the ramp", force_at(&s, &r, 1), 10 + rise, 1e-4);
    check("arm: 1 s later", force_at(&s, &r, 2), 10 + rise * exp(-2), 1e-4);
    r.shift = 1e-3; /* a spring alone has three quarters */
    s.n_arms = 0;
    check("contact: later by its shift", force_at(&s, &r, 2), 7.5, 1e-9);
    s.effect[SENSOR_LAG][0] = 0.2;
    r.shift = 0;
    check("sensor_lag: a ramp is late by its time", force_at(&s, &r, 1), 8 + 2 * exp(-5), 1e-4);
    s.effect[SENSOR_LAG][0] = 0;
    s.effect[PERMANENT_SET][0] = 0.25;
    path_to(&r, 2e-3, 4e-3);
    r.n += 50;
    check("permanent_set: on the way back", force_at(&s, &r, 3.5), 10 * (0.1 - 0.05) / 0.75 / 0.2, 1e-6);
}

/* An arm pulls the surface after the plate has left, until the specimen is at rest again: nothing pulls the
 * plate. */
static void test_release(void) {
    solid s = linear();
    run r = press(4e-3, 1);
    path_to(&r, -1e-3, 5e-3);
    path_wait(&r, 4);
    r.n += 500;
    double least = 0, *force = malloc(r.n * sizeof *force);
    if (!force)
        abort();
    solid_press(&s, &r, 0, force);
    for (size_t i = 0; i < r.n; i++)
        least = fmin(least, force[i]);
    check("release: the plate is never pulled", least, 0, 1e-12);
    s.effect[ADHESION][0] = 0.5;
    solid_press(&s, &r, 0, force);
    for (size_t i = 0; i < r.n; i++)
        least = fmin(least, force[i]);
    check("adhesion: it is, by nearly its force at most", least, -0.35, 0.15);
    free(force);
}

/* The plates of other testers: a swing that begins without a jump and dies away, steps that end on the way, a
 * clock that never turns back; arms that the force drives are those that the strain drives where it is
 * linear. */
static void test_testers(void) {
    run r = press(4e-3, 2);
    lab rings = {.Hz = 100, .height = 0.02, .strain = 0.2, .tester = RINGS}, steps = rings, late = rings;
    steps.tester = STEPS;
    late.jitter = 0.1;
    double d, v, a, before, least = 1;
    size_t hint = 0;
    lab_path(&rings, &r, 1 - 1e-6, &hint, &d, &before, &a);
    lab_path(&rings, &r, 1 + 1e-6, &hint, &d, &v, &a);
    check("rings: no jump of the speed at a corner", v, before, 1e-5);
    lab_path(&rings, &r, 1 + 0.25 * 0.25, &hint, &d, &v, &a);
    check("rings: it overshoots by about its speed over its frequency", d - 4e-3,
          4e-3 * 0.79 / (8 * acos(-1)), 1e-6);
    lab_path(&rings, &r, 3, &hint, &d, &v, &a);
    check("rings: and comes to rest", d, 4e-3, 1e-8);
    hint = 0;
    lab_path(&steps, &r, 0.50124, &hint, &d, &v, &a);
    check("steps: it stands between them", d, 200 * 1e-5, 1e-12);
    for (size_t i = 1; i < 300; i++)
        least = fmin(least, lab_time(&late, &r, 0, i) - lab_time(&late, &r, 0, i - 1));
    check("jitter: samples stay in order", fmin(least, 1e-3), 1e-3, 0);
    solid s = linear();
    double plain = force_at(&s, &r, 1.5);
    s.force_driven = true;
    check("force_driven: with a linear law the same", force_at(&s, &r, 1.5), plain, 1e-12);
    s.law = FUNG;
    s.shape = 2;
    double driven = force_at(&s, &r, 1);
    s.force_driven = false;
    check("force_driven: the arm follows the force, which rises late", driven > force_at(&s, &r, 1) + 0.5, 1,
          0);
}

/* Of noise alone half of chi2 is left for each sample that no column takes; a run's own parameters have no
 * residual. */
static void test_evidence(const lab *l) {
    truth t;
    search h;
    char what[96];
    if (!truth_draw(&t, l, 5, 1, 0) || !search_make(&h, &t, &t.solid))
        abort();
    double tails = l->kind == STUDENT ? 0.3 : 0.1;
    snprintf(what, sizeof what, "%s: chi2 of a sample of noise", l->name);
    check(what,
          2 * nuisance_left(&h.beside, t.force, h.force, h.left) / (double)(h.beside.n - h.beside.n_columns),
          1, tails);
    for (size_t i = 0; i < t.session.n_runs; i++)
        t.session.run[i].shift += 1e-4 * lab_travel(l) * (double)i;
    snprintf(what, sizeof what, "%s: contacts, zeros and law leave nothing", l->name);
    solid other = t.solid;
    other.hat[3] += 0.01 * other.size;
    check(what, search_evidence(&h, &other, 0), 0, 5);
    other = t.solid;
    other.effect[COULOMB_FRICTION][0] = 0.05 * h.peak;
    double nats = search_evidence(&h, &other, 0);
    other.effect[COULOMB_FRICTION][0] *= 2;
    snprintf(what, sizeof what, "%s: twice the friction has four times the evidence", l->name);
    check(what, search_evidence(&h, &other, 0) / nats, 4, 0.5);
    search_free(&h);
    truth_free(&t);
}

/* What is hidden has the evidence that was asked for, and is most like itself. */
static void test_draw(const lab *l) {
    truth t;
    if (!truth_draw(&t, l, 5, 2, 1))
        abort();
    check("draw: at least 60 nats", fmin(t.evidence, 60), 60, 0);
    check("draw: nothing in the forces but numbers", isfinite(t.force[t.session.n - 1]), 1, 0);
    check("draw: most like itself", t.cosine[t.effect], 1, 0.2);
    truth_free(&t);
    truth again, first;
    if (!truth_draw(&first, l, 6, 3, 0) || !truth_draw(&again, l, 6, 3, 0))
        abort();
    check("draw: a seed makes the same case",
          memcmp(first.force, again.force, first.session.n * sizeof *first.force), 0, 0);
    truth_free(&first);
    truth_free(&again);
}

/* Both of a pair are there, each unlike the other. */
static void test_pair(const lab *l) {
    truth t;
    if (!truth_draw(&t, l, 5, 4, 3))
        abort();
    check("pair: two effects", t.second != EFFECTS && t.second != t.effect, 1, 0);
    check("pair: the second is in the specimen too", t.solid.effect[t.second][0] != 0, 1, 0);
    check("pair: each as strong as it must be", fmin(t.second_evidence, 60), 60, 1);
    check("pair: unlike each other", fmax(t.cosine[t.second], t.second_cosine[t.effect]) < 0.7, 1, 0);
    truth_free(&t);
}

int worlds_self_test(void) {
    test_laws();
    test_press();
    test_release();
    test_testers();
    for (size_t i = 2; i < 6; i++) /* each kind of noise */
        test_evidence(&laboratories[i]);
    test_evidence(&laboratories[0]);
    test_draw(&laboratories[10]);
    test_pair(&laboratories[LABS - 2]);
    return failures;
}
