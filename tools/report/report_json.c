/* report_json.c: the content of a report's page as JSON: files, recordings, models, results, simulations. */
#define _POSIX_C_SOURCE 200809L
#include "report.h"
#include "shared/json_out.h"

#include <math.h>

static json_t *file_json(const report_file *f) {
    static const char *const kinds[] = {"not used", "recording", "simulation", "model", "result"};
    char date[32] = "-", crc[16];
    struct tm when;
    if (gmtime_r(&f->modified, &when))
        strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S", &when);
    snprintf(crc, sizeof crc, "%08lx", (unsigned long)f->crc);
    return json_pack("{s:o, s:s, s:I, s:s, s:s, s:o}", "file", json_text(f->path), "kind", kinds[f->kind],
                     "bytes", (json_int_t)f->size, "crc32", crc, "modified", date, "note",
                     json_text(f->note));
}

static json_t *recording_json(const report_file *f) {
    json_t *to =
        f->recording.n > 0 ? run_json(&f->recording) : json_pack("{s:o}", "file", json_text(f->path));
    if (f->recording.n > 0 && f->recording.radius_m > 0)
        json_object_set_new(to, "radius_mm", json_real(1e3 * f->recording.radius_m));
    json_object_set_new(to, "note", json_text(f->note));
    return to;
}

static double deepest_strain(const report *r) {
    double most = 0;
    for (size_t i = 0; i < r->n; i++)
        if (r->file[i].recording.n > 0)
            most = fmax(most, r->file[i].recording.deepest_m / r->file[i].recording.height_m);
    return most > 0 ? most : 0.4;
}

/* The model of the file, with its law over the measured strains. */
static json_t *model_json(const report_file *f, double strain_max) {
    enum { POINTS = 41 };
    double strain[POINTS], stiffness[POINTS];
    for (size_t i = 0; i < POINTS; i++) {
        strain[i] = strain_max * (double)i / (POINTS - 1);
        palp_law_stiffness(&f->model.material.law, strain[i], &stiffness[i], NULL);
    }
    return json_pack("{s:o, s:O, s:o, s:o}", "file", json_text(f->path), "model", f->json, "strain",
                     json_numbers(POINTS, strain), "stiffness_N", json_numbers(POINTS, stiffness));
}

static json_t *pair_json(const report_pair *p) {
    const char *model = "-";
    palp_experiment_get_string(p->simulation->experiment, "model.file", &model);
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "simulation", json_text(p->simulation->path), "model",
                     json_text(model), "recording", json_text(p->recording->path), "peak_N",
                     json_number_or_null(p->peak_N), "rms_N", json_number_or_null(p->rms_N),
                     "largest_error_percent", json_number_or_null(p->worst_percent));
}

json_t *report_json(const report *r, const char *title) {
    json_t *files = json_array(), *recordings = json_array(), *models = json_array(), *results = json_array(),
           *simulations = json_array();
    const double strain_max = deepest_strain(r);
    for (size_t i = 0; i < r->n; i++) {
        const report_file *f = &r->file[i];
        json_array_append_new(files, file_json(f));
        if (f->kind == REPORT_RECORDING)
            json_array_append_new(recordings, recording_json(f));
        if (f->kind == REPORT_MODEL)
            json_array_append_new(models, model_json(f, strain_max));
        if (f->kind == REPORT_RESULT)
            json_array_append_new(results,
                                  json_pack("{s:o, s:O}", "file", json_text(f->path), "result", f->json));
    }
    for (size_t i = 0; i < r->n_pairs; i++)
        json_array_append_new(simulations, pair_json(&r->pair[i]));
    return json_pack("{s:{s:i, s:s}, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "palpate", "report", 1, "version",
                     palp_version(), "title", json_text(title), "files", files, "recordings", recordings,
                     "models", models, "results", results, "simulations", simulations, "figures",
                     report_figures(r));
}
