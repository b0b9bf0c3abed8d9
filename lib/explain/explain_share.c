/* explain_share.c: how much of an effect these runs can show at all: what is left of its column beside the
 * richest law, arms, contacts and zeros that they could carry, and not only beside the model at hand. */
#include "explain_search.h"
#include "explain_noise.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of an effect of which a twentieth is left, a fault of the law as large as a twentieth of the effect looks
 * the same, and no law is known better than to some percent. */
static const double LEAST = 0.05;

size_t explain_rich_law(const explain_data *data) {
    const size_t a_coefficient = 20; /* samples, at least */
    size_t n = explain_samples(data) / a_coefficient;
    return n < PALP_LAW_MAX ? n : PALP_LAW_MAX;
}

size_t explain_rich_arms(const explain_search *s) {
    enum { ARMS = 8 };
    size_t room = PALP_ARMS_MAX - s->fit.model.material.n_arms;
    return room < ARMS ? room : ARMS;
}

/* Chebyshev's polynomials of depth, all of them 0 at the surface: [n_law n]. */
static void law_columns(const explain_data *data, const explain_run *run, double contact, size_t n_law,
                        double *column) {
    for (size_t i = 0; i < run->n; i++) {
        double x = fmin(1.0, fmax(0.0, (run->depth[i] - contact) / data->deepest)),
               turn = acos(2.0 * x - 1.0);
        for (size_t j = 0; j < n_law; j++)
            column[j * run->n + i] = x * cos((double)j * turn);
    }
}

/* Arms of times from two samples to three times the longest run: [n_arms n], the derivatives by their
 * stiffness. */
static palp_status arm_columns(const explain_search *s, size_t r, size_t n_arms, double *column) {
    const explain_run *run = &s->data.run[r];
    const double low = 2.0 * s->data.step, high = 3.0 * s->data.duration,
                 slight = 1e-6 * s->data.peak * s->data.height / s->data.deepest;
    palp_model model = s->fit.model;
    palp_material *m = &model.material;
    const size_t n = run->n, first = m->law.n + 2 * m->n_arms, given = m->n_arms;
    for (size_t j = 0; j < n_arms; j++) {
        double part = n_arms > 1 ? (double)j / (double)(n_arms - 1) : 0.5;
        m->arms[m->n_arms++] =
            (palp_arm){.stiffness_N = slight, .viscosity_Ns = slight * low * pow(high / low, part)};
    }
    double *force = malloc((1 + palp_forward_parameter_count(&model)) * n * sizeof *force);
    explain_history history = {.renewed = s->fit.renewed, .load.peak = run->largest_strain};
    palp_forward_run path = explain_forward_run(run, s->fit.contact[r], &history);
    palp_status status = force ? explain_predict(&model, &path, force, force + n, NULL) : PALP_ERR_NO_MEMORY;
    for (size_t j = 0; j < n_arms && !status; j++) {
        const double *by_stiffness = force + (1 + first + 2 * j) * n, *by_viscosity = by_stiffness + n;
        const double time = m->arms[given + j].viscosity_Ns / slight;
        for (size_t i = 0; i < n; i++)
            column[j * n + i] = by_stiffness[i] + time * by_viscosity[i];
    }
    if (status)
        memset(column, 0, n_arms * n * sizeof *column);
    palp_load_history_free(&history.load);
    free(force);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status explain_rich_columns(const explain_search *s, size_t r, double *column) {
    const explain_run *run = &s->data.run[r];
    const size_t n_law = explain_rich_law(&s->data);
    law_columns(&s->data, run, s->fit.contact[r], n_law, column);
    return arm_columns(s, r, explain_rich_arms(s), column + n_law * run->n);
}

/* Of the specimen's own effects the evidence is widened by what their estimates lean on the law's faults
 * (explain_widen.c); only the instrument and the contact are not to be accused of them at all. */
bool explain_shows(const explain_search *s, palp_effect_id id) {
    const effect_row *row = effect_row_of(id);
    const effect_data facts = explain_facts(&s->data);
    effect_read off;
    return row->info.place == PALP_EFFECT_SPECIMEN || row->line || (row->read && row->read(&facts, &off)) ||
           s->share[id] >= LEAST;
}

/* Whether these runs lack something for an effect, whatever is left of it; what, in words. */
static bool lacks(const explain_search *s, palp_effect_id id, char text[EFFECT_LACK_MAX]) {
    const effect_row *row = effect_row_of(id);
    const effect_data facts = explain_facts(&s->data);
    snprintf(text, EFFECT_LACK_MAX, "a model of this kind cannot have it");
    return !explain_carries(&s->fit.model, &row->info) || !effect_need_met(row, &facts, text);
}

bool explain_blind(const explain_search *s, palp_effect_id id) {
    char text[EFFECT_LACK_MAX];
    bool given = false;
    for (size_t i = 0; i < s->n_given; i++)
        given = given || (s->fit.model.effects[i].id == id && !palp_effect_look_up(id)->repeats);
    return !given && (s->data.one_speed || lacks(s, id, text) || !explain_shows(s, id));
}

void explain_say_blind(const explain_search *s, palp_effect_id id, char text[PALP_EXPLAIN_REASON]) {
    char lack[EFFECT_LACK_MAX];
    const double percent = 100.0 * s->share[id];
    if (lacks(s, id, lack))
        snprintf(text, PALP_EXPLAIN_REASON, "%s", lack);
    else if (s->data.one_speed)
        snprintf(text, PALP_EXPLAIN_REASON,
                 "the runs press at one speed, with no pause or way back: %.2g %% of it is left beside the "
                 "law and arms; "
                 "needed: %s",
                 percent, palp_effect_look_up(id)->seen_by);
    else
        snprintf(text, PALP_EXPLAIN_REASON,
                 "%.2g %% of it is left beside the richest law, arms, contacts and zeros; needed: %s",
                 percent, palp_effect_look_up(id)->seen_by);
}
