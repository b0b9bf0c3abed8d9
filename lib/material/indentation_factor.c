/* indentation_factor.c: what the contact of a wide layer at small strain lacks, by interpolation in tables of CalculiX. */
#include "indentation_internal.h"
#include "indentation_tables.h"

#include <math.h>

/* The polynomial through n points at x; n is small. */
static double through(size_t n, const double *at, const double *value, double x) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        double weight = value[i];
        for (size_t j = 0; j < n; j++)
            weight *= j == i ? 1.0 : (x - at[j]) / (at[i] - at[j]);
        sum += weight;
    }
    return sum;
}

/* Compliance is straight between Poisson's ratios; below the first as at the first. */
static size_t interval_of(double poisson, double *part) {
    size_t i = 0;
    while (i + 2 < TABLE_NU && poisson >= table_nu[i + 1])
        i++;
    *part = fmax((poisson - table_nu[i]) / (table_nu[i + 1] - table_nu[i]), 0.0);
    return i;
}

static double by_ratio(const double value[TABLE_RATIO], double ratio) {
    double at[TABLE_RATIO];
    for (size_t i = 0; i < TABLE_RATIO; i++)
        at[i] = log(table_ratio[i]);
    return through(TABLE_RATIO, at, value, log(ratio));
}

/* Of a depth as a part of the table's. */
static double large(size_t nu, double ratio, double part) {
    double at[TABLE_DEPTH + 1] = {0}, value[TABLE_DEPTH + 1] = {1}, row[TABLE_RATIO];
    for (size_t i = 0; i < TABLE_RATIO; i++) {
        for (size_t k = 1; k <= TABLE_DEPTH; k++) {
            at[k] = (double)k / TABLE_DEPTH;
            value[k] = table_large[nu][i][k - 1];
        }
        row[i] = through(TABLE_DEPTH + 1, at, value, part);
    }
    return by_ratio(row, ratio);
}

/* By the punch's share of the specimen's radius, which is 0 for a wide layer; through the four points around it. */
static double wide(size_t nu, double ratio, double share) {
    double at[TABLE_AROUND + 1] = {0}, row[TABLE_RATIO];
    for (size_t k = 0; k < TABLE_AROUND; k++)
        at[k] = 1.0 / table_around[k];
    size_t first = 0;
    while (first + 4 < TABLE_AROUND + 1 && share < at[first + 2])
        first++;
    for (size_t i = 0; i < TABLE_RATIO; i++) {
        double value[TABLE_AROUND + 1];
        for (size_t k = 0; k < TABLE_AROUND; k++)
            value[k] = table_wide[nu][i][k];
        value[TABLE_AROUND] = 1.0;
        row[i] = through(4, at + first, value + first, share);
    }
    return by_ratio(row, ratio);
}

static double glue(size_t nu, double ratio) {
    double at[TABLE_SLENDER];
    for (size_t i = 0; i < TABLE_SLENDER; i++)
        at[i] = log(table_slender[i]);
    return through(TABLE_SLENDER, at, table_glue[nu], log(ratio));
}

static double at_poisson(const palp_indentation *in, size_t nu, double depth_m) {
    double ratio = in->radius_m / in->thickness_m, factor = 1;
    if (in->tip == PALP_TIP_PLATE)
        return glue(nu, ratio);
    if (in->large_strain)
        factor *= large(nu, ratio, depth_m / fmin(0.2 * in->thickness_m, 0.4 * in->radius_m));
    if (in->specimen_radius_m > 0)
        factor *= wide(nu, ratio, in->radius_m / in->specimen_radius_m);
    return in->tip_sticks ? factor * by_ratio(table_stick[nu], ratio) : factor;
}

palp_status indentation_factor_check(const palp_indentation *in, double deepest_m) {
    bool flat = in->tip == PALP_TIP_FLAT, plate = in->tip == PALP_TIP_PLATE;
    double ratio = in->radius_m / in->thickness_m;
    bool wanted = in->tip_sticks || (!plate && (in->large_strain || in->specimen_radius_m > 0));
    if (!wanted)
        return PALP_OK;
    if (in->floor_slides || (!flat && !plate))
        return PALP_ERR_UNSUPPORTED;
    if (plate)
        return ratio >= table_slender[0] && ratio <= table_slender[TABLE_SLENDER - 1] ? PALP_OK : PALP_ERR_LIMIT;
    bool inside = ratio >= 0.999 * table_ratio[0] && ratio <= 1.001 * table_ratio[TABLE_RATIO - 1];
    inside = inside && (in->specimen_radius_m == 0 || in->specimen_radius_m >= 0.999 * in->radius_m);
    inside = inside && (!in->large_strain || deepest_m <= 1.001 * fmin(0.2 * in->thickness_m, 0.25 * in->radius_m));
    return inside ? PALP_OK : PALP_ERR_LIMIT;
}

double indentation_factor(const palp_indentation *in, double depth_m) {
    bool wanted = in->tip_sticks || (in->tip == PALP_TIP_FLAT && (in->large_strain || in->specimen_radius_m > 0));
    double part;
    if (!wanted)
        return 1.0;
    size_t nu = interval_of(in->poisson, &part);
    return 1.0 / ((1.0 - part) / at_poisson(in, nu, depth_m) + part / at_poisson(in, nu + 1, depth_m));
}
