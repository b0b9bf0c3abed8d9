/* characterize_model.c: the fits of palpate characterize, one after the other. */
#include "characterize.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

/* ---- static ---- */

static int fit_plain(const characterize_options *o, characterize_state *s) {
    for (size_t i = 0; i < s->n_static; i++) {
        for (size_t d = 1; d <= DEGREE_MAX; d++) {
            if (d > 5 && d != o->degree && d != s->degree && !o->degree_auto)
                continue;
            palp_status status = palp_thesis_polynomial(&s->run[i], d, &s->plain[i][d], &s->norm_N[i][d]);
            if (status)
                return cli_failure(NAME, "%s: no polynomial of degree %zu: %s", s->run[i].name, d,
                                   palp_status_text(status));
        }
    }
    return CLI_OK;
}

/* ---- ramp and hold ---- */

/* Least squares of ramps and holds with a spring of each, and fewer arms where the runs identify fewer. */
static palp_status fit_springs(size_t n, const palp_recording *run, palp_characterize_settings settings,
                               palp_lumped_fit *fit, palp_error *error) {
    palp_status status = palp_characterize_fit(n, run, &settings, fit, error);
    while (status == PALP_ERR_SINGULAR && settings.n_arms > 0) {
        settings.n_arms--;
        *error = (palp_error){PALP_OK, ""};
        status = palp_characterize_fit(n, run, &settings, fit, error);
    }
    return status;
}

static int fit_single(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings settings = characterize_settings(o, PALP_SPRING_PER_RUN, s->n_arms);
    for (size_t i = 0; i < s->n_hold && !o->shared_arms; i++) {
        palp_status status = fit_springs(1, &s->run[s->n_static + i], settings, &s->single[i], &error);
        if (status)
            return cli_status(NAME, status, &error);
        s->n_single++;
        if (!s->single[i].converged)
            characterize_warn(s, "%s: the fit of this depth by itself did not converge",
                              s->run[s->n_static + i].name);
    }
    return CLI_OK;
}

static int fit_shared(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings settings = characterize_settings(o, PALP_SPRING_PER_RUN, s->n_arms);
    if (s->n_hold == 0 || o->per_depth)
        return CLI_OK;
    palp_status status =
        o->method == METHOD_GRID
            ? palp_thesis_grid(s->n_hold, &s->run[s->n_static], &settings, &s->shared, &error)
            : fit_springs(s->n_hold, &s->run[s->n_static], settings, &s->shared, &error);
    s->has_shared = status == PALP_OK;
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

/* ---- the model ---- */

/* A fractional element in place of the arms, beside the law and the contacts that were found with free arms.
 */
static int fit_fractional(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings settings = characterize_settings(o, PALP_SPRING_LAW, 0);
    settings.law = s->material.law;
    settings.arms = PALP_ARMS_FRACTIONAL;
    palp_lumped_fit_free(&s->final);
    palp_specimens_fit_free(&s->specimens); /* their spread is of other parameters */
    if (s->n_points > 0)
        characterize_warn(s, "the fractional element is fitted to all specimens as if they were one");
    s->n_points = 0;
    palp_status status = palp_characterize_fit(s->n, s->run, &settings, &s->final, &error);
    if (status)
        return cli_status(NAME, status, &error);
    s->material = s->final.material;
    return CLI_OK;
}

/* The thesis' procedure: arms of the grid search; the law is the plain static polynomial, or one through
 * K_inf of each depth. */
static int assemble_grid(characterize_state *s) {
    s->material = s->shared.material;
    palp_status status = s->n_static ? PALP_OK : characterize_law_of_depths(s, s->degree, &s->material.law);
    if (s->n_static)
        s->material.law = s->plain[0][s->degree];
    return status ? cli_status_of(NAME, "the law through K_inf of each depth", status, NULL) : CLI_OK;
}

/* The law holds to the largest strain of the runs, or to the last strain at which its force rises. Beyond it
 * the force follows its tangent. */
static void limit_range(characterize_state *s) {
    double top = characterize_strain_max(s);
    if (palp_law_limit(&s->material.law, top) == PALP_OK && s->material.law.strain_max < top)
        characterize_warn(s,
                          "the law's force stops rising at a strain of %.3g, before the measured %.3g: "
                          "beyond it the model is extended along its tangent",
                          s->material.law.strain_max, top);
}

/* ---- the verdict ---- */

/* Ramps of one speed, within a tolerance, do not tell the law from arms that are faster than the ramp. */
static void warn_one_speed(characterize_state *s) {
    const bool holds = s->n_hold == s->n && characterize_depths(s) == 1, statics = s->n_static == s->n;
    double least = INFINITY, most = 0;
    for (size_t i = 0; i < s->n; i++) {
        const palp_recording *r = &s->run[i];
        double speed = r->deepest_m / fmax(r->ramp_end_s - r->ramp_start_s, 1e-12);
        least = fmin(least, speed);
        most = fmax(most, speed);
    }
    if (most > 1.5 * least || s->material.n_arms == 0)
        return;
    if (holds)
        characterize_warn(s, "one ramp to one depth at one speed cannot separate K(e) from arms faster than "
                             "the ramp; add a slow static press, or other depths and speeds");
    else if (statics)
        characterize_warn(s,
                          "ramps at one speed without a dwell cannot separate K(e) from arms; add a dwell, "
                          "or other speeds");
}

/* One sentence for all parameters that the data do not identify. */
static void warn_undetermined(characterize_state *s, const palp_lumped_fit *fit) {
    char names[256] = "";
    size_t total = 0, told = 0, used = 0;
    for (size_t j = 0; j < fit->n_estimates; j++)
        total += !fit->estimate[j].determined;
    for (size_t j = 0; j < fit->n_estimates && used < sizeof names; j++)
        if (!fit->estimate[j].determined) {
            const char *before = told == 0 ? "" : told + 1 < total ? ", " : " and ";
            used +=
                (size_t)snprintf(names + used, sizeof names - used, "%s%s", before, fit->estimate[j].name);
            told++;
        }
    if (total > 0)
        characterize_warn(s, "%s %s not identifiable from these data", names, total == 1 ? "is" : "are");
}

/* Warns of the run with the largest relative residual, if it is far above noise and 3 % of the peak. */
static void warn_misfit(characterize_state *s, const palp_lumped_fit *fit) {
    const double noises = 3.0, share = 0.03;
    size_t worst = fit->n_runs;
    double most = share;
    if (!s->has_final || s->n_points > 0) /* specimens differ from their mean */
        return;
    for (size_t i = 0; i < s->n; i++) {
        double left = s->peak_N[i] > 0 ? fit->rms_N[i] / s->peak_N[i] : 0;
        if (left > most && characterize_noise_ratio(fit, i, &s->run[i]) > noises) {
            most = left;
            worst = i;
        }
    }
    if (worst < fit->n_runs)
        characterize_warn(s,
                          "%s: the residual is %.2g %% of the peak (rms), %.2g times the noise: this law "
                          "and these arms do not fit; "
                          "try --arms auto, or palpate explain to find a missing effect",
                          s->run[worst].name, 100 * most,
                          characterize_noise_ratio(fit, worst, &s->run[worst]));
}

static void judge(const characterize_options *o, characterize_state *s) {
    const palp_lumped_fit *fit = characterize_fit_of(s);
    double top = characterize_strain_max(s), lowest = palp_law_minimum(&s->material.law, top);
    if (lowest <= 0)
        characterize_warn(s,
                          "K(e) falls to %.3g N within the measured range, which is not physical; try "
                          "another --degree or --law",
                          lowest);
    else if (fit->constrained)
        characterize_warn(
            s,
            "the constraint K(e) > 0 is active in the measured range; try a lower --degree or --law spline");
    for (size_t i = 0; i < s->n_static; i++) {
        const palp_law *plain = &s->plain[i][s->degree];
        if (plain->n && palp_law_minimum(plain, top) <= 0)
            characterize_warn(s, "%s: the plain polynomial of degree %zu has K(e) <= 0 in the measured range",
                              s->run[i].name, s->degree);
    }
    if (fit->n_merged > 0)
        characterize_warn(
            s, "%zu arm(s) merged with a neighbour: the data do not separate their relaxation times",
            fit->n_merged);
    if (o->law_auto)
        warn_one_speed(s);
    warn_undetermined(s, fit);
    warn_misfit(s, fit);
    if (s->has_shared && !s->shared.converged && s->has_final)
        characterize_warn(s, "the fit of shared arms did not converge");
    if (!fit->converged)
        characterize_warn(s, "the fit did not converge; the result is the best parameters found");
}

/* The fits by themselves, with as many arms as the model has. */
static int fit_depths(const characterize_options *o, characterize_state *s) {
    int code = fit_plain(o, s);
    code = code ? code : fit_single(o, s);
    return code ? code : fit_shared(o, s);
}

/* The procedure of Sedef 2008. */
static int fit_by_grid(const characterize_options *o, characterize_state *s) {
    if (s->n_hold == 0)
        return cli_failure(NAME, "--method grid needs ramp-and-hold runs (protocol.kind: \"ramp_hold\")");
    s->n_arms = o->arms;
    int code = fit_depths(o, s);
    return code ? code : assemble_grid(s);
}

static int fit_by_likelihood(const characterize_options *o, characterize_state *s) {
    if (o->fractional && s->n == s->n_static)
        return cli_failure(NAME, "--arms fractional needs a run with a dwell or a way back, not ramps alone");
    int code = fit_plain(o, s); /* first guesses of laws */
    code = code ? code : characterize_likelihood(o, s);
    code = code ? code : fit_depths(o, s); /* with the contacts found */
    return code || !o->fractional ? code : fit_fractional(o, s);
}

int characterize_model(const characterize_options *o, characterize_state *s) {
    const size_t depths = s->n_static ? DEGREE_MAX : characterize_depths(s);
    s->degree = o->degree <= depths || o->degree_given ? o->degree : depths;
    int code = o->method == METHOD_GRID ? fit_by_grid(o, s) : fit_by_likelihood(o, s);
    code = code ? code : characterize_compare(s);
    if (code == CLI_OK) {
        limit_range(s);
        judge(o, s);
        code = characterize_tip_fit(o, s);
    }
    return code;
}
