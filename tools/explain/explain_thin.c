/* explain_thin.c: every so-many-th sample of a run: picked, not averaged, so that what is fast keeps its
 * size. */
#include "explain.h"

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

palp_status explain_thin(palp_experiment **run, size_t every) {
    static const char *const columns[] = {"time_s", "depth_mm", "force_N"};
    palp_experiment *thin = NULL;
    size_t rows = (palp_experiment_rows(*run) + every - 1) / every;
    palp_status status = palp_experiment_create(rows, &thin);
    status = status ? status : copy_keys(*run, thin);
    for (size_t c = 0; c < 3 && !status; c++) {
        const double *from = palp_experiment_column(*run, columns[c]);
        double *to = palp_experiment_column(thin, columns[c]);
        for (size_t i = 0; i < rows; i++)
            to[i] = from[i * every];
    }
    if (status) {
        palp_experiment_free(thin);
        return status;
    }
    palp_experiment_free(*run);
    *run = thin;
    return PALP_OK;
}
