/* explain_block.c: runs that press no specimen: in air, and on a rigid block, which gives the frame's
 * compliance. */
#include "explain_data.h"
#include "base/file.h"
#include "data/segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double STIFFER =
    10.0; /* travel to the same force is so much shorter on a block than on a specimen */
static const double NOTHING =
    0.01; /* of the largest force: a run that went half as deep and has less was in air */
static const double LOADED = 0.1; /* of a run's largest force: the block is pressed */

/* Facts of a run before it counts as one of the specimen. */
typedef struct outline {
    size_t n;
    const double *time, *depth, *force; /* mm */
    double peak, deepest;               /* of pairs of neighbours: a lone spike is none */
    double white;                       /* sd of a sample's noise */
    bool constant;                      /* one force from the first sample to the last */
} outline;

static palp_status outline_of(const palp_explain_input *input, outline *o, palp_error *error) {
    const palp_experiment *e = input->experiment;
    *o = (outline){.n = palp_experiment_rows(e),
                   .time = palp_experiment_column(e, "time_s"),
                   .depth = palp_experiment_column(e, "depth_mm"),
                   .force = palp_experiment_column(e, "force_N")};
    if (!o->time || !o->depth || !o->force || o->n < EXPLAIN_SAMPLES_MIN)
        return palp_error_set(error, PALP_ERR_INPUT, "%s: fewer than %d samples of time_s, depth_mm, force_N",
                              input->name ? input->name : "run", EXPLAIN_SAMPLES_MIN);
    o->peak = 0.0;
    o->constant = true;
    o->deepest = o->depth[0];
    for (size_t i = 0; i < o->n; i++) {
        if (!segments_sample_valid(o->time, o->depth, o->force, i))
            return palp_error_set(error, PALP_ERR_INPUT,
                                  "%s: row %zu: not finite, beyond 1e12, or time_s does not increase",
                                  input->name ? input->name : "run", i + 1);
        o->deepest = fmax(o->deepest, o->depth[i]);
        if (i)
            o->peak = fmax(o->peak, fmin(o->force[i], o->force[i - 1]));
        o->constant = o->constant && o->force[i] == o->force[0];
    }
    double step = (o->time[o->n - 1] - o->time[0]) / (double)(o->n - 1);
    return palp_segments_noise(o->n, o->time, step, o->force, PALP_NOISE_MEDIAN, &o->white);
}

/* Depth at which the run first has that force, and keeps it for two samples; NAN: it begins there, or has it
 * never. */
static double depth_at(const outline *o, double force) {
    for (size_t i = 1; i + 1 < o->n && o->force[0] < force; i++)
        if (o->force[i] >= force && o->force[i + 1] >= force) {
            double share = (force - o->force[i - 1]) / fmax(o->force[i] - o->force[i - 1], 1e-300);
            return o->depth[i - 1] + fmax(0.0, share) * (o->depth[i] - o->depth[i - 1]);
        }
    return NAN;
}

/* Whether a has a much shorter way than b from a tenth of a force to all of it. */
static bool much_stiffer(const outline *a, const outline *b) {
    double force = 0.5 * fmin(a->peak, b->peak);
    double near = depth_at(a, force) - depth_at(a, 0.1 * force),
           far = depth_at(b, force) - depth_at(b, 0.1 * force);
    return 0.1 * force > 3.0 * fmax(a->white, b->white) && near >= 0.0 && far > STIFFER * near;
}

/* Whether a run without force may be one in air: its file names no specimen, and it has noise if others
 * have. */
static bool may_be_air(const outline *o, const palp_explain_pressed *pressed, double white) {
    return !pressed->declared && !(o->constant && white > 0.0);
}

palp_status explain_find_pressed(size_t n, const palp_explain_input *inputs, palp_explain_pressed *pressed,
                                 palp_error *error) {
    outline *all = calloc(n, sizeof *all);
    palp_status status = all ? PALP_OK : PALP_ERR_NO_MEMORY;
    double peak = 0.0, deepest = 0.0, white = 0.0;
    for (size_t r = 0; r < n && !status; r++) {
        const char *told = explain_text_of(inputs[r].experiment, "specimen.kind");
        pressed[r].declared = told[0] != '\0';
        pressed[r].object = strcmp(told, "none") == 0    ? PALP_EXPLAIN_AIR
                            : strcmp(told, "rigid") == 0 ? PALP_EXPLAIN_BLOCK
                                                         : PALP_EXPLAIN_SPECIMEN;
        status = outline_of(&inputs[r], &all[r], error);
        white = fmax(white, all[r].white);
        if (pressed[r].object == PALP_EXPLAIN_SPECIMEN) {
            peak = fmax(peak, all[r].peak);
            deepest = fmax(deepest, all[r].deepest);
        }
    }
    for (size_t r = 0; r < n && !status; r++)
        if (pressed[r].object == PALP_EXPLAIN_SPECIMEN && all[r].peak < NOTHING * peak &&
            all[r].deepest > 0.5 * deepest && may_be_air(&all[r], &pressed[r], white))
            pressed[r].object = PALP_EXPLAIN_AIR;
    for (size_t r = 0; r < n && !status; r++)
        for (size_t q = 0; q < n && pressed[r].object == PALP_EXPLAIN_SPECIMEN; q++)
            if (pressed[q].object == PALP_EXPLAIN_SPECIMEN && much_stiffer(&all[r], &all[q]))
                pressed[r].object = PALP_EXPLAIN_BLOCK;
    free(all);
    return status;
}

/* ---- the frame ---- */

enum { PARTS = 8 }; /* of a run, that are left out in turn */

/* Sums over a part of a run on a block, of force and depth. */
typedef struct sums {
    double n, f, d, ff, fd;
} sums;

/* A line of depth over force, with a contact of each run: a run's contribution to the numerator and the
 * denominator of the slope. */
static void add_line(const sums *s, double *over, double *under) {
    if (s->n > 0.0) {
        *over += s->fd - s->f * s->d / s->n;
        *under += s->ff - s->f * s->f / s->n;
    }
}

/* part[PARTS]: of the samples at which the block is pressed, in their order. */
static void sum_parts(const outline *o, sums *part) {
    size_t pressed = 0, at = 0;
    for (size_t i = 0; i < o->n; i++)
        pressed += o->force[i] > LOADED * o->peak;
    for (size_t i = 0; i < o->n; i++) {
        double f = o->force[i], d = 1e-3 * o->depth[i];
        if (!(f > LOADED * o->peak))
            continue;
        sums *s = &part[at++ * PARTS / pressed];
        s->n += 1.0;
        s->f += f;
        s->d += d;
        s->ff += f * f;
        s->fd += f * d;
    }
}

static double slope_without(size_t n_runs, const sums *part, size_t run, size_t left_out) {
    double over = 0.0, under = 0.0;
    for (size_t r = 0; r < n_runs; r++) {
        sums all = {.n = 0.0};
        for (size_t k = 0; k < PARTS; k++) {
            const sums *s = &part[r * PARTS + k];
            if (r == run && k == left_out)
                continue;
            all.n += s->n;
            all.f += s->f;
            all.d += s->d;
            all.ff += s->ff;
            all.fd += s->fd;
        }
        add_line(&all, &over, &under);
    }
    return under > 0.0 ? over / under : 0.0;
}

/* By the jackknife over the parts of the runs, with Student's 97.5 % quantile of as few. */
palp_status explain_block_measure(size_t n, const palp_explain_input *inputs,
                                  const palp_explain_pressed *pressed, explain_frame *frame,
                                  palp_error *error) {
    static const double STUDENT = 2.365, EQUATIONS = 0.01;
    sums *part = calloc(n * PARTS, sizeof *part);
    palp_status status = part ? PALP_OK : PALP_ERR_NO_MEMORY;
    size_t blocks = 0;
    *frame = (explain_frame){.n_runs = 0};
    for (size_t r = 0; r < n && !status; r++) {
        outline o;
        if (pressed[r].object != PALP_EXPLAIN_BLOCK)
            continue;
        status = outline_of(&inputs[r], &o, error);
        if (!status)
            sum_parts(&o, part + PARTS * blocks++);
    }
    if (!status && blocks > 0) {
        const double count = (double)(blocks * PARTS), all = slope_without(blocks, part, blocks, 0);
        double square = 0.0;
        for (size_t r = 0; r < blocks; r++)
            for (size_t k = 0; k < PARTS; k++)
                square += pow(slope_without(blocks, part, r, k) - all, 2) * (count - 1.0) / count;
        double reach = hypot(STUDENT * sqrt(square), EQUATIONS * all);
        *frame = (explain_frame){.n_runs = blocks,
                                 .compliance = fmax(0.0, all),
                                 .low = fmax(0.0, all - reach),
                                 .high = fmax(0.0, all) + reach,
                                 .evidence = 0.5 * all * all / fmax(square, 1e-300)};
    }
    free(part);
    return status;
}

palp_status palp_explain_frame(size_t n, const palp_explain_input *runs, palp_frame *frame,
                               palp_error *error) {
    if (n == 0 || !runs || !frame)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no run on a block");
    palp_explain_pressed *pressed = calloc(n, sizeof *pressed);
    explain_frame found;
    for (size_t r = 0; r < n && pressed; r++)
        pressed[r].object = PALP_EXPLAIN_BLOCK;
    palp_status status =
        pressed ? explain_block_measure(n, runs, pressed, &found, error) : PALP_ERR_NO_MEMORY;
    free(pressed);
    if (status)
        return status;
    if (!(found.compliance > 0.0) || !isfinite(found.high))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: shows no compliance of the frame",
                              runs[0].name ? runs[0].name : "run");
    *frame = (palp_frame){.compliance_m_N = found.compliance, .low_m_N = found.low, .high_m_N = found.high};
    return PALP_OK;
}

/* Whether it changes the specimen's forces by a quarter of a sample's noise. */
static bool matters(const explain_data *data) {
    double change = data->frame.compliance * data->peak / data->deepest * data->peak;
    return data->frame.low > 0.0 && change > 0.25 * data->run[0].white;
}

bool explain_frame_add(const explain_data *data, const palp_explain_settings *settings, palp_model *model) {
    bool room = model->n_effects + settings->max_effects + 3 <= PALP_EFFECTS_MAX, there = false;
    for (size_t i = 0; i < model->n_effects; i++)
        there = there || model->effects[i].id == PALP_EFFECT_FRAME_COMPLIANCE;
    if (there || !room || data->frame.n_runs == 0 || !matters(data))
        return false;
    model->effects[model->n_effects++] =
        (palp_effect){.id = PALP_EFFECT_FRAME_COMPLIANCE, .value = {data->frame.compliance}};
    return true;
}

palp_explain_effect explain_frame_effect(const explain_data *data) {
    const explain_frame *f = &data->frame;
    return (palp_explain_effect){.effect = {.id = PALP_EFFECT_FRAME_COMPLIANCE, .value = {f->compliance}},
                                 .low = {f->low},
                                 .high = {f->high},
                                 .n_class = 1,
                                 .alike = {PALP_EFFECT_FRAME_COMPLIANCE},
                                 .evidence = f->evidence};
}
