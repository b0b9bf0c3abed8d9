/* characterize_print.c: the result of palpate characterize as text. */
#include "characterize.h"
#include "shared/digits.h"
#include "shared/law_text.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "characterize";

enum { PAIRS_MAX = 12, MANY_KNOTS = 8 };

/* "7.608 +-0.012", half the interval; "?" if the data do not identify it. */
static void with_half(char text[2 * DIGITS_TEXT], const palp_estimate *e) {
    double half = 0.5 * (e->high - e->low);
    char value[DIGITS_TEXT], more[DIGITS_TEXT];
    if (!e->determined)
        strcpy(text, "?");
    else
        snprintf(text, 2 * DIGITS_TEXT, "%s +-%s", digits_text(value, e->value, half),
                 digits_text(more, half, half));
}

static void print_static(const characterize_state *s) {
    for (size_t i = 0; i < s->n_static; i++) {
        printf("Ramp without a dwell %s: plain polynomials F(e) (as Table 4.1)\n", s->run[i].name);
        printf("  degree  residual norm (N)\n");
        for (size_t d = DEGREE_MIN; d <= DEGREE_MAX; d++) {
            if (s->plain[i][d].n) {
                printf("  %6zu  %17.4g ", d, s->norm_N[i][d]);
                law_text_print(&s->plain[i][d]);
            }
        }
    }
}

static void print_single(const characterize_state *s) {
    char text[2 * DIGITS_TEXT];
    if (s->n_single == 0)
        return;
    size_t arms = 0;
    for (size_t i = 0; i < s->n_single; i++)
        arms = s->single[i].material.n_arms > arms ? s->single[i].material.n_arms : arms;
    printf("The dwell of each depth by itself (as Tables 4.2 and 4.3; +- 95 %%; ? = not identifiable)\n  "
           "depth (mm) "
           " strain  %17s",
           "K_inf (N)");
    for (size_t j = 1; j <= arms; j++)
        printf("      K_%zu (N)           b_%zu (N s)   ", j, j);
    printf("  rms / noise\n");
    for (size_t i = 0; i < s->n_single; i++) {
        const palp_lumped_fit *f = &s->single[i];
        const palp_recording *r = &s->run[s->n_static + i];
        size_t n = f->material.n_arms;
        printf("  %10.4g  %6.4f", 1e3 * r->deepest_m, r->deepest_m / r->height_m);
        with_half(text, &f->estimate[0]);
        printf("  %17s", text);
        for (size_t j = 0; j < arms; j++) {
            for (int k = 0; k < 2; k++) {
                strcpy(text, "merged");
                if (j < n)
                    with_half(text, &f->estimate[1 + 3 * j + (size_t)k]);
                printf("  %17s", text);
            }
        }
        printf("  %11.4g\n", characterize_noise_ratio(f, 0, r));
    }
}

/* The first estimate that is listed: the knots of a spline have a band of their own. */
static size_t first_listed(const palp_lumped_fit *f) {
    return f->n_parameters && f->material.law.kind == PALP_LAW_SPLINE ? f->material.law.n : 0;
}

static void print_estimates(const palp_lumped_fit *f) {
    const size_t first = first_listed(f);
    if (first == f->n_estimates)
        return;
    printf("  %-10s %14s   %s\n", "parameter", "value", "95 % interval");
    for (size_t i = first; i < f->n_estimates; i++) {
        const palp_estimate *e = &f->estimate[i];
        double half = 0.5 * (e->high - e->low);
        char value[DIGITS_TEXT], low[DIGITS_TEXT], high[DIGITS_TEXT];
        if (e->determined)
            printf("  %-10s %14s   %s to %s %s\n", e->name, digits_text(value, e->value, half),
                   digits_text(low, e->low, half), digits_text(high, e->high, half), e->unit);
        else
            printf("  %-10s %14s   not identifiable from these data (%.1g to %.1g %s)\n", e->name, "-",
                   e->low, e->high, e->unit);
    }
}

static void print_pairs(const palp_lumped_fit *f) {
    size_t n = f->n_estimates, found = 0;
    for (size_t i = first_listed(f); i < n; i++) {
        for (size_t j = i + 1; j < n; j++) {
            double c = f->correlation[i * n + j];
            if (fabs(c) > 0.95) {
                found++;
                if (found <= PAIRS_MAX)
                    printf("%s%s and %s %.3f", found == 1 ? "  correlated above 0.95: " : ", ",
                           f->estimate[i].name, f->estimate[j].name, c);
            }
        }
    }
    if (found > PAIRS_MAX)
        printf(" and %zu more", found - PAIRS_MAX);
    if (found)
        putchar('\n');
}

static void print_arms(const palp_material *m) {
    for (size_t j = 0; j < m->n_arms; j++) {
        const palp_arm *a = &m->arms[j];
        printf("  arm %zu: %.5g N, %.5g N s, %.4g s\n", j + 1, a->stiffness_N, a->viscosity_Ns,
               a->viscosity_Ns / a->stiffness_N);
    }
}

static void print_shared(const characterize_options *o, const characterize_state *s) {
    if (!s->has_shared)
        return;
    printf("Arms shared by the dwells of all depths (as Tables 4.4 and 4.5; %s)\n",
           o->method == METHOD_GRID ? "grid of Section 4.3.3" : "least squares");
    if (s->shared.n_estimates)
        print_estimates(&s->shared);
    else
        print_arms(&s->shared.material);
    printf("  total |residual| %.6g N\n", characterize_total(&s->shared));
}

static void print_final(const characterize_state *s) {
    const palp_lumped_fit *f = &s->final;
    printf(s->has_final ? "Model: one law%s over all runs\n" : "Model: the static law%s\n",
           s->material.n_arms ? " and one set of arms" : "");
    if (s->has_final && first_listed(f) > MANY_KNOTS)
        printf("  K(e): a monotone cubic through %zu knots, with the band below\n", first_listed(f));
    else
        law_text_print(&s->material.law);
    print_arms(&s->material);
    if (!s->has_final)
        return;
    print_estimates(f);
    print_pairs(f);
    int width = 34;
    for (size_t i = 0; i < f->n_runs; i++) {
        int length = (int)strlen(s->run[i].name);
        width = length > width ? length : width;
    }
    printf("  %-*s  rms (mN)   rms / noise   largest |residual| / peak\n", width, "run");
    for (size_t i = 0; i < f->n_runs; i++)
        printf("  %-*s %9.4g  %12.4g  %22.3f %%\n", width, s->run[i].name, 1e3 * f->rms_N[i],
               characterize_noise_ratio(f, i, &s->run[i]), 100 * s->largest_N[i] / s->peak_N[i]);
    printf("  total |residual| %.6g N", characterize_total(f));
    if (f->inflation > 1)
        printf("; intervals widened %.3g times for misfit and correlated noise", f->inflation);
    putchar('\n');
}

/* Coefficients are strongly correlated, so the band is shown for the force. */
static void print_band(const characterize_state *s) {
    if (s->n_band == 0)
        return;
    printf("  strain   K_inf (N)   95 %% band            force (N)   95 %% band\n");
    for (size_t i = s->n_band / 5; i < s->n_band; i += s->n_band / 5) {
        const characterize_known *at = &s->band[i];
        double e = at->strain;
        printf("  %6.4f  %10.5g   %8.5g to %-8.5g  %10.5g   %8.5g to %.5g\n", e, at->stiffness_N, at->low_N,
               at->high_N, at->stiffness_N * e, at->low_N * e, at->high_N * e);
    }
}

/* The plain polynomial beside the joint law: the force of arms that have not relaxed in a static run. */
static void print_bias(const characterize_state *s) {
    if (s->n_static == 0 || !s->has_final || s->material.n_arms == 0)
        return;
    double top = s->run[0].deepest_m / s->run[0].height_m;
    printf("Ramp without a dwell: the plain polynomial counts the arms' force as the spring's\n");
    printf("  strain   plain K (N)   joint K (N)   plain / joint - 1\n");
    for (double e = 0.05; e <= top + 1e-9; e += 0.05) {
        double plain, joint;
        palp_law_stiffness(&s->plain[0][s->degree], e, &plain, NULL);
        palp_law_stiffness(&s->material.law, e, &joint, NULL);
        printf("  %6.2f  %12.5g  %12.5g  %15.2f %%\n", e, plain, joint, 100 * (plain / joint - 1));
    }
}

static void print_gap(const characterize_state *s) {
    if (s->n_gap == 0 || s->n_static == 0 || !s->has_final)
        return;
    printf("K_inf of ramp without a dwell and ramp and hold (Figure 4.26)\n");
    printf("  strain   ramp and hold (N)   static, plain (N)   joint law (N)\n");
    for (size_t i = 0; i < s->n_gap; i++) {
        const characterize_gap *g = &s->gap[i];
        printf("  %6.4f  %18.5g  %18.5g  %14.5g\n", g->strain, g->run_N, g->plain_N, g->joint_N);
    }
    printf("  mean gap to ramp and hold: %.2f %% before (plain), %.2f %% after (joint)\n",
           s->gap_before_percent, s->gap_after_percent);
}

static void print_spread(const characterize_state *s) {
    if (s->n_spread == 0)
        return;
    printf("Spread of the %zu ramps without a dwell\n  strain   mean force (N)   sd (%%)   lowest (N)   "
           "highest (N)\n",
           s->n_static);
    for (size_t i = 0; i < s->n_spread; i++) {
        const characterize_spread *at = &s->spread[i];
        printf("  %6.3f  %15.5g  %7.2f  %11.5g  %12.5g\n", at->strain, at->mean_N,
               100 * at->sd_N / at->mean_N, at->low_N, at->high_N);
    }
}

static void print_laws(const characterize_state *s) {
    if (s->n_laws < 2)
        return;
    printf("Stiffness law: log odds of a spline of 31 knots over each, nats\n");
    printf("  law               parameters      log odds\n");
    for (size_t k = 0; k < s->n_laws; k++)
        printf("  %-16s %11zu  %12.4g%s\n", palp_law_kind_name(s->law[k].kind), s->law[k].n, s->log_odds[k],
               characterize_took(s, k) ? "   taken" : "");
}

int characterize_print(const characterize_options *o, const characterize_state *s) {
    print_static(s);
    print_spread(s);
    print_laws(s);
    print_single(s);
    print_shared(o, s);
    print_final(s);
    print_band(s);
    characterize_tip_print(s);
    characterize_print_specimens(s);
    print_bias(s);
    print_gap(s);
    characterize_print_spectrum(s);
    if (o->out)
        cli_say(stdout, "Written to %s", o->out);
    return cli_flush(NAME);
}
