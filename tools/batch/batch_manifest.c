/* batch_manifest.c: the jobs that a manifest lists, or that its command makes of each input. */
#define _POSIX_C_SOURCE 200809L
#include "batch.h"

#include <stdlib.h>
#include <string.h>

typedef struct manifest {
    const char *path;
    char *text;
    json_t *root;
    batch_plan *plan;
} manifest;

static int out_of_memory(void) {
    return cli_failure(BATCH_NAME, "out of memory");
}

/* "FILE:LINE: WHAT" of a member, or of an item of it. */
static int fault_at(const manifest *m, const char *key, size_t index, const char *what) {
    return cli_failure(BATCH_NAME, "%s:%zu: %s", m->path, batch_line_of(m->text, key, index), what);
}

static int name_fault(const manifest *m, const char *key, size_t index, const char *name, const char *why) {
    return cli_failure(BATCH_NAME, "%s:%zu: the name \"%s\" %s", m->path, batch_line_of(m->text, key, index),
                       name, why);
}

/* Only known keys; of an item of jobs, or of the root (NULL). */
static int check_keys(const manifest *m, json_t *object, const char *list, size_t index, size_t n,
                      const char *const *known) {
    const char *key;
    json_t *value;
    char what[128];
    json_object_foreach(object, key, value) {
        size_t i = 0;
        while (i < n && strcmp(known[i], key) != 0)
            i++;
        snprintf(what, sizeof what, "%.80s is no key of %s", key, list ? "a job" : "a manifest");
        if (i == n)
            return fault_at(m, list ? list : key, index, what);
    }
    return CLI_OK;
}

static bool is_list_of_text(const json_t *list) {
    bool good = json_is_array(list) && json_array_size(list) > 0;
    for (size_t i = 0; i < json_array_size(list) && good; i++)
        good = json_is_string(json_array_get(list, i));
    return good;
}

/* first, if any, then the texts, then NULL. NULL = out of memory. */
static char **words_of(const char *first, const json_t *list) {
    size_t at = 0, n = json_array_size(list);
    char **words = calloc(n + 2, sizeof *words);
    bool whole = words && (!first || (words[at++] = strdup(first)) != NULL);
    for (size_t i = 0; i < n && whole; i++)
        whole = (words[at++] = strdup(json_string_value(json_array_get(list, i)))) != NULL;
    if (!whole) {
        batch_free_words(words);
        return NULL;
    }
    return words;
}

/* ---- a list of jobs ---- */

static int add_listed(const manifest *m, size_t i, json_t *job) {
    static const char *const known[] = {"name", "arguments"};
    const json_t *name = json_object_get(job, "name"), *arguments = json_object_get(job, "arguments");
    int code = json_is_object(job) ? check_keys(m, job, "jobs", i, 2, known)
                                   : fault_at(m, "jobs", i, "a job is an object with name and arguments");
    if (code)
        return code;
    if (!json_is_string(name))
        return fault_at(m, "jobs", i, "the job has no name");
    if (!is_list_of_text(arguments))
        return fault_at(m, "jobs", i, "the job's arguments must be a list of texts");
    const char *fault = batch_name_fault(json_string_value(name));
    if (fault)
        return name_fault(m, "jobs", i, json_string_value(name), fault);
    return batch_plan_add(m->plan, strdup(json_string_value(name)), words_of("palpate", arguments))
               ? CLI_OK
               : out_of_memory();
}

static int add_list(const manifest *m, const json_t *jobs) {
    int code = json_is_array(jobs) && json_array_size(jobs) > 0
                   ? CLI_OK
                   : fault_at(m, "jobs", SIZE_MAX, "jobs must be a list with a job in it");
    for (size_t i = 0; i < json_array_size(jobs) && code == CLI_OK; i++)
        code = add_listed(m, i, json_array_get(jobs, i));
    return code;
}

/* ---- a command for each input ---- */

static int fill(const manifest *m, const batch_template *from, size_t index, const char *input) {
    const char *fault = batch_plan_fill(m->plan, from, input);
    const char *name = fault && m->plan->n ? m->plan->job[m->plan->n - 1].name : input;
    return fault ? name_fault(m, "inputs", index, name, fault) : CLI_OK;
}

static int fill_pattern(const manifest *m, const batch_template *from, const char *pattern) {
    glob_t found;
    int code = CLI_OK, failed = batch_glob(m->plan->folder, pattern, &found);
    if (failed == GLOB_NOSPACE)
        return out_of_memory();
    if (failed)
        return fault_at(m, "inputs", SIZE_MAX,
                        failed == GLOB_NOMATCH ? "no file matches inputs"
                                               : "the folder of inputs cannot be read");
    for (size_t i = 0; i < found.gl_pathc && code == CLI_OK; i++)
        code = fill(m, from, SIZE_MAX, found.gl_pathv[i]);
    globfree(&found);
    return code;
}

static int fill_inputs(const manifest *m, const batch_template *from, const json_t *inputs) {
    int code = CLI_OK;
    if (json_is_string(inputs))
        return fill_pattern(m, from, json_string_value(inputs));
    if (!is_list_of_text(inputs))
        return fault_at(m, "inputs", SIZE_MAX, "inputs must be a pattern or a list of texts");
    for (size_t i = 0; i < json_array_size(inputs) && code == CLI_OK; i++)
        code = fill(m, from, i, json_string_value(json_array_get(inputs, i)));
    return code;
}

static int add_template(const manifest *m, const json_t *command) {
    const json_t *name = json_object_get(m->root, "name"), *inputs = json_object_get(m->root, "inputs");
    if (!is_list_of_text(command))
        return fault_at(m, "command", SIZE_MAX, "command must be a list of texts");
    if (name && !json_is_string(name))
        return fault_at(m, "name", SIZE_MAX, "name must be a text");
    batch_template from = {json_array_size(command), words_of(NULL, command),
                           name ? json_string_value(name) : "{name}"};
    int code = from.words ? fill_inputs(m, &from, inputs) : out_of_memory();
    batch_free_words(from.words);
    return code;
}

/* ---- the file ---- */

static int check_form(const manifest *m) {
    static const char *const known[] = {"palpate", "about", "jobs", "command", "inputs", "name"};
    const json_t *about = json_object_get(m->root, "about");
    bool listed = json_object_get(m->root, "jobs") != NULL;
    if (json_integer_value(json_object_get(json_object_get(m->root, "palpate"), "batch")) != 1)
        return fault_at(m, "palpate", SIZE_MAX, "is no manifest: it lacks \"palpate\": {\"batch\": 1}");
    int code = check_keys(m, m->root, NULL, SIZE_MAX, sizeof known / sizeof known[0], known);
    if (code)
        return code;
    if (about && !json_is_string(about))
        return fault_at(m, "about", SIZE_MAX, "about must be a text");
    for (size_t i = 3; i < 6; i++)
        if (listed && json_object_get(m->root, known[i]))
            return fault_at(m, known[i], SIZE_MAX, "either jobs, or command and inputs");
    if (!listed && !(json_object_get(m->root, "command") && json_object_get(m->root, "inputs")))
        return fault_at(m, "", SIZE_MAX, "it needs jobs, or command and inputs");
    return CLI_OK;
}

static int check_names(const manifest *m) {
    bool listed = json_object_get(m->root, "jobs") != NULL;
    m->plan->by_name = malloc(m->plan->n * sizeof *m->plan->by_name);
    const batch_job *twice = m->plan->by_name ? batch_plan_sort(m->plan) : NULL;
    if (!m->plan->by_name)
        return out_of_memory();
    return twice ? name_fault(m, listed ? "jobs" : "inputs", twice->number, twice->name,
                              "is that of an earlier job")
                 : CLI_OK;
}

static int take(const manifest *m) {
    const json_t *jobs = json_object_get(m->root, "jobs");
    int code = check_form(m);
    if (code == CLI_OK)
        code = jobs ? add_list(m, jobs) : add_template(m, json_object_get(m->root, "command"));
    return code ? code : check_names(m);
}

int batch_manifest_read(const char *path, batch_plan *plan) {
    manifest m = {.path = path, .plan = plan};
    size_t size = 0, folder = (size_t)(cli_base(path) - path);
    palp_error error;
    json_error_t where;
    plan->folder = folder ? strndup(path, folder) : strdup(".");
    palp_status status = palp_file_read(path, &m.text, &size, &error);
    if (status)
        return cli_status(BATCH_NAME, status, &error);
    m.root = plan->folder ? json_loadb(m.text, size, JSON_REJECT_DUPLICATES, &where) : NULL;
    int code = m.root ? take(&m)
               : !plan->folder || json_error_code(&where) == json_error_out_of_memory
                   ? out_of_memory()
                   : cli_failure(BATCH_NAME, "%s:%d: malformed JSON: %s", path,
                                 where.line > 0 ? where.line : 1, where.text);
    json_decref(m.root);
    free(m.text);
    return code;
}
