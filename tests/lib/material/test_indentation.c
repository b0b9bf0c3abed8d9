/* test_indentation.c: a tip on an elastic layer against the half-space, published tables, thin layers and
 * itself. */
#include <palpate/indentation.h>

#include <check.h>
#include <math.h>

static const double PI = 3.14159265358979323846;

static palp_indentation of(palp_tip_kind tip, double thickness_m, double poisson) {
    return (palp_indentation){
        .tip = tip, .radius_m = 2e-3, .half_angle_rad = 1.0, .thickness_m = thickness_m, .poisson = poisson};
}

static double force(palp_indentation in, double depth_m) {
    double f = NAN;
    ck_assert_int_eq(palp_indentation_force(&in, 1, &depth_m, &f), PALP_OK);
    return f;
}

static void near_to(double got, double wanted, double relative) {
    ck_assert_double_eq_tol(got / wanted, 1.0, relative);
}

START_TEST(a_half_space_has_its_closed_forms) {
    double nu = 0.1 * _i, d = 1e-6, a = 2e-3;
    near_to(force(of(PALP_TIP_FLAT, INFINITY, nu), d), 4 * a * d / (1 - nu), 1e-12);
    near_to(force(of(PALP_TIP_CONE, INFINITY, nu), d), 4 / PI * tan(1.0) * d * d / (1 - nu), 1e-9);
    near_to(force(of(PALP_TIP_SPHERE, INFINITY, nu), d), 8.0 / 3.0 * sqrt(a) * pow(d, 1.5) / (1 - nu),
            2e-4); /* Hertz: a paraboloid */
    near_to(force(of(PALP_TIP_PLATE, 0.01, nu), d), 2 * (1 + nu) * PI * a * a * d / 0.01, 1e-12);
    near_to(force(of(PALP_TIP_FLAT, 1e3, nu), d), 4 * a * d / (1 - nu), 1e-5); /* a thick layer */
}
END_TEST

/* Hayes, Keer, Herrmann and Mockros 1972: F = 4 G a kappa d / (1 - nu); their figures are within 1 % up to a
 * / h = 2. */
START_TEST(the_flat_punch_has_the_published_factors) {
    static const double kappa[] = {1.281, 1.683, 2.211, 2.855, 3.609, 4.469, 5.441, 6.528, 7.735, 9.069};
    palp_indentation in = of(PALP_TIP_FLAT, 1.0, 0.5);
    in.thickness_m = in.radius_m / (0.2 * (_i + 1));
    near_to(force(in, 1e-5) * 0.5 / (4 * in.radius_m * 1e-5), kappa[_i], 0.01);
}
END_TEST

/* A thin layer is in uniaxial strain, but for the edge. */
START_TEST(a_thin_layer_is_compressed_without_spreading) {
    double a = 2e-3, h = a / 11.9, nu = 0.25, modulus = 2 * (1 - nu) / (1 - 2 * nu);
    near_to(force(of(PALP_TIP_FLAT, h, nu), 1e-6), modulus * PI * a * a * 1e-6 / h, 0.06);
    palp_indentation in = of(PALP_TIP_FLAT, h, 0.5);
    in.floor_slides = true; /* plane strain to all sides, and nothing holds it: far softer than bonded */
    ck_assert_double_lt(force(in, 1e-6), 0.2 * force(of(PALP_TIP_FLAT, h, 0.5), 1e-6));
}
END_TEST

/* Lengths times a factor: forces over G grow with its square. One call for many depths, in any order, is many
 * calls. */
START_TEST(scale_and_order_change_nothing) {
    double depth[4] = {3e-4, -1e-4, 1e-4, 2e-4}, one[4], scaled[4], factor = 1e-5;
    palp_indentation in = of((palp_tip_kind)_i, 4e-3, 0.45), small = in;
    small.radius_m *= factor;
    small.thickness_m *= factor;
    ck_assert_int_eq(palp_indentation_force(&in, 4, depth, one), PALP_OK);
    ck_assert_double_eq(one[1], 0.0);
    for (int i = 0; i < 4; i++)
        near_to(depth[i] > 0 ? force(in, depth[i]) : 1.0, depth[i] > 0 ? one[i] : 1.0, 1e-6);
    for (int i = 0; i < 4; i++)
        depth[i] *= factor;
    ck_assert_int_eq(palp_indentation_force(&small, 4, depth, scaled), PALP_OK);
    for (int i = 0; i < 4; i++)
        ck_assert_double_eq_tol(scaled[i] / (factor * factor), one[i], 1e-9 * one[0]);
}
END_TEST

/* The slope of a curved tip's force is the stiffness of a flat punch as wide as the contact. */
START_TEST(the_slope_is_that_of_a_punch_as_wide_as_the_contact) {
    palp_indentation in = of(_i ? PALP_TIP_CONE : PALP_TIP_SPHERE, 1e-3, 0.4), flat = in;
    double d = 1.2e-4, step = 1e-7;
    flat.tip = PALP_TIP_FLAT;
    ck_assert_int_eq(palp_indentation_contact(&in, d, &flat.radius_m), PALP_OK);
    near_to((force(in, d + step) - force(in, d - step)) / (2 * step), force(flat, 1.0), 1e-4);
}
END_TEST

/* Published closed forms and what CalculiX' tables must tend to. */
START_TEST(the_tables_meet_what_is_known) {
    palp_indentation plate = of(PALP_TIP_PLATE, 2e-3, 0.5), glued = plate,
                     flat = of(PALP_TIP_FLAT, 2e-3, 0.45), other = flat;
    glued.tip_sticks = true; /* Gent and Lindley 1959: 1 + 2 (R / 2 h)^2 */
    near_to(force(glued, 1e-5) / force(plate, 1e-5), 1.5, 0.06);
    glued.thickness_m = plate.thickness_m = 0.5e-3;
    near_to(force(glued, 1e-5) / force(plate, 1e-5), 9.0, 0.05);
    other.specimen_radius_m = 6e-3; /* three punches wide */
    near_to(force(other, 1e-5) / force(flat, 1e-5), 0.985, 2e-3);
    other.specimen_radius_m = 1.0;
    near_to(force(other, 1e-5) / force(flat, 1e-5), 1.0, 1e-3);
    other.large_strain = true; /* small depths: as at small strain */
    near_to(force(other, 1e-7) / force(flat, 1e-7), 1.0, 2e-3);
    ck_assert_double_gt(force(other, 4e-4), 1.15 * force(flat, 4e-4));
    other.specimen_radius_m = 0;
    other.thickness_m = 1e-4;
    double d = 1e-6, f;
    ck_assert_int_eq(palp_indentation_force(&other, 1, &d, &f), PALP_ERR_LIMIT);
    other = flat;
    other.large_strain = true;
    d = 6e-4;
    ck_assert_int_eq(palp_indentation_force(&other, 1, &d, &f), PALP_ERR_LIMIT);
    other.tip = PALP_TIP_SPHERE;
    ck_assert_int_eq(palp_indentation_force(&other, 1, &d, &f), PALP_ERR_LIMIT);
    other.tip_sticks = true;
    ck_assert_int_eq(palp_indentation_force(&other, 1, &d, &f), PALP_ERR_UNSUPPORTED);
    other.tip_sticks = false;
    other.specimen_radius_m = NAN;
    ck_assert_int_eq(palp_indentation_force(&other, 1, &d, &f), PALP_ERR_ARGUMENT);
}
END_TEST

/* A sphere as thick as its layer, Poisson's ratio 0.3, deep: CalculiX with three times the elements of the
 * tables', which is at no place of theirs. A shallow press is as at small strain, and the depth of the tables
 * ends where the header says. */
START_TEST(a_deep_sphere_is_that_of_finite_elements) {
    static const double depth[3] = {0.05, 0.075, 0.1}, wanted[3] = {0.054055, 0.105769, 0.172297};
    palp_indentation in = {.tip = PALP_TIP_SPHERE,
                           .radius_m = 1,
                           .thickness_m = 1,
                           .poisson = 0.3,
                           .large_strain = true},
                     small = in;
    double d = 0.16 / 1.1 + 1e-3, f;
    small.large_strain = false;
    near_to(force(in, depth[_i]), wanted[_i], 0.015);
    ck_assert_double_gt(force(in, depth[_i]), 1.02 * force(small, depth[_i]));
    near_to(force(in, 1e-5), force(small, 1e-5), 1e-3);
    ck_assert_int_eq(palp_indentation_force(&in, 1, &d, &f), PALP_ERR_LIMIT);
    in.radius_m = 0.25;
    near_to(force(in, 0.099),
            force((palp_indentation){.tip = PALP_TIP_SPHERE,
                                     .radius_m = 0.25,
                                     .thickness_m = 0.25 / 0.3,
                                     .poisson = 0.3,
                                     .large_strain = true},
                  0.099),
            0.03);
    d = 0.101;
    ck_assert_int_eq(palp_indentation_force(&in, 1, &d, &f), PALP_ERR_LIMIT);
    in.tip = PALP_TIP_CONE;
    in.half_angle_rad = 0.5;
    ck_assert_int_eq(palp_indentation_force(&in, 1, &d, &f), PALP_ERR_LIMIT);
}
END_TEST

/* Spheres of an eighth, 5/24 and 5/12 of the height on a specimen that is as high and as wide as a cube:
 * CalculiX with 12 elements in the contact (data/tips/block.csv). Without its width forces would be off by 7
 * to 24 %. */
START_TEST(a_sphere_on_a_narrow_specimen_is_that_of_finite_elements) {
    static const struct {
        double radius, poisson, depth, wanted;
    } CASES[] = {{3, 0.25, 1, 0.011268373}, {5, 0.25, 2, 0.041985594}, {10, 0.25, 2, 0.059929668},
                 {3, 0.45, 1, 0.013978454}, {5, 0.45, 2, 0.050963616}, {10, 0.45, 2, 0.074101464}};
    palp_indentation in = {.tip = PALP_TIP_SPHERE,
                           .radius_m = CASES[_i].radius / 24,
                           .thickness_m = 1,
                           .poisson = CASES[_i].poisson,
                           .large_strain = true,
                           .specimen_radius_m = sqrt(1 / 3.14159265358979323846)};
    near_to(force(in, CASES[_i].depth / 24), CASES[_i].wanted, 0.012);
    palp_indentation wide = in;
    wide.specimen_radius_m = 0;
    ck_assert_double_gt(force(wide, CASES[_i].depth / 24), 1.04 * force(in, CASES[_i].depth / 24));
    in.specimen_radius_m = 0.1; /* narrower than the tables' punches */
    double f, d = 0.01;
    ck_assert_int_eq(palp_indentation_force(&in, 1, &d, &f), PALP_ERR_LIMIT);
}
END_TEST

/* At small strain: CalculiX with 8 and with 16 elements in the contact, 0.134832 and 0.135476, is on its way
 * here. */
START_TEST(a_sphere_at_small_strain_is_that_of_finite_elements) {
    palp_indentation in = {.tip = PALP_TIP_SPHERE, .radius_m = 1, .thickness_m = 1, .poisson = 0.49};
    near_to(force(in, 0.07), 2 * 0.135476 - 0.134832, 0.003);
}
END_TEST

START_TEST(bad_numbers_are_refused) {
    double d = 1e-4, f, a;
    palp_indentation bad[] = {
        of(PALP_TIP_FLAT, 0, 0.3),       of(PALP_TIP_FLAT, NAN, 0.3),  of(PALP_TIP_PLATE, INFINITY, 0.3),
        of(PALP_TIP_FLAT, 0.01, 0.51),   of(PALP_TIP_FLAT, 0.01, NAN), of(PALP_TIP_FLAT, 0.01, -1),
        of((palp_tip_kind)9, 0.01, 0.3), of(PALP_TIP_CONE, 0.01, 0.3), of(PALP_TIP_SPHERE, 0.01, 0.3)};
    bad[7].half_angle_rad = 1.6;
    bad[8].radius_m = 0;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ck_assert_int_eq(palp_indentation_force(&bad[i], 1, &d, &f), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_indentation_contact(&bad[i], d, &a), PALP_ERR_ARGUMENT);
    }
    palp_indentation fine = of(PALP_TIP_SPHERE, 0.01, 0.3), wide = of(PALP_TIP_FLAT, 1e-4, 0.5);
    d = NAN;
    ck_assert_int_eq(palp_indentation_force(&fine, 1, &d, &f), PALP_ERR_ARGUMENT);
    d = 1e-6;
    ck_assert_int_eq(palp_indentation_force(&wide, 1, &d, &f), PALP_ERR_LIMIT);
}
END_TEST

START_TEST(a_tip_has_a_name) {
    palp_tip_kind kind = PALP_TIP_PLATE;
    for (int i = PALP_TIP_PLATE; i <= PALP_TIP_CONE; i++) {
        ck_assert(palp_tip_find(palp_tip_name((palp_tip_kind)i), &kind));
        ck_assert_int_eq(kind, i);
    }
    ck_assert(!palp_tip_find("needle", &kind));
    ck_assert_ptr_null(palp_tip_name((palp_tip_kind)4));
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_half_space_has_its_closed_forms, 0, 6);
    tcase_add_loop_test(tc, the_flat_punch_has_the_published_factors, 0, 10);
    tcase_add_test(tc, a_thin_layer_is_compressed_without_spreading);
    tcase_add_loop_test(tc, scale_and_order_change_nothing, 0, 4);
    tcase_add_loop_test(tc, the_slope_is_that_of_a_punch_as_wide_as_the_contact, 0, 2);
    tcase_add_test(tc, the_tables_meet_what_is_known);
    tcase_add_loop_test(tc, a_deep_sphere_is_that_of_finite_elements, 0, 3);
    tcase_add_loop_test(tc, a_sphere_on_a_narrow_specimen_is_that_of_finite_elements, 0, 6);
    tcase_add_test(tc, a_sphere_at_small_strain_is_that_of_finite_elements);
    tcase_add_test(tc, bad_numbers_are_refused);
    tcase_add_test(tc, a_tip_has_a_name);
}
