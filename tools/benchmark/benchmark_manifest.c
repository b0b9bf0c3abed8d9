/* benchmark_manifest.c: the splits and programs of a folder's benchmark.json. */
#include "benchmark.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

bool benchmark_path(const benchmark *b, char path[CLI_PATH_MAX], const char *format, ...) {
    va_list arguments;
    int n = snprintf(path, CLI_PATH_MAX, "%s/", b->folder);
    if (n < 0 || n >= CLI_PATH_MAX)
        return false;
    va_start(arguments, format);
    int more = vsnprintf(path + n, (size_t)(CLI_PATH_MAX - n), format, arguments);
    va_end(arguments);
    return more >= 0 && n + more < CLI_PATH_MAX;
}

static int fault(const benchmark *b, const char *where, const char *what) {
    return cli_failure(BENCHMARK_NAME, "%s/benchmark.json: %s%s%s", b->folder, where, *where ? ": " : "",
                       what);
}

/* A name that is one part of a path. */
static bool is_name(const char *name) {
    return name && *name && *name != '.' && strpbrk(name, "/\\") == NULL;
}

/* All texts of a list, at most so many. */
static bool take_texts(const json_t *list, size_t most, const char **text, size_t *n) {
    *n = json_array_size(list);
    for (size_t i = 0; i < *n && *n <= most; i++)
        if (!(text[i] = json_string_value(json_array_get(list, i))))
            return false;
    return json_is_array(list) && *n <= most;
}

static bool take_limit(const json_t *split, const char *key, double *value) {
    const json_t *number = json_object_get(split, key);
    *value = number ? json_number_value(number) : -INFINITY;
    return !number || json_is_number(number);
}

static int check_keys(const benchmark *b, const char *where, const json_t *object, size_t n,
                      const char *const *known) {
    const char *key;
    json_t *value;
    char what[160];
    json_object_foreach((json_t *)object, key, value) {
        size_t i = 0;
        while (i < n && strcmp(known[i], key) != 0)
            i++;
        snprintf(what, sizeof what, "%.80s is no key here", key);
        if (i == n)
            return fault(b, where, what);
    }
    return CLI_OK;
}

static int take_split(benchmark *b, size_t i, const json_t *from) {
    static const char *const known[] = {"name",    "leaves_out",     "about",       "fit",
                                        "predict", "deeper_than_mm", "later_than_s"};
    benchmark_split *s = &b->split[b->n_splits];
    char where[64];
    snprintf(where, sizeof where, "split %zu", i + 1);
    s->name = json_string_value(json_object_get(from, "name"));
    s->leaves_out = json_string_value(json_object_get(from, "leaves_out"));
    int code = check_keys(b, where, from, sizeof known / sizeof *known, known);
    if (code)
        return code;
    if (!is_name(s->name) || !s->leaves_out)
        return fault(b, where, "needs name (without a slash) and leaves_out, texts");
    for (size_t k = 0; k < b->n_splits; k++)
        if (strcmp(b->split[k].name, s->name) == 0)
            return fault(b, where, "its name is that of an earlier split");
    if (!take_texts(json_object_get(from, "fit"), BENCHMARK_RUNS, s->fit, &s->n_fit) || s->n_fit == 0 ||
        !take_texts(json_object_get(from, "predict"), BENCHMARK_RUNS, s->predict, &s->n_predict) ||
        s->n_predict == 0)
        return fault(b, where, "fit and predict must each list 1 to 64 files");
    if (!take_limit(from, "deeper_than_mm", &s->deeper_than_mm) ||
        !take_limit(from, "later_than_s", &s->later_than_s))
        return fault(b, where, "deeper_than_mm and later_than_s must be numbers");
    b->n_splits++;
    return CLI_OK;
}

static int take_own(benchmark *b, size_t i, const json_t *from) {
    static const char *const known[] = {"name", "arguments"};
    benchmark_program *p = &b->program[b->n_programs++];
    char where[64];
    snprintf(where, sizeof where, "palpate_with %zu", i + 1);
    *p = (benchmark_program){.name = json_string_value(json_object_get(from, "name")), .own = true};
    int code = check_keys(b, where, from, 2, known);
    if (code == CLI_OK &&
        (!p->name || !*p->name ||
         !take_texts(json_object_get(from, "arguments"), BENCHMARK_WORDS - 8, p->words, &p->n_words)))
        code = fault(b, where, "needs name, a text, and arguments, a list of options of characterize");
    return code;
}

static int take_programs(benchmark *b, const json_t *own, const json_t *others) {
    const size_t n_own = json_array_size(own), n = json_array_size(others);
    int code = CLI_OK;
    if ((own && !json_is_array(own)) || (others && !json_is_array(others)) || n_own + n == 0 ||
        n_own + n > BENCHMARK_PROGRAMS)
        return fault(b, "", "palpate_with and programs must be lists, of 1 to 16 programs in all");
    for (size_t i = 0; i < n_own && code == CLI_OK; i++)
        code = take_own(b, i, json_array_get(own, i));
    for (size_t i = 0; i < n && code == CLI_OK; i++) {
        benchmark_program *p = &b->program[b->n_programs++];
        *p = (benchmark_program){.name = json_string_value(json_array_get(others, i))};
        if (!is_name(p->name))
            code = fault(b, "programs", "must list names of folders of predictions/");
    }
    return code;
}

int benchmark_read(const char *folder, benchmark *b) {
    static const char *const known[] = {"palpate", "about", "splits", "palpate_with", "programs"};
    char path[CLI_PATH_MAX];
    json_error_t where;
    *b = (benchmark){.folder = folder};
    if (!benchmark_path(b, path, "benchmark.json"))
        return cli_usage_error(BENCHMARK_NAME, "the folder's name is too long");
    b->root = json_load_file(path, JSON_REJECT_DUPLICATES, &where);
    if (!b->root)
        return where.line > 0 ? cli_failure(BENCHMARK_NAME, "%s:%d: %s", path, where.line, where.text)
                              : cli_failure(BENCHMARK_NAME, "%s", where.text);
    const json_t *splits = json_object_get(b->root, "splits");
    if (json_integer_value(json_object_get(json_object_get(b->root, "palpate"), "benchmark")) != 1)
        return fault(b, "", "lacks \"palpate\": {\"benchmark\": 1}");
    int code = check_keys(b, "", b->root, sizeof known / sizeof *known, known);
    if (code == CLI_OK && (!json_is_array(splits) || json_array_size(splits) == 0 ||
                           json_array_size(splits) > BENCHMARK_SPLITS))
        code = fault(b, "", "splits must list 1 to 64 of them");
    for (size_t i = 0; i < json_array_size(splits) && code == CLI_OK; i++)
        code = take_split(b, i, json_array_get(splits, i));
    return code ? code
                : take_programs(b, json_object_get(b->root, "palpate_with"),
                                json_object_get(b->root, "programs"));
}
