/* machine_file.c: an indenter's parameters: shown, set by name, read from and written to a file. */
#include "calibrate_device.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = MACHINE_NAME;

static json_t *values(const device_parameters *p) {
    json_t *to = json_object();
    for (size_t i = 0; i < p->n; i++) {
        const device_parameter *one = &p->one[i];
        json_t *list = json_object_get(to, one->name);
        if (one->count == 1)
            json_object_set_new(to, one->name, json_real(device_parameter_plain(one->value)));
        else if (list)
            json_array_append_new(list, json_real(device_parameter_plain(one->value)));
        else
            json_object_set_new(to, one->name, json_pack("[f]", device_parameter_plain(one->value)));
    }
    return to;
}

static json_t *file_of(const device *d, const device_parameters *p) {
    char id[12], stored[12], date[16], board[PALP_WIRE_NAME + 1] = "";
    snprintf(id, sizeof id, "%08x", (unsigned)p->now.id);
    snprintf(stored, sizeof stored, "%08x", (unsigned)p->now.stored_id);
    device_date(device_parameter_value(p, "calibration_day", 0), date);
    memcpy(board, d->info.board, PALP_WIRE_NAME);
    return json_pack("{s{si} ss sI ss ss ss? ss? si so}", "palpate", "machine", 1, "board", board, "serial",
                     (json_int_t)d->info.serial, "id", id, "source", device_source_text(p->now.source),
                     "stored_id", p->now.stored_id ? stored : NULL, "date", *date ? date : NULL,
                     "damaged_records", (int)p->now.bad, "parameters", values(p));
}

static void print(const device_parameters *p) {
    char date[16], value[24], standard[24], low[24], high[24];
    device_date(device_parameter_value(p, "calibration_day", 0), date);
    printf("calibration %08x (%s), %s%s\n", (unsigned)p->now.id, device_source_text(p->now.source),
           *date ? date : "no date",
           p->now.id == p->now.stored_id ? ""
           : p->now.stored_id            ? "; changed since it was saved"
                                         : "; not saved");
    printf("%-20s %12s %12s %12s %12s\n", "name", "value", "compiled in", "lowest", "highest");
    for (size_t i = 0; i < p->n; i++) {
        const device_parameter *one = &p->one[i];
        char name[PALP_WIRE_PARAMETER_NAME + 8];
        snprintf(name, sizeof name, one->count > 1 ? "%s.%u" : "%s", one->name, (unsigned)one->index);
        device_parameter_text(one->value, value);
        device_parameter_text(one->standard, standard);
        device_parameter_text(one->low, low);
        device_parameter_text(one->high, high);
        printf("%-20s %12s %12s %12s %12s\n", name, value, standard, low, high);
    }
}

int machine_show(const machine_options *o, session *s) {
    device *d = &s->device;
    device_parameters p;
    device_result result = device_parameters_read(d, DEVICE_PARAMETERS, &p);
    if (result)
        return machine_failure(d, result);
    if (p.now.bad > 0)
        cli_warning(NAME, "%u damaged records in the device's flash; its parameters are those %s",
                    (unsigned)p.now.bad, p.now.source == 1 ? "of the last intact record" : "compiled in");
    int code = o->out ? json_save(NAME, file_of(d, &p), o->out) : CLI_OK;
    if (code == CLI_OK && o->json)
        return json_print(NAME, file_of(d, &p));
    if (code == CLI_OK && !o->out)
        print(&p);
    return code;
}

/* NAME=VALUE, or NAME.INDEX=VALUE of one with several values. */
static int read_word(const device_parameters *p, const char *word, machine_change *change) {
    char name[PALP_WIRE_PARAMETER_NAME + 1];
    const char *equals = strchr(word, '=');
    const size_t length = strcspn(word, ".=");
    char *rest = NULL;
    if (!equals || length >= sizeof name)
        return cli_usage_error(NAME, "set needs NAME=VALUE, not \"%s\"", word);
    snprintf(name, sizeof name, "%.*s", (int)length, word);
    const unsigned long index = word[length] == '.' ? strtoul(word + length + 1, &rest, 10) : 0;
    change->one = device_parameter_find(p, name, index);
    if (!device_parameter_find(p, name, 0))
        return cli_usage_error(NAME, "the device has no parameter %s; calibrate-device show lists them",
                               name);
    if ((word[length] == '.' && rest != equals) || !change->one)
        return cli_usage_error(NAME, "%s has %u values: name one as %s.0 to %s.%u", name,
                               (unsigned)device_parameter_find(p, name, 0)->count, name, name,
                               device_parameter_find(p, name, 0)->count - 1u);
    if (word[length] != '.' && change->one->count > 1)
        return cli_usage_error(NAME, "%s has %u values: name one as %s.0 to %s.%u", name,
                               (unsigned)change->one->count, name, name, change->one->count - 1u);
    if (!cli_read_number(equals + 1, &change->value))
        return cli_usage_error(NAME, "%s must be a number, not \"%s\"", name, equals + 1);
    return CLI_OK;
}

static int refuse(const machine_change *c) {
    char why[DEVICE_TEXT];
    device_parameter_refuse(c->one, c->value, why);
    return cli_failure(NAME, "%s", why);
}

static void set_back(device *d, size_t n, const machine_change *change) {
    for (size_t i = 0; i < n; i++)
        (void)device_parameter_set(d, change[i].one, (double)change[i].one->value);
}

/* A value out of its range is found before any value is set. */
static int check(size_t n, const machine_change *change) {
    for (size_t i = 0; i < n; i++) {
        const device_parameter *one = change[i].one;
        const float value = (float)change[i].value;
        char old[24], new[24];
        if (!(value >= one->low && value <= one->high))
            return refuse(&change[i]);
        device_parameter_text(one->value, old);
        device_parameter_text(value, new);
        if (value != one->value)
            fprintf(stderr, one->count > 1 ? "%s.%u: %s instead of %s\n" : "%s%.0u: %s instead of %s\n",
                    one->name, one->count > 1 ? (unsigned)one->index : 0u, new, old);
    }
    return CLI_OK;
}

int machine_change_all(const machine_options *o, device *d, size_t n, const machine_change *change) {
    int code = check(n, change);
    code = code ? code : machine_idle(d);
    if (code)
        return code;
    if (!machine_agrees(o, "Set these parameters and save them in the device?"))
        return cli_failure(NAME, "nothing is changed");
    device_result result = DEVICE_OK;
    size_t done = 0;
    while (result == DEVICE_OK && done < n) {
        result = device_parameter_set(d, change[done].one, change[done].value);
        done += result == DEVICE_OK;
    }
    result = result ? result : device_save(d);
    if (result == DEVICE_OK)
        return CLI_OK;
    code = machine_failure(d, result);
    set_back(d, done, change);
    return code;
}

int machine_set(const machine_options *o, session *s) {
    device *d = &s->device;
    device_parameters p;
    machine_change change[MACHINE_WORDS];
    if (o->n_words == 0)
        return cli_usage_error(NAME, "set needs NAME=VALUE");
    device_result result = device_parameters_read(d, DEVICE_PARAMETERS, &p);
    int code = result ? machine_failure(d, result) : CLI_OK;
    for (size_t i = 0; i < o->n_words && code == CLI_OK; i++)
        code = read_word(&p, o->word[i], &change[i]);
    code = code ? code : machine_change_all(o, d, o->n_words, change);
    return code ? code : machine_show(o, s);
}

int machine_standard(const machine_options *o, session *s) {
    device *d = &s->device;
    device_parameters p;
    machine_change change[DEVICE_PARAMETERS];
    device_result result = device_parameters_read(d, DEVICE_PARAMETERS, &p);
    for (size_t i = 0; i < p.n; i++)
        change[i] = (machine_change){&p.one[i], (double)p.one[i].standard};
    int code = result ? machine_failure(d, result) : machine_change_all(o, d, p.n, change);
    return code ? code : machine_show(o, s);
}

static int take_number(const acquire_json *j, const char *where, const json_t *value,
                       const device_parameter *one, machine_change *change) {
    *change = (machine_change){one, json_number_value(value)};
    return json_is_number(value) ? CLI_OK : acquire_json_fail(j, where, "must be a number");
}

static int take_value(const acquire_json *j, const char *key, const json_t *value, const device_parameters *p,
                      machine_change *change, size_t *n) {
    char where[64];
    const device_parameter *one = device_parameter_find(p, key, 0);
    snprintf(where, sizeof where, "parameters.%s", key);
    if (!one)
        return acquire_json_fail(j, where, "is not a parameter of this device");
    if (one->count == 1)
        return take_number(j, where, value, one, &change[(*n)++]);
    if (json_array_size(value) != one->count)
        return acquire_json_fail(j, where, "must be a list of %u numbers", (unsigned)one->count);
    int code = CLI_OK;
    for (size_t i = 0; i < one->count && code == CLI_OK; i++)
        code = take_number(j, where, json_array_get(value, i), one + i, &change[(*n)++]);
    return code;
}

static int take_file(const acquire_json *j, const device_parameters *p, machine_change *change, size_t *n) {
    const char *key;
    json_t *value, *all = json_object_get(j->root, "parameters");
    int code = json_is_object(all) ? CLI_OK : acquire_json_fail(j, "parameters", "must be an object");
    json_object_foreach(all, key, value) {
        code = code ? code : take_value(j, key, value, p, change, n);
    }
    return code;
}

int machine_load(const machine_options *o, session *s) {
    device *d = &s->device;
    device_parameters p;
    machine_change change[DEVICE_PARAMETERS];
    acquire_json j;
    size_t n = 0;
    if (o->n_words != 1)
        return cli_usage_error(NAME, "load needs one FILE.json");
    int code = acquire_json_open(o->word[0], "machine", &j);
    if (code)
        return code;
    device_result result = device_parameters_read(d, DEVICE_PARAMETERS, &p);
    code = result ? machine_failure(d, result) : take_file(&j, &p, change, &n);
    acquire_json_close(&j);
    code = code ? code : machine_change_all(o, d, n, change);
    return code ? code : machine_show(o, s);
}
