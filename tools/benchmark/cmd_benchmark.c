/* cmd_benchmark.c: palpate benchmark: held-out errors of several programs on fixed splits, in one table. */
#define _XOPEN_SOURCE 700
#include "benchmark.h"
#include "shared/commands.h"
#include "shared/json_out.h"
#include "shared/temporary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct benchmark_options {
    const char *out;
    bool json;
    char command[CLI_COMMAND_MAX];
} benchmark_options;

static int parse(int argc, char **argv, benchmark_options *o, const char **folder) {
    const cli_option options[] = {
        cli_heading("Output"),
        cli_out("out", "TABLE.csv", &o->out, "the table as CSV: a row for each split and program"),
        cli_flag("json", &o->json, "the table as JSON on standard output"),
    };
    const cli_command command = {
        BENCHMARK_NAME,
        "DIR [--out TABLE.csv] [--json]",
        "Compares forces that programs predict for runs that they were not fitted to. DIR/benchmark.json\n"
        "lists the splits: runs to fit and runs to predict. palpate fits and predicts them itself. The\n"
        "forces of another program are CSV files with the columns of a run (time_s, depth_mm, force_N):\n"
        "DIR/predictions/PROGRAM/SPLIT/ has one for each run to predict, with the run's name. Each number\n"
        "is the rms of predicted minus recorded force, as a share of the largest recorded force.",
        "  palpate benchmark data/benchmark --out table.csv\n",
        options,
        sizeof options / sizeof options[0]};
    size_t n = 0;
    int code = cli_parse(&command, argc, argv, folder, 1, &n);
    return code == CLI_OK && n == 0
               ? cli_usage_error(BENCHMARK_NAME,
                                 "name a folder with a benchmark.json; see palpate benchmark --help")
               : code;
}

/* ---- palpate's own predictions, in a folder for a moment ---- */

static int score_own(const benchmark *b, const benchmark_split *split, const benchmark_program *program,
                     benchmark_score *score) {
    char folder[CLI_PATH_MAX];
    int code = temporary_folder_make(BENCHMARK_NAME, folder);
    if (code)
        return code;
    code = benchmark_predict(b, program, split, folder);
    if (code == CLI_OK)
        code = benchmark_find(b, split, program, folder, score);
    temporary_folder_remove(folder);
    return code;
}

/* ---- the table ---- */

static double share_of(const benchmark_score *s) {
    return s->there && s->peak_N > 0 ? s->rms_N / s->peak_N : NAN;
}

static json_t *row_json(const benchmark_split *split, const benchmark_program *program,
                        const benchmark_score *s) {
    json_t *row = json_object();
    json_object_set_new(row, "split", json_text(split->name));
    json_object_set_new(row, "leaves_out", json_text(split->leaves_out));
    json_object_set_new(row, "program", json_text(program->name));
    json_object_set_new(row, "samples", json_integer((json_int_t)s->samples));
    json_figures(row, {"rms_N", s->there ? s->rms_N : NAN}, {"peak_N", s->there ? s->peak_N : NAN},
                 {"share", share_of(s)});
    return row;
}

static void print_text(const benchmark *b, const benchmark_score *score) {
    printf("rms of predicted minus recorded force on runs left out, %% of the peak (- = not handed in)\n");
    printf("%-24s%-16s", "split", "leaves out");
    for (size_t p = 0; p < b->n_programs; p++)
        printf("  %12s", b->program[p].name);
    putchar('\n');
    for (size_t i = 0; i < b->n_splits; i++) {
        printf("%-24s%-16s", b->split[i].name, b->split[i].leaves_out);
        for (size_t p = 0; p < b->n_programs; p++) {
            const double share = share_of(&score[i * b->n_programs + p]);
            if (isnan(share))
                printf("  %12s", "-");
            else
                printf("  %*.3g", (int)fmax(12, (double)strlen(b->program[p].name)), 100 * share);
        }
        putchar('\n');
    }
}

static int write_csv(const benchmark *b, const benchmark_score *score, const char *path) {
    palp_file file;
    int code = cli_file_open(BENCHMARK_NAME, path, &file);
    if (code)
        return code;
    fprintf(file.stream, "split,leaves_out,program,samples,rms_N,peak_N,share\n");
    for (size_t k = 0; k < b->n_splits * b->n_programs; k++) {
        const benchmark_split *s = &b->split[k / b->n_programs];
        if (score[k].there)
            fprintf(file.stream, "%s,%s,%s,%zu,%.6g,%.6g,%.6g\n", s->name, s->leaves_out,
                    b->program[k % b->n_programs].name, score[k].samples, score[k].rms_N, score[k].peak_N,
                    share_of(&score[k]));
    }
    return cli_file_close(BENCHMARK_NAME, &file);
}

static int tell(const benchmark_options *o, const benchmark *b, const benchmark_score *score) {
    int code = o->out ? write_csv(b, score, o->out) : CLI_OK;
    if (!o->json && (!o->out || strcmp(o->out, "-") != 0))
        print_text(b, score);
    if (code || !o->json)
        return code ? code : cli_flush(BENCHMARK_NAME);
    json_t *root = json_object(), *rows = json_array();
    for (size_t k = 0; k < b->n_splits * b->n_programs; k++)
        json_array_append_new(
            rows, row_json(&b->split[k / b->n_programs], &b->program[k % b->n_programs], &score[k]));
    json_object_set_new(root, "palpate", json_pack("{s:i}", "benchmark_result", 1));
    json_object_set_new(root, "command", json_text(o->command));
    json_object_set_new(root, "rows", rows);
    return json_print(BENCHMARK_NAME, root);
}

int cmd_benchmark(int argc, char **argv) {
    benchmark_options o = {.out = NULL};
    const char *folder = NULL;
    cli_keep_command(argc, argv, o.command);
    int code = parse(argc, argv, &o, &folder);
    if (code)
        return code == CLI_HELP ? CLI_OK : code;
    benchmark *b = calloc(1, sizeof *b);
    benchmark_score *score = calloc(BENCHMARK_SPLITS * BENCHMARK_PROGRAMS, sizeof *score);
    code = b && score ? benchmark_read(folder, b) : cli_failure(BENCHMARK_NAME, "out of memory");
    for (size_t i = 0; code == CLI_OK && i < b->n_splits; i++)
        for (size_t p = 0; code == CLI_OK && p < b->n_programs; p++) {
            benchmark_score *s = &score[i * b->n_programs + p];
            code = b->program[p].own ? score_own(b, &b->split[i], &b->program[p], s)
                                     : benchmark_find(b, &b->split[i], &b->program[p], NULL, s);
        }
    if (code == CLI_OK)
        code = tell(&o, b, score);
    if (b)
        json_decref(b->root);
    free(b);
    free(score);
    return code;
}
