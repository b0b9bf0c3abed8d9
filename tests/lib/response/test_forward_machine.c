/* test_forward_machine.c: the forward model of the machine: frame, inertia, friction and sensor against
 * closed forms. */
#include "forward_ramp.h"

START_TEST(frame_is_a_spring_in_series) {
    palp_model m = linear_model(9);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 1.1e-3;
    start(&s, 0, -1);
    go(&s, 2, 5, 30);
    go(&s, 4, -1, 30);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        EXPECT(i, fmax(0, 9 * s.depth_m[i] / (HEIGHT + 9 * 1.1e-3)), 1e-14);
}
END_TEST

START_TEST(frame_loads_the_specimen_less) {
    static double depth[SAMPLES_MAX], wanted[SAMPLES_MAX];
    palp_model m = lumped_model(2);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 4e-4;
    start(&s, 0, 0);
    go(&s, 2, 5, 200);
    go(&s, 30, 5, 200);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        depth[i] = s.depth_m[i] - 4e-4 * s.force_N[i];
    ck_assert_int_eq(palp_lumped_run(&m.material, HEIGHT, s.n, s.time_s, depth, wanted), PALP_OK);
    for (size_t i = 0; i < s.n; i++)
        EXPECT(i, wanted[i], 1e-13);
}
END_TEST

/* A force beside the specimen's reaches the sensor, and no frame: the sensor's gain multiplies both. */
START_TEST(added_force_is_sensed) {
    static double added[SAMPLES_MAX];
    palp_model m = linear_model(9);
    palp_error error = {PALP_OK, ""};
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 1.1e-3;
    add_effect(&m, PALP_EFFECT_SENSOR_GAIN, 1)->value[0] = 0.25;
    start(&s, 0, -1);
    go(&s, 2, 5, 30);
    for (size_t i = 0; i < s.n; i++)
        added[i] = 0.3 * sin((double)i);
    const palp_forward_run run = {.n = s.n, .time_s = s.time_s, .depth_m = s.depth_m, .added_N = added};
    ck_assert_int_eq(palp_forward_force(&m, &run, s.force_N, NULL, &error), PALP_OK);
    for (size_t i = 0; i < s.n; i++)
        EXPECT(i, 1.25 * (added[i] + fmax(0, 9 * s.depth_m[i] / (HEIGHT + 9 * 1.1e-3))), 1e-14);
}
END_TEST

START_TEST(lag_of_a_ramp) {
    palp_model m = linear_model(9);
    add_effect(&m, PALP_EFFECT_SENSOR_LAG, 1)->value[0] = 0.4;
    ramp(2, 3, 20);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        EXPECT(i, 9 * 2e-3 / HEIGHT * (s.time_s[i] - 0.4 * -expm1(-s.time_s[i] / 0.4)), 1e-14);
}
END_TEST

START_TEST(inertia_and_friction_in_air) {
    palp_model m = linear_model(9);
    add_effect(&m, PALP_EFFECT_PLATE_INERTIA, 1)->value[0] = 0.7;
    add_effect(&m, PALP_EFFECT_COULOMB_FRICTION, 1)->value[0] = 0.2;
    s.n = 40;
    for (size_t i = 0; i < s.n; i++) { /* an uneven walk along a parabola */
        s.time_s[i] = 0.1 * ((double)i + 0.3 * sin((double)i));
        s.depth_m[i] = -0.1 + 3e-3 * (s.time_s[i] - 2) * (s.time_s[i] - 2);
    }
    press_model(&m, &s);
    double fastest =
        fabs(s.depth_m[1] - s.depth_m[0]) / (s.time_s[1] - s.time_s[0]); /* of the ends the interval's */
    fastest = fmax(fastest, (s.depth_m[39] - s.depth_m[38]) / (s.time_s[39] - s.time_s[38]));
    for (size_t i = 1; i + 1 < s.n; i++)
        fastest = fmax(fastest, 6e-3 * fabs(s.time_s[i] - 2));
    for (size_t i = 1; i + 1 < s.n; i++) {
        double v = 6e-3 * (s.time_s[i] - 2);
        EXPECT(i, 0.7 * 6e-3 + 0.2 * v / (fabs(v) + 1e-3 * fastest), 1e-12);
    }
}
END_TEST

/* A swing of 21 samples: the parabola through three of them makes its speed 1.5 % too small. */
START_TEST(speed_of_a_swing) {
    const double turn = 0.3, stiffer = 0.5, from = 0.01, dt = 0.1;
    palp_model m = linear_model(9);
    palp_effect *rate = add_effect(&m, PALP_EFFECT_RATE_STIFFENING, 1);
    rate->value[0] = stiffer;
    rate->value[1] = from;
    s.n = 60;
    for (size_t i = 0; i < s.n; i++) {
        s.time_s[i] = dt * (double)i;
        s.depth_m[i] = 3e-3 - 2e-3 * cos(turn * (double)i);
    }
    press_model(&m, &s);
    for (size_t i = 2; i + 2 < s.n; i++) {
        double factor = s.force_N[i] / (9 * s.depth_m[i] / HEIGHT),
               v = (pow(10, (factor - 1) / stiffer) - 1) * from * HEIGHT;
        ck_assert_double_eq_tol(v, fabs(2e-3 * turn / dt * sin(turn * (double)i)), 1e-2 * 2e-3 * turn / dt);
    }
}
END_TEST

/* Where the plate stops at once its speed does not swing over: friction is what it was, half of it at the
 * corner, and none. */
START_TEST(a_stop_is_no_way_back) {
    palp_model m = linear_model(9);
    add_effect(&m, PALP_EFFECT_COULOMB_FRICTION, 1)->value[0] = 0.2;
    s.n = 40;
    for (size_t i = 0; i < s.n; i++) {
        s.time_s[i] = 0.125 * (double)i;
        s.depth_m[i] = -0.03125 + 0.0009765625 * fmin((double)i, 20);
    }
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++)
        ck_assert_double_eq_tol(s.force_N[i], i < 20 ? 0.2 / 1.001 : i == 20 ? 0.2 / 1.002 : 0, 1e-12);
}
END_TEST

START_TEST(sensor_in_its_order) {
    palp_model m = linear_model(9);
    add_effect(&m, PALP_EFFECT_FORCE_SATURATION, 1)->value[0] = 1.9;
    add_effect(&m, PALP_EFFECT_SENSOR_BIAS, 1)->value[0] = -0.3;
    add_effect(&m, PALP_EFFECT_SENSOR_GAIN, 1)->value[0] = 0.1;
    add_effect(&m, PALP_EFFECT_SENSOR_DRIFT, 1)->value[0] = 0.02;
    palp_effect *hum = add_effect(&m, PALP_EFFECT_MAINS_HUM, 1),
                *ripple = add_effect(&m, PALP_EFFECT_DRIVE_RIPPLE, 1);
    hum->value[0] = 0.05;
    hum->value[1] = 50.3;
    ripple->value[0] = 0.07;
    ripple->value[1] = 0.8e-3;
    ripple->value[2] = 0.5;
    start(&s, 12.5, -1);
    go(&s, 15, 6, 60);
    press_model(&m, &s);
    for (size_t i = 0; i < s.n; i++) {
        double t = s.time_s[i], d = s.depth_m[i];
        double wanted = fmax(0, 9 * d / HEIGHT) * 1.1 + 0.07 * sin(2 * PI * d / 0.8e-3 + 0.5) - 0.3 +
                        0.02 * (t - 12.5) + 0.05 * sin(2 * PI * 50.3 * t + 0.3);
        EXPECT(i, fmin(1.9, wanted), 1e-12);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, frame_is_a_spring_in_series);
    tcase_add_test(tc, frame_loads_the_specimen_less);
    tcase_add_test(tc, added_force_is_sensed);
    tcase_add_test(tc, lag_of_a_ramp);
    tcase_add_test(tc, inertia_and_friction_in_air);
    tcase_add_test(tc, speed_of_a_swing);
    tcase_add_test(tc, a_stop_is_no_way_back);
    tcase_add_test(tc, sensor_in_its_order);
}
