/* test_element.c: one element's force, tangent and energy against closed forms and finite differences. */
#include "element_make.h"

#include <math.h>

static bool needs_time(const palp_material *m) {
    return m->dashpot_Ns > 0.0 || (m->formulation == PALP_SEDEF2008 && m->n_arms > 0);
}

/* Somewhere with a history: two steps from rest. */
static palp_element_state worn(const palp_material *m, double strain) {
    palp_element_state state = {0};
    return advance(m, advance(m, state, -0.12, 0.3), strain, 0.7);
}

static const double STRAINS[] = {-0.38, -0.2, -0.01, 0.004, 0.15, 0.31};
static const double STEPS[] = {0.0, 1e-9, 1e-3, 0.1, 3.0, 1e3, INFINITY};
enum { N_STRAINS = sizeof STRAINS / sizeof *STRAINS, N_STEPS = sizeof STEPS / sizeof *STEPS };

/* ---- tangent ------------------------------------------------------------------------------------- */

/* Calls back with every material, history and step, at rest too. */
static void for_all(void (*judge)(const palp_material *, const palp_element_state *, double dt, int kind)) {
    for (int kind = 0; kind < KINDS; kind++) {
        palp_material m = material_of(kind);
        palp_element_state from[] = {{0}, worn(&m, -0.25), worn(&m, 0.1), worn(&m, 0.0)};
        for (size_t f = 0; f < 4; f++)
            for (size_t s = 0; s < N_STEPS; s++)
                if (STEPS[s] > 0.0 || !needs_time(&m))
                    judge(&m, &from[f], STEPS[s], kind);
    }
}

/* The error of a central difference is h^2 times a third derivative of some 1e3, plus rounding of 1e-16 of
 * the force over h. */
static void judge_tangent(const palp_material *m, const palp_element_state *from, double dt, int kind) {
    const double h = 1e-6;
    for (size_t i = 0; i < N_STRAINS; i++) {
        palp_element_state at;
        double e = STRAINS[i], tangent;
        ck_assert_int_eq(palp_element_advance(m, from, e, dt, &at, &tangent), PALP_OK);
        double high = advance(m, *from, e + h, dt).force_N, low = advance(m, *from, e - h, dt).force_N;
        double difference = (high - low) / (2.0 * h), size = fabs(tangent) + fabs(at.force_N) + 1.0;
        ck_assert_msg(fabs(tangent - difference) < 1e-8 * size,
                      "kind %d, e %g from %g, dt %g: %.12g not %.12g", kind, e, from->strain, dt, tangent,
                      difference);
    }
}

START_TEST(tangent_is_the_derivative_of_the_force) {
    for_all(judge_tangent);
}
END_TEST

/* At e = 0 the force has a kink where |e| meets a history (gamma) or a rate (Eq. 5.11): the tangent is one of
 * the two slopes. Where there is none, both. */
static void judge_tangent_at_zero(const palp_material *m, const palp_element_state *from, double dt,
                                  int kind) {
    const double h = 1e-5;
    bool kinked = kind == GAMMA || kind == BETA_GAMMA || kind == QLV_GAMMA || kind == SEDEF_1;
    palp_element_state at;
    double tangent, slope[2];
    ck_assert_int_eq(palp_element_advance(m, from, 0.0, dt, &at, &tangent), PALP_OK);
    for (int side = 0; side < 2; side++) {
        double s = side ? -h : h, one = advance(m, *from, s, dt).force_N,
               two = advance(m, *from, 2 * s, dt).force_N;
        slope[side] = (4.0 * one - 3.0 * at.force_N - two) / (2.0 * s);
    }
    double size = 1e-6 * (fabs(tangent) + fabs(at.force_N) + 1.0);
    bool high = fabs(tangent - slope[0]) < size, low = fabs(tangent - slope[1]) < size;
    ck_assert_msg(kinked ? high || low : high && low, "kind %d from %g, dt %g: %.12g not %.12g or %.12g",
                  kind, from->strain, dt, tangent, slope[0], slope[1]);
}

START_TEST(tangent_at_no_strain) {
    for_all(judge_tangent_at_zero);
}
END_TEST

/* ---- energy -------------------------------------------------------------------------------------- */

static double energy_at(const palp_material *m, const palp_element_state *from, double dt, double e,
                        bool *known) {
    palp_element_state start = *from;
    double elastic, energy = 0.0, work;
    palp_law_force(&m->law, 1, &start.strain, &elastic, NULL, NULL);
    element_history old = {&start.strain, &elastic, start.arm_N, NULL, 1};
    element_step step;
    element_step_prepare(m, dt, &step);
    *known = element_energy(m, &step, 1, &e, &old, &energy, &work);
    return energy;
}

/* Gauss' rule of four points, exact for these polynomials on either side of 0. */
static double work_done(const palp_material *m, const palp_element_state *from, double dt, double a,
                        double b) {
    static const double x[] = {0.3399810435848563, 0.8611363115940526},
                        w[] = {0.6521451548625461, 0.3478548451374538};
    double sum = 0.0, middle = 0.5 * (a + b), half = 0.5 * (b - a);
    for (size_t k = 0; k < 2; k++)
        sum += w[k] * (advance(m, *from, middle - half * x[k], dt).force_N +
                       advance(m, *from, middle + half * x[k], dt).force_N);
    return sum * half;
}

static void judge_energy(const palp_material *m, const palp_element_state *from, double dt, int kind) {
    bool known;
    double zero = energy_at(m, from, dt, 0.0, &known);
    ck_assert_int_eq(known, kind != GAMMA && kind != BETA_GAMMA && kind != QLV_GAMMA && kind != SEDEF_1);
    for (size_t i = 0; known && i < N_STRAINS; i++) {
        double work = work_done(m, from, dt, 0.0, STRAINS[i]),
               rise = energy_at(m, from, dt, STRAINS[i], &known) - zero;
        ck_assert_msg(fabs(rise - work) <= 1e-13 * (fabs(work) + fabs(zero) + 1.0),
                      "kind %d, e %g from %g, dt %g: %.15g not %.15g", kind, STRAINS[i], from->strain, dt,
                      rise, work);
    }
}

START_TEST(energy_is_the_integral_of_the_force) {
    for_all(judge_energy);
}
END_TEST

/* ---- partial derivatives of an arm --------------------------------------------------------------- */

enum { OF_STRAIN, OF_STRAIN_OLD, OF_ARM_OLD, OF_LOG_STIFFNESS, OF_LOG_TIME, OF_BETA, OF_GAMMA, PARTIALS };

/* The force of arm j after a step with one of its causes shifted by h. */
static double shifted_arm(const palp_material *m, const palp_element_state *from, size_t j, double e,
                          double dt, int what, double h) {
    palp_material material = *m;
    palp_element_state start = *from;
    palp_arm *arm = &material.arms[j];
    start.strain += what == OF_STRAIN_OLD ? h : 0.0;
    start.arm_N[j] += what == OF_ARM_OLD ? h : 0.0;
    if (what == OF_LOG_STIFFNESS)
        arm->stiffness_N *= exp(h);
    if (what == OF_LOG_STIFFNESS || what == OF_LOG_TIME)
        arm->viscosity_Ns *= exp(h);
    arm->beta += what == OF_BETA ? h : 0.0;
    arm->gamma += what == OF_GAMMA ? h : 0.0;
    return advance(&material, start, what == OF_STRAIN ? e + h : e, dt).arm_N[j];
}

static void judge_partials(const palp_material *m, const palp_element_state *from, double dt, int kind) {
    const double h = 1e-5;
    if (m->formulation != PALP_HISTORY || from->strain == 0.0)
        return; /* |e_old| has its kink there */
    element_step step;
    element_step_prepare(m, dt, &step);
    for (size_t j = 0; j < m->n_arms; j++)
        for (size_t i = 0; i < N_STRAINS; i++) {
            double p[ELEMENT_PARTIALS];
            element_arm_partials(m, &step, j, 1, &STRAINS[i], &from->strain, &from->arm_N[j], p);
            const double got[PARTIALS] = {p[ELEMENT_STRAIN],        p[ELEMENT_STRAIN_OLD], p[ELEMENT_ARM_OLD],
                                          p[ELEMENT_LOG_STIFFNESS], p[ELEMENT_LOG_TIME],   p[ELEMENT_BETA],
                                          p[ELEMENT_GAMMA]};
            for (int what = 0; what < PARTIALS; what++) {
                if (m->quasi_linear && what == OF_BETA)
                    continue; /* not a parameter of it */
                double high = shifted_arm(m, from, j, STRAINS[i], dt, what, h);
                double low = shifted_arm(m, from, j, STRAINS[i], dt, what, -h),
                       want = (high - low) / (2.0 * h);
                ck_assert_msg(fabs(got[what] - want) < 1e-7 * (fabs(want) + fabs(high) + 0.1),
                              "kind %d, arm %zu, e %g from %g, dt %g: partial %d is %.12g not %.12g", kind, j,
                              STRAINS[i], from->strain, dt, what, got[what], want);
            }
        }
}

START_TEST(partials_of_an_arm) {
    for_all(judge_partials);
}
END_TEST

/* ---- steps of no time and of all time ------------------------------------------------------------ */

START_TEST(no_time_moves_only_springs) {
    for (int kind = 0; kind < KINDS; kind++) {
        palp_material m = material_of(kind);
        if (needs_time(&m))
            continue;
        palp_element_state from = worn(&m, -0.1), to = advance(&m, from, -0.22, 0.0);
        double k, k_old, k0, sum;
        palp_law_stiffness(&m.law, -0.22, &k, NULL);
        palp_law_stiffness(&m.law, -0.1, &k_old, NULL);
        palp_law_stiffness(&m.law, 0.0, &k0, NULL);
        sum = k * -0.22;
        for (size_t j = 0; j < m.n_arms; j++) {
            double beta = m.arms[j].beta, drive = -0.12 - 0.5 * beta * (0.22 * 0.22 - 0.1 * 0.1);
            if (m.quasi_linear)
                drive = (k * -0.22 - k_old * -0.1) / k0;
            ck_assert_double_eq_tol(to.arm_N[j], from.arm_N[j] + m.arms[j].stiffness_N * drive, 1e-15);
            sum += to.arm_N[j];
        }
        ck_assert_double_eq_tol(to.force_N, sum, 1e-14);
        ck_assert_double_eq_tol(advance(&m, from, -0.22, 1e-13).force_N, sum, 1e-11); /* the limit is met */
    }
}
END_TEST

START_TEST(all_time_relaxes_the_arms) {
    for (int kind = 0; kind < KINDS; kind++) {
        palp_material m = material_of(kind);
        palp_element_state from = worn(&m, -0.1), to = advance(&m, from, -0.3, INFINITY);
        double k;
        palp_law_stiffness(&m.law, -0.3, &k, NULL);
        ck_assert_double_eq_tol(to.force_N, k * -0.3, 1e-15);
        for (size_t j = 0; j < m.n_arms && m.formulation == PALP_HISTORY; j++)
            ck_assert_double_eq(to.arm_N[j], 0.0);
        ck_assert_double_eq_tol(advance(&m, from, -0.3, 1e15).force_N, k * -0.3, 1e-11);
    }
}
END_TEST

START_TEST(decay_and_its_mean_over_a_step) {
    /* (1 - exp(-x)) / x by its series where the difference would cancel */
    for (double x = 1e-12; x < 1e3; x *= 1.7) {
        double decay, mean, series = 0.0, term = 1.0;
        element_decay(x, &decay, &mean);
        for (int k = 1; k < 30; k++) {
            series += term;
            term *= -x / (k + 1);
        }
        ck_assert_double_eq_tol(decay, exp(-x), 1e-16);
        ck_assert_double_eq_tol(mean / (x < 0.7 ? series : (1.0 - exp(-x)) / x), 1.0, 1e-15);
    }
    double decay, mean;
    element_decay(0.0, &decay, &mean);
    ck_assert(decay == 1.0 && mean == 1.0);
    element_decay(INFINITY, &decay, &mean);
    ck_assert(decay == 0.0 && mean == 0.0);
}
END_TEST

/* ---- what is refused ----------------------------------------------------------------------------- */

START_TEST(steps_that_make_no_sense) {
    palp_material m = material_of(PLAIN_1), dashpot = material_of(DASHPOT), sedef = material_of(SEDEF_1);
    palp_element_state from = {0}, to = {.force_N = 123.0};
    static const double bad_dt[] = {-1.0, -INFINITY, NAN};
    static const double bad_strain[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 3; i++) {
        ck_assert_int_eq(palp_element_advance(&m, &from, 0.1, bad_dt[i], &to, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_element_advance(&m, &from, bad_strain[i], 1.0, &to, NULL), PALP_ERR_ARGUMENT);
    }
    ck_assert_int_eq(palp_element_advance(&dashpot, &from, 0.1, 0.0, &to, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_element_advance(&sedef, &from, 0.1, 0.0, &to, NULL), PALP_ERR_ARGUMENT);
    ck_assert_double_eq(to.force_N, 123.0);
    ck_assert_int_eq(palp_element_advance(&m, &from, 0.1, 0.0, &from, NULL), PALP_OK); /* onto itself */
    ck_assert_double_eq(from.strain, 0.1);
}
END_TEST

START_TEST(materials_that_make_no_sense) {
    palp_error error;
    palp_material m = plain(2);
    static const double bad[] = {0.0, -1.0, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        m = plain(2);
        m.arms[1].stiffness_N = bad[i];
        ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
        m = plain(2);
        m.arms[1].viscosity_Ns = bad[i];
        ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
        m = plain(2);
        m.dashpot_Ns = bad[i];
        ck_assert_int_eq(palp_material_check(&m, &error), bad[i] == 0.0 ? PALP_OK : PALP_ERR_ARGUMENT);
        m = plain(2);
        m.arms[0].beta = bad[i];
        ck_assert_int_eq(palp_material_check(&m, NULL), bad[i] == 0.0 ? PALP_OK : PALP_ERR_ARGUMENT);
        m = plain(2);
        m.arms[0].gamma = bad[i];
        ck_assert_int_eq(palp_material_check(&m, NULL), bad[i] == 0.0 ? PALP_OK : PALP_ERR_ARGUMENT);
    }
    m = plain(2);
    m.n_arms = PALP_ARMS_MAX + 1;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_LIMIT);
    m = plain(2);
    m.formulation = PALP_SEDEF2008; /* two arms */
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_UNSUPPORTED);
    m = plain(1);
    m.formulation = PALP_SEDEF2008;
    m.arms[0].beta = 1.0;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_UNSUPPORTED);
    m = plain(1);
    m.quasi_linear = true;
    m.arms[0].beta = 1.0;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_UNSUPPORTED);
    m = plain(1);
    m.quasi_linear = true; /* K(0) divides */
    ck_assert_int_eq(palp_law_polynomial(2, (double[]){0.0, 1.0}, &m.law), PALP_OK);
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(laws_that_no_maker_made) {
    palp_material zero = {0}, m = plain(1);
    palp_element_state state = {0};
    palp_error error;
    ck_assert_int_eq(palp_material_check(&zero, &error), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_element_advance(&zero, &state, 0.1, 1.0, &state, NULL), PALP_ERR_ARGUMENT);
    m.law.n = PALP_LAW_MAX + 1;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_element_advance(&m, &state, 0.1, 1.0, &state, NULL), PALP_ERR_ARGUMENT);
    m = plain(1);
    m.law.kind = (palp_law_kind)99;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
    m = plain(1);
    m.law.coefficients[m.law.n - 1] = NAN;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
    m = plain(1);
    ck_assert_int_eq(palp_law_spline(2, (double[]){0.0, 0.5}, (double[]){1.0, 2.0}, &m.law), PALP_OK);
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_OK);
    m.law.slope[1] = NAN;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, (double[]){1e3}, 1e-4, &m.law), PALP_OK);
    m.law.area_m2 = 0.0;
    ck_assert_int_eq(palp_material_check(&m, &error), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(lumped_runs_that_make_no_sense) {
    palp_material m = plain(1);
    double force[3];
    const double time[] = {0.0, 1.0, 2.0}, depth[] = {0.0, 0.001, 0.002};
    ck_assert_int_eq(palp_lumped_run(&m, 0.0, 3, time, depth, force), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_lumped_run(&m, NAN, 3, time, depth, force), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 3, (double[]){0.0, 1.0, 1.0}, depth, force),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 3, (double[]){0.0, NAN, 1.0}, depth, force),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 3, time, (double[]){0.0, NAN, 1.0}, force),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 0, time, depth, force), PALP_OK);
    m.arms[0].stiffness_N = 0.0;
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 3, time, depth, force), PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, tangent_is_the_derivative_of_the_force);
    tcase_add_test(tc, tangent_at_no_strain);
    tcase_add_test(tc, energy_is_the_integral_of_the_force);
    tcase_add_test(tc, partials_of_an_arm);
    tcase_add_test(tc, no_time_moves_only_springs);
    tcase_add_test(tc, all_time_relaxes_the_arms);
    tcase_add_test(tc, decay_and_its_mean_over_a_step);
    tcase_add_test(tc, steps_that_make_no_sense);
    tcase_add_test(tc, materials_that_make_no_sense);
    tcase_add_test(tc, laws_that_no_maker_made);
    tcase_add_test(tc, lumped_runs_that_make_no_sense);
}
