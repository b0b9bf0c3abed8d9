/* characterize_model.c: the fits of palpate characterize, one after the other. */
#include "characterize.h"
#include "shared/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

/* The runs that are not static. */
static const palp_recording *timed(const characterize_state *s, size_t *n) {
    *n = s->n - s->n_static;
    return &s->run[s->n_static];
}

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

static int choose_degree(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    size_t depths = s->n_static ? DEGREE_MAX : characterize_depths(s);
    size_t best = 0;
    if (!o->degree_auto) {
        s->degree = o->degree <= depths || o->degree_given ? o->degree : depths;
        return CLI_OK;
    }
    palp_characterize_settings settings = characterize_settings(o, PALP_SPRING_LAW, s->n_static ? 0 : 2);
    const double one = 1;
    palp_law_polynomial(1, &one, &settings.law);
    palp_status status =
        palp_characterize_select_degree(s->n_static ? s->n_static : s->n, s->run, &settings, DEGREE_MAX - 1,
                                        s->degrees.score, s->degrees.sd, &best, &error);
    s->degrees.first = 1;
    s->degrees.n = status ? 0 : DEGREE_MAX;
    s->degrees.best = s->degree = best + 1;
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

/* ---- ramp and hold ---- */

/* Residual over noise, rms over all samples of all runs. */
static double whole_ratio(const palp_lumped_fit *fit, const palp_recording *run) {
    double square = 0, count = 0;
    for (size_t i = 0; i < fit->n_runs; i++) {
        double ratio = characterize_noise_ratio(fit, i, &run[i]), n = (double)run[i].n;
        square += n * ratio * ratio;
        count += n;
    }
    return sqrt(square / count);
}

/* Fits each number of arms for its residual and for how many arms it identifies. The chosen number is fitted
 * from all starts, the others from the best one. If the data identify fewer arms, the numbers between give
 * the same fit. */
static palp_status try_arms(characterize_state *s, palp_characterize_settings settings, size_t most,
                            progress *bar) {
    palp_error error = {PALP_OK, ""};
    palp_status status = PALP_OK;
    size_t n = 0, starts = settings.starts, apart = most + 1;
    double ratio = NAN; /* of the last fit with fewer arms; how many it identifies */
    const palp_recording *run = timed(s, &n);
    for (size_t k = most + 1; k-- > 0 && status == PALP_OK;) {
        palp_lumped_fit fit;
        bool chosen = k == s->arms.best;
        s->arms.rms_noise[k] = ratio;
        if (k >= apart && !chosen)
            continue;
        settings.starts = chosen ? starts : 1;
        settings.n_arms = k;
        progress_update(bar, 0.2 + 0.05 * (double)(most - k));
        status = palp_characterize_fit(n, run, &settings, &fit, &error);
        s->arms.rms_noise[k] = status ? NAN : whole_ratio(&fit, run);
        if (status == PALP_OK) {
            s->n_arms = chosen ? fit.material.n_arms : s->n_arms;
            apart = chosen ? apart : fit.material.n_arms;
            ratio = chosen ? ratio : s->arms.rms_noise[k];
            palp_lumped_fit_free(&fit);
        }
        status = status == PALP_ERR_SINGULAR && !chosen ? PALP_OK : status;
    }
    return status;
}

/* Chooses the number of arms by cross-validation. If all runs are ramps and holds, each has its own spring.
 * If the data do not identify the highest number, lower ones are tried. */
static int choose_arms(const characterize_options *o, characterize_state *s, progress *bar) {
    palp_error error = {PALP_OK, ""};
    size_t n = 0, most = SELECT_ARMS_MAX;
    const palp_recording *run = timed(s, &n);
    s->n_arms = n ? o->arms : 0;
    if (!o->arms_auto || n == 0)
        return CLI_OK;
    palp_characterize_settings settings =
        characterize_settings(o, s->n_hold == n ? PALP_SPRING_PER_RUN : PALP_SPRING_LAW, 0);
    palp_status status = characterize_guess(o, s, &settings.law);
    for (bool again = status == PALP_OK; again; again = status == PALP_ERR_SINGULAR && most-- > 1)
        status = palp_characterize_select_arms(n, run, &settings, most, s->arms.score, s->arms.sd,
                                               &s->arms.best, &error);
    status = status ? status : try_arms(s, settings, most, bar);
    s->arms.n = status ? 0 : most + 1;
    if (status == PALP_OK && s->n_arms < s->arms.best) {
        characterize_warn(s, "the data identify only %zu of %zu arms; %zu are fitted", s->n_arms,
                          s->arms.best, s->n_arms);
        s->arms.best = s->n_arms;
    }
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

static int fit_single(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings settings = characterize_settings(o, PALP_SPRING_PER_RUN, s->n_arms);
    for (size_t i = 0; i < s->n_hold && !o->shared_arms; i++) {
        palp_status status =
            palp_characterize_fit(1, &s->run[s->n_static + i], &settings, &s->single[i], &error);
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
            : palp_characterize_fit(s->n_hold, &s->run[s->n_static], &settings, &s->shared, &error);
    s->has_shared = status == PALP_OK;
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}

/* ---- the joint fit ---- */

/* Fixed arms or a fractional element need a law of fixed shape: that of a fit with free arms. */
static palp_status guess_law(const characterize_state *s, palp_characterize_settings *settings,
                             palp_error *error) {
    palp_lumped_fit fit;
    palp_status status = palp_characterize_fit(s->n, s->run, settings, &fit, error);
    if (status)
        return status;
    settings->law = fit.material.law;
    palp_lumped_fit_free(&fit);
    return PALP_OK;
}

static int fit_joint(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings settings = characterize_settings(o, PALP_SPRING_LAW, s->n_arms);
    palp_status status = s->laws.n ? PALP_OK : characterize_guess(o, s, &settings.law);
    if (s->laws.n)
        settings.law = s->law[s->laws.best];
    if (status == PALP_ERR_INPUT)
        return cli_failure(NAME,
                           "%s: --law %s needs the specimen's radius; add a line # specimen.radius_mm: R",
                           s->run[0].name, palp_law_kind_name((palp_law_kind)o->law));
    settings.contact = s->contact;
    if (o->arms_form != PALP_ARMS_FREE && s->n > s->n_static) {
        if (status == PALP_OK)
            status = guess_law(s, &settings, &error);
        settings.arms = o->arms_form;
        settings.per_decade = o->per_decade;
    }
    status = status ? status : characterize_fit_specimens(s, &settings, &error);
    if (status)
        return cli_status(NAME, status, &error);
    s->has_final = true;
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

static void judge(characterize_state *s) {
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
    warn_undetermined(s, fit);
    warn_misfit(s, fit);
    if (s->has_shared && !s->shared.converged && s->has_final)
        characterize_warn(s, "the fit of shared arms did not converge");
    if (!fit->converged)
        characterize_warn(s, "the fit did not converge; the result is the best parameters found");
}

/* Each fit by itself, one after the other. */
static int fit_all(const characterize_options *o, characterize_state *s, progress *bar) {
    int code = fit_plain(o, s);
    code = code ? code : characterize_find_level(o, s);
    characterize_level(s, true);
    code = code ? code : choose_degree(o, s);
    code = code ? code : choose_arms(o, s, bar);
    progress_update(bar, 0.5);
    code = code ? code : characterize_contacts(o, s);
    characterize_level(s, false);
    code = code || s->contact == PALP_CONTACT_KNOWN ? code : fit_plain(o, s); /* with the new contacts */
    code = code ? code : fit_single(o, s);
    progress_update(bar, 0.65);
    code = code ? code : fit_shared(o, s);
    progress_update(bar, 0.8);
    characterize_level(s, true);
    if (code == CLI_OK && o->law_auto)
        code = characterize_choose_law(o, s);
    characterize_level(s, false);
    if (code == CLI_OK)
        code = o->method == METHOD_GRID ? assemble_grid(s) : fit_joint(o, s);
    return code;
}

int characterize_model(const characterize_options *o, characterize_state *s) {
    progress bar;
    if (o->method == METHOD_GRID && s->n_hold == 0)
        return cli_failure(NAME, "--method grid needs ramp-and-hold runs (protocol.kind: \"ramp_hold\")");
    if (!o->arms_auto && o->arms > 0 && s->n == s->n_static)
        characterize_warn(s, "ramps without a dwell do not identify arms: the model has none");
    progress_start(&bar, "fitting");
    int code = o->likelihood ? fit_plain(o, s) : fit_all(o, s, &bar);
    code = code || !o->likelihood ? code : characterize_likelihood(o, s);
    if (code == CLI_OK && o->likelihood)
        code = fit_plain(o, s); /* with the new contacts, and the degree of the law */
    progress_finish(&bar);
    code = code ? code : characterize_compare(s);
    if (code == CLI_OK) {
        limit_range(s);
        judge(s);
        code = characterize_tip_fit(o, s);
    }
    return code;
}
