/* plant_actuator.c: the simulated motor and carriage, their figures and the file that holds them. */
#include "plant_internal.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static const double STOP_M = 1e-3;   /* the hard stops are so far beyond the travel */
static const double DRAG_M_S = 0.2;  /* how fast PLANT_PUSHED drags the carriage, */
static const double BEYOND_M = 5e-4; /* and how far beyond its travel */

plant_actuator plant_actuator_default(void) {
    return (plant_actuator){.force_constant_N_A = 12,
                            .resistance_ohm = 4,
                            .supply_V = 24,
                            .current_A = 3.5,
                            .moving_kg = 0.4,
                            .viscous_Ns_m = 4,
                            .coulomb_N = 0.15,
                            .travel_m = 0.03,
                            .count_m = 1e-6,
                            .start_m = 5e-3,
                            .winding_K_W = 2.5,
                            .winding_J_K = 40,
                            .case_K_W = 3,
                            .case_J_K = 400,
                            .ambient_C = 23};
}

typedef enum key_sign { POSITIVE, NOT_NEGATIVE, ANY_SIGN } key_sign;

/* X(key in the file, member, units of the file in an SI unit, sign) */
#define ACTUATOR_KEYS(X)                                                                                     \
    X("force_constant_N_A", force_constant_N_A, 1, POSITIVE)                                                 \
    X("resistance_ohm", resistance_ohm, 1, POSITIVE)                                                         \
    X("supply_V", supply_V, 1, POSITIVE)                                                                     \
    X("current_A", current_A, 1, POSITIVE)                                                                   \
    X("moving_kg", moving_kg, 1, POSITIVE)                                                                   \
    X("viscous_Ns_m", viscous_Ns_m, 1, NOT_NEGATIVE)                                                         \
    X("coulomb_N", coulomb_N, 1, NOT_NEGATIVE)                                                               \
    X("lift_N", lift_N, 1, ANY_SIGN)                                                                         \
    X("backlash_mm", backlash_m, 1e3, NOT_NEGATIVE)                                                          \
    X("travel_mm", travel_m, 1e3, POSITIVE)                                                                  \
    X("count_mm", count_m, 1e3, POSITIVE)                                                                    \
    X("start_mm", start_m, 1e3, NOT_NEGATIVE)                                                                \
    X("compliance_mm_N", compliance_m_N, 1e3, NOT_NEGATIVE)                                                  \
    X("winding_K_W", winding_K_W, 1, POSITIVE)                                                               \
    X("winding_J_K", winding_J_K, 1, POSITIVE)                                                               \
    X("case_K_W", case_K_W, 1, POSITIVE)                                                                     \
    X("case_J_K", case_J_K, 1, POSITIVE)                                                                     \
    X("ambient_C", ambient_C, 1, NOT_NEGATIVE)

typedef struct actuator_file {
    const char *path;
    json_t *root;
    palp_error *error;
} actuator_file;

/* The first line with this key; 1 where none is found. */
static int key_line(const char *path, const char *key) {
    char text[512], quoted[64];
    int line = 0, found = 0;
    FILE *file = fopen(path, "r");
    snprintf(quoted, sizeof quoted, "\"%s\"", key);
    while (file && !found && fgets(text, sizeof text, file)) {
        line++;
        found = strstr(text, quoted) ? line : 0;
    }
    if (file)
        fclose(file);
    return found ? found : 1;
}

static palp_status bad_key(const actuator_file *f, const char *key, const char *why) {
    return plant_fail(f->error, PALP_ERR_INPUT, "%s:%d: %s %s", f->path, key_line(f->path, key), key, why);
}

static palp_status read_number(const actuator_file *f, const char *key, double unit, key_sign sign,
                               double *value) {
    static const char *const must[] = {"must be a positive number", "must be a number, 0 or more",
                                       "must be a number"};
    const json_t *found = json_object_get(f->root, key);
    if (!found)
        return PALP_OK;
    double x = json_number_value(found);
    if (!json_is_number(found) || (x < 0 && sign != ANY_SIGN) || (x == 0 && sign == POSITIVE))
        return bad_key(f, key, must[sign]);
    *value = x / unit;
    return PALP_OK;
}

static palp_status check_keys(const actuator_file *f) {
    static const char *const known[] = {
#define ACTUATOR_KEY(key, member, unit, sign) key,
        ACTUATOR_KEYS(ACTUATOR_KEY)
#undef ACTUATOR_KEY
            "palpate",
        "about"};
    const char *key;
    json_t *value;
    if (!json_is_integer(json_object_get(json_object_get(f->root, "palpate"), "actuator")))
        return plant_fail(f->error, PALP_ERR_INPUT,
                          "%s:1: is no actuator: it lacks \"palpate\": {\"actuator\": 1}", f->path);
    json_object_foreach(f->root, key, value) {
        size_t i = 0, n = sizeof known / sizeof known[0];
        while (i < n && strcmp(known[i], key) != 0)
            i++;
        if (i == n)
            return bad_key(f, key, "is not a key of an actuator; see data/rig/README.md");
    }
    return PALP_OK;
}

static palp_status take(const actuator_file *f, plant_actuator *a) {
    palp_status status = check_keys(f);
#define ACTUATOR_KEY(key, member, unit, sign)                                                                \
    status = status ? status : read_number(f, key, unit, sign, &a->member);
    ACTUATOR_KEYS(ACTUATOR_KEY)
#undef ACTUATOR_KEY
    if (status == PALP_OK && a->start_m > a->travel_m)
        return bad_key(f, "start_mm", "is beyond the travel");
    return status;
}

palp_status plant_actuator_read(const char *path, plant_actuator *actuator, palp_error *error) {
    json_error_t where;
    actuator_file f = {path, json_load_file(path, JSON_REJECT_DUPLICATES, &where), error};
    if (!f.root && json_error_code(&where) == json_error_cannot_open_file)
        return plant_fail(error, PALP_ERR_FILE, "%s: cannot be read", path);
    if (!f.root)
        return plant_fail(error, PALP_ERR_INPUT, "%s:%d: %s", path, where.line, where.text);
    plant_actuator read = *actuator;
    palp_status status = take(&f, &read);
    json_decref(f.root);
    if (status == PALP_OK)
        *actuator = read;
    return status;
}

drive drive_start(const plant_actuator *a) {
    return (drive){.carriage_m = a->start_m, .winding_C = a->ambient_C, .case_C = a->ambient_C};
}

static double limited(double x, double most) {
    return fmin(fmax(x, -most), most);
}

/* The carriage's driving force, friction included, is force_N - drag_Ns_m * velocity. */
typedef struct push {
    double force_N, drag_Ns_m;
} push;

/* Beyond the driver's limit the current no longer falls with speed: no drag by back-EMF. */
static push motor_push(const plant_actuator *a, const drive *d, bool on, double volt) {
    const double k = a->force_constant_N_A, r = a->resistance_ohm;
    double current = on ? (volt - k * d->velocity_m_s) / r : 0;
    if (!on || fabs(current) >= a->current_A)
        return (push){k * limited(current, a->current_A), a->viscous_Ns_m};
    return (push){k * volt / r, a->viscous_Ns_m + k * k / r};
}

/* Friction stops the carriage exactly where its velocity would cross zero. Only a force above the friction
 * moves it again. */
static double next_velocity(const plant_actuator *a, double v, push f, double dt) {
    double friction = v > 0 || (v == 0 && f.force_N > 0) ? a->coulomb_N : -a->coulomb_N;
    if (v == 0 && fabs(f.force_N) <= a->coulomb_N)
        return 0;
    double half = 0.5 * f.drag_Ns_m * dt / a->moving_kg;
    double next = (v * (1 - half) + (f.force_N - friction) * dt / a->moving_kg) / (1 + half);
    return v * next < 0 ? 0 : next;
}

static void move(const plant_actuator *a, drive *d, double dt) {
    d->carriage_m += d->velocity_m_s * dt;
    if (d->carriage_m > a->travel_m + STOP_M || d->carriage_m < -STOP_M) {
        d->carriage_m = d->carriage_m > 0 ? a->travel_m + STOP_M : -STOP_M;
        d->velocity_m_s = 0;
    }
}

/* Two nodes: the winding over the case, the case over the air. */
static void heat(const plant_actuator *a, drive *d, double dt) {
    double power = d->current_A * d->current_A * a->resistance_ohm;
    double out = (d->winding_C - d->case_C) / a->winding_K_W, lost = (d->case_C - a->ambient_C) / a->case_K_W;
    d->winding_C += dt * (power - out) / a->winding_J_K;
    d->case_C += dt * (out - lost) / a->case_J_K;
}

void drive_step(const plant_actuator *a, drive *d, double speed_m_s, double dt_s) {
    d->velocity_m_s = d->hold == DRIVE_FREE ? speed_m_s : 0;
    move(a, d, dt_s);
}

void drive_advance(const plant_actuator *a, drive *d, uint8_t motor, double volt, double load_N,
                   double dt_s) {
    const bool on = motor != PLANT_MOTOR_OFF;
    double before = d->velocity_m_s;
    volt = motor == PLANT_MOTOR_ON ? volt : 0;
    push f = motor_push(a, d, on, volt);
    f.force_N -= load_N + a->lift_N;
    d->velocity_m_s = d->hold == DRIVE_FREE ? next_velocity(a, before, f, dt_s) : 0;
    if (d->hold == DRIVE_DRAGGED && d->carriage_m < a->travel_m + BEYOND_M)
        d->velocity_m_s = DRAG_M_S;
    move(a, d, dt_s);
    double speed = 0.5 * (before + d->velocity_m_s);
    d->current_A = on ? limited((volt - a->force_constant_N_A * speed) / a->resistance_ohm, a->current_A) : 0;
    heat(a, d, dt_s);
}
