/* acquire_read.c: protocol files. */
#include "acquire.h"

#include <math.h>
#include <string.h>

enum { WHERE = 128 };

static bool fits(const char *name, double x, bool zero, double most) {
    bool whole = strcmp(name, "cycles") != 0 || x == floor(x);
    return whole && (zero ? x >= 0 : x > 0) && x <= most;
}

/* Reads one key of an object into the motion; *known = whether it is a parameter. Returns an exit code. */
static int take_figure(const acquire_json *j, const char *where, const char *key, const json_t *value,
                       acquire_motion *m, bool *known) {
    *known = true;
#define ACQUIRE_READ(name, mask, zero, most)                                                                 \
    if (strcmp(key, #name) == 0) {                                                                           \
        double x = json_number_value(value);                                                                 \
        if (!json_is_number(value) || !fits(#name, x, zero, most)) {                                         \
            return acquire_json_fail(j, where, "must be a %snumber %s 0 and at most %g",                     \
                                     #name[0] == 'c' ? "whole " : "", (zero) ? "from" : "above",             \
                                     (double)(most));                                                        \
        }                                                                                                    \
        m->name = x;                                                                                         \
        return CLI_OK;                                                                                       \
    }
    ACQUIRE_FIGURES(ACQUIRE_READ)
#undef ACQUIRE_READ
    *known = false;
    return CLI_OK;
}

static bool kind_has(acquire_kind kind, const char *key) {
#define ACQUIRE_HAS(name, mask, zero, most)                                                                  \
    if (strcmp(key, #name) == 0) {                                                                           \
        return ((mask) >> kind & 1) != 0;                                                                    \
    }
    ACQUIRE_FIGURES(ACQUIRE_HAS)
#undef ACQUIRE_HAS
    return true;
}

/* Key of each segment and its required parameters. */
static const struct {
    const char *key;
    uint8_t kind;
    const char *needs[3];
} forms[] = {{"move_to_mm", PALP_WIRE_SEGMENT_MOVE, {"rate_mm_s"}},
             {"hold_s", PALP_WIRE_SEGMENT_HOLD, {NULL}},
             {"cycle_to_mm", PALP_WIRE_SEGMENT_CYCLE, {"rate_mm_s", "cycles"}},
             {"sine_mm", PALP_WIRE_SEGMENT_SINE, {"frequency_Hz", "cycles"}},
             {"sweep_mm", PALP_WIRE_SEGMENT_SWEEP, {"frequency_Hz", "frequency_end_Hz", "duration_s"}},
             {"force_N", PALP_WIRE_SEGMENT_FORCE, {"ramp_s", "duration_s"}}};

enum { FORMS = sizeof forms / sizeof forms[0] };

static size_t form_of(const json_t *object) {
    size_t i = 0;
    while (i < FORMS && !json_object_get(object, forms[i].key))
        i++;
    return i;
}

static bool needed(size_t form, const char *key) {
    for (size_t i = 0; i < 3; i++)
        if (forms[form].needs[i] && strcmp(forms[form].needs[i], key) == 0)
            return true;
    return strcmp(key, "acceleration_mm_s2") == 0 || strcmp(key, forms[form].key) == 0 ||
           (strcmp(key, "deepest_mm") == 0 && forms[form].kind == PALP_WIRE_SEGMENT_FORCE);
}

static int read_segment_keys(const acquire_json *j, const char *where, const json_t *object, size_t form,
                             acquire_motion *m) {
    const char *key;
    json_t *value;
    char at[WHERE + 32];
    json_object_foreach((json_t *)object, key, value) {
        bool known;
        snprintf(at, sizeof at, "%s.%.24s", where, key);
        if (!needed(form, key))
            return acquire_json_fail(j, at, "does not go with %s", forms[form].key);
        int code = take_figure(j, at, key, value, m, &known);
        if (code)
            return code;
        if (!known && (!json_is_number(value) || fabs(json_number_value(value)) > 1000))
            return acquire_json_fail(j, at, "must be a number from -1000 to 1000");
    }
    for (size_t i = 0; i < 3 && forms[form].needs[i]; i++)
        if (!json_object_get(object, forms[form].needs[i]))
            return acquire_json_fail(j, where, "needs %s", forms[form].needs[i]);
    return CLI_OK;
}

static int read_segment(const acquire_json *j, const char *where, const json_t *object, acquire_run *r) {
    size_t form = form_of(object);
    acquire_motion m = acquire_motion_none();
    if (form == FORMS)
        return acquire_json_fail(j, where,
                                 "needs one of move_to_mm, hold_s, cycle_to_mm, sine_mm, sweep_mm, force_N");
    m.acceleration_mm_s2 = r->motion.acceleration_mm_s2;
    m.deepest_mm = r->motion.deepest_mm;
    int code = read_segment_keys(j, where, object, form, &m);
    if (code)
        return code;
    double target_mm = json_number_value(json_object_get(object, forms[form].key));
    target_mm = forms[form].kind == PALP_WIRE_SEGMENT_HOLD ? r->at_mm : target_mm;
    return acquire_segment_add(r, forms[form].kind, target_mm, &m)
               ? CLI_OK
               : acquire_json_fail(j, where, "is too many: a run has at most %d segments",
                                   PALP_WIRE_SEGMENTS);
}

static int read_segments(const acquire_json *j, const char *where, const json_t *list, acquire_run *r) {
    char at[WHERE];
    int code = CLI_OK;
    if (json_array_size(list) == 0)
        return acquire_json_fail(j, where, "needs \"segments\": [...]");
    for (size_t i = 0; code == CLI_OK && i < json_array_size(list); i++) {
        snprintf(at, sizeof at, "%s.segments[%zu]", where, i);
        code = read_segment(j, at, json_array_get(list, i), r);
    }
    return code;
}

static int read_kind(const acquire_json *j, const char *where, const json_t *object, acquire_kind *kind) {
    const char *text = json_string_value(json_object_get(object, "kind"));
    for (int k = 0; text && k < ACQUIRE_KINDS; k++) {
        if (strcmp(text, acquire_kind_name((acquire_kind)k)) == 0) {
            *kind = (acquire_kind)k;
            return CLI_OK;
        }
    }
    return acquire_json_fail(j, where,
                             "needs \"kind\": static, ramp_hold, cyclic, sine, sweep, segments or free");
}

/* Whether a text is valid in a file's name. */
static bool is_name(const char *text) {
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return text && *text && *text != '.' && strlen(text) < ACQUIRE_NAME - 16 && !text[strspn(text, allowed)];
}

static int read_run_keys(const acquire_json *j, const char *where, const json_t *object, acquire_kind kind,
                         acquire_motion *m) {
    const char *key;
    json_t *value;
    char at[WHERE];
    json_object_foreach((json_t *)object, key, value) {
        bool known;
        snprintf(at, sizeof at, "%s.%.24s", where, key);
        int code = take_figure(j, at, key, value, m, &known);
        if (code)
            return code;
        if (!kind_has(kind, key))
            return acquire_json_fail(j, at, "does not go with kind %s", acquire_kind_name(kind));
        if (strcmp(key, "name") == 0 && !is_name(json_string_value(value)))
            return acquire_json_fail(
                j, at, "must be a text of letters, digits, _ . and -, as it becomes a file's name");
        if (!known && strcmp(key, "kind") != 0 && strcmp(key, "name") != 0 && strcmp(key, "about") != 0 &&
            (strcmp(key, "segments") != 0 || kind != ACQUIRE_SEGMENTS)) {
            return acquire_json_fail(j, at, "is not a known key");
        }
    }
    bool twice = !isnan(m->rate_mm_s) && !isnan(m->ramp_s);
    return twice ? acquire_json_fail(j, where, "has rate_mm_s and ramp_s; give one of them") : CLI_OK;
}

static int read_run(const acquire_json *j, size_t i, const acquire_motion *options,
                    const acquire_motion *shared, acquire_plan *plan) {
    char where[WHERE / 2], why[ACQUIRE_TEXT];
    const json_t *object = json_array_get(json_object_get(j->root, "runs"), i);
    acquire_motion m = acquire_motion_none();
    acquire_kind kind = ACQUIRE_KINDS;
    snprintf(where, sizeof where, "runs[%zu]", i);
    int code = read_kind(j, where, object, &kind);
    code = code ? code : read_run_keys(j, where, object, kind, &m);
    if (code)
        return code;
    acquire_motion_inherit(kind, &m, options);
    acquire_motion_inherit(kind, &m, shared);
    acquire_run *r =
        acquire_plan_add(plan, kind, &m, json_string_value(json_object_get(object, "name")), why);
    if (!r)
        return acquire_json_fail(j, where, "%s", why);
    return kind == ACQUIRE_SEGMENTS ? read_segments(j, where, json_object_get(object, "segments"), r)
                                    : CLI_OK;
}

static int read_order(const acquire_json *j, const char *key, const json_t *value, acquire_plan *plan) {
    const char *text = json_string_value(value);
    if (strcmp(key, "order") == 0) {
        if (!text || (strcmp(text, "random") != 0 && strcmp(text, "given") != 0))
            return acquire_json_fail(j, key, "must be \"random\" or \"given\"");
        plan->random = plan->random < 0 ? strcmp(text, "random") == 0 : plan->random;
    } else if (strcmp(key, "order_seed") == 0) {
        if (!json_is_integer(value) || json_integer_value(value) < 0 || json_number_value(value) > 9e15)
            return acquire_json_fail(j, key, "must be a whole number, 0 or more");
        plan->seed = isnan(plan->seed) ? json_number_value(value) : plan->seed;
    } else if (strcmp(key, "repeat_first") == 0) {
        if (!json_is_boolean(value))
            return acquire_json_fail(j, key, "must be true or false");
        plan->repeat_first = plan->repeat_first < 0 ? json_is_true(value) : plan->repeat_first;
    } else if (strcmp(key, "palpate") != 0 && strcmp(key, "about") != 0 && strcmp(key, "runs") != 0) {
        return acquire_json_fail(j, key, "is not a known key");
    }
    return CLI_OK;
}

static int read_all(const acquire_json *j, const acquire_motion *options, acquire_plan *plan) {
    acquire_motion shared = acquire_motion_none();
    const char *key;
    json_t *value, *runs = json_object_get(j->root, "runs");
    json_object_foreach(j->root, key, value) {
        bool known;
        int code = take_figure(j, key, key, value, &shared, &known);
        code = code || known ? code : read_order(j, key, value, plan);
        if (code)
            return code;
    }
    if (json_array_size(runs) == 0)
        return acquire_json_fail(j, "", "needs \"runs\": [...]");
    int code = CLI_OK;
    for (size_t i = 0; code == CLI_OK && i < json_array_size(runs); i++)
        code = read_run(j, i, options, &shared, plan);
    return code;
}

int acquire_plan_read(acquire_plan *plan, const char *file, const acquire_motion *options) {
    acquire_json j;
    int code = acquire_json_open(file, "protocol", &j);
    if (code == CLI_OK) {
        code = read_all(&j, options, plan);
        acquire_json_close(&j);
    }
    return code;
}
