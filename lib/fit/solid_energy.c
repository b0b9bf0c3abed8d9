/* solid_energy.c: energies of isotropic solids by the invariants I1, I2 and J, and their derivatives by F. */
#include "solid_internal.h"

#include <math.h>

/* An energy by (I1, I2, J) with its gradient and Hessian. */
typedef struct invariant_energy {
    double w, g[3], h[3][3];
} invariant_energy;

size_t palp_solid_count(palp_solid_law law) {
    return law == PALP_SOLID_YEOH                                                   ? 3
           : law == PALP_SOLID_MOONEY_RIVLIN || law == PALP_SOLID_MOONEY_RIVLIN_LOG ? 2
                                                                                    : 1;
}

double palp_solid_shear(const palp_solid *solid) {
    if (!solid)
        return 0.0;
    switch (solid->law) {
    case PALP_SOLID_NEO_HOOKEAN:
    case PALP_SOLID_YEOH:
        return 2.0 * solid->c_Pa[0];
    case PALP_SOLID_MOONEY_RIVLIN:
    case PALP_SOLID_MOONEY_RIVLIN_LOG:
        return 2.0 * (solid->c_Pa[0] + solid->c_Pa[1]);
    default:
        return solid->c_Pa[0];
    }
}

double palp_solid_bulk(const palp_solid *solid) {
    return !solid ? 0.0
                  : palp_solid_shear(solid) * 2.0 * (1.0 + solid->poisson) /
                        (3.0 * (1.0 - 2.0 * solid->poisson));
}

double palp_solid_lambda(const palp_solid *solid) {
    return !solid ? 0.0 : palp_solid_shear(solid) * 2.0 * solid->poisson / (1.0 - 2.0 * solid->poisson);
}

/* Adds c (invariant J^-p - 3)^power, invariant number which, to *e. */
static void add_isochoric(invariant_energy *e, double c, int which, double p, int power, const double x[3]) {
    const double J = x[2], a = pow(J, -p), s = a * x[which] - 3.0;
    const double ds[2] = {a, -p * a * x[which] / J};
    const double cross = -p * a / J, twice = p * (p + 1.0) * a * x[which] / (J * J);
    const double f1 = power == 1 ? 1.0 : power * pow(s, power - 1),
                 f2 = power == 1   ? 0.0
                      : power == 2 ? 2.0
                                   : power * (power - 1) * pow(s, power - 2);
    e->w += c * pow(s, power);
    e->g[which] += c * f1 * ds[0];
    e->g[2] += c * f1 * ds[1];
    e->h[which][which] += c * f2 * ds[0] * ds[0];
    e->h[which][2] += c * (f1 * cross + f2 * ds[0] * ds[1]);
    e->h[2][which] = e->h[which][2];
    e->h[2][2] += c * (f1 * twice + f2 * ds[1] * ds[1]);
}

/* Adds k/2 (J - at)^2, and k/2 (ln J)^2 - m ln J. */
static void add_square(invariant_energy *e, double k, double at, double J) {
    e->w += 0.5 * k * (J - at) * (J - at);
    e->g[2] += k * (J - at);
    e->h[2][2] += k;
}

static void add_logarithm(invariant_energy *e, double k, double m, double J) {
    const double l = log(J);
    e->w += 0.5 * k * l * l - m * l;
    e->g[2] += (k * l - m) / J;
    e->h[2][2] += (k * (1.0 - l) + m) / (J * J);
}

static void add_first(invariant_energy *e, double mu, double I1) { /* mu/2 (I1 - 3) */
    e->w += 0.5 * mu * (I1 - 3.0);
    e->g[0] += 0.5 * mu;
}

/* lambda/2 (tr E)^2 + mu E:E with tr E = (I1 - 3)/2 and E:E = (I1^2 - 2 I2 - 2 I1 + 3)/4. */
static void add_st_venant(invariant_energy *e, double lambda, double mu, const double x[3]) {
    const double trace = 0.5 * (x[0] - 3.0);
    e->w += 0.5 * lambda * trace * trace + 0.25 * mu * (x[0] * x[0] - 2.0 * x[1] - 2.0 * x[0] + 3.0);
    e->g[0] += 0.5 * lambda * trace + 0.5 * mu * (x[0] - 1.0);
    e->g[1] -= 0.5 * mu;
    e->h[0][0] += 0.25 * lambda + 0.5 * mu;
}

static invariant_energy energy_of(const palp_solid *solid, const double x[3]) {
    invariant_energy e = {0};
    const double *c = solid->c_Pa, bulk = palp_solid_bulk(solid), lambda = palp_solid_lambda(solid);
    switch (solid->law) {
    case PALP_SOLID_YEOH:
        add_isochoric(&e, c[1], 0, 2.0 / 3.0, 2, x);
        add_isochoric(&e, c[2], 0, 2.0 / 3.0, 3, x); /* fall through */
    case PALP_SOLID_NEO_HOOKEAN:
        add_isochoric(&e, c[0], 0, 2.0 / 3.0, 1, x);
        add_square(&e, bulk, 1.0, x[2]);
        break;
    case PALP_SOLID_MOONEY_RIVLIN:
    case PALP_SOLID_MOONEY_RIVLIN_LOG:
        add_isochoric(&e, c[0], 0, 2.0 / 3.0, 1, x);
        add_isochoric(&e, c[1], 1, 4.0 / 3.0, 1, x);
        if (solid->law == PALP_SOLID_MOONEY_RIVLIN)
            add_square(&e, bulk, 1.0, x[2]);
        else
            add_logarithm(&e, bulk, 0.0, x[2]);
        break;
    case PALP_SOLID_NEO_HOOKEAN_LOG:
        add_first(&e, c[0], x[0]);
        add_logarithm(&e, lambda, c[0], x[2]);
        break;
    case PALP_SOLID_NEO_HOOKEAN_STABLE:
        add_first(&e, c[0], x[0]);
        add_square(&e, lambda + c[0], 1.0 + c[0] / (lambda + c[0]), x[2]);
        break;
    case PALP_SOLID_ST_VENANT:
        add_st_venant(&e, lambda, c[0], x);
        break;
    }
    return e;
}

static void cofactor(const double F[9], double cof[9]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
            cof[3 * i + j] = F[3 * a + p] * F[3 * b + q] - F[3 * a + q] * F[3 * b + p];
        }
    }
}

void solid_green(const double F[9], const double dF[9], double dE[9]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            dE[3 * i + j] = 0.0;
            for (int k = 0; k < 3; k++)
                dE[3 * i + j] += 0.5 * (F[3 * k + i] * dF[3 * k + j] + dF[3 * k + i] * F[3 * k + j]);
        }
    }
}

/* Derivatives of I1, I2 and J by F; C = F'F is in C. */
static void gradients(const double F[9], const double C[9], double I1, double d[3][9]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double FC = 0.0;
            for (int k = 0; k < 3; k++)
                FC += F[3 * i + k] * C[3 * k + j];
            d[0][3 * i + j] = 2.0 * F[3 * i + j];
            d[1][3 * i + j] = 2.0 * (I1 * F[3 * i + j] - FC);
        }
    }
    cofactor(F, d[2]);
}

/* Adds g times the second derivatives of I1, I2 and J by F. */
static void add_curvature(const double F[9], const double C[9], double I1, const double g[3], double H[81]) {
    static const int next[3] = {1, 2, 0};
    for (int i = 0; i < 3; i++) {
        for (int p = 0; p < 3; p++) {
            for (int j = 0; j < 3; j++) {
                for (int q = 0; q < 3; q++) {
                    double FF = 0.0, second = 4.0 * F[3 * i + p] * F[3 * j + q], volume = 0.0;
                    for (int k = 0; k < 3; k++)
                        FF += F[3 * i + k] * F[3 * j + k];
                    second -= 2.0 * F[3 * i + q] * F[3 * j + p] + (p == q ? 2.0 * FF : 0.0);
                    if (i == j)
                        second += (p == q ? 2.0 * I1 : 0.0) - 2.0 * C[3 * p + q];
                    if (i != j && p != q) {
                        const int r = 3 - i - j, s = 3 - p - q;
                        volume = F[3 * r + s] * ((next[i] == j) == (next[p] == q) ? 1.0 : -1.0);
                    }
                    H[9 * (3 * i + p) + 3 * j + q] +=
                        g[1] * second + g[2] * volume + (i == j && p == q ? 2.0 * g[0] : 0.0);
                }
            }
        }
    }
}

double palp_solid_energy(const palp_solid *solid, const double F[9], double *stress, double *tangent) {
    double C[9], x[3], d[3][9];
    if (!solid || !F)
        return INFINITY;
    solid_green(F, F, C); /* half of F'F + F'F */
    x[0] = C[0] + C[4] + C[8];
    double squares = 0.0;
    for (int i = 0; i < 9; i++)
        squares += C[i] * C[i];
    x[1] = 0.5 * (x[0] * x[0] - squares);
    gradients(F, C, x[0], d);
    x[2] = F[0] * d[2][0] + F[1] * d[2][1] + F[2] * d[2][2];
    if (!(x[2] > 0.0) && solid->law != PALP_SOLID_ST_VENANT && solid->law != PALP_SOLID_NEO_HOOKEAN_STABLE)
        return INFINITY;
    const invariant_energy e = energy_of(solid, x);
    for (int i = 0; stress && i < 9; i++)
        stress[i] = e.g[0] * d[0][i] + e.g[1] * d[1][i] + e.g[2] * d[2][i];
    if (tangent) {
        for (int i = 0; i < 9; i++) {
            for (int j = 0; j < 9; j++) {
                double sum = 0.0;
                for (int a = 0; a < 3; a++)
                    for (int b = 0; b < 3; b++)
                        sum += e.h[a][b] * d[a][i] * d[b][j];
                tangent[9 * i + j] = sum;
            }
        }
        add_curvature(F, C, x[0], e.g, tangent);
    }
    return e.w;
}
