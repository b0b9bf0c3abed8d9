/* characterize_compare.c: the model against its runs, static runs against holds and each other. */
#include "characterize.h"

#include <math.h>
#include <stdlib.h>

static const char NAME[] = "characterize";

/* ---- static against ramp and hold, Figure 4.26 ---- */

static void compare_springs(characterize_state *s) {
    double before = 0, after = 0;
    const palp_lumped_fit *shared = &s->shared;
    for (size_t i = 0; i < s->n_hold && (s->has_shared || s->n_single == s->n_hold); i++) {
        characterize_gap *g = &s->gap[s->n_gap++];
        const palp_lumped_fit *fit = s->has_shared ? shared : &s->single[i];
        size_t at = s->has_shared ? i : 0;
        const palp_recording *r = &s->run[s->n_static + i];
        g->strain = r->deepest_m / r->height_m;
        g->run_N = fit->spring_N[at];
        g->low_N = fit->n_estimates ? fit->estimate[at].low : NAN;
        g->high_N = fit->n_estimates ? fit->estimate[at].high : NAN;
        g->plain_N = g->joint_N = NAN;
        if (s->n_static > 0)
            palp_law_stiffness(&s->plain[0][s->degree], g->strain, &g->plain_N, NULL);
        palp_law_stiffness(&s->material.law, g->strain, &g->joint_N, NULL);
        before += 100 * (g->plain_N / g->run_N - 1) / (double)s->n_hold;
        after += 100 * (g->joint_N / g->run_N - 1) / (double)s->n_hold;
    }
    s->gap_before_percent = s->n_gap ? before : NAN;
    s->gap_after_percent = s->n_gap ? after : NAN;
}

/* Confidence band of the law over the measured strains. */
static void find_band(characterize_state *s) {
    double strain[CHARACTERIZE_BAND], stiffness[CHARACTERIZE_BAND], sd[CHARACTERIZE_BAND];
    for (size_t i = 0; i < CHARACTERIZE_BAND; i++)
        strain[i] = characterize_strain_max(s) * (double)i / (CHARACTERIZE_BAND - 1);
    bool known = s->has_final &&
                 palp_lumped_fit_stiffness(&s->final, CHARACTERIZE_BAND, strain, stiffness, sd) == PALP_OK;
    s->n_band = known ? CHARACTERIZE_BAND : 0;
    for (size_t i = 0; i < s->n_band; i++)
        s->band[i] = (characterize_known){strain[i], stiffness[i], stiffness[i] - 1.96 * sd[i],
                                          stiffness[i] + 1.96 * sd[i]};
}

static palp_status compare_run(characterize_state *s, size_t i) {
    const palp_recording *r = &s->run[i];
    double *force = malloc(r->n * sizeof *force), *depth = malloc(r->n * sizeof *depth);
    palp_status status = force && depth ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t k = 0; status == PALP_OK && k < r->n; k++)
        depth[k] = fmax(r->depth_m[k], 0);
    if (status == PALP_OK)
        status = palp_lumped_run(&s->material, r->height_m, r->n, r->time_s, depth, force);
    for (size_t k = 0; status == PALP_OK && k < r->n; k++) {
        if (r->use[k]) {
            s->peak_N[i] = fmax(s->peak_N[i], r->force_N[k]);
            s->largest_N[i] = fmax(s->largest_N[i], fabs(force[k] - r->force_N[k]));
        }
    }
    free(force);
    free(depth);
    return status;
}

/* Mean force of the samples near a strain; NaN without any. */
static double force_near(const palp_recording *r, double strain, double width) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < r->n; i++) {
        if (r->use[i] && fabs(r->depth_m[i] / r->height_m - strain) < width) {
            sum += r->force_N[i];
            count++;
        }
    }
    return sum / count;
}

static void compare_static(characterize_state *s) {
    double top = HUGE_VAL;
    for (size_t i = 0; i < s->n_static; i++)
        top = fmin(top, s->run[i].deepest_m / s->run[i].height_m);
    double step = top > 0.4 ? 0.1 : top > 0.2 ? 0.05 : 0.2 * top;
    for (double e = step; s->n_static > 1 && e < top && s->n_spread < CHARACTERIZE_SPREAD_MAX; e += step) {
        characterize_spread *at = &s->spread[s->n_spread++];
        double square = 0, n = (double)s->n_static;
        *at = (characterize_spread){.strain = e, .low_N = HUGE_VAL, .high_N = -HUGE_VAL};
        for (size_t i = 0; i < s->n_static; i++) {
            double force = force_near(&s->run[i], e, 0.01 * top);
            at->mean_N += force / n;
            square += force * force / n;
            at->low_N = fmin(at->low_N, force);
            at->high_N = fmax(at->high_N, force);
        }
        at->sd_N = sqrt(fmax(square - at->mean_N * at->mean_N, 0) * n / (n - 1));
    }
}

int characterize_compare(characterize_state *s) {
    compare_springs(s);
    compare_static(s);
    find_band(s);
    for (size_t i = 0; i < s->n; i++) {
        palp_status status = compare_run(s, i);
        if (status)
            return cli_status_of(NAME, s->run[i].name, status, NULL);
    }
    return characterize_measure_spectra(s);
}
