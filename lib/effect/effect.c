/* effect.c: the catalogue of effects: one table, and what can be asked of it. */
#include "effect_internal.h"
#include "base/file.h"

#include <math.h>
#include <string.h>

#define TURN 6.28318530717958647692

/* clang-format off */
/* A parameter: key, SI per file unit, low, high and typical in SI. SHAPE: searched in its logarithm. */
#define STRENGTH(key, unit, low, high, typical) {key, unit, low, high, typical, false, true}
#define SHAPE(key, unit, low, high, typical) {key, unit, low, high, typical, true, false}
#define PLAIN(key, unit, low, high, typical) {key, unit, low, high, typical, false, false}

/* Look-alikes; who carries it. */
#define LIKE(...) {__VA_ARGS__, PALP_EFFECT_COUNT}
#define BOTH true, true
#define NETWORK false, true

static const effect_row TABLE[PALP_EFFECT_COUNT] = {
    [PALP_EFFECT_RELAXATION_ARM] = {
        .info = {
            "relaxation_arm", PALP_EFFECT_MATERIAL, "another relaxation time",
            "holds as long as the time, ramps as short",
            2, {STRENGTH("stiffness_N", 1, 0, 1e5, 1),
                SHAPE("time_s", 1, 1e-4, 1e6, 10)},
            LIKE(PALP_EFFECT_POWER_LAW_RELAXATION, PALP_EFFECT_POROELASTIC, PALP_EFFECT_SENSOR_DRIFT),
            BOTH, true}},
    [PALP_EFFECT_POWER_LAW_RELAXATION] = {
        .info = {
            "power_law_relaxation", PALP_EFFECT_MATERIAL, "power-law relaxation (springpot)",
            "holds and ramps over several decades of time",
            2, {STRENGTH("stiffness_N", 1, 0, 1e5, 1), PLAIN("exponent", 1, 0.02, 0.9, 0.2)},
            LIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POROELASTIC), BOTH, false},
        .spectrum = effect_power_law},
    [PALP_EFFECT_STRAIN_DEPENDENT_ARM] = {
        .info = {
            "strain_dependent_arm", PALP_EFFECT_MATERIAL, "strain-dependent arms",
            "holds at several depths",
            2, {STRENGTH("stiffness_per_strain", 1, -0.95, 100, 1),
                STRENGTH("time_per_strain", 1, -0.95, 100, 1)},
            LIKE(PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_RATE_STIFFENING), BOTH, false}},
    [PALP_EFFECT_RATE_STIFFENING] = {
        .info = {
            "rate_stiffening", PALP_EFFECT_MATERIAL, "rate stiffening",
            "ramps at several rates, one in a decade",
            1, {STRENGTH("per_decade", 1, 0, 2, 0.05)},
            LIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION, PALP_EFFECT_COULOMB_FRICTION),
            BOTH, false}},
    [PALP_EFFECT_DAMAGE_SOFTENING] = {
        .info = {
            "damage_softening", PALP_EFFECT_MATERIAL, "damage softening (Mullins)",
            "unloading, and loading again",
            2, {STRENGTH("softening", 1, 0, 0.9, 0.2), SHAPE("sharpness", 1, 0.02, 20, 0.5)},
            LIKE(PALP_EFFECT_PERMANENT_SET, PALP_EFFECT_COULOMB_FRICTION), BOTH, false}},
    [PALP_EFFECT_PERMANENT_SET] = {
        .info = {
            "permanent_set", PALP_EFFECT_MATERIAL, "permanent set",
            "unloading to contact, and loading again",
            1, {STRENGTH("fraction", 1, 0, 0.8, 0.1)},
            LIKE(PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_CONTACT_OFFSET), BOTH, false}},
    [PALP_EFFECT_POROELASTIC] = {
        .info = {
            "poroelastic", PALP_EFFECT_MATERIAL, "poroelastic consolidation",
            "holds as long as the time, ramps a hundredth of it",
            2, {STRENGTH("stiffness_N", 1, 0, 1e5, 1), SHAPE("time_s", 1, 1e-3, 1e6, 10)},
            LIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION), BOTH, false},
        .spectrum = effect_consolidation},
    [PALP_EFFECT_CONTACT_OFFSET] = {
        .info = {
            "contact_offset", PALP_EFFECT_CONTACT, "contact offset",
            "free air before contact",
            1, {STRENGTH("offset_mm", 1e-3, -0.02, 0.02, 1e-4)},
            LIKE(PALP_EFFECT_SENSOR_BIAS, PALP_EFFECT_TOE_REGION), BOTH, false},
        .stage = 1, .map = effect_contact_offset},
    [PALP_EFFECT_TOE_REGION] = {
        .info = {
            "toe_region", PALP_EFFECT_CONTACT, "toe region of an uneven surface",
            "a slow ramp through contact",
            1, {STRENGTH("length_mm", 1e-3, 0, 0.02, 2e-4)},
            LIKE(PALP_EFFECT_CONTACT_OFFSET), BOTH, false},
        .stage = 3, .map = effect_toe_region},
    [PALP_EFFECT_ADHESION] = {
        .info = {
            "adhesion", PALP_EFFECT_CONTACT, "adhesion",
            "withdrawal past contact",
            1, {STRENGTH("force_N", 1, 0, 1e3, 0.05)},
            LIKE(PALP_EFFECT_SENSOR_BIAS), BOTH, false}},
    [PALP_EFFECT_PLATE_SLIP] = {
        .info = {
            "plate_slip", PALP_EFFECT_CONTACT, "slip at the plates",
            "a network whose shape is known; plates dry and greased",
            1, {STRENGTH("slip", 1, 0, 1, 0.5)},
            LIKE(PALP_EFFECT_SENSOR_GAIN, PALP_EFFECT_FRAME_COMPLIANCE), NETWORK, false}},
    [PALP_EFFECT_SESSION_AGEING] = {
        .info = {
            "session_ageing", PALP_EFFECT_CONTACT, "ageing in the session",
            "the first test again at the end",
            1, {STRENGTH("per_hour", 1.0 / 3600, -1.0 / 3600, 1.0 / 3600, 0.05 / 3600)},
            LIKE(PALP_EFFECT_SENSOR_GAIN, PALP_EFFECT_DAMAGE_SOFTENING), BOTH, false}},
    [PALP_EFFECT_FRAME_COMPLIANCE] = {
        .info = {
            "frame_compliance", PALP_EFFECT_INSTRUMENT, "frame compliance",
            "a rigid block, or specimens of two heights",
            1, {STRENGTH("compliance_mm_N", 1e-3, 0, 0.01, 1e-5)},
            LIKE(PALP_EFFECT_STRAIN_DEPENDENT_ARM, PALP_EFFECT_SENSOR_GAIN), BOTH, false},
        .stage = 2, .map = effect_frame_compliance},
    [PALP_EFFECT_PLATE_INERTIA] = {
        .info = {
            "plate_inertia", PALP_EFFECT_INSTRUMENT, "inertia of the plate",
            "fast starts and stops, in air too",
            1, {STRENGTH("mass_kg", 1, 0, 100, 0.1)},
            LIKE(PALP_EFFECT_SENSOR_LAG), BOTH, false},
        .stage = 3, .sensor = effect_plate_inertia},
    [PALP_EFFECT_COULOMB_FRICTION] = {
        .info = {
            "coulomb_friction", PALP_EFFECT_INSTRUMENT, "Coulomb friction",
            "both directions, in air too",
            1, {STRENGTH("force_N", 1, 0, 1e3, 0.05)},
            LIKE(PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_RATE_STIFFENING), BOTH, false},
        .stage = 2, .sensor = effect_coulomb_friction},
    [PALP_EFFECT_SENSOR_LAG] = {
        .info = {
            "sensor_lag", PALP_EFFECT_INSTRUMENT, "lag of the sensor",
            "fast ramps in both directions, and their ends",
            1, {STRENGTH("time_s", 1, 0, 100, 0.01)},
            LIKE(PALP_EFFECT_PLATE_INERTIA, PALP_EFFECT_RELAXATION_ARM), BOTH, false},
        .stage = 5, .sensor = effect_sensor_lag},
    [PALP_EFFECT_SENSOR_BIAS] = {
        .info = {
            "sensor_bias", PALP_EFFECT_INSTRUMENT, "bias of the sensor",
            "free air",
            1, {STRENGTH("force_N", 1, -1e3, 1e3, 0.05)},
            LIKE(PALP_EFFECT_CONTACT_OFFSET), BOTH, false},
        .stage = 6, .sensor = effect_sensor_bias},
    [PALP_EFFECT_SENSOR_DRIFT] = {
        .info = {
            "sensor_drift", PALP_EFFECT_INSTRUMENT, "drift of the sensor",
            "free air before and after a long test",
            1, {STRENGTH("force_N_s", 1, -10, 10, 1e-3)},
            LIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION), BOTH, false},
        .stage = 7, .sensor = effect_sensor_drift},
    [PALP_EFFECT_SENSOR_GAIN] = {
        .info = {
            "sensor_gain", PALP_EFFECT_INSTRUMENT, "gain of the sensor",
            "a known weight on the sensor",
            1, {STRENGTH("gain", 1, -0.9, 10, 0.05)},
            LIKE(PALP_EFFECT_SESSION_AGEING, PALP_EFFECT_FRAME_COMPLIANCE), BOTH, false},
        .stage = 1, .sensor = effect_sensor_gain},
    [PALP_EFFECT_FORCE_SATURATION] = {
        .info = {
            "force_saturation", PALP_EFFECT_INSTRUMENT, "saturation of the sensor",
            "forces up to the sensor's end",
            1, {STRENGTH("force_N", 1, 0, 1e6, 10)},
            LIKE(PALP_EFFECT_FRAME_COMPLIANCE), BOTH, false},
        .stage = 9, .sensor = effect_force_saturation},
    [PALP_EFFECT_MAINS_HUM] = {
        .info = {
            "mains_hum", PALP_EFFECT_INSTRUMENT, "mains hum",
            "a sample rate well above twice the mains'",
            2, {STRENGTH("amplitude_N", 1, 0, 1e3, 0.01), PLAIN("frequency_Hz", 1, 40, 70, 50)},
            LIKE(PALP_EFFECT_DRIVE_RIPPLE), BOTH, false},
        .stage = 8, .sensor = effect_mains_hum},
    [PALP_EFFECT_DRIVE_RIPPLE] = {
        .info = {
            "drive_ripple", PALP_EFFECT_INSTRUMENT, "ripple of the drive, periodic in position",
            "slow motion over several periods, in air too",
            3, {STRENGTH("amplitude_N", 1, 0, 1e3, 0.02),
                SHAPE("period_mm", 1e-3, 1e-6, 0.1, 1e-3),
                PLAIN("phase_rad", 1, -TURN, TURN, 0)},
            LIKE(PALP_EFFECT_MAINS_HUM), BOTH, false},
        .stage = 4, .sensor = effect_drive_ripple},
};
/* clang-format on */

const effect_row *effect_row_of(palp_effect_id id) {
    return (unsigned)id < PALP_EFFECT_COUNT ? &TABLE[id] : NULL;
}

const palp_effect_info *palp_effect_look_up(palp_effect_id id) {
    const effect_row *row = effect_row_of(id);
    return row ? &row->info : NULL;
}

palp_status palp_effect_by_name(const char *id, palp_effect_id *found) {
    for (int i = 0; i < PALP_EFFECT_COUNT; i++)
        if (strcmp(TABLE[i].info.id, id) == 0) {
            *found = (palp_effect_id)i;
            return PALP_OK;
        }
    return PALP_ERR_ARGUMENT;
}

palp_status palp_effect_default(palp_effect_id id, palp_effect *effect) {
    const effect_row *row = effect_row_of(id);
    if (!row)
        return PALP_ERR_ARGUMENT;
    *effect = (palp_effect){.id = id};
    for (size_t k = 0; k < row->info.n_parameters; k++)
        effect->value[k] = row->info.parameter[k].strength ? 0.0 : row->info.parameter[k].typical;
    return PALP_OK;
}

palp_status palp_effect_check(const palp_effect *effect, palp_error *error) {
    const effect_row *row = effect_row_of(effect->id);
    if (!row)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no effect has the number %d", (int)effect->id);
    for (size_t k = 0; k < row->info.n_parameters; k++) {
        const palp_effect_parameter *p = &row->info.parameter[k];
        if (!(effect->value[k] >= p->low && effect->value[k] <= p->high))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "%s: %s must be between %.6g and %.6g, not %.6g",
                                  row->info.id, p->key, p->low / p->unit, p->high / p->unit,
                                  effect->value[k] / p->unit);
    }
    return PALP_OK;
}

static palp_status check_one(const palp_model *model, size_t i, palp_error *error) {
    const palp_effect *effect = &model->effects[i];
    palp_status status = palp_effect_check(effect, error);
    if (status)
        return status;
    const palp_effect_info *info = &TABLE[effect->id].info;
    bool network = model->kind == PALP_MODEL_NETWORK;
    if (!(network ? info->in_network : info->in_lumped))
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "%s is no effect of a %s", info->id,
                              network ? "network" : "lumped model");
    for (size_t j = 0; j < i && !info->repeats; j++)
        if (model->effects[j].id == effect->id)
            return palp_error_set(error, PALP_ERR_ARGUMENT, "%s is there twice", info->id);
    return PALP_OK;
}

palp_status effect_list_check(const palp_model *model, palp_error *error) {
    palp_status status = PALP_OK;
    if (model->n_effects > PALP_EFFECTS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu effects, at most %d", model->n_effects,
                              PALP_EFFECTS_MAX);
    if (model->n_effects > 0 && model->material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "formulation sedef2008 takes no effects; use history");
    for (size_t i = 0; i < model->n_effects && !status; i++)
        status = check_one(model, i, error);
    return status;
}

bool effect_is_off(const palp_effect *effect) {
    const effect_row *row = effect_row_of(effect->id);
    for (size_t k = 0; k < row->info.n_parameters; k++)
        if (row->info.parameter[k].strength && effect->value[k] != 0.0)
            return false;
    return true;
}
