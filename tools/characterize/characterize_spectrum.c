/* characterize_spectrum.c: storage and loss against frequency, of runs that oscillate and of the model. */
#include "characterize.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";
static const double Z95 = 1.96;

/* Of all runs. */
static size_t count_points(const characterize_state *s) {
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        n += s->spectrum[i].n;
    return n;
}

/* Pa, of the cylinder; NaN without a radius. */
static double modulus(const palp_recording *r, double stiffness_N_m) {
    const double pi = 3.14159265358979323846;
    return r->radius_m > 0 ? stiffness_N_m * r->height_m / (pi * r->radius_m * r->radius_m) : NAN;
}

/* Storage and loss of the model about a depth. */
static palp_status model_spectrum(const characterize_state *s, const palp_material *m, double depth_m,
                                  size_t n, const double *frequency_Hz, double *storage_N_m,
                                  double *loss_N_m) {
    double height = s->run[0].height_m;
    return palp_lumped_oscillation(m, height, depth_m / height, n, frequency_Hz, storage_N_m, loss_N_m);
}

int characterize_measure_spectra(characterize_state *s) {
    for (size_t i = 0; i < s->n; i++) {
        if (s->run[i].kind != PALP_RECORDING_OTHER)
            continue;
        palp_status status = palp_spectrum_measure(&s->run[i], &s->spectrum[i]);
        if (status)
            return cli_status_of(NAME, s->run[i].name, status, NULL);
    }
    return CLI_OK;
}

void characterize_print_spectrum(const characterize_state *s) {
    if (count_points(s) == 0)
        return;
    printf("Storage and loss stiffness by the driven frequency (+- 95 %%), and the model's\n");
    printf("  frequency (Hz)   storage (N/m)          model   loss (N/m)             model   run\n");
    for (size_t i = 0; i < s->n; i++) {
        for (size_t k = 0; k < s->spectrum[i].n; k++) {
            const palp_spectrum_point *p = &s->spectrum[i].point[k];
            double storage = NAN, loss = NAN;
            model_spectrum(s, &s->material, p->depth_m, 1, &p->frequency_Hz, &storage, &loss);
            printf("  %14.5g   %9.5g +-%-8.2g %9.5g   %9.4g +-%-8.2g %9.4g   %s\n", p->frequency_Hz,
                   p->storage_N_m, Z95 * p->storage_sd_N_m, storage, p->loss_N_m, Z95 * p->loss_sd_N_m, loss,
                   s->run[i].name);
        }
    }
}

static json_t *point_json(const characterize_state *s, size_t run, const palp_spectrum_point *p) {
    const palp_recording *r = &s->run[run];
    double storage = NAN, loss = NAN;
    json_t *to = json_object();
    json_object_set_new(to, "file", json_text(r->name));
    model_spectrum(s, &s->material, p->depth_m, 1, &p->frequency_Hz, &storage, &loss);
    json_figures(to, {"frequency_Hz", p->frequency_Hz}, {"from_s", p->from_s}, {"to_s", p->to_s},
                 {"cycles", p->cycles}, {"depth_mm", 1e3 * p->depth_m},
                 {"amplitude_mm", 1e3 * p->amplitude_m}, {"storage_N_m", p->storage_N_m},
                 {"storage_low_N_m", p->storage_N_m - Z95 * p->storage_sd_N_m},
                 {"storage_high_N_m", p->storage_N_m + Z95 * p->storage_sd_N_m}, {"loss_N_m", p->loss_N_m},
                 {"loss_low_N_m", p->loss_N_m - Z95 * p->loss_sd_N_m},
                 {"loss_high_N_m", p->loss_N_m + Z95 * p->loss_sd_N_m}, {"model_storage_N_m", storage},
                 {"model_loss_N_m", loss}, {"storage_Pa", modulus(r, p->storage_N_m)},
                 {"loss_Pa", modulus(r, p->loss_N_m)});
    return to;
}

json_t *characterize_spectrum_json(const characterize_state *s) {
    json_t *list = json_array();
    for (size_t i = 0; i < s->n; i++)
        for (size_t k = 0; k < s->spectrum[i].n; k++)
            json_array_append_new(list, point_json(s, i, &s->spectrum[i].point[k]));
    return list;
}

/* Range of the model's curve: from the longest run or the lowest driven frequency to twice the highest.
 * Without oscillation it ends at the rate of the fastest ramp. */
static void range_of(const characterize_state *s, double *low, double *high) {
    bool driven = count_points(s) > 0;
    *low = HUGE_VAL;
    *high = 0;
    for (size_t i = 0; i < s->n; i++) {
        const palp_recording *r = &s->run[i];
        if (s->material.n_arms > 0 || !driven)
            *low = fmin(*low, 0.159 / (r->end_s - r->ramp_start_s));
        if (!driven && r->ramp_end_s > r->ramp_start_s)
            *high = fmax(*high, 0.159 / (r->ramp_end_s - r->ramp_start_s));
        for (size_t k = 0; k < s->spectrum[i].n; k++) {
            *low = fmin(*low, 0.5 * s->spectrum[i].point[k].frequency_Hz);
            *high = fmax(*high, 2 * s->spectrum[i].point[k].frequency_Hz);
        }
    }
    *high = fmax(*high, *low);
}

static void write_name(FILE *to, const char *name) {
    bool plain = !strpbrk(name, ",\"\n");
    if (!plain)
        fputc('"', to);
    for (; *name; name++)
        fprintf(to, *name == '"' ? "\"\"" : "%c", *name);
    if (!plain)
        fputc('"', to);
}

static void write_points(FILE *to, const characterize_state *s, size_t run) {
    for (size_t k = 0; k < s->spectrum[run].n; k++) {
        const palp_spectrum_point *p = &s->spectrum[run].point[k];
        double storage = Z95 * p->storage_sd_N_m, loss = Z95 * p->loss_sd_N_m,
               pascal = modulus(&s->run[run], 1.0);
        write_name(to, cli_base(s->run[run].name));
        fprintf(to, ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", p->frequency_Hz, 1e3 * p->depth_m,
                p->storage_N_m, p->storage_N_m - storage, p->storage_N_m + storage, p->loss_N_m,
                p->loss_N_m - loss, p->loss_N_m + loss);
        fprintf(to, isfinite(pascal) ? ",%.9g,%.9g\n" : ",,\n", pascal * p->storage_N_m,
                pascal * p->loss_N_m);
    }
}

/* The model's curve about the depth of the first spectrum, else of the first run, ten points a decade. */
static int write_model(FILE *to, const characterize_state *s) {
    double low, high, depth = s->run[0].deepest_m, pascal = modulus(&s->run[0], 1.0);
    range_of(s, &low, &high);
    for (size_t i = s->n; i-- > 0;)
        depth = s->spectrum[i].n ? s->spectrum[i].point[0].depth_m : depth;
    size_t n = 1 + (size_t)ceil(10 * log10(high / low));
    for (size_t k = 0; k < n; k++) {
        double storage, loss, frequency = low * pow(10, (double)k / 10);
        palp_status status = model_spectrum(s, &s->material, depth, 1, &frequency, &storage, &loss);
        if (status)
            return cli_status_of(NAME, "the model's spectrum", status, NULL);
        fprintf(to, "model,%.9g,%.9g,%.9g,,,%.9g,,", frequency, 1e3 * depth, storage, loss);
        fprintf(to, isfinite(pascal) ? ",%.9g,%.9g\n" : ",,\n", pascal * storage, pascal * loss);
    }
    return CLI_OK;
}

int characterize_write_spectrum(const char *path, const characterize_state *s) {
    palp_file file;
    int code = cli_file_open(NAME, path, &file);
    if (code)
        return code;
    fputs("run,frequency_Hz,depth_mm,storage_N_m,storage_low_N_m,storage_high_N_m,loss_N_m,loss_low_N_m,loss_"
          "high_N_m,storage_Pa,loss_Pa\n",
          file.stream);
    for (size_t i = 0; i < s->n; i++)
        write_points(file.stream, s, i);
    code = write_model(file.stream, s);
    if (code) {
        palp_file_abandon(&file);
        return code;
    }
    return cli_file_close(NAME, &file);
}
