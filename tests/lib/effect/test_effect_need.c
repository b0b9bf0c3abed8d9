/* test_effect_need.c: conditions on recordings for each effect: the message has the missing quantity, and
 * just enough is accepted. */
#include "effect/effect_internal.h"

#include <check.h>
#include <math.h>
#include <string.h>

static double column_change; /* of any column */

static double change_of(const effect_data *data, const char *column) {
    (void)data;
    return strcmp(column, "temperature_C") == 0 ? column_change : 0.0;
}

/* Runs that hold all that any effect asks for, but a weight. */
static effect_data rich(void) {
    column_change = 2;
    return (effect_data){.duration = 100,
                         .step = 0.005,
                         .deepest = 5e-3,
                         .fastest = 1e-2,
                         .peak = 10,
                         .white = 1e-3,
                         .height = 0.02,
                         .pulled = 0.1,
                         .shown = {.speeds = 3, .back = 1, .depths = 2, .rate = 200, .stride = 1e-5},
                         .change_of = change_of};
}

/* Changes that leave too little, with the word and number that tell it, or just enough: no words. */
static void one_speed(effect_data *d) {
    d->shown.speeds = 1.2, d->shown.back = 0.01;
}
static void two_speeds(effect_data *d) {
    d->shown.speeds = 1.6, d->shown.back = 0;
}
static void turned(effect_data *d) {
    d->shown.speeds = 1, d->shown.back = 0.12;
}
static void no_way_back(effect_data *d) {
    d->shown.back = 0.004;
}
static void no_way_back_again(effect_data *d) {
    d->shown.back = 0.004, d->shown.again = true;
}
static void a_way_back(effect_data *d) {
    d->shown.back = 0.2;
}
static void one_depth(effect_data *d) {
    d->shown.depths = 1.03, d->shown.back = 0;
}
static void two_depths(effect_data *d) {
    d->shown.depths = 1.3, d->shown.back = 0;
}
static void one_depth_and_back(effect_data *d) {
    d->shown.depths = 1;
}
static void slow_samples(effect_data *d) {
    d->shown.rate = 90;
}
static void just_fast(effect_data *d) {
    d->shown.rate = 94;
}
static void two_periods(effect_data *d) {
    d->duration = 0.06;
}
static void three_periods(effect_data *d) {
    d->duration = 0.076;
}
static void coarse(effect_data *d) {
    d->shown.stride = 1e-3;
}
static void just_fine(effect_data *d) {
    d->shown.stride = 0.8e-3;
}
static void no_withdrawal(effect_data *d) {
    d->pulled = 0;
}
static void a_release(effect_data *d) {
    d->pulled = 0, d->n_releases = 1;
}
static void one_temperature(effect_data *d) {
    (void)d, column_change = 0;
}
static void all(effect_data *d) {
    (void)d;
}

static const struct {
    palp_effect_id id;
    void (*change)(effect_data *d);
    const char *lack; /* NULL: it is enough */
    /* clang-format off */
} cases[] = {
    {PALP_EFFECT_RELAXATION_ARM, one_speed, "1.2 times"}, {PALP_EFFECT_RELAXATION_ARM, two_speeds, NULL},
    {PALP_EFFECT_RELAXATION_ARM, turned, NULL},
    {PALP_EFFECT_POWER_LAW_RELAXATION, one_speed, "1.2 times"},
    {PALP_EFFECT_POROELASTIC, one_speed, "1.2 times"},
    {PALP_EFFECT_RATE_STIFFENING, one_speed, "1.2 times"},
    {PALP_EFFECT_PLATE_INERTIA, one_speed, "fast starts and stops"},
    {PALP_EFFECT_SENSOR_LAG, one_speed, "fast ramps in both"}, {PALP_EFFECT_SENSOR_LAG, turned, NULL},
    {PALP_EFFECT_SENSOR_DRIFT, one_speed, "1.2 times"},
    {PALP_EFFECT_COULOMB_FRICTION, no_way_back, "0.4 % of the depth"},
    {PALP_EFFECT_COULOMB_FRICTION, a_way_back, NULL},
    {PALP_EFFECT_COULOMB_FRICTION, no_way_back_again, "0.4 % of the depth"},
    {PALP_EFFECT_DAMAGE_SOFTENING, no_way_back, "by 10 % at least"},
    {PALP_EFFECT_DAMAGE_SOFTENING, no_way_back_again, NULL},
    {PALP_EFFECT_PERMANENT_SET, no_way_back, "by 10 % at least"},
    {PALP_EFFECT_PERMANENT_SET, a_way_back, NULL},
    {PALP_EFFECT_STRAIN_DEPENDENT_ARM, one_depth, "1.03 times"},
    {PALP_EFFECT_STRAIN_DEPENDENT_ARM, two_depths, NULL},
    {PALP_EFFECT_STRAIN_DEPENDENT_ARM, one_depth_and_back, NULL},
    {PALP_EFFECT_MAINS_HUM, slow_samples, "90 samples a second, but 93.3"},
    {PALP_EFFECT_MAINS_HUM, just_fast, NULL},
    {PALP_EFFECT_MAINS_HUM, two_periods, "2.4 periods of 40 Hz, but needs 3"},
    {PALP_EFFECT_MAINS_HUM, three_periods, NULL}, {PALP_EFFECT_DRIVE_RIPPLE, coarse, "2.5 periods"},
    {PALP_EFFECT_DRIVE_RIPPLE, just_fine, NULL},
    {PALP_EFFECT_ADHESION, no_withdrawal, "in no run the plate withdraws"},
    {PALP_EFFECT_ADHESION, a_release, NULL},
    {PALP_EFFECT_THERMAL_EXPANSION, one_temperature, "temperature_C"},
    {PALP_EFFECT_THERMAL_EXPANSION, all, NULL},
    {PALP_EFFECT_SENSOR_GAIN, all, "an unknown stiffness; needed: a known weight"},
    {PALP_EFFECT_SENSOR_BIAS, one_speed, NULL}};
/* clang-format on */

START_TEST(too_little_is_told_with_its_number) {
    char lack[EFFECT_LACK_MAX] = "";
    effect_data data = rich();
    cases[_i].change(&data);
    const bool met = effect_need_met(effect_row_of(cases[_i].id), &data, lack);
    ck_assert_msg(met == !cases[_i].lack, "%s: %s", palp_effect_look_up(cases[_i].id)->id, lack);
    ck_assert_msg(met || strstr(lack, cases[_i].lack), "%s: %s", palp_effect_look_up(cases[_i].id)->id, lack);
    ck_assert_uint_lt(strlen(lack), EFFECT_LACK_MAX - 1); /* a whole sentence */
}
END_TEST

START_TEST(rich_runs_lack_nothing) {
    const effect_data data = rich();
    char lack[EFFECT_LACK_MAX];
    for (int id = 0; id < PALP_EFFECT_COUNT; id++)
        ck_assert_msg(effect_need_met(effect_row_of((palp_effect_id)id), &data, lack) ||
                          id == PALP_EFFECT_SENSOR_GAIN,
                      "%s", palp_effect_look_up((palp_effect_id)id)->id);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, too_little_is_told_with_its_number, 0, sizeof cases / sizeof *cases);
    tcase_add_test(tc, rich_runs_lack_nothing);
}
