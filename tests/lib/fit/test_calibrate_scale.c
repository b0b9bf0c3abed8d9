/* test_calibrate_scale.c: other units of force, length and time change the numbers of a calibration by their
 * factors only. */
#include <palpate/calibrate.h>

#include <check.h>
#include <math.h>
#include <string.h>

typedef struct scale {
    double force, length, time;
} scale;

static const scale scales[] = {{1e-9, 1, 1}, {1e-4, 1, 1}, {1e3, 1, 1},        {1, 1e-4, 1},  {1, 10, 1},
                               {1, 1, 1e-3}, {1, 1, 1e3},  {1e-9, 1e-4, 1e-3}, {1e3, 10, 1e3}};
enum { SCALES = sizeof scales / sizeof scales[0], SAMPLES = 60 };

#define NEAR(got, want)                                                                                      \
    ck_assert_msg(fabs((got) - (want)) <= 1e-6 * fabs(want), "scale %d: %s is %.9g, not %.9g", _i, #got,     \
                  (got), (want))

static palp_network *cube(scale by, const palp_material *m) {
    const size_t nodes[3] = {3, 3, 3};
    const double size[3] = {0.024 * by.length, 0.024 * by.length, 0.024 * by.length};
    palp_mesh *mesh;
    palp_support supports[2];
    palp_network *net = NULL;
    palp_network_settings settings = palp_network_settings_default();
    palp_supports_default(supports);
    ck_assert_int_eq(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, m, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static palp_material guess(scale by) {
    palp_material m = {.n_arms = 1, .arms = {{1.0 * by.force, 2.0 * by.force * by.time, 0, 0}}};
    const double c[3] = {1.0 * by.force, 0.5 * by.force, 0.5 * by.force};
    ck_assert_int_eq(palp_law_polynomial(3, c, &m.law), PALP_OK);
    return m;
}

static palp_calibration static_stage(scale by) {
    double depth[SAMPLES], target[SAMPLES];
    palp_material m = guess(by);
    palp_network *net = cube(by, &m);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration c;
    for (int i = 0; i < SAMPLES; i++) {
        double e = 0.3 * (i + 1) / SAMPLES;
        depth[i] = 0.024 * by.length * e;
        target[i] = by.force * e * (8.0 - 3.0 * e + 60.0 * e * e + 3.0 * sin(20.0 * e));
    }
    ck_assert_int_eq(palp_calibrate_static(net, &m, SAMPLES, depth, target, &settings, &c), PALP_OK);
    ck_assert(c.converged);
    palp_network_free(net);
    return c;
}

START_TEST(the_static_stage_scales) {
    const scale by = scales[_i], one = {1, 1, 1};
    palp_calibration c = static_stage(by), base = static_stage(one);
    for (size_t k = 0; k < 3; k++)
        NEAR(c.material.law.coefficients[k], by.force * base.material.law.coefficients[k]);
    NEAR(c.residual_N, by.force * base.residual_N);
    NEAR(c.strain_max, base.strain_max);
    palp_calibration_free(&c);
    palp_calibration_free(&base);
}
END_TEST

static palp_calibration relaxation_stage(scale by) {
    double time[SAMPLES], force[SAMPLES];
    palp_material m = guess(by);
    palp_network *net = cube(by, &m);
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    palp_target target = {.n = SAMPLES, .time_s = time, .force_N = force};
    palp_calibration c;
    ck_assert_int_eq(
        palp_path_ramp_hold(0.2 * 0.024 * by.length, 1.0 * by.time, 20.0 * by.time, &target.path), PALP_OK);
    for (int i = 0; i < SAMPLES; i++) {
        double t = 0.35 * (i + 1);
        time[i] = t * by.time;
        force[i] = by.force * (fmin(t, 1.0) * 1.5 + 0.6 * exp(-fmax(t - 1.0, 0.0) / 3.0) + 0.01 * sin(t));
    }
    ck_assert_int_eq(palp_calibrate_relaxation(net, &m, 1, &target, &settings, &c), PALP_OK);
    palp_path_free(&target.path);
    palp_network_free(net);
    return c;
}

START_TEST(the_relaxation_stage_scales) {
    const scale by = scales[_i], one = {1, 1, 1};
    palp_calibration c = relaxation_stage(by), base = relaxation_stage(one);
    ck_assert(c.converged && base.converged);
    NEAR(c.material.law.coefficients[0], by.force * base.material.law.coefficients[0]);
    NEAR(c.material.arms[0].stiffness_N, by.force * base.material.arms[0].stiffness_N);
    NEAR(c.material.arms[0].viscosity_Ns, by.force * by.time * base.material.arms[0].viscosity_Ns);
    palp_calibration_free(&c);
    palp_calibration_free(&base);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, the_static_stage_scales, 0, SCALES);
    tcase_add_loop_test(tc, the_relaxation_stage_scales, 0, SCALES);
}
