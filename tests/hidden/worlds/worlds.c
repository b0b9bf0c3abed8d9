/* worlds.c: writes cases of laboratories that are not ours: see README.md in the folder above. */
#define _POSIX_C_SOURCE 200809L
#include "worlds.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Of each laboratory: nulls, effects, what is outside the catalogue, pairs of effects, what is outside it and
 * comes again; fewer where little can be separated. */
typedef struct share {
    int of[5];
} share;

static share share_of(const lab *l, const char *set) {
    bool quick = strcmp(set, "quick") == 0;
    if (strcmp(set, "outside") == 0) /* of the laboratories whose files say when a run began */
        return l->protocol == RICH && l->header == FULL && l->Hz < 1000 && !(l->differ > 0)
                   ? (share){{3, 0, 0, 0, ALL_OUTSIDES - OUTSIDES}}
                   : (share){{0, 0, 0, 0, 0}};
    if (l->other != (strcmp(set, "testers") == 0))
        return (share){{0, 0, 0, 0, 0}};
    if (l->other)
        return (share){{2, 3, 1, 1, 0}};
    bool plain = strcmp(l->name, "family") == 0 || strcmp(l->name, "one_speed") == 0;
    if (quick)
        return plain ? (share){{1, 1, 0, 0, 0}} : (share){{0, 0, 0, 0, 0}};
    return l->protocol == RICH ? (share){{3, 4, 2, 0, 0}} : (share){{2, 2, 0, 0, 0}};
}

static bool one_case(const lab *l, uint64_t seed, uint64_t stream, int number, int kind, const char *out,
                     FILE *truths) {
    truth t;
    char path[1024];
    if (!truth_draw(&t, l, seed, stream, kind))
        return false;
    snprintf(t.name, sizeof t.name, "case_%03d", number);
    snprintf(path, sizeof path, "%s/%s", out, t.name);
    bool good = (mkdir(path, 0777) == 0 || errno == EEXIST) && truth_files(&t, out);
    fprintf(truths, "%s", number > 1 ? ",\n" : "");
    truth_line(truths, &t);
    truth_free(&t);
    return good;
}

static bool all_cases(uint64_t seed, const char *set, const char *out, FILE *truths) {
    int number = 0;
    for (size_t i = 0; i < LABS; i++) {
        share s = share_of(&laboratories[i], set);
        for (int kind = 0; kind < 5; kind++)
            for (int k = 0; k < s.of[kind]; k++)
                if (!one_case(&laboratories[i], seed, 1000 * (i + 1) + 100 * (uint64_t)kind + (uint64_t)k,
                              ++number, kind, out, truths)) {
                    fprintf(stderr, "worlds: case %d of %s could not be made\n", number,
                            laboratories[i].name);
                    return false;
                }
    }
    printf("%d cases in %s\n", number, out);
    return true;
}

static int usage(void) {
    fprintf(stderr, "worlds all|quick|testers|outside SEED DIR TRUTH.json\nworlds --self-test\n");
    return 2;
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "--self-test") == 0)
        return worlds_self_test() == 0 ? 0 : 1;
    if (argc != 5 || (strcmp(argv[1], "all") != 0 && strcmp(argv[1], "quick") != 0 &&
                      strcmp(argv[1], "testers") != 0 && strcmp(argv[1], "outside") != 0))
        return usage();
    uint64_t seed = strtoull(argv[2], NULL, 10);
    if (mkdir(argv[3], 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "worlds: %s: %s\n", argv[3], strerror(errno));
        return 1;
    }
    FILE *truths = fopen(argv[4], "w");
    if (!truths) {
        fprintf(stderr, "worlds: %s: %s\n", argv[4], strerror(errno));
        return 1;
    }
    fprintf(truths, "{\"seed\": %" PRIu64 ", \"set\": \"%s\", \"cases\": [\n", seed, argv[1]);
    bool good = all_cases(seed, argv[1], argv[3], truths);
    fprintf(truths, "\n]}\n");
    return fclose(truths) == 0 && good ? 0 : 1;
}
