/* characterize_law.c: first guesses of the stiffness laws. */
#include "characterize.h"

#include <math.h>
#include <string.h>

/* Fits a law to K_inf of the depths, as if recorded by a static press, by least squares. */
palp_status characterize_law_of_depths(const characterize_state *s, size_t degree, palp_law *law) {
    double depth[CHARACTERIZE_RUNS_MAX], force[CHARACTERIZE_RUNS_MAX], norm = 0;
    unsigned char use[CHARACTERIZE_RUNS_MAX];
    palp_recording points = {
        .height_m = s->run[0].height_m, .n = s->n_hold, .depth_m = depth, .force_N = force, .use = use};
    for (size_t i = 0; i < s->n_hold; i++) {
        double strain = s->run[s->n_static + i].deepest_m / points.height_m;
        double k = s->has_shared ? s->shared.spring_N[i] : s->n_single ? s->single[i].spring_N[0] : NAN;
        depth[i] = strain * points.height_m;
        force[i] = k * strain;
        use[i] = 1;
        points.deepest_m = fmax(points.deepest_m, depth[i]);
        if (!isfinite(k))
            return PALP_ERR_INPUT;
    }
    degree = degree < s->n_hold ? degree : s->n_hold - (s->n_hold > 1);
    return degree ? palp_thesis_polynomial(&points, degree, law, &norm) : PALP_ERR_INPUT;
}

/* Force over strain at the deepest point of a run: a first guess of the stiffness. */
static double rough_stiffness(const palp_recording *r) {
    size_t last = r->n - 1;
    while (last > 0 && (r->depth_m[last] < 0.9 * r->deepest_m || !r->use[last]))
        last--;
    double largest = 0, strain = fmax(r->depth_m[last], 1e-3 * r->deepest_m) / r->height_m;
    for (size_t i = 0; i < r->n; i++)
        largest = fmax(largest, fabs(r->force_N[i]));
    return fmax(r->force_N[last], 1e-3 * largest) / strain;
}

/* Initial polynomial K(e). */
static palp_status rough_law(const characterize_state *s, size_t n, palp_law *law) {
    double c[PALP_LAW_MAX] = {rough_stiffness(&s->run[0])};
    if (s->n_static > 0 && n <= DEGREE_MAX && s->plain[0][n].n == n) {
        *law = s->plain[0][n];
        return PALP_OK;
    }
    palp_law through;
    if (s->n_hold > 0 && characterize_law_of_depths(s, n, &through) == PALP_OK)
        memcpy(c, through.coefficients, through.n * sizeof *c);
    return palp_law_polynomial(n, c, law);
}

static palp_status guess_spline(const characterize_state *s, size_t knots, palp_law *law) {
    double strain[PALP_LAW_MAX], stiffness[PALP_LAW_MAX], top = characterize_strain_max(s), most = 0;
    palp_law rough;
    palp_status status = rough_law(s, s->n_static ? 4 : 1, &rough);
    for (size_t k = 0; k < knots && status == PALP_OK; k++) {
        strain[k] = top * (double)k / (double)(knots - 1);
        palp_law_stiffness(&rough, strain[k], &stiffness[k], NULL);
        most = fmax(most, stiffness[k]);
    }
    for (size_t k = 0; k < knots; k++)
        stiffness[k] = fmax(stiffness[k], 0.02 * most);
    return status ? status : palp_law_spline(knots, strain, stiffness, law);
}

static double radius_of(const characterize_state *s) {
    double radius = 0;
    for (size_t i = 0; i < s->n; i++)
        radius = fmax(radius, s->run[i].radius_m);
    return radius;
}

/* K(0) = 3 G area with G the initial shear modulus, split over the coefficients. */
static palp_status guess_hyperelastic(const characterize_state *s, palp_law_kind kind, palp_law *law) {
    static const size_t counts[] = {0, 0, 1, 2, 5, 3, 4};
    double radius = radius_of(s), k0 = 0, c[5] = {0};
    palp_law rough;
    palp_status status = rough_law(s, 1, &rough);
    if (radius <= 0 || status)
        return status ? status : PALP_ERR_INPUT;
    double area = 3.14159265358979323846 * radius * radius;
    palp_law_stiffness(&rough, 0, &k0, NULL);
    double shear = k0 / (3 * area);
    c[0] = 0.5 * shear;
    c[1] = kind == PALP_LAW_YEOH ? 0.01 * shear : 0.05 * shear;
    if (kind == PALP_LAW_OGDEN) {
        c[0] = 0.8 * shear; /* alpha 2 */
        c[1] = 2;
        c[2] = -0.1 * shear; /* alpha -4 */
        c[3] = -4;
    }
    return palp_law_hyperelastic(kind, counts[kind], c, area, law);
}

/* size: coefficients of a polynomial, knots of a spline. */
static palp_status guess(const characterize_state *s, palp_law_kind kind, size_t size, palp_law *law) {
    if (kind == PALP_LAW_POLYNOMIAL)
        return rough_law(s, size, law);
    return kind == PALP_LAW_SPLINE ? guess_spline(s, size, law) : guess_hyperelastic(s, kind, law);
}

palp_status characterize_guess(const characterize_options *o, const characterize_state *s, palp_law *law) {
    return guess(s, (palp_law_kind)o->law, o->law == PALP_LAW_SPLINE ? o->knots : s->degree, law);
}

palp_status characterize_list_laws(const characterize_options *o, characterize_state *s) {
    static const struct {
        palp_law_kind kind;
        size_t size;
    } list[] = {{PALP_LAW_POLYNOMIAL, 1},     {PALP_LAW_NEO_HOOKEAN, 0}, {PALP_LAW_POLYNOMIAL, 2},
                {PALP_LAW_MOONEY_RIVLIN2, 0}, {PALP_LAW_POLYNOMIAL, 3},  {PALP_LAW_YEOH, 0},
                {PALP_LAW_POLYNOMIAL, 4},     {PALP_LAW_OGDEN, 0},       {PALP_LAW_POLYNOMIAL, 5},
                {PALP_LAW_MOONEY_RIVLIN5, 0}, {PALP_LAW_POLYNOMIAL, 6},  {PALP_LAW_POLYNOMIAL, 7}};
    palp_status status = PALP_OK;
    s->n_laws = 0;
    for (size_t i = 0; i < sizeof list / sizeof list[0] && status == PALP_OK; i++) {
        if (list[i].kind >= PALP_LAW_NEO_HOOKEAN && (radius_of(s) <= 0 || o->degree_auto))
            continue;
        status = guess(s, list[i].kind, list[i].size, &s->law[s->n_laws]);
        s->n_laws += status == PALP_OK;
    }
    return status;
}
