/* json_out.c: JSON on standard output and in files. */
#include "json_out.h"

#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t LOOK = JSON_INDENT(2) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15);

int json_print(const char *name, json_t *value) {
    return json_save(name, value, NULL);
}

/* Writes the members, then each figure on a line. */
static bool dump(json_t *value, FILE *to) {
    json_t *figures = json_object_get(value, "figures");
    figures = json_is_array(figures) ? json_incref(figures) : NULL;
    if (figures)
        json_object_del(value, "figures");
    char *text = json_dumps(value, LOOK);
    size_t n = text ? strlen(text) : 0;
    bool good = n > 2;
    if (figures && good) {
        fprintf(to, "%.*s,\n  \"figures\": [", (int)(n - 2), text); /* without the last brace */
        for (size_t i = 0; i < json_array_size(figures) && good; i++) {
            fputs(i ? ",\n    " : "\n    ", to);
            good = json_dumpf(json_array_get(figures, i), to,
                              JSON_COMPACT | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15)) == 0 ||
                   ferror(to);
        }
        fputs("\n  ]\n}\n", to);
        json_object_set(value, "figures", figures);
    } else if (text) {
        fprintf(to, "%s\n", text);
    }
    json_decref(figures);
    free(text);
    return text && good;
}

int json_save(const char *name, json_t *value, const char *path) {
    palp_file to;
    int code = value ? cli_file_open(name, path, &to) : cli_failure(name, "out of memory");
    if (code == CLI_OK) {
        if (!dump(value, to.stream)) {
            palp_file_abandon(&to);
            code = cli_failure(name, "out of memory");
        } else {
            code = cli_file_close(name, &to);
        }
    }
    json_decref(value);
    return code;
}

json_t *json_text(const char *text) {
    char *copy = malloc(strlen(text) + 1);
    json_t *value = copy ? json_string(palp_text_make_plain(strcpy(copy, text))) : NULL;
    free(copy);
    return value;
}

json_t *json_number_or_null(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

void json_set_figures(json_t *to, size_t n, const json_figure *figure) {
    for (size_t i = 0; i < n; i++)
        json_object_set_new(to, figure[i].key, json_number_or_null(figure[i].value));
}

json_t *json_numbers(size_t n, const double *value) {
    json_t *list = json_array();
    for (size_t i = 0; list && i < n; i++)
        json_array_append_new(list, json_number_or_null(value[i]));
    return list;
}

void json_add_law(json_t *to, const palp_law *law) {
    if (law->kind == PALP_LAW_SPLINE) {
        json_object_set_new(to, "strain", json_numbers(law->n, law->strain));
        json_object_set_new(to, "stiffness_N", json_numbers(law->n, law->coefficients));
        return;
    }
    json_object_set_new(to, law->kind == PALP_LAW_POLYNOMIAL ? "coefficients_N" : "coefficients_Pa",
                        json_numbers(law->n, law->coefficients));
}

double json_number_at(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

const char *json_text_at(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    return json_is_string(value) ? json_string_value(value) : "-";
}
