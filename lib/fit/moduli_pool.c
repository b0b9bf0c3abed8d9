/* moduli_pool.c: the moduli of several specimens as one mean. */
#include <palpate/moduli.h>

#include <math.h>
#include <palpate/random.h>

static palp_modulus mean_of(size_t n, const palp_moduli *each, size_t offset, double *between) {
    double sum = 0.0, square = 0.0;
    for (size_t k = 0; k < n; k++)
        sum += ((const palp_modulus *)((const char *)&each[k] + offset))->value;
    const double mean = sum / (double)n;
    for (size_t k = 0; k < n; k++) {
        double off = ((const palp_modulus *)((const char *)&each[k] + offset))->value - mean;
        square += off * off;
    }
    *between = sqrt(square / (double)(n - 1));
    const double sd = *between / sqrt((double)n), half = palp_student_95(n - 1) * sd;
    return (palp_modulus){mean, sd, mean - half, mean + half};
}

palp_status palp_moduli_pool(size_t n, const palp_moduli *each, palp_moduli *mean, double between_Pa[2]) {
    double unused;
    if (!each || !mean || !between_Pa || n < 2)
        return PALP_ERR_ARGUMENT;
    mean->shear_inf_Pa = mean_of(n, each, offsetof(palp_moduli, shear_inf_Pa), &between_Pa[0]);
    mean->shear_0_Pa = mean_of(n, each, offsetof(palp_moduli, shear_0_Pa), &between_Pa[1]);
    mean->young_inf_Pa = mean_of(n, each, offsetof(palp_moduli, young_inf_Pa), &unused);
    mean->young_0_Pa = mean_of(n, each, offsetof(palp_moduli, young_0_Pa), &unused);
    return PALP_OK;
}
