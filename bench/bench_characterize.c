/* bench_characterize.c: twelve recordings of 200 s at 1 kHz, then one of ten million rows (1000 s at 10 kHz):
 * reading them beside a plain fscanf reader, preparing them, and one fit of two shared arms. */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RUNS = 12, SAMPLES = 202001, MANY = 10000001 };

/* Noise enough to make digits: a congruential generator, twelve uniforms to a normal. */
static double noise(unsigned long long *state) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        *state = *state * 6364136223846793005ULL + 1442695040888963407ULL;
        sum += (double)(*state >> 11) / 9007199254740992.0;
    }
    return sum;
}

static void write_run(const char *path, int run, int samples, double step) {
    const double k = 8.5;
    palp_material m = {.n_arms = 2, .arms = {{2.5847711, 3.6146, 0, 0}, {0.6853036, 23.964533, 0, 0}}};
    palp_experiment *e;
    palp_element_state s = {0};
    unsigned long long state = (unsigned long long)run + 1;
    bench_check(palp_law_polynomial(1, &k, &m.law), "law");
    bench_check(palp_experiment_create((size_t)samples, &e), "experiment");
    double *t = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
           *f = palp_experiment_column(e, "force_N"), depth = 1.5 + 0.5 * run;
    for (int i = 0; i < samples; i++) {
        t[i] = step * i;
        d[i] = round(1e6 * depth * fmin(t[i] - 1.0, 1.0)) / 1e6;
        bench_check(palp_element_advance(&m, &s, fmax(d[i], 0.0) / 24.0, i ? step : 0.0, &s, NULL), "step");
        f[i] = round(1e9 * (s.force_N + 0.004 * noise(&state))) / 1e9;
    }
    bench_check(palp_experiment_set_number(e, "specimen.height_mm", 24.0), "key");
    bench_check(palp_experiment_set_string(e, "protocol.kind", "ramp_hold"), "key");
    bench_check(palp_experiment_write(e, path, NULL), "write");
    palp_experiment_free(e);
}

/* What a reader of an afternoon does: skip the header, fscanf three numbers a row. */
static double plain_reader(const char *path) {
    double before = bench_seconds(), t, d, f, sum = 0.0;
    FILE *file = fopen(path, "r");
    char line[512];
    while (file && fgets(line, sizeof line, file) && strncmp(line, "time_s", 6) != 0)
        ;
    while (file && fscanf(file, "%lf,%lf,%lf", &t, &d, &f) == 3)
        sum += f;
    if (file)
        fclose(file);
    return sum > 0.0 ? bench_seconds() - before : NAN;
}

static void bench_runs(int n, int samples, double step, const char *what) {
    char path[] = "/tmp/palpate-bench-XXXXXX";
    palp_recording runs[RUNS];
    palp_recording_settings settings = palp_recording_settings_default();
    double read = 0.0, prepare = 0.0, plain = 0.0, bytes = 0.0;
    int descriptor = mkstemp(path);
    if (descriptor < 0)
        exit(1);
    close(descriptor);
    for (int r = 0; r < n; r++) {
        palp_experiment *e;
        struct stat info;
        write_run(path, r, samples, step);
        plain += plain_reader(path);
        double t0 = bench_seconds();
        bench_check(palp_experiment_read(path, &e, NULL), "read");
        double t1 = bench_seconds();
        bench_check(palp_recording_prepare(e, "run.csv", &settings, &runs[r], NULL), "prepare");
        prepare += bench_seconds() - t1;
        read += t1 - t0;
        bytes += stat(path, &info) == 0 ? (double)info.st_size : 0.0;
        palp_experiment_free(e);
    }
    unlink(path);
    palp_characterize_settings fit = palp_characterize_settings_default();
    palp_lumped_fit result;
    fit.n_arms = 2;
    double t0 = bench_seconds();
    bench_check(palp_characterize_fit((size_t)n, runs, &fit, &result, NULL), "fit");
    double spent = bench_seconds() - t0;
    printf("characterize, %s, two shared arms\n", what);
    printf("  read %.2f s (%.0f MB/s, at least 100; plain fscanf %.0f MB/s, ratio %.1f), prepare %.2f s, fit "
           "%.2f s\n",
           read, 1e-6 * bytes / read, 1e-6 * bytes / plain, plain / read, prepare, spent);
    printf("  together %.2f s\n", read + prepare + spent);
    palp_lumped_fit_free(&result);
    for (int r = 0; r < n; r++)
        palp_recording_free(&runs[r]);
}

int main(void) {
    bench_runs(RUNS, SAMPLES, 1e-3, "12 runs of 200 s at 1 kHz (at most 3 s)");
    bench_runs(1, MANY, 1e-4, "one run of 10^7 rows (at most 10 s)");
    return 0;
}
