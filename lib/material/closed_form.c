/* closed_form.c: closed-form responses of viscoelastic models (Section 3.1.2, Eq. 3.20-3.56, 4.7). */
#include <palpate/closed_form.h>

#include "element.h"

#include <float.h>
#include <math.h>

static const double PI = 3.14159265358979323846;

/* Stress of a Maxwell arm, z(t) - z(t - c) of Eq. 3.50 as one product: its value at the end of the ramp, and
 * the decay since. The thesis' exp(c / tau) would overflow for a long ramp. */
static double arm_stress_on_ramp_hold(palp_spring_dashpot arm, double rate, double ramp_s, double t) {
    double ramped = fmin(t, ramp_s), tau = arm.viscosity_Pa_s / arm.modulus_Pa;
    return -rate * arm.viscosity_Pa_s * expm1(-ramped / tau) * exp(-(t - ramped) / tau);
}

static double arm_stress_after_step(palp_spring_dashpot arm, double strain, double t) {
    return strain * arm.modulus_Pa * exp(-t * arm.modulus_Pa / arm.viscosity_Pa_s);
}

/* Eq. 3.20 */
double palp_maxwell_creep(palp_spring_dashpot model, double stress_Pa, double t) {
    return t < 0.0 ? 0.0 : stress_Pa * (1.0 / model.modulus_Pa + t / model.viscosity_Pa_s);
}

/* Eq. 3.21 */
double palp_maxwell_relaxation(palp_spring_dashpot model, double strain, double t) {
    return t < 0.0 ? 0.0 : arm_stress_after_step(model, strain, t);
}

/* Eq. 3.23 */
double palp_maxwell_ramp(palp_spring_dashpot model, double rate_1_s, double t) {
    return palp_maxwell_ramp_hold(model, rate_1_s, t, t);
}

/* Eq. 3.25 */
double palp_maxwell_ramp_hold(palp_spring_dashpot model, double rate_1_s, double ramp_s, double t) {
    return t < 0.0 ? 0.0 : arm_stress_on_ramp_hold(model, rate_1_s, ramp_s, t);
}

/* Eq. 3.28 */
double palp_voigt_creep(palp_spring_dashpot model, double stress_Pa, double t) {
    if (t < 0.0)
        return 0.0;
    return -stress_Pa / model.modulus_Pa * expm1(-t * model.modulus_Pa / model.viscosity_Pa_s);
}

/* Eq. 3.29 and the strain impulse that it leaves out. */
double palp_voigt_relaxation(palp_spring_dashpot model, double strain, double t, double *impulse_Pa_s) {
    if (impulse_Pa_s)
        *impulse_Pa_s = model.viscosity_Pa_s * strain;
    return t < 0.0 ? 0.0 : model.modulus_Pa * strain;
}

/* Eq. 3.30 */
double palp_voigt_ramp(palp_spring_dashpot model, double rate_1_s, double t) {
    return palp_voigt_ramp_hold(model, rate_1_s, t, t);
}

/* Eq. 3.33, with its step u(t - c) taken as 0 at t = c. */
double palp_voigt_ramp_hold(palp_spring_dashpot model, double rate_1_s, double ramp_s, double t) {
    if (t < 0.0)
        return 0.0;
    double viscous = t <= ramp_s ? model.viscosity_Pa_s : 0.0;
    return rate_1_s * (viscous + model.modulus_Pa * fmin(t, ramp_s));
}

/* Eq. 3.42 with 3.43, rearranged so that it becomes Eq. 3.20 as the spring goes to 0. */
double palp_maxwell_solid_creep(double spring_Pa, palp_spring_dashpot arm, double stress_Pa, double t) {
    if (t < 0.0)
        return 0.0;
    if (spring_Pa == 0.0)
        return palp_maxwell_creep(arm, stress_Pa, t);
    double instant = spring_Pa + arm.modulus_Pa;
    double tau_sigma = arm.viscosity_Pa_s / spring_Pa + arm.viscosity_Pa_s / arm.modulus_Pa;
    double delayed = -arm.modulus_Pa / spring_Pa * expm1(-t / tau_sigma);
    return stress_Pa / instant * (1.0 + delayed);
}

/* Eq. 3.45 */
double palp_maxwell_solid_relaxation(double spring_Pa, palp_spring_dashpot arm, double strain, double t) {
    return t < 0.0 ? 0.0 : spring_Pa * strain + arm_stress_after_step(arm, strain, t);
}

/* Eq. 3.48 */
double palp_maxwell_solid_ramp(double spring_Pa, palp_spring_dashpot arm, double rate_1_s, double t) {
    return palp_maxwell_solid_ramp_hold(spring_Pa, arm, rate_1_s, t, t);
}

/* Eq. 3.50 */
double palp_maxwell_solid_ramp_hold(double spring_Pa, palp_spring_dashpot arm, double rate_1_s, double ramp_s,
                                    double t) {
    if (t < 0.0)
        return 0.0;
    return spring_Pa * rate_1_s * fmin(t, ramp_s) + arm_stress_on_ramp_hold(arm, rate_1_s, ramp_s, t);
}

/* Eq. 3.54 */
double palp_generalized_maxwell_relaxation(const palp_generalized_maxwell *model, double strain, double t) {
    if (!model)
        return NAN;
    if (t < 0.0)
        return 0.0;
    double stress = model->spring_Pa * strain;
    for (size_t j = 0; j < model->n_arms; j++)
        stress += arm_stress_after_step(model->arms[j], strain, t);
    return stress;
}

/* Eq. 3.55 */
double palp_generalized_maxwell_ramp(const palp_generalized_maxwell *model, double rate_1_s, double t) {
    return model ? palp_generalized_maxwell_ramp_hold(model, rate_1_s, t, t) : NAN;
}

/* Eq. 3.56 */
double palp_generalized_maxwell_ramp_hold(const palp_generalized_maxwell *model, double rate_1_s,
                                          double ramp_s, double t) {
    if (!model)
        return NAN;
    if (t < 0.0)
        return 0.0;
    double stress = model->spring_Pa * rate_1_s * fmin(t, ramp_s);
    for (size_t j = 0; j < model->n_arms; j++)
        stress += arm_stress_on_ramp_hold(model->arms[j], rate_1_s, ramp_s, t);
    return stress;
}

/* Arms by rising rate 1 / tau; arms of equal tau are merged. */
typedef struct spectrum_arms {
    size_t n;
    double modulus[PALP_ARMS_MAX], rate[PALP_ARMS_MAX];
} spectrum_arms;

static palp_status check_maxwell_solid(const palp_generalized_maxwell *model) {
    if (model->n_arms > PALP_ARMS_MAX)
        return PALP_ERR_LIMIT;
    if (!(model->spring_Pa >= 0.0) || !isfinite(model->spring_Pa))
        return PALP_ERR_ARGUMENT;
    for (size_t j = 0; j < model->n_arms; j++) {
        double modulus = model->arms[j].modulus_Pa, viscosity = model->arms[j].viscosity_Pa_s;
        if (!(modulus > 0.0 && viscosity > 0.0) || !isfinite(modulus) || !isfinite(viscosity))
            return PALP_ERR_ARGUMENT;
    }
    return model->spring_Pa > 0.0 || model->n_arms > 0 ? PALP_OK : PALP_ERR_ARGUMENT;
}

static void insert_arm_by_rate(spectrum_arms *arms, double modulus, double rate) {
    size_t i = 0;
    while (i < arms->n && arms->rate[i] < rate * (1.0 - 8.0 * DBL_EPSILON))
        i++;
    if (i < arms->n && arms->rate[i] <= rate * (1.0 + 8.0 * DBL_EPSILON)) {
        arms->modulus[i] += modulus;
        return;
    }
    for (size_t k = arms->n++; k > i; k--) {
        arms->modulus[k] = arms->modulus[k - 1];
        arms->rate[k] = arms->rate[k - 1];
    }
    arms->modulus[i] = modulus;
    arms->rate[i] = rate;
}

/* The zero p of sum_j E_j p / (r_j - p) - E_inf, which rises on low < p < high, to the last bit. */
static double find_retardation_rate(const spectrum_arms *arms, double spring, double low, double high) {
    for (;;) {
        double p = low + 0.5 * (high - low), sum = -spring;
        if (p <= low || p >= high)
            return p;
        for (size_t j = 0; j < arms->n; j++)
            sum += arms->modulus[j] * p / (arms->rate[j] - p);
        if (sum < 0.0)
            low = p;
        else
            high = p;
    }
}

static void add_retardation_element(palp_retardation *spectrum, const spectrum_arms *arms, double p) {
    double sum = 0.0;
    for (size_t j = 0; j < arms->n; j++) {
        double gap = arms->rate[j] - p;
        sum += arms->modulus[j] * arms->rate[j] / (gap * gap);
    }
    spectrum->time_s[spectrum->n] = 1.0 / p;
    spectrum->compliance_1_Pa[spectrum->n++] = 1.0 / (p * sum);
}

palp_status palp_retardation_spectrum(const palp_generalized_maxwell *model, palp_retardation *spectrum) {
    if (!model || !spectrum)
        return PALP_ERR_ARGUMENT;
    palp_status status = check_maxwell_solid(model);
    if (status != PALP_OK)
        return status;
    spectrum_arms arms = {0};
    double total = 0.0, viscosity = 0.0;
    for (size_t j = 0; j < model->n_arms; j++) {
        const palp_spring_dashpot *arm = &model->arms[j];
        insert_arm_by_rate(&arms, arm->modulus_Pa, arm->modulus_Pa / arm->viscosity_Pa_s);
        total += arm->modulus_Pa;
        viscosity += arm->viscosity_Pa_s;
    }
    double spring = model->spring_Pa;
    *spectrum = (palp_retardation){.instant_1_Pa = 1.0 / (spring + total)};
    if (spring == 0.0)
        spectrum->fluidity_1_Pa_s = 1.0 / viscosity;
    /* p_1 >= r_1 E_inf / (E_inf + sum E_j), with equality for one arm */
    for (size_t k = spring == 0.0 ? 1 : 0; k < arms.n; k++) {
        double low = k ? arms.rate[k - 1] : 0.5 * arms.rate[0] * spring / (spring + total);
        add_retardation_element(spectrum, &arms, find_retardation_rate(&arms, spring, low, arms.rate[k]));
    }
    return PALP_OK;
}

/* The creep of palp_retardation; for one arm Eq. 3.42. */
double palp_generalized_maxwell_creep(const palp_retardation *spectrum, double stress_Pa, double t) {
    if (!spectrum)
        return NAN;
    if (t < 0.0)
        return 0.0;
    double compliance = spectrum->instant_1_Pa + spectrum->fluidity_1_Pa_s * t;
    for (size_t k = 0; k < spectrum->n; k++)
        compliance -= spectrum->compliance_1_Pa[k] * expm1(-t / spectrum->time_s[k]);
    return stress_Pa * compliance;
}

/* q_j of Eq. 4.7 for ramp and hold, with the beta term of E_j(strain) in Eq. 3.79. A drive K_j (1 + beta |A|
 * t) A reaches K_j A (tau g + beta |A| (tau t - tau^2 g)) at t, with g = 1 - exp(-t/tau). */
static double lumped_arm_force_at(const palp_arm *arm, double strain, double ramp_s, double t) {
    double k = arm->stiffness_N, tau = arm->viscosity_Ns / k;
    if (ramp_s == 0.0)
        return k * strain * (1.0 + 0.5 * arm->beta * fabs(strain)) * exp(-t / tau);
    double rate = strain / ramp_s, ramped = fmin(t, ramp_s), g = -expm1(-ramped / tau);
    double gained = tau * g + arm->beta * fabs(rate) * tau * (ramped - tau * g);
    return k * rate * gained * exp(-(t - ramped) / tau);
}

static double lumped_force_at_time(const palp_material *material, double strain, double ramp_s, double t) {
    if (t < 0.0)
        return 0.0;
    double e = t < ramp_s ? strain * (t / ramp_s) : strain, force;
    palp_law_force(&material->law, 1, &e, &force, NULL, NULL);
    for (size_t j = 0; j < material->n_arms; j++)
        force += lumped_arm_force_at(&material->arms[j], strain, ramp_s, t);
    if (material->dashpot_Ns > 0.0 && t <= ramp_s)
        force += material->dashpot_Ns * strain / ramp_s;
    return force;
}

palp_status palp_lumped_ramp_hold(const palp_material *material, double strain, double ramp_s, size_t n,
                                  const double *time_s, double *force_N) {
    if (!material || !time_s || !force_N)
        return PALP_ERR_ARGUMENT;
    palp_status status = palp_material_check(material, NULL);
    if (status != PALP_OK)
        return status;
    for (size_t j = 0; j < material->n_arms; j++) {
        if (material->arms[j].gamma != 0.0)
            return PALP_ERR_UNSUPPORTED;
    }
    if (material->quasi_linear)
        return PALP_ERR_UNSUPPORTED;
    if (!(ramp_s >= 0.0) || !isfinite(ramp_s) || !isfinite(strain) ||
        (ramp_s == 0.0 && material->dashpot_Ns > 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        force_N[i] = lumped_force_at_time(material, strain, ramp_s, time_s[i]);
    return PALP_OK;
}

palp_status palp_lumped_oscillation(const palp_material *material, double height_m, double strain, size_t n,
                                    const double *frequency_Hz, double *storage_N_m, double *loss_N_m) {
    double force, tangent, drive[PALP_ARMS_MAX];
    if (!material || !frequency_Hz || !storage_N_m || !loss_N_m || !(height_m > 0.0) || !isfinite(strain))
        return PALP_ERR_ARGUMENT;
    palp_status status = palp_material_check(material, NULL);
    if (status != PALP_OK || material->formulation == PALP_SEDEF2008)
        return status != PALP_OK ? status : PALP_ERR_UNSUPPORTED;
    palp_law_force(&material->law, 1, &strain, &force, &tangent, NULL);
    for (size_t j = 0; j < material->n_arms; j++)
        drive[j] = element_arm_drive(material, j, strain, force, tangent, 0.0).slope;
    for (size_t i = 0; i < n; i++) {
        const double w = 2.0 * PI * frequency_Hz[i];
        if (!(w > 0.0) || !isfinite(w))
            return PALP_ERR_ARGUMENT;
        double storage = tangent, loss = material->dashpot_Ns * w;
        for (size_t j = 0; j < material->n_arms; j++) {
            const palp_arm *arm = &material->arms[j];
            double x = w * arm->viscosity_Ns / arm->stiffness_N * (1.0 + arm->gamma * fabs(strain)),
                   part = 1.0 / (1.0 + x * x);
            storage += arm->stiffness_N * drive[j] * x * x * part;
            loss += arm->stiffness_N * drive[j] * x * part;
        }
        storage_N_m[i] = storage / height_m;
        loss_N_m[i] = loss / height_m;
    }
    return PALP_OK;
}
