/* moduli.c: recordings whose depth is replaced by their tip's force over G at that depth. They are then those
 * of a linear solid with the stiffness G, which the lumped fit finds. */
#include <palpate/characterize.h>
#include <palpate/moduli.h>

#include "base/file.h"
#include "fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POISSON_STEPS = 250 };
static const double POISSON_LOW = 0.0, POISSON_HIGH = 0.5, CHI2_95 = 3.84;

palp_moduli_settings palp_moduli_settings_default(void) {
    return (palp_moduli_settings){.poisson = 0.5};
}

/* ---- recordings of a linear solid ---- */

static palp_indentation with_poisson(const palp_indentation *tip, double poisson) {
    palp_indentation in = *tip;
    in.poisson = poisson;
    return in;
}

/* Force over G at the deepest. */
static palp_status reach(const palp_recording *r, const palp_indentation *tip, double poisson,
                         double *force_m2) {
    palp_indentation in = with_poisson(tip, poisson);
    return palp_indentation_force(&in, 1, &r->deepest_m, force_m2);
}

/* A copy that shares all arrays but depth_m, which is the force over G over area_m2, of a specimen of
 * height 1. */
static palp_status linear_run(const palp_recording *from, const palp_indentation *tip, double poisson,
                              double area_m2, palp_recording *to) {
    palp_indentation in = with_poisson(tip, poisson);
    double near[2] = {from->deepest_m, 0.99 * from->deepest_m}, force[2];
    *to = *from;
    to->height_m = 1.0;
    to->depth_m = malloc((from->n + 1) * sizeof(double));
    palp_status status =
        to->depth_m ? palp_indentation_force(&in, from->n, from->depth_m, to->depth_m) : PALP_ERR_NO_MEMORY;
    status = status ? status : palp_indentation_force(&in, 2, near, force);
    for (size_t i = 0; !status && i < from->n; i++)
        to->depth_m[i] = from->depth_m[i] > 0 ? to->depth_m[i] / area_m2 : from->depth_m[i] / from->deepest_m;
    if (status)
        return status;
    to->deepest_m = force[0] / area_m2;
    to->contact_sd_m = from->contact_sd_m * (force[0] - force[1]) / (near[0] - near[1]) / area_m2;
    return PALP_OK;
}

/* One constant law for recordings [n] of different tips. */
static palp_status fit_linear(size_t n, const palp_recording *const *run, const palp_indentation *const *tip,
                              const palp_moduli_settings *settings, double poisson, double *area_m2,
                              palp_lumped_fit *fit, palp_error *error) {
    palp_characterize_settings s = palp_characterize_settings_default();
    palp_recording *linear = calloc(n, sizeof *linear);
    palp_status status = linear ? PALP_OK : PALP_ERR_NO_MEMORY;
    const double guess = 1.0;
    *area_m2 = 0;
    for (size_t i = 0; i < n && !status; i++) {
        double force = 0;
        status = reach(run[i], tip[i], poisson, &force);
        *area_m2 = fmax(*area_m2, force);
    }
    for (size_t i = 0; i < n && !status; i++)
        status = linear_run(run[i], tip[i], poisson, *area_m2, &linear[i]);
    s.spring = PALP_SPRING_LAW;
    s.n_arms = settings->n_arms;
    s.dwell_only = settings->dwell_only;
    palp_law_polynomial(1, &guess, &s.law);
    if (status)
        fit_failed(error, status, run[0]->name);
    status = status ? status : palp_characterize_fit(n, linear, &s, fit, error);
    for (size_t i = 0; linear && i < n; i++)
        free(linear[i].depth_m);
    free(linear);
    return status;
}

/* ---- contact of curved tips ---- */

/* A copy whose contact is later by shift_m. */
static palp_status moved_run(const palp_recording *from, double shift_m, palp_recording *to) {
    *to = *from;
    to->depth_m = malloc((from->n + 1) * sizeof(double));
    for (size_t i = 0; to->depth_m && i < from->n; i++)
        to->depth_m[i] = from->depth_m[i] - shift_m;
    to->deepest_m = from->deepest_m - shift_m;
    to->contact_m = from->contact_m + shift_m;
    return to->depth_m ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* Squares of the residuals over the noise, of a run whose contact is later by shift_m. */
static palp_status squares(const palp_recording *r, const palp_indentation *tip,
                           const palp_moduli_settings *settings, double poisson, double shift_m, double *chi2,
                           palp_error *error) {
    palp_recording moved;
    palp_lumped_fit fit = {0};
    double area = 0, used = 0;
    palp_status status = moved_run(r, shift_m, &moved);
    const palp_recording *run = &moved;
    status = status ? status : fit_linear(1, &run, &tip, settings, poisson, &area, &fit, error);
    for (size_t i = 0; i < r->n; i++)
        used += r->use[i];
    if (!status)
        *chi2 = used * fit.rms_N[0] * fit.rms_N[0] / (r->noise_N * r->noise_N);
    free(moved.depth_m);
    palp_lumped_fit_free(&fit);
    return status;
}

/* Largest shift of contact to earlier, with a step to spare: a third of the depth, or less where the tip's
 * tables end. */
static double earliest(const palp_recording *r, const palp_indentation *tip, double poisson, double step) {
    double low = -r->deepest_m / 3, force = 0;
    palp_recording deeper = *r;
    for (int k = 0; k < 8; k++) {
        deeper.deepest_m = r->deepest_m - low + step;
        if (reach(&deeper, tip, poisson, &force) != PALP_ERR_LIMIT)
            break;
        low *= 0.5;
    }
    return low;
}

/* Golden section for the shift of least squares, within a third of the depth; its sd from their growth
 * relative to their size. ERR_LIMIT: it lies beyond the tip's tables. */
static palp_status find_contact(const palp_recording *r, const palp_indentation *tip,
                                const palp_moduli_settings *settings, double poisson, palp_recording *found,
                                palp_error *error) {
    const double golden = 0.6180339887498949, step = 0.02 * r->deepest_m,
                 first = earliest(r, tip, poisson, step);
    double low = first, high = r->deepest_m / 3,
           x[3] = {high - golden * (high - low), low + golden * (high - low), 0}, y[3];
    palp_status status = squares(r, tip, settings, poisson, x[0], &y[0], error);
    status = status ? status : squares(r, tip, settings, poisson, x[1], &y[1], error);
    for (int i = 0; i < 18 && !status; i++) {
        bool left = y[0] < y[1];
        *(left ? &high : &low) = x[left];
        x[left] = x[!left];
        y[left] = y[!left];
        x[!left] = left ? high - golden * (high - low) : low + golden * (high - low);
        status = squares(r, tip, settings, poisson, x[!left], &y[!left], error);
    }
    double at = 0.5 * (low + high);
    if (!status && first > -0.3 * r->deepest_m && at < first + step)
        status = PALP_ERR_LIMIT;
    for (int k = 0; k < 3 && !status; k++)
        status = squares(r, tip, settings, poisson, at + (k - 1) * step, &y[k], error);
    status = status ? status : moved_run(r, at, found);
    if (!status) {
        double used = 0, growth = (y[0] + y[2] - 2 * y[1]) / (2 * step * step);
        for (size_t i = 0; i < r->n; i++)
            used += r->use[i];
        found->contact_sd_m = growth > 0 ? sqrt(fmax(1.0, y[1] / used) / growth) : r->deepest_m / 3;
    }
    return status;
}

static bool is_curved(const palp_indentation *tip) {
    return tip->tip == PALP_TIP_SPHERE || tip->tip == PALP_TIP_CONE;
}

/* The recordings, with contact found for curved tips; free_contacts. */
static palp_status find_contacts(size_t n, const palp_recording *recordings, const palp_indentation *tips,
                                 const palp_moduli_settings *settings, double poisson, palp_recording *found,
                                 palp_moduli *m, palp_error *error) {
    palp_status status = PALP_OK;
    m->largest_shift_m = 0;
    for (size_t i = 0; i < n && !status; i++) {
        bool wanted = is_curved(&tips[i]) && !settings->contact_known;
        free(found[i].depth_m);
        found[i] = recordings[i];
        found[i].depth_m = NULL;
        status = wanted ? find_contact(&recordings[i], &tips[i], settings, poisson, &found[i], error)
                        : moved_run(&recordings[i], 0, &found[i]);
        m->largest_shift_m = fmax(m->largest_shift_m, fabs(found[i].contact_m - recordings[i].contact_m));
    }
    return status;
}

/* ---- Poisson's ratio ---- */

/* The runs of one tip: its long-term modulus at a given ratio. */
typedef struct group {
    const palp_indentation *tip;
    const palp_recording *deepest;       /* of its runs */
    double log_modulus, sd;              /* at reference, of the logarithm */
    double log_reach[POISSON_STEPS + 1]; /* log force over G by Poisson's ratio */
} group;

static bool same_tip(const palp_indentation *a, const palp_indentation *b) {
    bool size = a->tip == PALP_TIP_CONE ? a->half_angle_rad == b->half_angle_rad : a->radius_m == b->radius_m;
    return a->tip == b->tip && size && a->thickness_m == b->thickness_m &&
           a->floor_slides == b->floor_slides && a->tip_sticks == b->tip_sticks &&
           a->specimen_radius_m == b->specimen_radius_m;
}

static size_t count_tips(size_t n, const palp_indentation *tips) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        size_t j = 0;
        while (j < i && !same_tip(&tips[i], &tips[j]))
            j++;
        count += j == i;
    }
    return count;
}

/* The runs with the tip of run `first`: into run[] and tip[]. */
static size_t gather(size_t n, const palp_recording *recordings, const palp_indentation *tips, size_t first,
                     const palp_recording **run, const palp_indentation **tip) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        if (same_tip(&tips[i], &tips[first])) {
            run[count] = &recordings[i];
            tip[count++] = &tips[i];
        }
    return count;
}

static double ratio_at(int step) {
    return POISSON_LOW + (POISSON_HIGH - POISSON_LOW) * step / POISSON_STEPS;
}

/* Force over G is smooth in Poisson's ratio: every tenth is computed. */
static palp_status fill_reach(group *g) {
    enum { EVERY = 10 };
    palp_status status = PALP_OK;
    for (int k = 0; k <= POISSON_STEPS && !status; k += EVERY) {
        double force = 0;
        status = reach(g->deepest, g->tip, ratio_at(k), &force);
        g->log_reach[k] = log(force);
        for (int j = 1; k > 0 && j < EVERY; j++)
            g->log_reach[k - j] = g->log_reach[k] + (g->log_reach[k - EVERY] - g->log_reach[k]) * j / EVERY;
    }
    return status;
}

static palp_status group_make(size_t n, const palp_recording **run, const palp_indentation **tip,
                              const palp_moduli_settings *settings, int at, group *g, palp_error *error) {
    palp_lumped_fit fit = {0};
    double area = 0;
    palp_status status = fit_linear(n, run, tip, settings, ratio_at(at), &area, &fit, error);
    if (status)
        return status;
    g->tip = tip[0];
    g->deepest = run[0];
    for (size_t i = 1; i < n; i++)
        g->deepest = run[i]->deepest_m > g->deepest->deepest_m ? run[i] : g->deepest;
    g->log_modulus = log(fit.material.law.coefficients[0] / area);
    g->sd = fmax(sqrt(fit.covariance[0]) / fit.material.law.coefficients[0], 1e-6);
    palp_lumped_fit_free(&fit);
    return fill_reach(g);
}

/* Disagreement of the groups' moduli at a ratio: squares over their variances. */
static double disagreement(size_t n, const group *g, int at, int reference) {
    double sum = 0, weight = 0, chi2 = 0;
    for (int again = 0; again < 2; again++)
        for (size_t i = 0; i < n; i++) {
            double w = 1.0 / (g[i].sd * g[i].sd),
                   x = g[i].log_modulus + g[i].log_reach[reference] - g[i].log_reach[at];
            if (again == 0) {
                sum += w * x;
                weight += w;
            } else
                chi2 += w * (x - sum / weight) * (x - sum / weight);
        }
    return chi2;
}

/* The best ratio, and all that are within the 95 % bound of it. Tips that agree at no ratio widen it. */
static void find_best(size_t n, const group *g, int *reference, palp_modulus *poisson) {
    double chi2[POISSON_STEPS + 1];
    int best = 0, low, high;
    for (int k = 0; k <= POISSON_STEPS; k++) {
        chi2[k] = disagreement(n, g, k, *reference);
        best = chi2[k] < chi2[best] ? k : best;
    }
    double bound = chi2[best] + CHI2_95 * fmax(1.0, chi2[best] / fmax((double)n - 2.0, 1.0));
    for (low = best; low > 0 && chi2[low - 1] <= bound;)
        low--;
    for (high = best; high < POISSON_STEPS && chi2[high + 1] <= bound;)
        high++;
    double step = ratio_at(1) - ratio_at(0), left = ratio_at(best) - ratio_at(low),
           right = ratio_at(high) - ratio_at(best);
    *poisson =
        (palp_modulus){ratio_at(best), fmax(fmax(left, right), step) / 1.96, ratio_at(low), ratio_at(high)};
    *reference = best;
}

static palp_status find_poisson(size_t n, const palp_recording *recordings, const palp_indentation *tips,
                                const palp_moduli_settings *settings, double guess, palp_moduli *m,
                                palp_error *error) {
    const palp_recording **run = malloc(n * sizeof *run);
    const palp_indentation **tip = malloc(n * sizeof *tip);
    group *g = calloc(m->n_tips, sizeof *g);
    int reference = (int)lround((guess - POISSON_LOW) / (POISSON_HIGH - POISSON_LOW) * POISSON_STEPS);
    palp_status status = run && tip && g ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (int again = 0; again < 2 && !status;
         again++) { /* a curved tip's shape of force depends a little on the ratio */
        size_t made = 0;
        for (size_t i = 0; i < n && !status; i++) {
            size_t count = gather(n, recordings, tips, i, run, tip);
            if (run[0] == &recordings[i])
                status = group_make(count, run, tip, settings, reference, &g[made++], error);
        }
        if (!status)
            find_best(made, g, &reference, &m->poisson);
    }
    m->poisson_found = true;
    free(g);
    free(tip);
    free(run);
    return status;
}

/* ---- moduli ---- */

static palp_modulus modulus(double value, double variance) {
    double sd = sqrt(variance);
    return (palp_modulus){value, sd, value - 1.96 * sd, value + 1.96 * sd};
}

static palp_modulus times(palp_modulus m, double factor) {
    return (palp_modulus){m.value * factor, m.sd * factor, m.low * factor, m.high * factor};
}

/* Variance of log G: of the fit's stiffnesses, and of the ratio by the derivative. */
static void fill_moduli(const palp_lumped_fit *fit, double area_m2, double by_poisson, palp_moduli *m) {
    const palp_material *material = &fit->material;
    size_t n = fit->n_parameters;
    double sum = material->law.coefficients[0], variance = fit->covariance[0],
           more = by_poisson * m->poisson.sd;
    palp_modulus last =
        modulus(sum / area_m2, variance / (area_m2 * area_m2) + pow(more * sum / area_m2, 2.0));
    m->n_arms = material->n_arms;
    for (size_t j = 0; j < m->n_arms; j++) {
        sum += material->arms[j].stiffness_N;
        m->arm_Pa[j] = material->arms[j].stiffness_N / area_m2;
        m->tau_s[j] = material->arms[j].viscosity_Ns / material->arms[j].stiffness_N;
        size_t a = 1 + 2 * j;
        variance += fit->covariance[a * n + a] + 2.0 * fit->covariance[a];
        for (size_t k = 0; k < j; k++)
            variance += 2.0 * fit->covariance[a * n + 1 + 2 * k];
    }
    m->shear_inf_Pa = last;
    m->shear_0_Pa = modulus(sum / area_m2, variance / (area_m2 * area_m2) + pow(more * sum / area_m2, 2.0));
    m->young_inf_Pa = times(m->shear_inf_Pa, 2.0 * (1.0 + m->poisson.value));
    m->young_0_Pa = times(m->shear_0_Pa, 2.0 * (1.0 + m->poisson.value));
}

/* The deepest run's modulus at another ratio. */
static palp_status fill_range(const palp_recording *r, const palp_indentation *tip, palp_moduli *m,
                              double *by_poisson) {
    double at[5] = {m->poisson.value, 0.5, 0.3, fmin(m->poisson.value, 0.49) + 0.01,
                    fmax(fmin(m->poisson.value, 0.49) - 0.01, 0.0)},
           force[5];
    palp_status status = PALP_OK;
    for (int i = 0; i < 5 && !status; i++)
        status = reach(r, tip, at[i], &force[i]);
    m->shear_low_Pa = force[0] / force[1]; /* of the modulus, which is not known yet */
    m->shear_high_Pa = force[0] / force[2];
    *by_poisson = log(force[4] / force[3]) / (at[3] - at[4]);
    return status;
}

static void fill_sizes(const palp_recording *r, const palp_indentation *tip, palp_moduli *m) {
    palp_indentation in = with_poisson(tip, m->poisson.value);
    double contact = 0;
    palp_indentation_contact(&in, r->deepest_m, &contact);
    m->largest_depth = fmax(m->largest_depth, r->deepest_m / tip->thickness_m);
    m->widest_contact = fmax(m->widest_contact, contact / tip->thickness_m);
}

static double misfit_of(size_t n, const palp_recording *recordings, const palp_lumped_fit *fit) {
    double miss = 0, force = 0;
    for (size_t r = 0; r < n; r++) {
        double square = 0, used = 0;
        for (size_t i = 0; i < recordings[r].n; i++)
            if (recordings[r].use[i] && recordings[r].depth_m[i] > 0) {
                square += recordings[r].force_N[i] * recordings[r].force_N[i];
                used += 1;
            }
        miss += fit->rms_N[r] * fit->rms_N[r];
        force += used > 0 ? square / used : 0;
    }
    return force > 0 ? sqrt(miss / force) : 0;
}

static palp_status fit_all(size_t n, const palp_recording *recordings, const palp_indentation *tips,
                           const palp_moduli_settings *settings, palp_moduli *m, palp_error *error) {
    const palp_recording **run = malloc(n * sizeof *run);
    const palp_indentation **tip = malloc(n * sizeof *tip);
    palp_lumped_fit fit = {0};
    double area = 0, by_poisson = 0;
    size_t deepest = 0;
    palp_status status = run && tip ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && !status; i++) {
        run[i] = &recordings[i];
        tip[i] = &tips[i];
        deepest = recordings[i].deepest_m > recordings[deepest].deepest_m ? i : deepest;
    }
    status = status ? status : fit_linear(n, run, tip, settings, m->poisson.value, &area, &fit, error);
    status = status ? status : fill_range(&recordings[deepest], &tips[deepest], m, &by_poisson);
    if (!status) {
        fill_moduli(&fit, area, by_poisson, m);
        m->shear_low_Pa *= m->shear_inf_Pa.value;
        m->shear_high_Pa *= m->shear_inf_Pa.value;
        m->converged = fit.converged;
        m->misfit = misfit_of(n, recordings, &fit);
        for (size_t i = 0; i < n; i++)
            fill_sizes(&recordings[i], &tips[i], m);
    }
    palp_lumped_fit_free(&fit);
    free(tip);
    free(run);
    return status;
}

/* Ratio and contacts of curved tips depend on each other a little. Aitken's step after two rounds gives the
 * limit. */
static palp_status find_both(size_t n, const palp_recording *recordings, const palp_indentation *tips,
                             const palp_moduli_settings *settings, palp_recording *found, palp_moduli *m,
                             palp_error *error) {
    double p[4] = {0.45, 0, 0, 0};
    palp_status status = PALP_OK;
    for (int k = 0; k < 3 && !status; k++) {
        status = find_contacts(n, recordings, tips, settings, p[k], found, m, error);
        status = status ? status : find_poisson(n, found, tips, settings, p[k], m, error);
        p[k + 1] = m->poisson.value;
        if (m->largest_shift_m == 0 || fabs(p[k + 1] - p[k]) < 0.005)
            break;
        double bend = k == 1 ? p[2] - 2 * p[1] + p[0] : 0;
        if (fabs(bend) > fabs(p[2] - p[1]))
            p[2] = fmin(fmax(p[2] - (p[2] - p[1]) * (p[2] - p[1]) / bend, POISSON_LOW), POISSON_HIGH);
    }
    return status;
}

palp_status palp_moduli_fit(size_t n, const palp_recording *recordings, const palp_indentation *tips,
                            const palp_moduli_settings *settings, palp_moduli *moduli, palp_error *error) {
    if (!recordings || !tips || !settings || !moduli)
        return palp_error_null(error);
    memset(moduli, 0, sizeof *moduli);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no recording");
    moduli->n_tips = count_tips(n, tips);
    if (isnan(settings->poisson) && moduli->n_tips < 2)
        return palp_error_set(error, PALP_ERR_INPUT,
                              "%s: one tip on one thickness gives no Poisson's ratio: it takes runs with "
                              "tips of another shape or size",
                              recordings[0].name);
    moduli->poisson = (palp_modulus){settings->poisson, 0, settings->poisson, settings->poisson};
    palp_recording *found = calloc(n, sizeof *found);
    palp_status status = found ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status)
        status = isnan(settings->poisson)
                     ? find_both(n, recordings, tips, settings, found, moduli, error)
                     : find_contacts(n, recordings, tips, settings, settings->poisson, found, moduli, error);
    status = status ? status : fit_all(n, found, tips, settings, moduli, error);
    for (size_t i = 0; found && i < n; i++)
        free(found[i].depth_m);
    free(found);
    return status;
}
