/* test_recording_blocks.c: a recording as means of blocks: every sample is in one, and path and force
 * follow. */
#include "../recordings.h"

static palp_recording hold(void) {
    take t = {phantom(), 6.0, 1.0, 100.0, 1.0, 500.0, 0.004, "ramp_hold", 7};
    return prepare(record(&t));
}

static double count(const palp_experiment *e) {
    double sum = 0;
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        sum += palp_experiment_column(e, "samples")[i];
    return sum;
}

/* Every sample is in one block, their mean is that of all, and there are far fewer blocks, the longest at
 * the end. */
START_TEST(every_sample_counts_once) {
    palp_recording r = hold();
    palp_experiment *e;
    double sum = 0, whole = 0, most = 0;
    ck_assert_int_eq(palp_recording_blocks(&r, 100.0, &e), PALP_OK);
    const size_t n = palp_experiment_rows(e);
    const double *samples = palp_experiment_column(e, "samples"),
                 *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < n; i++) {
        sum += samples[i] * force[i];
        most = fmax(most, samples[i]);
        const double times = palp_experiment_column(e, "time_sd_s")[i] / 0.002, count = fmax(1.0, samples[i]);
        ck_assert_double_eq_tol(12.0 * times * times, count * count - 1.0, 1e-6 * count * count);
        if (samples[i] > 1000.0)
            ck_assert_double_eq_tol(palp_experiment_column(e, "noise_N")[i], 0.004, 4e-4);
    }
    for (size_t i = 0; i < r.n; i++)
        whole += r.force_N[i];
    ck_assert_double_eq(count(e), (double)r.n);
    ck_assert_double_eq_tol(sum, whole, 1e-9 * whole);
    ck_assert_uint_lt(n, r.n / 50);
    ck_assert_double_gt(most, 1000.0);
    palp_experiment_free(e);
    palp_recording_free(&r);
}
END_TEST

/* The line between the rows is the path, also round its corners, to a thousandth of the way. */
START_TEST(the_path_is_between_the_rows) {
    palp_recording r = hold();
    palp_experiment *e;
    ck_assert_int_eq(palp_recording_blocks(&r, 100.0, &e), PALP_OK);
    const size_t n = palp_experiment_rows(e);
    const double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm");
    double worst = 0;
    for (size_t i = 0, k = 0; i < r.n; i++) {
        while (k + 2 < n && time[k + 1] < r.time_s[i])
            k++;
        const double share = (r.time_s[i] - time[k]) / (time[k + 1] - time[k]),
                     on = depth[k] + share * (depth[k + 1] - depth[k]);
        worst = fmax(worst, fabs(on - 1e3 * r.depth_m[i]));
    }
    ck_assert_double_lt(worst, 1e-3 * 1e3 * r.deepest_m);
    palp_experiment_free(e);
    palp_recording_free(&r);
}
END_TEST

/* Masked samples and corners carry the path alone; of a withdrawal, which a press masks, samples count. */
START_TEST(what_is_masked_does_not_count) {
    palp_recording r = hold();
    palp_experiment *e;
    for (size_t i = 20000; i < 21000; i++)
        r.use[i] = 0;
    ck_assert_int_eq(palp_recording_blocks(&r, 100.0, &e), PALP_OK);
    ck_assert_double_eq(count(e), (double)r.n - 1000.0);
    palp_experiment_free(e);
    r.end_s = r.time_s[20000];
    ck_assert_int_eq(palp_recording_blocks(&r, 100.0, &e), PALP_OK);
    ck_assert_double_eq(count(e), (double)r.n);
    palp_experiment_free(e);
    palp_recording_free(&r);
}
END_TEST

START_TEST(too_few_parts_are_refused) {
    palp_recording r = hold();
    palp_experiment *e;
    ck_assert_int_eq(palp_recording_blocks(&r, 9.0, &e), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_recording_blocks(&r, NAN, &e), PALP_ERR_ARGUMENT);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, every_sample_counts_once);
    tcase_add_test(tc, the_path_is_between_the_rows);
    tcase_add_test(tc, what_is_masked_does_not_count);
    tcase_add_test(tc, too_few_parts_are_refused);
}
