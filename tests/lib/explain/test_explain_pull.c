/* test_explain_pull.c: plates that pull: the specimen is a spring that stiffens, behind a traction that is
 * not the effect's own: it holds at once, and fades with the gap as a bell. check: all */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 4 };

static const double LAW[3] = {8, 6, 40}; /* N */

/* Noise and friction, N; a dwell, s, of 50 samples a second; samples of the way back. */
static struct tester {
    double noise, friction;
    int dwell_s;
    size_t back;
    bool seldom; /* every other run ends before the plate pulls */
} tester;

static const struct tester quiet = {4e-3, 0, 1, 300, false}, slow = {4e-3, 0.01, 60, 150, true};

static double spring(double e) {
    return LAW[0] * e + LAW[1] * fabs(e) * e + LAW[2] * e * e * e;
}

/* Force on a plate that has withdrawn to depth < 0; HUGE_VAL: it has let go. */
static double pulled(double strongest, double reach, double depth) {
    if (spring(depth / HEIGHT) >= -strongest)
        return spring(depth / HEIGHT);
    for (double gap = 0; gap < 4 * reach; gap += 1e-3 * reach) {
        double force = spring((depth + gap) / HEIGHT);
        if (force >= -strongest * exp(-pow(gap / reach, 2)))
            return force;
    }
    return HUGE_VAL;
}

/* Presses to depth_mm in as many s, dwells, and withdraws at half a millimetre a second, into the air unless
 * it stays. */
static palp_experiment *record(double depth_mm, double strongest, double reach, bool stays, uint64_t *noise) {
    static samples s;
    palp_experiment *e;
    bool stuck = true;
    start(&s, 0, -1);
    go(&s, 1 + depth_mm, depth_mm, 150);
    for (int i = 1; i <= 50 * tester.dwell_s; i++)
        s.time_s[s.n] = 1 + depth_mm + 0.02 * i, s.depth_m[s.n++] = 1e-3 * depth_mm;
    go(&s, 1 + tester.dwell_s + depth_mm + 2 * (depth_mm + 2), stays ? 0.2 : -2, tester.back);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        double depth = s.depth_m[i], force = depth > 0 ? spring(depth / HEIGHT) : 0;
        if (depth <= 0 && i > 200 && stuck) {
            force = pulled(strongest, reach, depth);
            stuck = force < HUGE_VAL;
        }
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * depth;
        const double way = i ? depth - s.depth_m[i - 1] : 0, rubs = way > 0   ? tester.friction
                                                                    : way < 0 ? -tester.friction
                                                                              : 0;
        palp_experiment_column(e, "force_N")[i] =
            (stuck || depth > 0 ? force : 0) + rubs + tester.noise * white_noise(noise);
    }
    return e;
}

static void explain(double strongest, double reach, const palp_explain_settings *settings,
                    palp_explanation *e) {
    static const double depth_mm[RUNS] = {2, 3, 4, 3.5};
    static const double given[3] = {8.8, 5, 44};
    palp_explain_input input[RUNS];
    palp_model m = lumped_model(0);
    uint64_t noise = 7;
    ck_assert_int_eq(palp_law_polynomial(3, given, &m.material.law), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){record(depth_mm[r], strongest, reach, tester.seldom && r % 2, &noise),
                                        "run"};
    ck_assert_int_eq(palp_explain(&m, RUNS, input, settings, e, NULL), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static size_t releases(const palp_explanation *e) {
    size_t n = 0;
    for (size_t i = 0; i < e->n_events; i++)
        n += strcmp(e->event[i].kind, "release") == 0;
    return n;
}

/* With a jump, and without: the traction fades more slowly than the spring gives way. The residual of the
 * other shape is reported. */
START_TEST(a_pull_is_named) {
    static const struct {
        double force, reach;
    } cases[] = {{0.18, 1e-5}, {0.18, 1e-3}, {0.056, 1e-5}, {0.018, 1e-5}};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    tester = quiet;
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_ADHESION] = settings.candidate[PALP_EFFECT_SENSOR_BIAS] = true;
    settings.candidate[PALP_EFFECT_COULOMB_FRICTION] = settings.candidate[PALP_EFFECT_CONTACT_OFFSET] = true;
    explain(cases[_i].force, cases[_i].reach, &settings, &e);
    ck_assert_msg(e.verdict != PALP_EXPLAIN_AGREES && e.n_effects == 1 &&
                      e.effect[0].effect.id == PALP_EFFECT_ADHESION,
                  "%s, %zu effects", palp_explain_verdict_name(e.verdict), e.n_effects);
    const bool far = cases[_i].reach > 1e-4; /* the discrepancy takes a part of a pull of another form */
    double force = e.effect[0].effect.value[0];
    ck_assert_msg(fabs(force - cases[_i].force) < (far ? 0.35 : 0.2) * cases[_i].force, "%g, not %g N", force,
                  cases[_i].force);
    const double low = e.effect[0].low[0], high = e.effect[0].high[0];
    ck_assert_msg(
        far || (low <= cases[_i].force && cases[_i].force <= high && high - low < 0.5 * cases[_i].force),
        "%g N is in %g to %g N", cases[_i].force, low, high);
    ck_assert_msg(releases(&e) > 0 || cases[_i].reach > 1e-4 || cases[_i].force < 0.05,
                  "no release is listed");
    palp_explanation_free(&e);
}
END_TEST

/* Without the effect that follows them, releases are missing from the model: that is no agreement. */
START_TEST(a_release_must_be_accounted_for) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    tester = quiet;
    memset(settings.candidate, 0, sizeof settings.candidate);
    explain(0.056, 1e-5, &settings, &e);
    ck_assert_uint_gt(releases(&e), 0);
    ck_assert_msg(e.verdict == PALP_EXPLAIN_UNEXPLAINED && e.unexplained_N > 0, "%s, %g N",
                  palp_explain_verdict_name(e.verdict), e.unexplained_N);
    palp_explanation_free(&e);
    explain(0.0, 1e-5, &settings, &e);
    ck_assert_uint_eq(releases(&e), 0);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    palp_explanation_free(&e);
}
END_TEST

/* Beside a friction a pull that changes the forces, over all samples, by less than a quarter of the noise: it
 * is named where nothing else accounts for a release. */
START_TEST(a_slight_pull_is_named_where_it_accounts_for_what_is_left) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    tester = slow;
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_ADHESION] = settings.candidate[PALP_EFFECT_COULOMB_FRICTION] = true;
    explain(0.05, 1e-5, &settings, &e);
    ck_assert_uint_gt(releases(&e), 0);
    ck_assert_msg(e.verdict == PALP_EXPLAIN_EXPLAINED && e.n_effects == 2, "%s, %zu effects, %g N",
                  palp_explain_verdict_name(e.verdict), e.n_effects, e.unexplained_N);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_COULOMB_FRICTION);
    ck_assert_int_eq(e.effect[1].effect.id, PALP_EFFECT_ADHESION);
    ck_assert(e.step[1].candidate[0].id == PALP_EFFECT_ADHESION &&
              e.step[1].candidate[0].explained_N < 0.25 * slow.noise);
    ck_assert(e.effect[1].low[0] <= 0.05 && 0.05 <= e.effect[1].high[0]);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_pull_is_named, 0, 4);
    tcase_add_test(tc, a_release_must_be_accounted_for);
    tcase_add_test(tc, a_slight_pull_is_named_where_it_accounts_for_what_is_left);
}
