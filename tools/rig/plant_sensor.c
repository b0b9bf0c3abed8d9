/* plant_sensor.c: the simulated force sensor and thermistor: from newtons and degrees to counts. */
#include "plant_internal.h"

#include <math.h>
#include <palpate/random.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double HUM_HZ = 50, TICK = 1e-3;
static const double SIDE_N = 0.1; /* Fx at rest: a real sensor, too, does not read 0 without force */

enum { N = PALP_WIRE_CHANNELS };

/* The same count as machine_stepper has; and the cell's and plate's own weight, which a tare takes off. */
static const double SLOW_COUNT_N = 1.5e-3, SLOW_REST = 700;

/* LAPACK's: solves A X = B, both by columns; b becomes x. */
void dgesv_(const int *n, const int *columns, double *a, const int *lda, int *pivots, double *b,
            const int *ldb, int *info);

/* The counts that read as value on an axis and 0 on the others. */
static bool counts_of(const force_sensor *f, int axis, double value, double counts[N]) {
    const int n = N, one = 1;
    int pivots[N], info;
    double columns[N][N];
    for (int i = 0; i < N; i++) {
        counts[i] = i == axis ? value : 0;
        for (int j = 0; j < N; j++)
            columns[j][i] = (double)f->matrix[i][j];
    }
    dgesv_(&n, &one, columns[0], &n, pivots, counts, &n, &info);
    return info == 0;
}

bool sensor_start(const plant_sensor *settings, sensor *s) {
    force_sensor f;
    double square = 0;
    *s = (sensor){.settings = *settings, .held = (int16_t)SLOW_REST};
    force_init(&f);
    for (int i = 0; i < N; i++) {
        s->z_counts[i] = (double)f.matrix[FORCE_Z][i];
        square += s->z_counts[i] * s->z_counts[i];
    }
    s->noise_counts = settings->noise_N / sqrt(square);
    return counts_of(&f, FORCE_Z, 1, s->counts_N) && counts_of(&f, 0, SIDE_N, s->rest);
}

double sensor_range(const sensor *s) {
    double largest = 0;
    for (int i = 0; i < N; i++)
        largest = fmax(largest, fabs(s->counts_N[i]));
    return INT16_MAX / (s->settings.gain * largest);
}

/* The bridge's reading of the force on the plate, without noise. */
static double bridge(const plant_sensor *s, double force_N, double time_s) {
    double z = s->gain * force_N + s->bias_N + s->drift_N_s * time_s;
    return z + (s->hum_N > 0 ? s->hum_N * sin(2 * PI * HUM_HZ * time_s) : 0);
}

/* Conversions begin every 12 and 13 ticks in turn. */
static bool begins(uint32_t tick) {
    return 2 * tick / 25 != 2 * (tick - 1) / 25;
}

bool sensor_gather(sensor *s, bool fast, double force_N, uint32_t tick) {
    s->gathered += bridge(&s->settings, force_N, TICK * tick);
    s->n_gathered++;
    if (!fast && !begins(tick))
        return false;
    memmove(s->said + 1, s->said, 3 * sizeof s->said[0]);
    s->said[0] = s->gathered / s->n_gathered;
    s->gathered = s->n_gathered = 0;
    double mean = fast ? s->said[0] : (s->said[0] + s->said[1] + s->said[2] + s->said[3]) / 4;
    mean += s->settings.noise_N * palp_random_normal_at(s->settings.seed, tick);
    s->held = (int16_t)fmin(fmax(rint(SLOW_REST + mean / SLOW_COUNT_N), INT16_MIN), INT16_MAX);
    return true;
}

/* The amplifier clips the z of bridge and noise together. */
void sensor_convert(const sensor *s, double force_N, uint32_t tick, int16_t adc[N]) {
    double z = bridge(&s->settings, force_N, TICK * tick), noise[N] = {0}, most = s->settings.range_N;
    for (uint32_t i = 0; i < N && s->noise_counts > 0; i++)
        noise[i] = s->noise_counts * palp_random_normal_at(s->settings.seed, (uint64_t)tick * N + i);
    if (most > 0) {
        double seen = z;
        for (int i = 0; i < N; i++)
            seen += s->z_counts[i] * noise[i];
        z -= seen - fmin(fmax(seen, -most), most);
    }
    for (int i = 0; i < N; i++) {
        double counts = s->rest[i] + s->counts_N[i] * z + noise[i];
        adc[i] = (int16_t)fmin(fmax(rint(counts), INT16_MIN), INT16_MAX);
    }
}

uint16_t sensor_thermistor(double celsius) {
    const double ratio = exp(3950 * (1 / (celsius + 273.15) - 1 / 298.15)); /* of its resistance to 10 kOhm */
    return (uint16_t)rint(4095 * ratio / (ratio + 1));
}
