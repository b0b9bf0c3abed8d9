/* test_spectrum.c: storage and loss stiffness of oscillations, against the closed form. */
#include "sweeps.h"

static const double PI = 3.14159265358979323846, HEIGHT = 0.024;

/* Arms from a hundredth of a cycle to a hundred cycles, and a dashpot. */
static palp_material solid(double force, double time) {
    static const double tau[3] = {0.02, 0.7, 40.0}, stiffness[3] = {3.0, 2.0, 1.0};
    double k = 8.0 * force;
    palp_material m = {.n_arms = 3, .dashpot_Ns = 0.001 * force * time};
    ck_assert_int_eq(palp_law_polynomial(1, &k, &m.law), PALP_OK);
    for (size_t j = 0; j < 3; j++)
        m.arms[j] = (palp_arm){force * stiffness[j], force * stiffness[j] * time * tau[j], 0.0, 0.0};
    return m;
}

static palp_recording blank(size_t n, double length) {
    palp_recording r = {.name = "made", .height_m = HEIGHT * length, .n = n, .kind = PALP_RECORDING_OTHER};
    r.time_s = calloc(n, sizeof(double));
    r.depth_m = calloc(n, sizeof(double));
    r.force_N = calloc(n, sizeof(double));
    r.use = malloc(n);
    ck_assert(r.time_s && r.depth_m && r.force_N && r.use);
    memset(r.use, 1, n);
    return r;
}

/* The exact force of a specimen, relaxed at 10 % until then, under a sine of 1 % that begins, with its
 * transients. */
static palp_recording sine(const palp_material *m, double frequency, size_t cycles, size_t each,
                           double length) {
    palp_recording r = blank(cycles * each + 1, length);
    double w = 2.0 * PI * frequency;
    for (size_t i = 0; i < r.n; i++) {
        double t = (double)i / (double)each / frequency, e = 0.1 + 0.01 * sin(w * t);
        r.time_s[i] = t;
        r.depth_m[i] = e * r.height_m;
        r.force_N[i] = m->law.coefficients[0] * e + m->dashpot_Ns * 0.01 * w * cos(w * t);
        for (size_t j = 0; j < m->n_arms; j++) {
            double tau = m->arms[j].viscosity_Ns / m->arms[j].stiffness_N, x = w * tau;
            r.force_N[i] += m->arms[j].stiffness_N * 0.01 * x / (1.0 + x * x) *
                            (x * sin(w * t) + cos(w * t) - exp(-t / tau));
        }
    }
    return r;
}

static double error_of(const palp_material *m, const palp_recording *r, const palp_spectrum_point *p) {
    double storage, loss;
    ck_assert_int_eq(palp_lumped_oscillation(m, r->height_m, p->depth_m / r->height_m, 1, &p->frequency_Hz,
                                             &storage, &loss),
                     PALP_OK);
    return hypot(p->storage_N_m - storage, p->loss_N_m - loss) / hypot(storage, loss);
}

/* Five decades, in one set of units and in others: to 1e-6, and so is the frequency. */
START_TEST(a_sine_has_the_stiffness_of_the_closed_form) {
    static const double force[4] = {1.0, 1e-9, 1e3, 1.0}, length[4] = {1.0, 1e-4, 10.0, 1.0},
                        time[4] = {1.0, 1.0, 1.0, 1e3};
    palp_material m = solid(force[_i], time[_i]);
    for (int k = -2; k <= 3; k++) {
        double frequency = 1.7 * pow(10.0, k) / time[_i];
        palp_spectrum s;
        palp_recording r = sine(&m, frequency, 60, 100, length[_i]);
        ck_assert_int_eq(palp_spectrum_measure(&r, &s), PALP_OK);
        ck_assert_uint_eq(s.n, 1);
        ck_assert_double_eq_tol(s.point->frequency_Hz, frequency, 1e-6 * frequency);
        ck_assert_double_eq_tol(s.point->amplitude_m, 0.01 * r.height_m, 1e-6 * 0.01 * r.height_m);
        ck_assert_double_lt(error_of(&m, &r, s.point), 1e-6);
        palp_spectrum_free(&s);
        palp_recording_free(&r);
    }
}
END_TEST

/* A law that bends, arms, a sweep of two decades, at 2 kHz so that straight steps between samples are of no
 * account. Nothing but noise is missed: of the stiffness half a percent of its size where there is none, else
 * two sds in nearly all stretches. */
START_TEST(a_sweep_has_the_stiffness_of_the_closed_form) {
    sweep t = {phantom(), 3.0, 0.3, 10.0, 0.1, 10.0, 60.0, 2000.0, _i ? 0.004 : 0.0, 7};
    palp_spectrum s;
    palp_recording r = prepare(record_sweep(&t));
    size_t beyond = 0;
    double worst = 0.0;
    ck_assert_int_eq(palp_spectrum_measure(&r, &s), PALP_OK);
    ck_assert_uint_gt(s.n, 10);
    for (size_t k = 0; k < s.n; k++) {
        double storage, loss, sd = s.point[k].storage_sd_N_m, e = s.point[k].depth_m / r.height_m;
        ck_assert_int_eq(
            palp_lumped_oscillation(&t.material, r.height_m, e, 1, &s.point[k].frequency_Hz, &storage, &loss),
            PALP_OK);
        beyond += fabs(s.point[k].storage_N_m - storage) > 2.0 * sd;
        beyond += fabs(s.point[k].loss_N_m - loss) > 2.0 * sd;
        worst = fmax(worst, hypot(s.point[k].storage_N_m - storage, s.point[k].loss_N_m - loss) /
                                hypot(storage, loss));
    }
    ck_assert_double_lt(worst, _i ? 0.005 : 2e-4);
    if (_i)
        ck_assert_uint_le(beyond, s.n / 3);
    palp_spectrum_free(&s);
    palp_recording_free(&r);
}
END_TEST

/* Presses without an oscillation have no spectrum, nor has one that leaves the specimen at every cycle. */
START_TEST(what_does_not_oscillate_in_the_specimen_has_no_spectrum) {
    palp_spectrum s;
    sweep off = {phantom(), 1.0, 1.2, 2.0, 1.0, 1.0, 10.0, 200.0, 0.002, 3};
    take dwell = {phantom(), 3.0, 1.0, 20.0, 1.0, 200.0, 0.002, "ramp_hold", 4};
    palp_recording r[2] = {prepare(record_sweep(&off)), prepare(record(&dwell))};
    for (size_t k = 0; k < 2; k++) {
        ck_assert_int_eq(palp_spectrum_measure(&r[k], &s), PALP_OK);
        ck_assert_uint_eq(s.n, 0);
        palp_spectrum_free(&s);
    }
    free_all(2, r);
    palp_spectrum_free(NULL);
    ck_assert_int_eq(palp_spectrum_measure(NULL, &s), PALP_ERR_ARGUMENT);
}
END_TEST

/* Triangles, uneven samples and a third of them lost: the same. */
START_TEST(an_uneven_triangle_has_it_too) {
    sweep t = {phantom(), 3.0, 0.3, 10.0, 0.5, 0.5, 40.0, 2000.0, 0.0, 7};
    palp_experiment *e = record_sweep(&t);
    palp_recording whole = prepare(e), r = whole;
    palp_element_state at = {0};
    uint64_t state = 5;
    r.n = 0;
    for (size_t i = 0; i < whole.n; i++) {
        double time = whole.time_s[i] - 12.0, cycle = 0.5 * time - floor(0.5 * time);
        if (time > 0.0 && time < 40.0)
            whole.depth_m[i] = 3e-3 + 3e-4 * (cycle < 0.25   ? 4.0 * cycle
                                              : cycle < 0.75 ? 2.0 - 4.0 * cycle
                                                             : 4.0 * cycle - 4.0);
        ck_assert_int_eq(palp_element_advance(&t.material, &at, fmax(whole.depth_m[i], 0.0) / 0.024,
                                              i ? 5e-4 : 0.0, &at, NULL),
                         PALP_OK);
        if (palp_random_uniform(&state) < 1.0 / 3.0)
            continue;
        r.time_s[r.n] = whole.time_s[i];
        r.depth_m[r.n] = whole.depth_m[i];
        r.force_N[r.n] = fmax(at.force_N, 0.0);
        r.use[r.n++] = 1;
    }
    palp_spectrum s;
    ck_assert_int_eq(palp_spectrum_measure(&r, &s), PALP_OK);
    ck_assert_uint_eq(s.n, 1);
    ck_assert_double_lt(error_of(&t.material, &r, s.point), 1e-3);
    palp_spectrum_free(&s);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_sine_has_the_stiffness_of_the_closed_form, 0, 4);
    tcase_add_loop_test(tc, a_sweep_has_the_stiffness_of_the_closed_form, 0, 2);
    tcase_add_test(tc, what_does_not_oscillate_in_the_specimen_has_no_spectrum);
    tcase_add_test(tc, an_uneven_triangle_has_it_too);
}
