/* json_out.h: JSON on standard output and in files. */
#ifndef PALPATE_JSON_OUT_H
#define PALPATE_JSON_OUT_H

#include <jansson.h>
#include <palpate/law.h>
#include <stddef.h>

/* Prints a value indented by two and frees it; returns an exit code. NULL = out of memory. */
int json_print(const char *name, json_t *value);

/* Writes it to a file by a temporary one and frees it; returns an exit code. NULL = out of memory. Each
 * figure takes one long line. */
int json_save(const char *name, json_t *value, const char *path);

/* Text from outside, made plain (palp_text_make_plain); NULL = out of memory. */
json_t *json_text(const char *text);

json_t *json_numbers(size_t n, const double *value);

/* Parameters of a law: coefficients_N or coefficients_Pa, or strain and stiffness_N of a spline. */
void json_add_law(json_t *to, const palp_law *law);

/* The member of this key and type; NAN or "-" if there is none. */
double json_number_at(const json_t *object, const char *key);
const char *json_text_at(const json_t *object, const char *key);

/* A number, or null where it is not finite. */
json_t *json_number_or_null(double value);

typedef struct json_figure {
    const char *key;
    double value;
} json_figure;

/* Sets such numbers of an object: json_figures(to, {"low_N", low}, {"high_N", high}). */
#define json_figures(to, ...)                                                                                \
    json_set_figures(to, sizeof((json_figure[]){__VA_ARGS__}) / sizeof(json_figure),                         \
                     (const json_figure[]){__VA_ARGS__})
void json_set_figures(json_t *to, size_t n, const json_figure *figure);

#endif
