/* generate.c: writes cases whose hidden effects are known: see README.md beside this file. */
#define _POSIX_C_SOURCE 200809L
#include "hidden.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CASES = 256, JOBS = 64 };

typedef struct options {
    uint64_t seed;
    bool quick, raw, test;
    const char *out, *truth;
    long jobs;
} options;

typedef struct plans {
    size_t n;
    plan list[CASES];
} plans;

static void add(plans *p, enum group group, int effect, int strength, double fineness) {
    bool lasting = p->n % 2 == 1;
    p->list[p->n++] = (plan){group, effect, strength, fineness, lasting};
}

/* 21 effects at three strengths, the two weaker ones twice where anything can be seen of the effect. */
static void plan_all(plans *p) {
    for (int id = 0; id < EFFECTS; id++)
        for (int i = 0; i < (id == SENSOR_GAIN || id == FRAME_COMPLIANCE ? 3 : 5); i++)
            add(p, SINGLE, id, i % 3, 1);
    for (int i = 0; i < 30; i++)
        add(p, NONE, 0, 0, 1);
    for (int i = 0; i < 20; i++)
        add(p, TWO, 0, 0, 1);
    for (int i = 0; i < 15; i++)
        add(p, OUTSIDE, i, 0, 1);
    for (int i = 0; i < 20; i++)
        add(p, SEED, i, 0, 1);
}

static void plan_quick(plans *p) {
    static const int ids[] = {RELAXATION_ARM, PERMANENT_SET, SENSOR_BIAS,
                              DRIVE_RIPPLE,   ADHESION,      RATE_STIFFENING};
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++)
        add(p, SINGLE, ids[i], 1, 0.3);
    add(p, NONE, 0, 0, 0.3);
    add(p, NONE, 0, 0, 0.3);
    add(p, TWO, 0, 0, 0.3);
    add(p, OUTSIDE, 0, 0, 0.3);
}

/* After the shuffle, so that the other cases of a seed are what they are without these. */
static void plan_network(plans *p, bool quick) {
    if (quick)
        add(p, NETWORK, FAULTY, 0, 0.3);
    for (int i = 0; i < 12 && !quick; i++)
        add(p, NETWORK, i % NETWORK_KINDS, 0, 1);
}

/* So that a case's number says nothing. */
static void plan_shuffle(plans *p, uint64_t seed) {
    random_state rng = random_make(seed, UINT64_MAX);
    for (size_t i = p->n; i-- > 1;) {
        size_t k = random_index(&rng, i + 1);
        plan other = p->list[i];
        p->list[i] = p->list[k];
        p->list[k] = other;
    }
}

static bool folder_make(const char *path) {
    return mkdir(path, 0777) == 0 || errno == EEXIST;
}

static bool one_case(const options *o, size_t i, plan p, FILE *truth) {
    hidden_case *c = malloc(sizeof *c);
    char path[1024];
    if (!c || !case_make(c, o->seed, i, p, o->raw)) {
        free(c);
        return false;
    }
    snprintf(c->name, sizeof c->name, "case_%03zu", i + 1);
    snprintf(path, sizeof path, "%s/%s", o->out, c->name);
    bool good = folder_make(path) && case_write(c, o->out);
    truth_write(truth, c);
    fprintf(truth, "\n");
    case_free(c);
    free(c);
    return good;
}

/* Every jobs-th case, its truth a line each into a temporary file. */
static int worker(const options *o, const plans *p, size_t which, FILE *truth) {
    for (size_t i = which; i < p->n; i += (size_t)o->jobs)
        if (!one_case(o, i, p->list[i], truth)) {
            fprintf(stderr, "generate: case %zu: could not be made\n", i + 1);
            return 1;
        }
    return fflush(truth) == 0 ? 0 : 1;
}

static bool copy_line(FILE *from, FILE *to) {
    int c = getc(from);
    for (; c != EOF && c != '\n'; c = getc(from))
        putc(c, to);
    return c == '\n';
}

static bool truth_join(const options *o, const plans *p, FILE *part[]) {
    FILE *f = fopen(o->truth, "w");
    if (!f)
        return false;
    fprintf(f, "{\"seed\": %" PRIu64 ", \"set\": \"%s\", \"strength\": \"%s\", \"cases\": [\n", o->seed,
            o->quick ? "quick" : "all", o->raw ? "raw" : "left");
    for (long i = 0; i < o->jobs; i++)
        rewind(part[i]);
    bool good = true;
    for (size_t i = 0; i < p->n && good; i++) {
        good = copy_line(part[i % (size_t)o->jobs], f);
        fprintf(f, "%s\n", i + 1 < p->n ? "," : "");
    }
    fprintf(f, "]}\n");
    return fclose(f) == 0 && good;
}

static int generate(const options *o) {
    plans p = {0};
    FILE *part[JOBS];
    int failed = 0;
    if (o->quick)
        plan_quick(&p);
    else
        plan_all(&p);
    plan_shuffle(&p, o->seed);
    plan_network(&p, o->quick);
    if (!folder_make(o->out)) {
        fprintf(stderr, "generate: %s: %s\n", o->out, strerror(errno));
        return 1;
    }
    for (long i = 0; i < o->jobs; i++) {
        part[i] = tmpfile();
        pid_t child = part[i] ? fork() : -1;
        if (child == 0)
            _Exit(worker(o, &p, (size_t)i, part[i]));
        failed |= child < 0;
    }
    for (int status; wait(&status) > 0;)
        failed |= !WIFEXITED(status) || WEXITSTATUS(status) != 0;
    if (failed || !truth_join(o, &p, part)) {
        fprintf(stderr, "generate: not all cases were written\n");
        return 1;
    }
    printf("%zu cases in %s, truth in %s\n", p.n, o->out, o->truth);
    return 0;
}

static int usage(void) {
    fprintf(stderr,
            "generate --seed N --set all|quick --out DIR --truth FILE.json [--strength left|raw] [--jobs N]\n"
            "generate --self-test\n");
    return 2;
}

static bool parse(int argc, char **argv, options *o) {
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(name, "--self-test") == 0) {
            o->test = true;
            continue;
        }
        if (!value)
            return false;
        i++;
        if (strcmp(name, "--seed") == 0)
            o->seed = strtoull(value, NULL, 10);
        else if (strcmp(name, "--set") == 0 && (strcmp(value, "all") == 0 || strcmp(value, "quick") == 0))
            o->quick = *value == 'q';
        else if (strcmp(name, "--strength") == 0 && (strcmp(value, "left") == 0 || strcmp(value, "raw") == 0))
            o->raw = *value == 'r';
        else if (strcmp(name, "--out") == 0)
            o->out = value;
        else if (strcmp(name, "--truth") == 0)
            o->truth = value;
        else if (strcmp(name, "--jobs") == 0)
            o->jobs = strtol(value, NULL, 10);
        else
            return false;
    }
    return o->test || (o->out && o->truth && o->jobs >= 1 && o->jobs <= JOBS);
}

int main(int argc, char **argv) {
    options o = {.seed = 1, .jobs = 1};
    if (!parse(argc, argv, &o))
        return usage();
    if (o.test)
        return self_test() == 0 ? 0 : 1;
    return generate(&o);
}
