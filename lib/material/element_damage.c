/* element_damage.c: softening and permanent set of a spring by its largest strain so far (Ogden and Roxburgh
 * 1999). */
#include "element.h"

#include <math.h>

/* Strain in a spring's law below its peak, and its derivatives. */
static void strain_after_permanent_set(const element_damage *damage, double e, double peak,
                                       element_damaged *out, double *by_strain, double *by_peak) {
    double rest = 1.0 - damage->set, seen = (fabs(e) - damage->set * peak) / rest,
           sign = e < 0.0 ? -1.0 : 1.0;
    if (seen < damage->slack * fabs(e)) {
        out->inner = damage->slack * e;
        *by_strain = damage->slack;
        return;
    }
    out->inner = sign * seen;
    out->by_set = sign * (fabs(e) - peak) / (rest * rest);
    *by_strain = 1.0 / rest;
    *by_peak = -sign * damage->set / rest;
}

void element_damage_force(const palp_law *law, const element_damage *damage, double e, double peak,
                          element_damaged *out) {
    const double slope_of_erf = 1.12837916709551257390; /* 2 / sqrt(pi) */
    double law_force, tangent, energy, peak_force, peak_energy, by_strain = 1.0, by_peak = 0.0;
    *out = (element_damaged){.peak = fmax(fabs(e), peak), .inner = e, .factor = 1.0};
    if (fabs(e) < peak)
        palp_law_force(law, 1, &peak, &peak_force, NULL, &peak_energy);
    if (!(fabs(e) < peak) || !(peak_energy > 0.0)) {
        palp_law_force(law, 1, &e, &out->force, &out->by_strain, NULL);
        return;
    }
    strain_after_permanent_set(damage, e, peak, out, &by_strain, &by_peak);
    palp_law_force(law, 1, &out->inner, &law_force, &tangent, &energy);
    double ratio = (1.0 - energy / peak_energy) / damage->sharpness;
    double steep = slope_of_erf * exp(-ratio * ratio) / (damage->sharpness * peak_energy);
    out->by_softening = -law_force * erf(ratio);
    out->by_sharpness = law_force * damage->softening * steep * peak_energy * ratio;
    out->factor = 1.0 - damage->softening * erf(ratio);
    out->factor_by_energy = damage->softening * steep;
    out->factor_by_peak_energy = -damage->softening * steep * energy / peak_energy;
    double by_inner = out->factor * tangent + law_force * law_force * out->factor_by_energy;
    out->force = out->factor * law_force;
    out->by_set *= by_inner;
    out->by_strain = by_inner * by_strain;
    out->by_peak = by_inner * by_peak + law_force * out->factor_by_peak_energy * peak_force;
}
