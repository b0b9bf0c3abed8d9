/* test_specimens.c: several specimens: their mean, how they differ, and what holds for one that was not
 * measured. */
#include "recordings.h"

#include <stdio.h>

enum { SPECIMENS = 6, WORLDS = 60, POINTS = 4 };

static const double TRUTH[3] = {8.0, -6.0, 80.0};

/* A specimen of a world: springs and arms scaled together by a normal number, relaxation time by another. */
static palp_material specimen_of(double stiffer, double slower) {
    palp_material m = {.n_arms = 1, .arms = {{2.4 * stiffer, 4.8 * stiffer * slower, 0, 0}}};
    double c[3];
    for (int i = 0; i < 3; i++)
        c[i] = TRUTH[i] * stiffer;
    m.law = polynomial(3, c);
    return m;
}

static palp_material draw(double spread, uint64_t *state) {
    double stiffer = 1.0 + spread * palp_random_normal(state),
           slower = exp(spread * palp_random_normal(state));
    return specimen_of(stiffer, slower);
}

/* Two presses of each. */
static void measure(uint64_t world, double spread, size_t n, palp_recording *r, size_t *specimen) {
    uint64_t state = 1000 * world;
    for (size_t k = 0; k < n; k++) {
        palp_material m = draw(spread, &state);
        for (size_t q = 0; q < 2; q++) {
            take t = {m,    4.0 + 3.0 * (double)q, 1.0 + (double)q,         15.0, 1.0, 25.0,
                      0.01, "ramp_hold",           7777 * world + 2 * k + q};
            r[2 * k + q] = prepare(record(&t));
            specimen[2 * k + q] = k;
        }
    }
}

static palp_specimens_fit fit_world(uint64_t world, double spread, size_t n) {
    palp_recording r[2 * SPECIMENS];
    size_t specimen[2 * SPECIMENS];
    palp_specimens_fit f;
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings settings = with_law(polynomial(3, (double[3]){5.0, 1.0, 1.0}), 1);
    measure(world, spread, n, r, specimen);
    palp_status status = palp_characterize_specimens(2 * n, r, specimen, &settings, &f, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    free_all(2 * n, r);
    return f;
}

/* Specimens that differ by 20 %: how often the intervals hold the mean and the spread, and the band a
 * specimen not measured. */
START_TEST(the_spread_and_the_mean_are_covered) {
    const double spread = 0.2, strain[POINTS] = {0.05, 0.12, 0.2, 0.28};
    double mean = 0, between = 0, new = 0, held = 0, holds = 0;
    enum { TIMES = 12 };
    for (uint64_t world = 1; world <= WORLDS; world++) {
        palp_specimens_fit f = fit_world(world, spread, SPECIMENS);
        palp_specimens_point at[POINTS];
        ck_assert_uint_eq(f.n_specimens, SPECIMENS);
        ck_assert_uint_ge(f.n_spread, 1);
        ck_assert_int_eq(palp_specimens_fit_stiffness(&f, POINTS, strain, at), PALP_OK);
        uint64_t state = 99 * world + 5;
        palp_material other = draw(spread, &state), truth = specimen_of(1.0, 1.0);
        for (int i = 0; i < POINTS; i++) {
            double known, k;
            palp_law_stiffness(&truth.law, strain[i], &known, NULL);
            palp_law_stiffness(&other.law, strain[i], &k, NULL);
            mean += fabs(at[i].stiffness_N - known) <= 1.96 * at[i].sd_N;
            between += at[i].between_low <= spread * known && spread * known <= at[i].between_high;
            new += fabs(at[i].stiffness_N - k) <= 1.96 * at[i].new_sd_N;
        }
        double time_s[TIMES], depth_m[TIMES], force[TIMES], sd[TIMES], total[25], wanted[TIMES];
        for (int i = 0; i < TIMES; i++) {
            time_s[i] = 0.5 * i * i;
            depth_m[i] = 1e-3 * fmin(5.0, 5.0 * time_s[i]);
        }
        const palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024, .material = f.mean.material};
        const palp_forward_run run = {.n = TIMES, .time_s = time_s, .depth_m = depth_m};
        ck_assert_uint_eq(f.mean.n_parameters, 5);
        ck_assert_int_eq(palp_model_unmeasured(5, f.mean.covariance, f.between, SPECIMENS, total), PALP_OK);
        ck_assert_int_eq(palp_forward_band(&model, &run, total, force, sd, NULL), PALP_OK);
        ck_assert_int_eq(palp_lumped_run(&other, 0.024, TIMES, time_s, depth_m, wanted), PALP_OK);
        for (int i = 1; i < TIMES; i++, holds += 1.0)
            held += fabs(force[i] - wanted[i]) <= 1.96 * sd[i];
        palp_specimens_fit_free(&f);
    }
    double n = POINTS * WORLDS;
    printf("mean held in %.1f %%, spread in %.1f %%, K of a new specimen in %.1f %%, its force in %.1f %%\n",
           100 * mean / n, 100 * between / n, 100 * new / n, 100 * held / holds);
    ck_assert_double_ge(mean / n, 0.85); /* 95 % of 20 worlds whose points go together: +- 5 % */
    ck_assert_double_ge(between / n, 0.85);
    ck_assert_double_ge(new / n, 0.85);
    ck_assert_double_ge(held / holds, 0.85);
}
END_TEST

START_TEST(no_spread_is_none) {
    const double strain[1] = {0.2};
    size_t found = 0;
    for (uint64_t world = 1; world <= 10; world++) {
        palp_specimens_fit f = fit_world(world, 0.0, 4);
        palp_specimens_point at;
        ck_assert_int_eq(palp_specimens_fit_stiffness(&f, 1, strain, &at), PALP_OK);
        found += f.n_spread > 0;
        if (f.n_spread == 0)
            ck_assert_double_eq(at.between_N, 0.0);
        ck_assert_double_le(at.between_N, 0.02 * at.stiffness_N);
        ck_assert_double_eq(at.between_low > 0.0, f.n_spread > 0 && at.between_low > 0.0);
        ck_assert_double_eq_tol(at.stiffness_N, 8.0 - 6.0 * 0.2 + 80.0 * 0.04, 0.2);
        palp_specimens_fit_free(&f);
    }
    printf("spread found in %zu of 10 worlds without any\n", found);
    ck_assert_uint_le(found, 3); /* one in twenty by chance */
}
END_TEST

/* As of another height and area, stress and strain are the same: so are the numbers, in that specimen's
 * newtons. */
START_TEST(a_recording_of_another_size_is_the_same_stress) {
    take t = {specimen_of(1.0, 1.0), 5.0, 1.0, 15.0, 1.0, 25.0, 0.01, "ramp_hold", 5};
    palp_recording r = prepare(record(&t));
    palp_characterize_settings settings = with_law(polynomial(2, (double[2]){5.0, 1.0}), 1);
    palp_lumped_fit one = fit(1, &r, settings);
    r.radius_m = 0.01;
    palp_recording_scale(&r, 0.5, 4.0);
    ck_assert_double_eq_tol(r.height_m, 0.012, 1e-15);
    ck_assert_double_eq_tol(r.radius_m, 0.02, 1e-15);
    palp_lumped_fit scaled = fit(1, &r, settings);
    for (size_t i = 0; i < one.n_parameters; i++)
        ck_assert_double_eq_tol(sqrt(scaled.covariance[i * one.n_parameters + i]),
                                4.0 * sqrt(one.covariance[i * one.n_parameters + i]),
                                1e-4 * sqrt(scaled.covariance[i * one.n_parameters + i]));
    ck_assert_double_eq_tol(scaled.material.arms[0].stiffness_N, 4.0 * one.material.arms[0].stiffness_N,
                            1e-4);
    palp_lumped_fit_free(&one);
    palp_lumped_fit_free(&scaled);
    palp_recording_free(&r);
}
END_TEST

START_TEST(what_are_no_specimens_is_refused) {
    take t = {specimen_of(1.0, 1.0), 5.0, 1.0, 15.0, 1.0, 25.0, 0.01, "ramp_hold", 5};
    palp_recording r[2] = {prepare(record(&t)), prepare(record(&t))};
    palp_characterize_settings settings = with_law(polynomial(2, (double[2]){5.0, 1.0}), 1);
    palp_specimens_fit f;
    double factor[2];
    const size_t one[2] = {0, 0}, gap[2] = {0, 2};
    ck_assert_int_eq(palp_characterize_specimens(2, r, one, &settings, &f, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_characterize_specimens(2, r, gap, &settings, &f, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_characterize_level(2, r, gap, &settings, factor, NULL), PALP_ERR_ARGUMENT);
    settings.spring = PALP_SPRING_PER_RUN;
    ck_assert_int_eq(palp_characterize_specimens(2, r, (size_t[2]){0, 1}, &settings, &f, NULL),
                     PALP_ERR_ARGUMENT);
    free_all(2, r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_spread_and_the_mean_are_covered);
    tcase_add_test(tc, no_spread_is_none);
    tcase_add_test(tc, a_recording_of_another_size_is_the_same_stress);
    tcase_add_test(tc, what_are_no_specimens_is_refused);
}
