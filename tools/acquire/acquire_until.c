/* acquire_until.c: after the first session, further experiments until the effects have no look-alikes.
 * palpate explain, a child process, names the effects and designs each experiment. */
#define _XOPEN_SOURCE 700
#include "acquire_setup.h"
#include "shared/json_out.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const char NAME[] = "acquire";

enum { FILES = 512, WORDS = FILES + 24, NUMBER = 32 };

/* Recordings of all sessions so far, and the results of explain. */
typedef struct sessions {
    acquire_setup *setup;
    const acquire_until *how;
    size_t n;
    char *file[FILES]; /* [n] owned */
    char result[CLI_PATH_MAX], next[CLI_PATH_MAX], explained[CLI_PATH_MAX];
    double left_s, rest_s; /* of the time for further experiments; before each of their runs */
} sessions;

static int path_in(const sessions *u, const char *name, char path[CLI_PATH_MAX]) {
    const int n = snprintf(path, CLI_PATH_MAX, "%s/%s", u->setup->session.out, name);
    return n >= 0 && n < CLI_PATH_MAX ? CLI_OK
                                      : cli_failure(NAME, "%s: the name is too long", u->setup->session.out);
}

static int add_files(sessions *u, const acquire_plan *plan) {
    char name[ACQUIRE_NAME + 8], path[CLI_PATH_MAX];
    for (size_t i = 0; i < plan->n; i++) {
        snprintf(name, sizeof name, "%s.csv", plan->run[i].name);
        int code = path_in(u, name, path);
        if (code)
            return code;
        if (u->n == FILES || !(u->file[u->n] = strdup(path)))
            return cli_failure(NAME, "too many recordings to explain");
        u->n++;
    }
    return CLI_OK;
}

/* The child is in a group of its own: a signal to this command is handed on, and ends its search. */
static int explain(const sessions *u) {
    const char *argv[WORDS] = {"palpate", "explain", "--model", u->how->model, "--result",     u->result,
                               "--next",  u->next,   "--out",   u->explained,  "--next-time-s"};
    char time[NUMBER], rest[NUMBER], every[NUMBER], alarm[NUMBER];
    size_t n = 11;
    posix_spawn_file_actions_t files;
    posix_spawnattr_t group;
    pid_t child;
    int status = 0;
    snprintf(time, sizeof time, "%.9g", fmax(1e-3, u->left_s)); /* too little for any run */
    snprintf(rest, sizeof rest, "%.9g", u->rest_s);
    snprintf(every, sizeof every, "%zu", u->how->every);
    snprintf(alarm, sizeof alarm, "%.9g", u->how->false_alarm);
    argv[n++] = time;
    if (u->rest_s > 0) {
        argv[n++] = "--next-rest-s";
        argv[n++] = rest;
    }
    if (u->how->every > 0) {
        argv[n++] = "--every";
        argv[n++] = every;
    }
    if (u->how->false_alarm > 0) {
        argv[n++] = "--false-alarm";
        argv[n++] = alarm;
    }
    argv[n++] = "--"; /* a folder's name may begin with a dash */
    for (size_t i = 0; i < u->n; i++)
        argv[n++] = u->file[i];
    unlink(u->next); /* one of an earlier result */
    fflush(NULL);
    posix_spawn_file_actions_init(&files); /* its output is text for the user, not this command's data */
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    posix_spawnattr_init(&group);
    posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP);
    const int failed = posix_spawn(&child, "/proc/self/exe", &files, &group, (char *const *)argv, environ);
    posix_spawnattr_destroy(&group);
    posix_spawn_file_actions_destroy(&files);
    if (failed)
        return cli_failure(NAME, "palpate explain cannot be started: %s", strerror(failed));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        kill(child, SIGINT);
    return WIFEXITED(status) ? WEXITSTATUS(status) : CLI_FAILURE;
}

/* The runs of the next experiment, with names of their own; there is a pause before the first of them,
 * too. */
static int plan_next(const sessions *u, size_t round, acquire_plan *plan) {
    const acquire_motion none = acquire_motion_none();
    *plan = (acquire_plan){.random = -1, .repeat_first = -1, .seed = NAN};
    int code = acquire_plan_read(plan, u->next, &none);
    if (code || !acquire_plan_arrange(plan))
        return code ? code : CLI_FAILURE;
    for (size_t i = 0; i < plan->n; i++) {
        acquire_run *r = &plan->run[i];
        char name[ACQUIRE_NAME];
        snprintf(name, sizeof name, "next%zu_%.*s", round, ACQUIRE_NAME - 32, r->name);
        memcpy(r->name, name, sizeof name);
        if (r->kind != ACQUIRE_FREE)
            r->motion.rest_s = u->rest_s;
    }
    return CLI_OK;
}

/* The pause before a press of this plan; 0 where there is none. */
static double mean_rest_s(const acquire_plan *plan) {
    double sum = 0, n = 0;
    for (size_t i = 0; i < plan->n; i++)
        if (plan->run[i].motion.rest_s > 0) {
            sum += plan->run[i].motion.rest_s;
            n++;
        }
    return n > 0 ? sum / n : 0;
}

static void add_summary(json_t *all, json_t *more) {
    if (all && more) {
        json_array_extend(json_object_get(all, "runs"), json_object_get(more, "runs"));
        json_object_set_new(all, "planned",
                            json_integer(json_integer_value(json_object_get(all, "planned")) +
                                         json_integer_value(json_object_get(more, "planned"))));
        json_object_set(all, "fault", json_object_get(more, "fault"));
    }
    json_decref(more);
}

/* Explains, and records the experiments of explain, while effects have look-alikes and time remains. *result:
 * the last one, which the caller releases. */
static int go_on(sessions *u, acquire_plan *plan, json_t *summary, json_t **result) {
    acquire_options *again = &u->setup->session;
    again->keep_contact = true;
    for (size_t round = 1;; round++) {
        rig_pause(&u->setup->virtual_one, true);
        int code = explain(u);
        rig_pause(&u->setup->virtual_one, false);
        if (code)
            return code;
        json_decref(*result);
        *result = json_load_file(u->result, 0, NULL);
        const json_t *next = json_object_get(*result, "next_experiment");
        const double needs_s = json_number_at(next, "time_s");
        if (strcmp(json_text_at(*result, "verdict"), "ambiguous") != 0 ||
            json_array_size(json_object_get(next, "runs")) == 0 || !(needs_s <= u->left_s))
            return CLI_OK;
        code = plan_next(u, round, plan);
        if (code)
            return code;
        u->left_s -= acquire_plan_time_s(plan);
        json_t *more = NULL;
        rig_open_again(&u->setup->virtual_one); /* which again->where names */
        code = acquire_session(again, plan, summary ? &more : NULL);
        add_summary(summary, more);
        code = code ? code : add_files(u, plan);
        if (code)
            return code;
    }
}

int acquire_until_explained(acquire_setup *setup, acquire_plan *plan, const acquire_until *how,
                            json_t *summary) {
    sessions *u = calloc(1, sizeof *u);
    json_t *result = NULL;
    if (!u)
        return cli_failure(NAME, "out of memory");
    u->setup = setup;
    u->how = how;
    u->left_s = how->time_s > 0 ? how->time_s : acquire_plan_time_s(plan);
    u->rest_s = mean_rest_s(plan);
    int code = path_in(u, "explain.json", u->result);
    code = code ? code : path_in(u, "next.json", u->next);
    code = code ? code : path_in(u, "explained.json", u->explained);
    code = code ? code : add_files(u, plan);
    code = code ? code : go_on(u, plan, summary, &result);
    if (code == CLI_OK) {
        const char *verdict = json_text_at(result, "verdict");
        const bool open = strcmp(verdict, "ambiguous") == 0 || strcmp(verdict, "unexplained") == 0 ||
                          strcmp(verdict, "suspected") == 0;
        if (strcmp(verdict, "ambiguous") == 0)
            cli_warning(NAME, "several effects fit the recordings: no further experiment fits the time");
        if (summary)
            json_object_set_new(summary, "verdict", json_string(verdict));
        code = open ? CLI_NOT_CONVERGED : CLI_OK;
    }
    json_decref(result);
    for (size_t i = 0; i < u->n; i++)
        free(u->file[i]);
    free(u);
    return code;
}
