/* test_effect.c: the catalogue's table, and its relaxation moduli against their closed forms. */
#include "effect/effect_internal.h"
#include "forward_make.h"

static const double PI = 3.14159265358979323846;

START_TEST(catalogue_is_whole) {
    for (int i = 0; i < PALP_EFFECT_COUNT; i++) {
        const palp_effect_info *info = palp_effect_look_up((palp_effect_id)i);
        palp_effect_id found;
        bool strong = false;
        ck_assert_ptr_nonnull(info);
        ck_assert_int_eq(palp_effect_parse(info->id, &found), PALP_OK);
        ck_assert_int_eq((int)found, i);
        ck_assert(info->name[0] && info->means[0] && info->seen_by[0] &&
                  (info->in_lumped || info->in_network));
        ck_assert_uint_ge(info->n_parameters, 1);
        for (size_t k = 0; k < info->n_parameters; k++) {
            const palp_effect_parameter *p = &info->parameter[k];
            ck_assert_msg(p->key && p->unit > 0 && p->low <= p->typical && p->typical <= p->high, "%s",
                          info->id);
            ck_assert(!p->logarithmic || p->low > 0 || p->optional);
            ck_assert(!p->strength || (p->low <= 0 && p->high > 0 && p->typical != 0));
            strong = strong || p->strength;
        }
        ck_assert_msg(strong, "%s has no strength", info->id);
        for (size_t k = 0; k < info->n_alike; k++)
            ck_assert(palp_effect_look_up(info->alike[k]) && (int)info->alike[k] != i);
    }
    ck_assert_ptr_null(palp_effect_look_up(PALP_EFFECT_COUNT));
    ck_assert_int_eq(palp_effect_parse("gremlins", &(palp_effect_id){0}), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(default_is_off_and_sound) {
    for (int i = 0; i < PALP_EFFECT_COUNT; i++) {
        palp_effect effect;
        ck_assert_int_eq(palp_effect_default((palp_effect_id)i, &effect), PALP_OK);
        ck_assert_int_eq(palp_effect_check(&effect, NULL), PALP_OK);
        ck_assert(effect_is_off(&effect));
        effect.value[0] = palp_effect_look_up(effect.id)->parameter[0].typical;
        ck_assert(!effect_is_off(&effect));
    }
    ck_assert_int_eq(palp_effect_default(PALP_EFFECT_COUNT, &(palp_effect){0}), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(check_names_the_parameter_in_the_files_unit) {
    palp_error error = {PALP_OK, ""};
    palp_effect effect = {PALP_EFFECT_FRAME_COMPLIANCE, {-1e-6}};
    ck_assert_int_eq(palp_effect_check(&effect, &error), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(error.text, "frame_compliance: compliance_mm_N must be between 0 and 1e+15, not -0.001");
    effect.value[0] = NAN;
    ck_assert_int_eq(palp_effect_check(&effect, NULL), PALP_ERR_ARGUMENT);
    effect.id = (palp_effect_id)99;
    ck_assert_int_eq(palp_effect_check(&effect, NULL), PALP_ERR_ARGUMENT);
}
END_TEST

/* ---- relaxation moduli ---- */

static const effect_range whole = {EFFECT_MODES_MAX, 6e-6, 7e4};

static double modulus(size_t n, const effect_mode *mode, double t) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += mode[i].weight * exp(-mode[i].rate * t);
    return sum;
}

START_TEST(power_law_is_one_from_a_millisecond_to_hours) {
    for (double a = 0.02; a < 0.901; a += 0.08) {
        const double value[2] = {1.7, a};
        effect_mode mode[EFFECT_MODES_MAX];
        effect_power_law_relaxation.spectrum(value, &whole, mode);
        for (double t = 1e-3; t < 1.01e4; t *= 1.3) {
            double wanted = 1.7 * pow(t, -a) / tgamma(1 - a);
            ck_assert_msg(fabs(modulus(whole.n, mode, t) - wanted) < 6e-5 * wanted, "exponent %g at %g s", a,
                          t);
        }
    }
}
END_TEST

START_TEST(consolidation_is_its_series) {
    const double value[2] = {2.5, 10};
    effect_mode mode[EFFECT_MODES_MAX];
    effect_poroelastic.spectrum(value, &whole, mode);
    ck_assert_double_eq_tol(modulus(whole.n, mode, 0), 2.5, 1e-12);
    for (double t = 1e-5; t < 100; t *= 1.7) {
        double wanted = 0;
        for (int k = 100001; k > 0; k -= 2)
            wanted += 2.5 * 8 / (PI * PI) * exp(-(double)k * k * t / 10) / ((double)k * k);
        ck_assert_msg(fabs(modulus(whole.n, mode, t) - wanted) < 2e-4, "%g, not %g, at %g s",
                      modulus(whole.n, mode, t), wanted, t);
    }
}
END_TEST

/* A network has room for fewer: over its own range of time. */
START_TEST(few_modes_are_near) {
    const double law[2] = {1.7, 0.25}, pores[2] = {2.5, 10};
    const effect_range few = {10, 0.1 / 100, 5 / 0.01};
    effect_mode mode[EFFECT_MODES_MAX], exact[EFFECT_MODES_MAX];
    effect_power_law_relaxation.spectrum(law, &few, mode);
    for (double t = 0.01; t < 100; t *= 1.3) {
        double wanted = 1.7 * pow(t, -0.25) / tgamma(0.75);
        ck_assert_msg(fabs(modulus(few.n, mode, t) - wanted) < 1e-2 * wanted, "power law at %g s", t);
    }
    effect_poroelastic.spectrum(pores, &few, mode);
    effect_poroelastic.spectrum(pores, &whole, exact);
    for (double t = 0.01; t < 100; t *= 1.3)
        ck_assert_double_eq_tol(modulus(few.n, mode, t), modulus(whole.n, exact, t), 1e-2);
}
END_TEST

START_TEST(spectra_have_their_derivatives) {
    effect_spectrum *spectra[] = {effect_power_law_relaxation.spectrum, effect_poroelastic.spectrum};
    const double values[2][PALP_EFFECT_PARAMETERS] = {{1.7, 0.3}, {2.5, 10}};
    for (size_t s = 0; s < 2; s++)
        for (size_t k = 0; k < 2; k++) {
            effect_mode mid[EFFECT_MODES_MAX], up[EFFECT_MODES_MAX], down[EFFECT_MODES_MAX];
            double value[PALP_EFFECT_PARAMETERS] = {values[s][0], values[s][1]}, h = 1e-4 * values[s][k];
            spectra[s](value, &whole, mid);
            value[k] = values[s][k] + h;
            spectra[s](value, &whole, up);
            value[k] = values[s][k] - h;
            spectra[s](value, &whole, down);
            for (size_t i = 0; i < whole.n; i++) {
                double weight = (up[i].weight - down[i].weight) / (2 * h),
                       rate = (up[i].rate - down[i].rate) / (2 * h);
                ck_assert_double_eq_tol(weight, mid[i].weight_by[k],
                                        1e-6 * fabs(weight) + 1e-9 * mid[i].weight);
                ck_assert_double_eq_tol(rate, mid[i].rate_by[k], 1e-6 * fabs(rate) + 1e-9 * mid[i].rate);
            }
        }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, catalogue_is_whole);
    tcase_add_test(tc, default_is_off_and_sound);
    tcase_add_test(tc, check_names_the_parameter_in_the_files_unit);
    tcase_add_test(tc, power_law_is_one_from_a_millisecond_to_hours);
    tcase_add_test(tc, consolidation_is_its_series);
    tcase_add_test(tc, few_modes_are_near);
    tcase_add_test(tc, spectra_have_their_derivatives);
}
