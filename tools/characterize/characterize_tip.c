/* characterize_tip.c: the tip that pressed, and the moduli of the layer under it. */
#include "characterize.h"
#include "shared/digits.h"
#include "shared/json_out.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "characterize";
static const double RADIAN = 3.14159265358979323846 / 180.0;

/* The option, else the value in the file; 0 = neither. */
static double number_of(double option, const palp_experiment *run, const char *key) {
    double value = 0;
    return option > 0 ? option : palp_experiment_get_number(run, key, &value) == PALP_OK ? value : 0;
}

/* The missing dimension of the tip in words; NULL if none. */
static const char *missing(const palp_indentation *tip) {
    if (tip->tip == PALP_TIP_CONE)
        return tip->half_angle_rad > 0 && tip->half_angle_rad < 90 * RADIAN
                   ? NULL
                   : "--tip-angle-deg, or a line # tip.half_angle_deg: A in the file, between 0 and 90";
    if (tip->radius_m > 0)
        return NULL;
    return tip->tip == PALP_TIP_PLATE ? "the specimen's radius; add a line # specimen.radius_mm: R"
                                      : "--tip-radius-mm, or a line # tip.radius_mm: R in the file";
}

int characterize_tip_read(const characterize_options *o, const palp_experiment *experiment,
                          const palp_recording *run, characterize_state *s) {
    const char *text = NULL;
    palp_indentation *tip = &s->tip[s->n];
    bool in_file = palp_experiment_get_string(experiment, "tip.kind", &text) == PALP_OK;
    *tip = (palp_indentation){
        .thickness_m = run->height_m, .floor_slides = o->floor == 1, .tip_sticks = o->tip_sticks};
    if (o->tip >= 0)
        tip->tip = (palp_tip_kind)o->tip;
    else if (in_file && !palp_tip_find(text, &tip->tip))
        return cli_failure(NAME, "%s: tip.kind is \"%s\", but must be plate, flat, sphere or cone", run->name,
                           text);
    bool known = o->tip >= 0 || in_file;
    if (s->n > 0 && known != s->has_tip)
        return cli_failure(NAME, "%s: has %s, but %s has %s; give --tip for all runs", run->name,
                           known ? "a tip.kind" : "no tip.kind", s->run[0].name, known ? "none" : "one");
    s->has_tip = known;
    if (!known)
        return CLI_OK;
    tip->radius_m = tip->tip == PALP_TIP_PLATE
                        ? run->radius_m
                        : 1e-3 * number_of(o->tip_radius_mm, experiment, "tip.radius_mm");
    if (tip->tip != PALP_TIP_PLATE && !tip->floor_slides)
        tip->large_strain = !o->small_strain;
    if (tip->tip == PALP_TIP_FLAT && !tip->floor_slides)
        tip->specimen_radius_m = run->radius_m;
    tip->half_angle_rad = RADIAN * number_of(o->tip_angle_deg, experiment, "tip.half_angle_deg");
    const char *what = missing(tip);
    return what ? cli_failure(NAME, "%s: a %s tip needs %s", run->name, palp_tip_name(tip->tip), what)
                : CLI_OK;
}

/* Depth to which linear elasticity is within some 2 % (data/tips); zero under a sharp cone. */
static bool too_deep(const palp_indentation *tip, double depth_m) {
    double depth = depth_m / tip->thickness_m;
    if (tip->large_strain)
        return false;
    switch (tip->tip) {
    case PALP_TIP_FLAT:
        return depth > 0.05 || depth_m > 0.13 * tip->radius_m;
    case PALP_TIP_SPHERE:
        return depth > 0.03 || depth_m > 0.08 * tip->radius_m;
    case PALP_TIP_CONE:
        return depth > 0.03 || tip->half_angle_rad < 72 * RADIAN;
    default:
        return depth > 0.05;
    }
}

static size_t first_too_deep(const characterize_state *s) {
    size_t deep = 0;
    while (deep < s->n && !too_deep(&s->tip[deep], s->run[deep].deepest_m))
        deep++;
    return deep;
}

static void judge(const characterize_options *o, characterize_state *s) {
    const palp_moduli *m = &s->moduli;
    size_t deep = first_too_deep(s);
    if (!m->poisson_found && isnan(o->poisson))
        characterize_warn(
            s, "one tip on one thickness cannot identify both modulus and Poisson's ratio: 0.5 is assumed "
               "(incompressible); give --poisson, or add runs with a tip of another size");
    if (m->poisson_found && m->poisson.high - m->poisson.low > 0.2)
        characterize_warn(s, "Poisson's ratio is not identifiable from these tips (%.2f to %.2f)",
                          m->poisson.low, m->poisson.high);
    if (m->misfit > 0.05)
        characterize_warn(s,
                          "the fit of one shear modulus has a residual of %.2g %% of the force (rms): check "
                          "contact, tip and layer; the material may be nonlinear",
                          100 * m->misfit);
    for (size_t i = 0; i < s->n; i++)
        if (s->tip[i].tip != PALP_TIP_PLATE && s->tip[i].specimen_radius_m == 0 && s->run[i].radius_m > 0 &&
            s->run[i].radius_m < (m->widest_contact + 1.5) * s->tip[i].thickness_m) {
            characterize_warn(
                s,
                "%s: the specimen's edge is near the tip, but the moduli assume a wide layer and are too low",
                s->run[i].name);
            break;
        }
    if (deep < s->n)
        characterize_warn(s,
                          "%s: pressed to %.2g of the layer's thickness: small-strain moduli are wrong by "
                          "more than 2 %% at such depths",
                          s->run[deep].name, s->run[deep].deepest_m / s->tip[deep].thickness_m);
}

static palp_moduli_settings settings_of(const characterize_options *o, const characterize_state *s) {
    palp_moduli_settings settings = palp_moduli_settings_default();
    /* Arms as many as asked for, not what one law for all tips has left; else at most three. */
    const size_t found = s->material.n_arms < 3 ? s->material.n_arms : 3;
    settings.n_arms = o->arms_auto ? found : s->n > s->n_static ? o->arms : 0;
    settings.dwell_only = o->dwell_only;
    settings.contact_known = o->contact == 1 || !isnan(o->contact_mm);
    settings.poisson = o->poisson;
    return settings;
}

/* Fits the moduli of each specimen with the common Poisson's ratio; the result is their mean. */
static palp_status pool(const characterize_options *o, characterize_state *s, palp_error *error) {
    const size_t n = s->n_tip_specimens;
    palp_moduli_settings settings = settings_of(o, s);
    palp_recording *run = malloc(s->n * sizeof *run);
    palp_indentation *tip = malloc(s->n * sizeof *tip);
    palp_status status = run && tip ? PALP_OK : PALP_ERR_NO_MEMORY;
    settings.poisson = s->moduli.poisson.value;
    for (size_t k = 0; k < n && !status; k++) {
        size_t own = 0;
        for (size_t r = 0; r < s->n; r++) {
            if (s->specimen[r] == k) {
                run[own] = s->run[r];
                tip[own++] = s->tip[r];
            }
        }
        status = palp_moduli_fit(own, run, tip, &settings, &s->each[k], error);
    }
    free(run);
    free(tip);
    return status ? status : palp_moduli_pool(n, s->each, &s->moduli, s->between_Pa);
}

static palp_status fit(const characterize_options *o, characterize_state *s, palp_error *error) {
    palp_moduli_settings settings = settings_of(o, s);
    palp_status status = palp_moduli_fit(s->n, s->run, s->tip, &settings, &s->moduli, error);
    if (status == PALP_ERR_INPUT && isnan(o->poisson) && s->moduli.n_tips < 2) {
        settings.poisson = 0.5;
        status = palp_moduli_fit(s->n, s->run, s->tip, &settings, &s->moduli, error);
    }
    return status;
}

/* Drops the large-strain correction outside of its tables, with a warning. */
int characterize_tip_fit(const characterize_options *o, characterize_state *s) {
    palp_error error = {PALP_OK, ""};
    if (!s->has_tip)
        return CLI_OK;
    palp_status status = fit(o, s, &error);
    for (int less = 0; status == PALP_ERR_LIMIT && less < 2; less++) {
        for (size_t i = 0; i < s->n; i++) {
            s->tip[i].large_strain = false;
            s->tip[i].specimen_radius_m = less ? 0 : s->tip[i].specimen_radius_m;
        }
        if (less == 0 && !o->small_strain && first_too_deep(s) < s->n)
            characterize_warn(s, "not corrected for large strain: the tables hold for punches of 0.2 to 2 "
                                 "thicknesses pressed to 0.2 thicknesses and 0.25 radii, "
                                 "spheres R of 0.3 to 4 thicknesses h pressed to 0.16 h R / (R + 0.1 h), "
                                 "cones of 70 to 80 degrees pressed to 0.15 h");
        status = fit(o, s, &error);
    }
    if (status == PALP_ERR_UNSUPPORTED)
        return cli_failure(NAME, "%s: --tip-sticks needs a plate, or a flat punch and --floor bonded",
                           s->run[0].name);
    if (status == PALP_ERR_LIMIT && o->tip_sticks)
        return cli_failure(NAME,
                           "%s: --tip-sticks is tabulated for punches of 0.2 to 2 thicknesses and plates of "
                           "0.2 to 4 heights",
                           s->run[0].name);
    if (status == PALP_ERR_LIMIT)
        return cli_failure(NAME,
                           "%s: the contact is wider than %g thicknesses of the layer; give --tip plate",
                           s->run[0].name, PALP_INDENTATION_WIDEST);
    if (status == PALP_OK && s->n_tip_specimens > 1)
        status = pool(o, s, &error);
    if (status)
        return cli_status(NAME, status, &error);
    judge(o, s);
    return CLI_OK;
}

static void print_modulus(const char *name, const palp_modulus *m) {
    double scale = m->value >= 1e6   ? 1e-6
                   : m->value >= 1e3 ? 1e-3
                                     : 1,
           half = 0.5 * scale * (m->high - m->low);
    char value[DIGITS_TEXT], low[DIGITS_TEXT], high[DIGITS_TEXT];
    printf("  %-28s %12s   %s to %s %s\n", name, digits_text(value, scale * m->value, half),
           digits_text(low, scale * m->low, half), digits_text(high, scale * m->high, half),
           scale == 1     ? "Pa"
           : scale > 1e-5 ? "kPa"
                          : "MPa");
}

void characterize_tip_print(const characterize_state *s) {
    const palp_moduli *m = &s->moduli;
    if (!s->has_tip)
        return;
    printf("Moduli of the layer under %s tip%s (layer %s; %s; the tip %s)\n",
           m->n_tips > 1 ? "the" : palp_tip_name(s->tip[0].tip), m->n_tips > 1 ? "s" : "",
           s->tip[0].tip == PALP_TIP_PLATE || s->tip[0].floor_slides ? "sliding on its floor"
                                                                     : "bonded to its floor",
           s->tip[0].large_strain ? "neo-Hookean" : "small strain",
           s->tip[0].tip_sticks ? "sticks" : "slides");
    if (m->poisson_found)
        printf("  %-28s %12.3f   %.3f to %.3f, from %zu tips of different size\n", "Poisson's ratio",
               m->poisson.value, m->poisson.low, m->poisson.high, m->n_tips);
    else
        printf("  %-28s %12.3f   assumed: not identifiable from these runs\n", "Poisson's ratio",
               m->poisson.value);
    print_modulus("G_inf, shear, long-term", &m->shear_inf_Pa);
    print_modulus("G_0, shear, instantaneous", &m->shear_0_Pa);
    print_modulus("E_inf = 2 (1 + nu) G_inf", &m->young_inf_Pa);
    print_modulus("E_0 = 2 (1 + nu) G_0", &m->young_0_Pa);
    for (size_t k = 0; k < s->n_tip_specimens; k++)
        printf("  of %-25s %12.5g   G_0 %.5g Pa, from its own runs\n", characterize_specimen_name(s, k),
               s->each[k].shear_inf_Pa.value, s->each[k].shear_0_Pa.value);
    if (s->n_tip_specimens > 1)
        printf("  sd between specimens         %12.3g   G_0 %.3g Pa; the moduli above are of the mean, "
               "their intervals from the spread\n",
               s->between_Pa[0], s->between_Pa[1]);
    if (!m->poisson_found)
        printf("  G_inf would be %.4g Pa with a ratio of 0.5, %.4g Pa with 0.3\n", m->shear_low_Pa,
               m->shear_high_Pa);
    if (m->largest_shift_m > 0)
        printf("  contact was fitted with the moduli, up to %.3g mm from the recordings' (--contact known "
               "keeps theirs)\n",
               1e3 * m->largest_shift_m);
    printf("  contact up to %.3g, depth up to %.3g thicknesses; residual %.2g %% of the force (rms)\n",
           m->widest_contact, m->largest_depth, 100 * m->misfit);
}

static json_t *modulus_json(const palp_modulus *m) {
    json_t *to = json_object();
    json_figures(to, {"value", m->value}, {"sd", m->sd}, {"low", m->low}, {"high", m->high});
    return to;
}

static json_t *tip_json(const characterize_state *s, size_t i) {
    const palp_indentation *tip = &s->tip[i];
    bool cone = tip->tip == PALP_TIP_CONE;
    return json_pack("{s:s, s:s, s:o, s:o, s:f}", "file", s->run[i].name, "kind", palp_tip_name(tip->tip),
                     "radius_mm", cone ? json_null() : json_real(1e3 * tip->radius_m), "half_angle_deg",
                     cone ? json_real(tip->half_angle_rad / RADIAN) : json_null(), "thickness_mm",
                     1e3 * tip->thickness_m);
}

json_t *characterize_tip_json(const characterize_state *s) {
    const palp_moduli *m = &s->moduli;
    if (!s->has_tip)
        return json_null();
    json_t *tips = json_array(), *arms = json_array(), *to = json_object();
    for (size_t i = 0; i < s->n; i++)
        json_array_append_new(tips, tip_json(s, i));
    for (size_t j = 0; j < m->n_arms; j++)
        json_array_append_new(arms, json_pack("{s:f, s:f}", "shear_Pa", m->arm_Pa[j], "tau_s", m->tau_s[j]));
    json_t *each = json_array();
    for (size_t k = 0; k < s->n_tip_specimens; k++)
        json_array_append_new(each, json_pack("{s:s, s:o, s:o}", "name", characterize_specimen_name(s, k),
                                              "shear_inf_Pa", modulus_json(&s->each[k].shear_inf_Pa),
                                              "shear_0_Pa", modulus_json(&s->each[k].shear_0_Pa)));
    json_object_set_new(to, "specimens", each);
    json_object_set_new(to, "tips", tips);
    json_object_set_new(to, "floor", json_string(s->tip[0].floor_slides ? "slides" : "bonded"));
    json_object_set_new(to, "tip_sticks", json_boolean(s->tip[0].tip_sticks));
    json_object_set_new(to, "large_strain", json_boolean(s->tip[0].large_strain));
    json_object_set_new(to, "poisson", modulus_json(&m->poisson));
    json_object_set_new(to, "poisson_found", json_boolean(m->poisson_found));
    json_object_set_new(to, "shear_inf_Pa", modulus_json(&m->shear_inf_Pa));
    json_object_set_new(to, "shear_0_Pa", modulus_json(&m->shear_0_Pa));
    json_object_set_new(to, "young_inf_Pa", modulus_json(&m->young_inf_Pa));
    json_object_set_new(to, "young_0_Pa", modulus_json(&m->young_0_Pa));
    json_object_set_new(to, "arms", arms);
    json_figures(to, {"shear_inf_at_0_5_Pa", m->shear_low_Pa}, {"shear_inf_at_0_3_Pa", m->shear_high_Pa},
                 {"largest_depth", m->largest_depth}, {"widest_contact", m->widest_contact},
                 {"contact_shift_mm", 1e3 * m->largest_shift_m}, {"misfit", m->misfit});
    return to;
}
