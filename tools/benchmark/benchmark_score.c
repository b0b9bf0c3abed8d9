/* benchmark_score.c: how far predicted forces are from recorded ones. */
#include "benchmark.h"
#include "shared/opening.h"

#include <math.h>

/* Force of a prediction at a time, linear between its samples; NAN outside. */
static double force_at(const palp_experiment *e, size_t *k, double at) {
    const double *time = palp_experiment_column(e, "time_s"), *force = palp_experiment_column(e, "force_N");
    const size_t n = palp_experiment_rows(e);
    while (*k + 2 < n && time[*k + 1] < at)
        ++*k;
    const double share = n > 1 ? (at - time[*k]) / (time[*k + 1] - time[*k]) : NAN;
    return share >= -1e-9 && share <= 1.0 + 1e-9 ? force[*k] + share * (force[*k + 1] - force[*k]) : NAN;
}

/* Adds one run to the sums of squares. */
static int add_run(const benchmark_split *split, const char *path, const char *predicted, double *square,
                   benchmark_score *score) {
    palp_experiment *run = NULL, *other = NULL;
    int code = open_run(BENCHMARK_NAME, path, &run);
    if (code == CLI_OK)
        code = open_run(BENCHMARK_NAME, predicted, &other);
    if (code == CLI_OK) {
        const double *time = palp_experiment_column(run, "time_s"),
                     *depth = palp_experiment_column(run, "depth_mm"),
                     *force = palp_experiment_column(run, "force_N");
        for (size_t i = 0, k = 0; i < palp_experiment_rows(run) && code == CLI_OK; i++) {
            score->peak_N = fmax(score->peak_N, fabs(force[i]));
            if (depth[i] < split->deeper_than_mm || time[i] - time[0] < split->later_than_s)
                continue;
            const double miss = force_at(other, &k, time[i]) - force[i];
            if (isnan(miss))
                code = cli_failure(BENCHMARK_NAME, "%s: has no force at %.6g s, where %s has one", predicted,
                                   time[i], path);
            *square += miss * miss;
            score->samples++;
        }
    }
    palp_experiment_free(run);
    palp_experiment_free(other);
    return code;
}

static bool is_file(const char *path) {
    FILE *file = fopen(path, "r");
    if (file)
        fclose(file);
    return file != NULL;
}

int benchmark_find(const benchmark *b, const benchmark_split *split, const benchmark_program *program,
                   const char *folder, benchmark_score *score) {
    double square = 0;
    int code = CLI_OK;
    *score = (benchmark_score){.there = true};
    for (size_t r = 0; r < split->n_predict && code == CLI_OK; r++) {
        char path[CLI_PATH_MAX], predicted[CLI_PATH_MAX];
        bool fits = benchmark_path(b, path, "%s", split->predict[r]);
        if (folder)
            fits = snprintf(predicted, CLI_PATH_MAX, "%s/%zu.csv", folder, r) < CLI_PATH_MAX && fits;
        else
            fits = benchmark_path(b, predicted, "predictions/%s/%s/%s", program->name, split->name,
                                  cli_base(split->predict[r])) &&
                   fits;
        if (!fits)
            return cli_failure(BENCHMARK_NAME, "%s: the path is too long", split->predict[r]);
        if (!folder && r == 0 && !is_file(predicted)) {
            score->there = false;
            return CLI_OK;
        }
        code = add_run(split, path, predicted, &square, score);
    }
    if (code == CLI_OK && score->samples == 0)
        return cli_failure(BENCHMARK_NAME, "%s/benchmark.json: %s: no sample is left to predict", b->folder,
                           split->name);
    score->rms_N = code ? NAN : sqrt(square / (double)score->samples);
    return code;
}
