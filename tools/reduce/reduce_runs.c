/* reduce_runs.c: the runs of palpate reduce: the plate's depth, and the path of a ball. */
#include "reduce.h"
#include "shared/opening.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "reduce";
static const char *const COLUMN[3] = {"tool_x_mm", "tool_y_mm", "tool_z_mm"};

void reduce_run_free(reduce_run *run) {
    free(run->time_s);
    free(run->depth_m);
    free(run->tool);
    palp_snapshots_free(run->snapshots);
}

/* Reads the ball's radius and friction; a run with one tool column needs all. */
static int tool_read(const char *file, const palp_experiment *from, palp_tool *tool,
                     const double *column[3]) {
    size_t there = 0;
    double radius_mm = 0;
    for (int k = 0; k < 3; k++) {
        column[k] = palp_experiment_column(from, COLUMN[k]);
        there += column[k] != NULL;
    }
    if (there == 0)
        return CLI_OK;
    if (there < 3)
        return cli_failure(NAME, "%s: a tool needs the columns tool_x_mm, tool_y_mm and tool_z_mm", file);
    if (palp_experiment_get_number(from, "tool.radius_mm", &radius_mm) || !(radius_mm > 0))
        return cli_failure(NAME, "%s: a tool needs the key tool.radius_mm, a number above 0", file);
    *tool = (palp_tool){.shape = PALP_TOOL_SPHERE, .radius_m = 1e-3 * radius_mm};
    if (palp_experiment_get_number(from, "tool.friction", &tool->friction))
        tool->friction = 0;
    return tool->friction >= 0 ? CLI_OK : cli_failure(NAME, "%s: tool.friction must not be negative", file);
}

static int fill(const palp_experiment *from, size_t samples, const palp_tool *tool,
                const double *const column[3], reduce_run *run) {
    size_t rows = palp_experiment_rows(from), n = rows < samples ? rows : samples;
    const double *time_s = palp_experiment_column(from, "time_s"),
                 *depth_mm = palp_experiment_column(from, "depth_mm");
    run->n = n;
    run->time_s = malloc(n * sizeof *run->time_s);
    run->depth_m = malloc(n * sizeof *run->depth_m);
    run->tool = column[0] ? malloc(n * sizeof *run->tool) : NULL;
    if (!run->time_s || !run->depth_m || (column[0] && !run->tool))
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    for (size_t i = 0; i < n; i++) {
        size_t row = n > 1 ? i * (rows - 1) / (n - 1) : 0;
        run->time_s[i] = time_s[row] - time_s[0];
        run->depth_m[i] = 1e-3 * fmax(depth_mm[row], 0);
        if (run->tool) {
            run->tool[i] = *tool;
            for (int k = 0; k < 3; k++)
                run->tool[i].position_m[k] = 1e-3 * column[k][row];
        }
    }
    return CLI_OK;
}

int reduce_run_read(const char *file, size_t samples, reduce_run *run) {
    palp_experiment *from = NULL;
    palp_tool tool = {.shape = PALP_TOOL_SPHERE};
    const double *column[3];
    run->file = file;
    int code = open_run(NAME, file, &from);
    if (code)
        return code;
    code = palp_experiment_rows(from) < 2
               ? cli_failure(NAME, "%s: needs at least two samples to follow", file)
               : tool_read(file, from, &tool, column);
    palp_status status = code == CLI_OK ? open_smooth_path(from) : PALP_OK;
    if (status)
        code = cli_failure(NAME, "%s: %s", file, palp_status_text(status));
    if (code == CLI_OK)
        code = fill(from, samples, &tool, column, run);
    palp_experiment_free(from);
    return code;
}
