/* test_infer_blocks.c: means of blocks give the same material as all samples. check: once */
#include "../recordings.h"

#include <palpate/explain.h>

enum { RUNS = 2 };

static palp_lumped_fit characterize(palp_experiment *const *e) {
    static const char *const name[RUNS] = {"1.csv", "2.csv"};
    const palp_model specimen = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024};
    const palp_explain_settings s = palp_explain_settings_default();
    const palp_law law = polynomial(2, (double[2]){8.0, 0.0});
    const palp_explain_choice choice = {
        .least_arms = 2, .most_arms = 2, .n_laws = 1, .law = &law, .no_spline = true};
    palp_explain_input input[RUNS];
    palp_specimens_fit all;
    palp_error error = {PALP_OK, ""};
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){e[r], name[r]};
    palp_status status = palp_explain_material(&specimen, RUNS, input, &s, &choice, &all, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    return all.mean;
}

/* The same numbers within their sds, which are alike, from a tenth of the rows; also of blocks that are half
 * and twice as fine as those of the command. */
START_TEST(blocks_tell_what_samples_tell) {
    palp_material m = phantom();
    m.law = polynomial(2, (double[2]){8.0, 4.0});
    palp_experiment *raw[RUNS], *blocks[RUNS];
    const double parts = 50.0 * pow(2.0, _i);
    for (uint64_t r = 0; r < RUNS; r++) {
        const double more = 2.0 * (double)r;
        take t = {m, 4.0 + more, 1.0 + more, 100.0, 1.0, 50.0, 0.01, "ramp_hold", 5 + r};
        palp_recording recording = prepare(record(&t));
        raw[r] = record(&t);
        for (size_t i = 0; i < recording.n; i++) {
            palp_experiment_column(raw[r], "depth_mm")[i] = 1e3 * recording.depth_m[i];
            palp_experiment_column(raw[r], "force_N")[i] = recording.force_N[i];
        }
        ck_assert_int_eq(palp_recording_blocks(&recording, parts, &blocks[r]), PALP_OK);
        palp_experiment_set_number(blocks[r], "specimen.height_mm", 24.0);
        ck_assert(parts > 100.0 || palp_experiment_rows(blocks[r]) < palp_experiment_rows(raw[r]) / 10);
        palp_recording_free(&recording);
    }
    palp_lumped_fit all = characterize(raw), means = characterize(blocks);
    ck_assert_uint_eq(means.n_estimates, all.n_estimates);
    for (size_t i = 0; i < all.n_estimates; i++) {
        const palp_estimate *a = &all.estimate[i], *b = &means.estimate[i];
        ck_assert_msg(fabs(b->value - a->value) < 1.5 * a->sd, "%s is %g, not %g +- %g", a->name, b->value,
                      a->value, a->sd);
        ck_assert_msg(b->sd > 0.5 * a->sd && b->sd < 2.0 * a->sd, "%s +- %g, not %g", a->name, b->sd, a->sd);
    }
    palp_lumped_fit_free(&all);
    palp_lumped_fit_free(&means);
    for (size_t r = 0; r < RUNS; r++) {
        palp_experiment_free(raw[r]);
        palp_experiment_free(blocks[r]);
    }
}
END_TEST

/* Without noise: by the forces in the middles of the blocks, an arm's stiffness would be 1.2e-4 off. */
START_TEST(the_model_has_means_too) {
    palp_material m = phantom();
    m.law = polynomial(2, (double[2]){8.0, 4.0});
    palp_experiment *blocks[RUNS];
    for (size_t r = 0; r < RUNS; r++) {
        const double more = 2.0 * (double)r;
        take t = {m, 4.0 + more, 1.0 + more, 100.0, 1.0, 1000.0, 0.0, "ramp_hold", 5};
        palp_recording recording = prepare(record(&t));
        ck_assert_int_eq(palp_recording_blocks(&recording, 100.0, &blocks[r]), PALP_OK);
        palp_experiment_set_number(blocks[r], "specimen.height_mm", 24.0);
        palp_recording_free(&recording);
    }
    palp_lumped_fit means = characterize(blocks);
    ck_assert_uint_eq(means.material.n_arms, 2);
    for (size_t j = 0; j < 2; j++) {
        ck_assert_double_eq_tol(means.material.arms[j].stiffness_N / m.arms[j].stiffness_N, 1.0, 2e-5);
        ck_assert_double_eq_tol(means.material.arms[j].viscosity_Ns / m.arms[j].viscosity_Ns, 1.0, 5e-5);
    }
    palp_lumped_fit_free(&means);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free(blocks[r]);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, blocks_tell_what_samples_tell, 0, 3);
    tcase_add_test(tc, the_model_has_means_too);
}
