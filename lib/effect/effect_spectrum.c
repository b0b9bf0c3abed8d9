/* effect_spectrum.c: the relaxation moduli of power-law and poroelastic relaxation as sums of exponentials.
 */
#include "effect_internal.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* sum over i >= 0 of exp(p (u - i h)) for p > 0, of exp(p (u + i h)) for p < 0, and d/dp of its logarithm. */
static double geometric(double p, double u, double h, double *slope) {
    double ratio = 1.0 / expm1(fabs(p) * h);
    *slope = u - copysign(h * ratio, p);
    return exp(p * u) * (1.0 + ratio);
}

/* value: c, a. t^-a / Gamma(1-a) = sin(pi a) / pi * integral of exp(a u - e^u t) du by the trapezoidal rule,
 * which converges exponentially in 1 / h. What lies beyond its ends is one mode each of the same first two
 * moments: of the slow ones what they add after long times, of the fast ones their viscosity. */
void effect_power_law(const double *value, const effect_range *range, effect_mode *mode) {
    const size_t inner = range->n - 2;
    const double c = value[0], a = value[1], turn = PI / tan(PI * a);
    double start = log(range->slow), h = (log(range->fast) - start) / (double)(inner - 1);
    double scale = h * sin(PI * a) / PI, end = start + h * (double)inner, of_weight, of_first, of_second;
    for (size_t i = 0; i < inner; i++) {
        double u = start + h * (double)i, unit = scale * exp(a * u);
        mode[i] =
            (effect_mode){.weight = c * unit, .rate = exp(u), .weight_by = {unit, c * unit * (turn + u)}};
    }
    double weight = scale * geometric(a, start - h, h, &of_weight);
    double first = scale * geometric(a + 1.0, start - h, h, &of_first);
    mode[inner] = (effect_mode){.weight = c * weight,
                                .rate = first / weight,
                                .weight_by = {weight, c * weight * (turn + of_weight)},
                                .rate_by = {0.0, first / weight * (of_first - of_weight)}};
    first = scale * geometric(a - 1.0, end, h, &of_first);
    double second = scale * geometric(a - 2.0, end, h, &of_second);
    weight = first * first / second;
    mode[inner + 1] = (effect_mode){.weight = c * weight,
                                    .rate = first / second,
                                    .weight_by = {weight, c * weight * (turn + 2.0 * of_first - of_second)},
                                    .rate_by = {0.0, first / second * (of_first - of_second)}};
}

/* Terms 1 / n^2 of the odd n in [n, end) as one mode: its weight, and the viscosity that gives its rate. */
static effect_mode group(int n, int end, double *weight, double *viscosity) {
    double w = 0.0, v = 0.0;
    for (; n < end; n += 2) {
        w += 1.0 / ((double)n * n);
        v += 1.0 / ((double)n * n * n * n);
    }
    *weight -= w;
    *viscosity -= v;
    return (effect_mode){.weight = w, .rate = w / v};
}

/* value: stiffness, time. 8 / pi^2 sum over odd n of exp(-n^2 t / time) / n^2: the first terms as they are,
 * then groups that become wider, then all that is left. */
void effect_consolidation(const double *value, const effect_range *range, effect_mode *mode) {
    enum { LAST = 1001 };
    const double whole = PI * PI / 8.0; /* sum of 1 / n^2 */
    const size_t alone = range->n / 3, groups = range->n - 1 - alone;
    double weight = whole, viscosity = PI * PI * PI * PI / 96.0; /* what is left of both sums */
    int n = 1;
    for (size_t i = 0; i + 1 < range->n; i++) {
        double wider = pow((double)LAST / n, 1.0 / (double)(alone + groups - i));
        int end = i < alone ? n + 2 : (int)fmax(n + 2, wider * n) | 1;
        mode[i] = group(n, end, &weight, &viscosity);
        n = end;
    }
    mode[range->n - 1] = (effect_mode){.weight = weight, .rate = weight / viscosity};
    for (size_t i = 0; i < range->n; i++) {
        double unit = mode[i].weight / whole, rate = mode[i].rate / value[1];
        mode[i] = (effect_mode){
            .weight = value[0] * unit, .rate = rate, .weight_by = {unit}, .rate_by = {0.0, -rate / value[1]}};
    }
}
