/* spectrum_fit.c: the ratio of force and path at the driven frequency of a stretch. */
#include "base/arena.h"
#include "base/dense.h"
#include "spectrum_internal.h"

#include <complex.h>
#include <math.h>

/* Functions that path and force are sums of: Legendre polynomials (the drift), then Re and -Im of e^(i phase)
 * times 1, x and x^2, then the harmonics. x goes from -1 to 1 over the stretch. */
enum { DRIFT_MAX = 8, ORDERS = 3, HARMONICS = 2, COLUMNS_MAX = DRIFT_MAX + 1 + 2 * ORDERS + 2 * HARMONICS };
enum {
    BINS = 64,
    ROUNDS = 30,
    FEW = 4,
    HARMONIC_FEW = 12
}; /* bins of a cycle; samples of one, and with harmonics */

/* Samples, or means of neighbours where there are very many, which changes path and force alike. The phase
 * goes by phase(x) = turn (e^(chirp x) - 1) / chirp. */
typedef struct stretch {
    size_t n;
    double *x, *depth, *force; /* [n] */
    double half_s, middle_s, turn, chirp;
    size_t drift, orders, harmonics, columns;
    double *square, *inverse, *row, *of_depth, *of_force; /* [columns^2] twice, [columns] thrice */
} stretch;

static size_t first_wave(const stretch *s) {
    return s->drift + 1;
}

static void fill(const palp_recording *r, const spectrum_stretch *from, stretch *s) {
    size_t each = (size_t)fmax(floor((double)(from->last - from->first) / (BINS * from->cycles)), 1.0),
           count = 0;
    double t = 0.0, d = 0.0, f = 0.0;
    for (size_t i = from->first; i < from->last; i++) {
        if (!r->use[i])
            continue;
        t += (r->time_s[i] - s->middle_s) / s->half_s;
        d += r->depth_m[i];
        f += r->force_N[i];
        if (++count < each)
            continue;
        s->x[s->n] = t / (double)count;
        s->depth[s->n] = d / (double)count;
        s->force[s->n++] = f / (double)count;
        t = d = f = 0.0;
        count = 0;
    }
}

static double phase(const stretch *s, double x) {
    double c = s->chirp * x;
    return s->turn * x * (fabs(c) < 1e-12 ? 1.0 : expm1(c) / c);
}

static void fill_row(const stretch *s, double x) {
    double *row = s->row, angle = phase(s, x), power = 1.0;
    size_t k = first_wave(s);
    row[0] = 1.0;
    row[1] = x;
    for (size_t j = 2; j <= s->drift; j++)
        row[j] = ((2.0 * (double)j - 1.0) * x * row[j - 1] - ((double)j - 1.0) * row[j - 2]) / (double)j;
    for (size_t j = 0; j < s->orders; j++, power *= x) {
        row[k++] = power * cos(angle);
        row[k++] = -power * sin(angle);
    }
    for (size_t j = 2; j < 2 + s->harmonics; j++) {
        row[k++] = cos((double)j * angle);
        row[k++] = -sin((double)j * angle);
    }
}

/* Least squares of path and force; false if the stretch is too short for the columns. */
static bool solve(stretch *s) {
    size_t m = s->columns;
    for (size_t k = 0; k < m * m; k++)
        s->square[k] = s->inverse[k] = 0.0;
    for (size_t k = 0; k < m; k++)
        s->of_depth[k] = s->of_force[k] = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        fill_row(s, s->x[i]);
        for (size_t a = 0; a < m; a++) {
            s->of_depth[a] += s->row[a] * s->depth[i];
            s->of_force[a] += s->row[a] * s->force[i];
            for (size_t b = 0; b <= a; b++)
                s->square[a * m + b] += s->row[a] * s->row[b];
        }
    }
    for (size_t k = 0; k < m; k++) {
        s->inverse[k * m + k] = 1.0;
        s->square[k * m + k] *= 1.0 + 1e-14;
    }
    if (!dense_cholesky(m, s->square))
        return false;
    dense_cholesky_solve(m, s->square, 1, s->of_depth);
    dense_cholesky_solve(m, s->square, 1, s->of_force);
    dense_cholesky_solve(m, s->square, m, s->inverse);
    return true;
}

/* Coefficient of x^order e^(i phase). */
static double complex wave(const stretch *s, const double *of, size_t order) {
    size_t k = first_wave(s) + 2 * order;
    return of[k] + of[k + 1] * I;
}

/* Fits the path's phase until the other coefficients of the fundamental vanish. */
static bool follow(stretch *s) {
    for (int round = 0; round < ROUNDS; round++) {
        if (!solve(s) || cabs(wave(s, s->of_depth, 0)) == 0.0)
            return false;
        double complex first = wave(s, s->of_depth, 1) / wave(s, s->of_depth, 0);
        double complex second =
            s->orders > 2 ? wave(s, s->of_depth, 2) / wave(s, s->of_depth, 0) - 0.5 * first * first : 0.0;
        double turn = s->turn + cimag(first);
        s->chirp = s->orders > 2 ? (s->turn * s->chirp + 2.0 * cimag(second)) / turn : 0.0;
        s->turn = turn;
        if (!(turn > 0.0) || fabs(s->chirp) > 3.0)
            return false;
        if (fabs(cimag(first)) + fabs(cimag(second)) < 1e-9)
            return solve(s);
    }
    return false;
}

/* Variance of the force's residual, without the force that the plate's own deviations cause, and at least
 * that of the noise. It is larger if the residual is correlated from sample to sample, as fewer samples are
 * then independent. */
static double left(const stretch *s, double stiffness, double noise) {
    double own = 0.0, next = 0.0, last = 0.0, freedom = fmax((double)s->n - (double)s->columns, 1.0);
    for (size_t i = 0; i < s->n; i++) {
        fill_row(s, s->x[i]);
        double off = s->depth[i] - dense_dot(s->columns, s->row, s->of_depth);
        double miss = s->force[i] - dense_dot(s->columns, s->row, s->of_force) - stiffness * off;
        own += miss * miss;
        next += miss * last;
        last = miss;
    }
    double rho = own > 0.0 ? fmin(next / own, 0.98) : 0.0;
    rho = rho < 3.0 / sqrt(freedom) ? 0.0 : rho;
    return fmax(own / freedom, noise * noise) * (1.0 + rho) / (1.0 - rho);
}

/* The stiffness at the middle's frequency w. Where frequency and amplitude change, the second order of K
 * about w adds -i K' a / half - i/2 K'' w' to K(w). a is the relative growth of the amplitude. K' and K''
 * follow from how K changes along the stretch. */
static double complex stiffness(const stretch *s) {
    double complex d = wave(s, s->of_depth, 0), d1 = wave(s, s->of_depth, 1) / d,
                   k = wave(s, s->of_force, 0) / d;
    if (s->orders < 3 || fabs(s->chirp) < 0.01)
        return k;
    double complex d2 = wave(s, s->of_depth, 2) / d, k1 = wave(s, s->of_force, 1) / d - k * d1;
    double complex k2 = wave(s, s->of_force, 2) / d - k1 * d1 - k * d2, slope = k1 / s->chirp;
    return k + I * slope * d1 / s->turn + I * (k2 / s->chirp - 0.5 * k1) / s->turn;
}

static void conclude(const palp_recording *r, const spectrum_stretch *from, const stretch *s,
                     palp_spectrum_point *p) {
    const double pi = 3.14159265358979323846;
    size_t k = first_wave(s), m = s->columns, each = (from->last - from->first) / s->n;
    double complex value = stiffness(s);
    double amplitude = cabs(wave(s, s->of_depth, 0)), noise = r->noise_N / sqrt((double)(each ? each : 1));
    double variance = s->inverse[k * m + k];
    if (s->orders > 2 && fabs(s->chirp) >= 0.01)
        variance += s->inverse[(k + 4) * m + k + 4] / (s->chirp * s->turn * s->chirp * s->turn);
    double sd = sqrt(variance * left(s, creal(value), noise)) / amplitude;
    *p = (palp_spectrum_point){.frequency_Hz = s->turn / s->half_s / (2.0 * pi),
                               .from_s = r->time_s[from->first],
                               .to_s = r->time_s[from->last],
                               .cycles = from->cycles,
                               .amplitude_m = amplitude,
                               .storage_N_m = creal(value),
                               .storage_sd_N_m = sd,
                               .loss_N_m = cimag(value),
                               .loss_sd_N_m = sd};
    fill_row(s, 0.0);
    for (size_t j = 0; j <= s->drift; j++) {
        p->depth_m += s->row[j] * s->of_depth[j];
        p->force_N += s->row[j] * s->of_force[j];
    }
}

static palp_status make(arena *memory, const spectrum_stretch *from, stretch *s) {
    double few = (double)(from->last - from->first) / from->cycles;
    s->drift = from->cycles > DRIFT_MAX ? DRIFT_MAX : from->cycles < 4.0 ? 2 : (size_t)from->cycles - 1;
    s->orders = from->sweeps ? ORDERS : ORDERS - 1;
    s->harmonics = few < HARMONIC_FEW ? 0 : HARMONICS;
    s->columns = s->drift + 1 + 2 * s->orders + 2 * s->harmonics;
    double **arrays[] = {&s->x, &s->depth, &s->force}, **columns[] = {&s->row, &s->of_depth, &s->of_force};
    for (size_t k = 0; k < 3; k++) {
        *arrays[k] = arena_take(memory, from->last - from->first, sizeof(double));
        *columns[k] = arena_take(memory, s->columns, sizeof(double));
    }
    s->square = arena_take(memory, s->columns * s->columns, sizeof(double));
    s->inverse = arena_take(memory, s->columns * s->columns, sizeof(double));
    return memory->failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

palp_status spectrum_fit(const palp_recording *r, const spectrum_stretch *from, palp_spectrum_point *point,
                         bool *found) {
    const double pi = 3.14159265358979323846;
    stretch s = {.n = 0};
    arena memory = {0};
    double begin = r->time_s[from->first], end = r->time_s[from->last], lowest = HUGE_VAL;
    palp_status status = make(&memory, from, &s);
    *found = false;
    if (!status) {
        s.half_s = 0.5 * (end - begin);
        s.middle_s = begin + s.half_s;
        fill(r, from, &s);
        double across = end - begin - 0.5 * (from->first_cycle_s + from->last_cycle_s);
        s.chirp = from->sweeps ? s.half_s / across * log(from->first_cycle_s / from->last_cycle_s) : 0.0;
        s.turn = pi * from->cycles * (fabs(s.chirp) < 1e-6 ? 1.0 : s.chirp / sinh(s.chirp));
        for (size_t i = 0; i < s.n; i++)
            lowest = fmin(lowest, s.depth[i]);
        *found = (double)s.n > FEW * from->cycles && s.n > 2 * s.columns && lowest > 0.0 && follow(&s);
    }
    if (*found)
        conclude(r, from, &s, point);
    *found = *found && point->force_N > hypot(point->storage_N_m, point->loss_N_m) * point->amplitude_m;
    arena_free(&memory);
    return status;
}
