/* explain_knots.c: a spline law with more knots where it bends most: at a knee a few do what many do that are
 * evenly spread. Each costs what an even one does, and besides what choosing its place among all knots does.
 */
#include "explain_search.h"

#include <math.h>
#include <string.h>

enum { DEEPER = 3, PLACES = 2 }; /* how often in turn, and at how many bends each time */

/* The law with knots more in the middle of the intervals on both sides of knot i. */
static palp_status halve(const palp_law *law, size_t i, palp_law *finer) {
    double strain[PALP_LAW_MAX], stiffness[PALP_LAW_MAX];
    size_t n = 0;
    if (law->n + 2 > PALP_LAW_MAX)
        return PALP_ERR_LIMIT;
    for (size_t k = 0; k < law->n; k++) {
        strain[n] = law->strain[k];
        stiffness[n++] = law->coefficients[k];
        if (k + 1 != i && k != i)
            continue;
        strain[n] = 0.5 * (law->strain[k] + law->strain[k + 1]);
        palp_law_stiffness(law, strain[n], &stiffness[n], NULL);
        n++;
    }
    palp_status status = palp_law_spline(n, strain, stiffness, finer);
    return status || !(law->strain_max > 0.0) ? status : palp_law_limit(finer, law->strain_max);
}

/* By how much the slope of the force changes at inner knot i. */
static double bend(const palp_law *law, size_t i) {
    const double *k = law->coefficients, *e = law->strain;
    return e[i] * fabs((k[i + 1] - k[i]) / (e[i + 1] - e[i]) - (k[i] - k[i - 1]) / (e[i] - e[i - 1]));
}

/* The inner knots of the sharpest bends, sharpest first. */
static size_t sharpest(const palp_law *law, size_t at[PLACES]) {
    size_t n = 0;
    for (size_t i = 1; i + 1 < law->n; i++) {
        size_t place = n;
        while (place > 0 && bend(law, at[place - 1]) < bend(law, i))
            place--;
        if (place == PLACES)
            continue;
        n += n < PLACES;
        memmove(at + place + 1, at + place, (n - 1 - place) * sizeof *at);
        at[place] = i;
    }
    return n;
}

static palp_status fit_with(const explain_search *s, const explain_fit *from, const palp_law *law,
                            explain_fit *fit) {
    palp_model model = from->model;
    model.material.law = *law;
    palp_status status = explain_fit_beside(from, &model, &s->data, fit);
    return status ? status : explain_fit_settle_anew(fit, &s->data, s->settings);
}

/* from with more knots at that one of its sharpest bends where it gains most. ERR_ARGUMENT: there is none. */
static palp_status add_knots(const explain_search *s, const explain_fit *from, explain_fit *best) {
    size_t at[PLACES];
    const size_t n = sharpest(&from->model.material.law, at);
    memset(best, 0, sizeof *best);
    for (size_t k = 0; k < n; k++) {
        explain_fit fit = {.n_columns = 0};
        palp_law finer;
        palp_status status = halve(&from->model.material.law, at[k], &finer);
        if (!status)
            status = fit_with(s, from, &finer, &fit);
        const bool better = !status && (!best->product || fit.score > best->score);
        explain_fit_free(better ? best : &fit);
        if (better)
            *best = fit;
        if (status == PALP_ERR_NO_MEMORY)
            return status;
    }
    return best->product ? PALP_OK : PALP_ERR_ARGUMENT;
}

double explain_knots_cost(const explain_search *s, size_t n) {
    const size_t now = s->fit.model.material.law.n;
    return n > now ? 0.5 * (double)(n - now) * log((double)now) : 0.0;
}

static double worth(const explain_search *s, const explain_fit *fit) {
    const size_t n = fit->model.material.law.n;
    return fit->score - explain_knots_cost(s, n) - 0.5 * (double)n * log((double)s->data.n);
}

palp_status explain_knots_add(const explain_search *s, explain_fit *best) {
    explain_fit last = {.n_columns = 0};
    palp_status status = PALP_OK;
    memset(best, 0, sizeof *best);
    for (int k = 0; k < DEEPER && !status; k++) {
        explain_fit next;
        status = add_knots(s, k ? &last : &s->fit, &next);
        explain_fit_free(&last);
        last = next;
        if (status || (best->product && !(worth(s, &last) > worth(s, best))))
            continue;
        explain_fit_free(best);
        status = explain_fit_copy(&last, s->data.n_runs, best);
        best->spread = s->settings;
    }
    explain_fit_free(&last);
    return status == PALP_ERR_NO_MEMORY ? status : best->product ? PALP_OK : PALP_ERR_ARGUMENT;
}
