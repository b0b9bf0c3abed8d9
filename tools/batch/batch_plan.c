/* batch_plan.c: the list of jobs, and commands with placeholders. */
#define _POSIX_C_SOURCE 200809L
#include "batch.h"
#include "shared/crc32.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The last part of the path without its ending; the caller frees it. */
static char *base_name(const char *input) {
    const char *base = cli_base(input), *end = strrchr(base, '.');
    return strndup(base, end && end != base ? (size_t)(end - base) : strlen(base));
}

/* Replaces {input}, {name} and {index}; the caller frees it. NULL = out of memory. */
static char *fill(const char *pattern, const char *input, const char *name, size_t index) {
    char *text = NULL;
    size_t size = 0;
    FILE *to = open_memstream(&text, &size);
    for (const char *at = pattern; to && *at;) {
        if (strncmp(at, "{input}", 7) == 0) {
            /* a command takes no file for an option */
            fprintf(to, "%s%s", at == pattern && *input == '-' ? "./" : "", input);
            at += 7;
        } else if (strncmp(at, "{name}", 6) == 0) {
            fputs(name, to);
            at += 6;
        } else if (strncmp(at, "{index}", 7) == 0) {
            fprintf(to, "%zu", index);
            at += 7;
        } else {
            fputc(*at++, to);
        }
    }
    if (!to || fclose(to) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

const char *batch_name_fault(const char *name) {
    return !*name                                              ? "is empty"
           : strchr(name, '/')                                 ? "has a slash"
           : strcmp(name, ".") == 0 || strcmp(name, "..") == 0 ? "is a folder"
           : strlen(name) > BATCH_NAME_MAX                     ? "is longer than 240 bytes"
                                                               : NULL;
}

/* Each argument with the NUL that ends it. */
static uint32_t hash_of(char *const *argv) {
    uint32_t hash = 0;
    for (size_t i = 1; argv[i]; i++)
        hash = crc32_add(hash, argv[i], strlen(argv[i]) + 1);
    return hash;
}

void batch_free_words(char **words) {
    for (size_t i = 0; words && words[i]; i++)
        free(words[i]);
    free(words);
}

bool batch_plan_add(batch_plan *plan, char *name, char **argv) {
    if (plan->n == plan->room) {
        size_t room = plan->room ? 2 * plan->room : 64;
        batch_job *larger = realloc(plan->job, room * sizeof *larger);
        plan->room = larger ? room : plan->room;
        plan->job = larger ? larger : plan->job;
    }
    if (!name || !argv || plan->n == plan->room) {
        free(name);
        batch_free_words(argv);
        return false;
    }
    plan->job[plan->n] = (batch_job){.name = name, .argv = argv, .number = plan->n, .hash = hash_of(argv)};
    plan->n++;
    return true;
}

static int compare(const void *a, const void *b) {
    const batch_job *one = *(batch_job *const *)a, *other = *(batch_job *const *)b;
    int order = strcmp(one->name, other->name);
    return order ? order : (one->number > other->number) - (one->number < other->number);
}

const batch_job *batch_plan_sort(batch_plan *plan) {
    const batch_job *first = NULL;
    for (size_t i = 0; i < plan->n; i++)
        plan->by_name[i] = &plan->job[i];
    qsort(plan->by_name, plan->n, sizeof *plan->by_name, compare);
    for (size_t i = 1; i < plan->n; i++)
        if (strcmp(plan->by_name[i - 1]->name, plan->by_name[i]->name) == 0 &&
            (!first || plan->by_name[i]->number < first->number))
            first = plan->by_name[i];
    return first;
}

int batch_glob(const char *folder, const char *pattern, glob_t *found) {
    int here = open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC), failed = GLOB_ABORTED;
    if (here >= 0 && chdir(folder) == 0) {
        failed = glob(pattern, 0, NULL, found);
        failed = fchdir(here) == 0 ? failed : GLOB_ABORTED;
    }
    if (here >= 0)
        close(here);
    return failed;
}

/* A pattern that only the text matches. */
static char *escaped(const char *text) {
    char *pattern = malloc(2 * strlen(text) + 1), *to = pattern;
    for (; pattern && *text; *to++ = *text++)
        if (strchr("*?[\\", *text))
            *to++ = '\\';
    if (pattern)
        *to = '\0';
    return pattern;
}

/* Adds a word, which becomes that of the list, also on failure. */
static bool add_word(char ***words, size_t *n, char *word) {
    char **longer = word ? realloc(*words, (*n + 2) * sizeof *longer) : NULL;
    if (!longer) {
        free(word);
        return false;
    }
    longer[*n] = word;
    longer[++*n] = NULL;
    *words = longer;
    return true;
}

/* Adds the files that a word of the command matches; *found = there are any. */
static bool add_files(const batch_plan *plan, const char *word, const char *input, const char *name,
                      char ***words, size_t *n, bool *found) {
    glob_t files;
    char *in = escaped(input), *as = escaped(name);
    char *pattern = in && as ? fill(word, in, as, plan->n) : NULL;
    int failed = pattern ? batch_glob(plan->folder, pattern, &files) : GLOB_NOSPACE;
    bool whole = failed != GLOB_NOSPACE;
    *found = failed == 0;
    for (size_t i = 0; *found && i < files.gl_pathc && whole; i++)
        whole = add_word(words, n, strdup(files.gl_pathv[i]));
    if (*found)
        globfree(&files);
    free(in);
    free(as);
    free(pattern);
    return whole;
}

static bool add_filled(const batch_plan *plan, const char *word, const char *input, const char *name,
                       char ***words, size_t *n) {
    bool found = false;
    return (!strpbrk(word, "*?[") || add_files(plan, word, input, name, words, n, &found)) &&
           (found || add_word(words, n, fill(word, input, name, plan->n)));
}

const char *batch_plan_fill(batch_plan *plan, const batch_template *from, const char *input) {
    static const char memory[] = "out of memory";
    char *base = base_name(input), *name = base ? fill(from->name, input, base, plan->n) : NULL;
    char **argv = NULL;
    size_t n = 0;
    bool whole = name && add_word(&argv, &n, strdup("palpate"));
    for (size_t i = 0; i < from->n_words && whole; i++)
        whole = add_filled(plan, from->words[i], input, name, &argv, &n);
    free(base);
    if (!whole) {
        free(name);
        batch_free_words(argv);
        return memory;
    }
    const char *fault = batch_name_fault(name);
    return batch_plan_add(plan, name, argv) ? fault : memory;
}

bool batch_is_mine(const batch_options *o, const batch_job *job) {
    return !o->is_task || job->number % o->tasks == o->task;
}

void batch_plan_free(batch_plan *plan) {
    for (size_t i = 0; i < plan->n; i++) {
        free(plan->job[i].name);
        batch_free_words(plan->job[i].argv);
    }
    free(plan->job);
    free(plan->by_name);
    free(plan->folder);
}
