/* open_runs.c: runs for one fit of all: every so-many-th sample, picked, not averaged, so that what is fast
 * keeps its size. */
#include "opening.h"

#include "cli.h"

static const char *const NUMBERS[] = {"specimen.height_mm", "specimen.radius_mm", "session.start_s",
                                      "protocol.order",     "protocol.repeat",    "protocol.depth_mm",
                                      "protocol.rate_mm_s", "protocol.ramp_s",    "protocol.hold_s",
                                      "protocol.cycles",    "contact.sd_mm"};
static const char *const TEXTS[] = {"specimen.kind", "specimen.name", "protocol.kind", "contact.rule",
                                    "end.fault"};

static palp_status copy_keys(const palp_experiment *from, palp_experiment *to) {
    palp_status status = PALP_OK;
    double number;
    const char *text;
    for (size_t i = 0; i < sizeof NUMBERS / sizeof NUMBERS[0] && !status; i++)
        if (!palp_experiment_get_number(from, NUMBERS[i], &number))
            status = palp_experiment_set_number(to, NUMBERS[i], number);
    for (size_t i = 0; i < sizeof TEXTS / sizeof TEXTS[0] && !status; i++)
        if (!palp_experiment_get_string(from, TEXTS[i], &text))
            status = palp_experiment_set_string(to, TEXTS[i], text);
    return status;
}

static palp_status thin(palp_experiment **run, size_t every) {
    static const char *const columns[] = {"time_s", "depth_mm", "force_N"};
    palp_experiment *fewer = NULL;
    size_t rows = (palp_experiment_rows(*run) + every - 1) / every;
    palp_status status = palp_experiment_create(rows, &fewer);
    status = status ? status : copy_keys(*run, fewer);
    for (size_t c = 0; c < 3 && !status; c++) {
        const double *from = palp_experiment_column(*run, columns[c]);
        double *to = palp_experiment_column(fewer, columns[c]);
        for (size_t i = 0; i < rows; i++)
            to[i] = from[i * every];
    }
    if (status) {
        palp_experiment_free(fewer);
        return status;
    }
    palp_experiment_free(*run);
    *run = fewer;
    return PALP_OK;
}

int open_runs(const char *command, size_t n, const char *const *files, size_t every, palp_experiment **run,
              palp_explain_input *input) {
    enum { ROWS = 20000 };
    size_t rows = 0;
    for (size_t r = 0; r < n; r++) {
        int code = open_run(command, files[r], &run[r]);
        if (code)
            return code;
        rows += palp_experiment_rows(run[r]);
    }
    const size_t picked = every ? every : 1 + rows / ROWS;
    for (size_t r = 0; r < n; r++) {
        palp_status status = picked > 1 ? thin(&run[r], picked) : PALP_OK;
        if (status)
            return cli_status_of(command, files[r], status, NULL);
        input[r] = (palp_explain_input){run[r], files[r]};
    }
    if (picked > 1 && !every)
        cli_note(command, "one sample in %zu of each run is taken", picked);
    return CLI_OK;
}
