/* indentation_factor.c: factor of the force for large strain, finite width and adhesion of the layer, by
 * interpolation in tables made with CalculiX. */
#include "indentation_internal.h"
#include "indentation_tables.h"

#include <math.h>

/* The polynomial through n points at x; n is small. */
static double interpolate_polynomial_at(size_t n, const double *at, const double *value, double x) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        double weight = value[i];
        for (size_t j = 0; j < n; j++)
            weight *= j == i ? 1.0 : (x - at[j]) / (at[i] - at[j]);
        sum += weight;
    }
    return sum;
}

/* The tables start at 0.3; they go on along their slope to the ratio of springs, 1/4, and keep that value
 * below it. */
static const double LEAST_NU = 0.25;

/* Linear interpolation of compliance between Poisson's ratios. */
static size_t find_poisson_interval(double poisson, double *part) {
    size_t i = 0;
    while (i + 2 < TABLE_NU && poisson >= table_nu[i + 1])
        i++;
    *part = (fmax(poisson, LEAST_NU) - table_nu[i]) / (table_nu[i + 1] - table_nu[i]);
    return i;
}

static double interpolate_over_ratio(const double value[TABLE_RATIO], double ratio) {
    double at[TABLE_RATIO];
    for (size_t i = 0; i < TABLE_RATIO; i++)
        at[i] = log(table_ratio[i]);
    return interpolate_polynomial_at(TABLE_RATIO, at, value, log(ratio));
}

/* Factor of a flat punch at a depth, given as a share of the table's largest. */
static double large_depth_factor(size_t nu, double ratio, double part) {
    double at[TABLE_DEPTH + 1] = {0}, value[TABLE_DEPTH + 1] = {1}, row[TABLE_RATIO];
    for (size_t i = 0; i < TABLE_RATIO; i++) {
        for (size_t k = 1; k <= TABLE_DEPTH; k++) {
            at[k] = (double)k / TABLE_DEPTH;
            value[k] = table_large[nu][i][k - 1];
        }
        row[i] = interpolate_polynomial_at(TABLE_DEPTH + 1, at, value, part);
    }
    return interpolate_over_ratio(row, ratio);
}

/* The thickness for which a tip has its factor. A sphere that is smaller than those of the tables hardly
 * feels the floor: its factor is that of the smallest one on the layer that is as much thinner. */
static double tabulated_thickness(const palp_indentation *in) {
    return in->tip == PALP_TIP_SPHERE ? fmin(in->thickness_m, in->radius_m / SPHERE_LEAST) : in->thickness_m;
}

/* The largest depth of a tip that the fits cover. */
static double deepest_tabulated_press(const palp_indentation *in) {
    double h = tabulated_thickness(in);
    if (in->tip == PALP_TIP_SPHERE)
        return SPHERE_DEPTH * in->radius_m * h / (in->radius_m + SPHERE_SHARE * h);
    return in->tip == PALP_TIP_CONE ? CONE_DEPTH * in->thickness_m
                                    : fmin(0.2 * in->thickness_m, 0.25 * in->radius_m);
}

/* For a sphere or cone the factor is so near to 1 that a few terms fit it; data/tips/make_tables.py has the
 * same terms. */
static double large_curved(const palp_indentation *in, double depth_m) {
    double p = fmax(depth_m, 0.0) / deepest_tabulated_press(in),
           n = 10.0 * (fmax(in->poisson, LEAST_NU) - 0.4), sum = 1.0;
    if (in->tip == PALP_TIP_SPHERE) {
        double x = log(in->radius_m / tabulated_thickness(in)), s = sqrt(p),
               term[LARGE_TERMS] = {s, s * n, s * n * n, s * x, s * x * n, p, p * n, p * x, p * x * n};
        for (size_t i = 0; i < LARGE_TERMS; i++)
            sum += large_sphere[i] * term[i];
        return sum;
    }
    double c = 1.0 / tan(in->half_angle_rad),
           term[LARGE_TERMS] = {1.0, n, n * n, p, p * n, c, c * n, c * p, c * p * n};
    for (size_t i = 0; i < LARGE_TERMS; i++)
        sum += large_cone[i] * term[i];
    return sum;
}

/* Factor of a flat punch on a specimen of finite width, by the punch's share of its radius (0: wide layer).
 * Interpolates the four nearest points. */
static double specimen_radius_factor(size_t nu, double ratio, double share) {
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
        row[i] = interpolate_polynomial_at(4, at + first, value + first, share);
    }
    return interpolate_over_ratio(row, ratio);
}

static double glued_plate_factor(size_t nu, double ratio) {
    double at[TABLE_SLENDER];
    for (size_t i = 0; i < TABLE_SLENDER; i++)
        at[i] = log(table_slender[i]);
    return interpolate_polynomial_at(TABLE_SLENDER, at, table_glue[nu], log(ratio));
}

static double factor_at_table_poisson(const palp_indentation *in, size_t nu, double depth_m) {
    double ratio = in->radius_m / in->thickness_m, factor = 1;
    if (in->tip == PALP_TIP_PLATE)
        return glued_plate_factor(nu, ratio);
    if (in->large_strain)
        factor *= large_depth_factor(nu, ratio, depth_m / fmin(0.2 * in->thickness_m, 0.4 * in->radius_m));
    if (in->specimen_radius_m > 0)
        factor *= specimen_radius_factor(nu, ratio, in->radius_m / in->specimen_radius_m);
    return in->tip_sticks ? factor * interpolate_over_ratio(table_stick[nu], ratio) : factor;
}

static bool is_sphere_or_cone(const palp_indentation *in) {
    return in->tip == PALP_TIP_SPHERE || in->tip == PALP_TIP_CONE;
}

static bool is_correction_wanted(const palp_indentation *in) {
    return in->tip_sticks || (in->tip != PALP_TIP_PLATE && (in->large_strain || in->specimen_radius_m > 0));
}

/* Is the tip's size within the tables? */
static bool is_tip_within_tables(const palp_indentation *in) {
    double ratio = in->radius_m / in->thickness_m;
    if (in->tip == PALP_TIP_PLATE)
        return ratio >= table_slender[0] && ratio <= table_slender[TABLE_SLENDER - 1];
    if (in->tip == PALP_TIP_SPHERE)
        return ratio <= 1.001 * SPHERE_MOST;
    if (in->tip == PALP_TIP_CONE)
        return tan(in->half_angle_rad) >= 0.999 * CONE_LEAST && tan(in->half_angle_rad) <= 1.001 * CONE_MOST;
    return ratio >= 0.999 * table_ratio[0] && ratio <= 1.001 * table_ratio[TABLE_RATIO - 1] &&
           (in->specimen_radius_m == 0 || in->specimen_radius_m >= 0.999 * in->radius_m);
}

palp_status indentation_factor_check(const palp_indentation *in, double deepest_m) {
    if (!is_correction_wanted(in))
        return PALP_OK;
    if (in->floor_slides || (is_sphere_or_cone(in) && in->tip_sticks))
        return PALP_ERR_UNSUPPORTED;
    if (is_sphere_or_cone(in) && !in->large_strain)
        return PALP_OK; /* what is narrow is known by the punches as wide as its contacts */
    bool deep =
        in->large_strain && in->tip != PALP_TIP_PLATE && deepest_m > 1.001 * deepest_tabulated_press(in);
    return is_tip_within_tables(in) && !deep ? PALP_OK : PALP_ERR_LIMIT;
}

double indentation_factor(const palp_indentation *in, double depth_m) {
    double part;
    if (!is_correction_wanted(in))
        return 1.0;
    if (is_sphere_or_cone(in))
        return in->large_strain ? large_curved(in, depth_m) : 1.0;
    size_t nu = find_poisson_interval(in->poisson, &part);
    return 1.0 / ((1.0 - part) / factor_at_table_poisson(in, nu, depth_m) +
                  part / factor_at_table_poisson(in, nu + 1, depth_m));
}

double indentation_smallest_punch(const palp_indentation *in) {
    return table_ratio[0] * in->thickness_m;
}
