/* test_force.c: calibration, tare and range of the six-channel sensor. */
#include "force.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = PALP_WIRE_CHANNELS };

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.12g is not %.12g to %g", got, wanted, tolerance);
}

static void default_matrix(double matrix[N][N]) {
    force_sensor f;
    int32_t row[N];
    force_init(&f);
    for (uint8_t axis = 0; axis < N; axis++) {
        assert_true(force_get_row(&f, axis, row));
        for (int i = 0; i < N; i++)
            matrix[axis][i] = 1e-9 * row[i];
    }
}

/* Counts that this load makes, by Gauss and Jordan with pivoting; the determinant. */
static double counts_of(const double load[N], double counts[N]) {
    double a[N][N + 1], determinant = 1;
    double matrix[N][N];
    default_matrix(matrix);
    for (int i = 0; i < N; i++) {
        memcpy(a[i], matrix[i], sizeof matrix[i]);
        a[i][N] = load[i];
    }
    for (int k = 0; k < N; k++) {
        int p = k;
        for (int i = k; i < N; i++)
            p = fabs(a[i][k]) > fabs(a[p][k]) ? i : p;
        double row[N + 1];
        memcpy(row, a[p], sizeof row);
        memcpy(a[p], a[k], sizeof row);
        memcpy(a[k], row, sizeof row);
        determinant *= row[k];
        for (int i = 0; i < N; i++)
            for (int j = N; i != k && j >= k; j--)
                a[i][j] -= a[k][j] * a[i][k] / a[k][k];
    }
    for (int i = 0; i < N; i++)
        counts[i] = a[i][N] / a[i][i];
    return determinant;
}

/* ---- calibration ---- */

static void test_product(void **state) {
    force_sensor f;
    double matrix[N][N];
    (void)state;
    force_init(&f);
    default_matrix(matrix);
    srand(1);
    for (int n = 0; n < 1000; n++) {
        int16_t adc[N];
        for (int i = 0; i < N; i++)
            adc[i] = (int16_t)(rand() % 65536 - 32768);
        for (uint8_t axis = 0; axis < N; axis++) {
            double wanted = 0, largest = 0;
            for (int i = 0; i < N; i++) {
                wanted += matrix[axis][i] * adc[i];
                largest += fabs(matrix[axis][i] * adc[i]);
            }
            assert_near((double)force_axis(&f, adc, axis), wanted, 5e-7 * largest);
        }
    }
}

/* All loads in the machine's range have different counts, with the resolution and range in z that the machine
 * needs. */
static void test_range(void **state) {
    double z[N] = {[FORCE_Z] = 24}, counts[N], matrix[N][N], variance = 0;
    int16_t adc[N];
    force_sensor f;
    (void)state;
    force_init(&f);
    default_matrix(matrix);
    for (int axis = 0; axis < N; axis++) {
        double load[N] = {0};
        load[axis] = 1;
        assert_true(fabs(counts_of(load, counts)) > 0);
        for (int i = 0; i < N; i++)
            adc[i] = (int16_t)lrint(counts[i] * (axis < 3 ? 10 : 0.1));
        for (uint8_t other = 0; other < N; other++)
            assert_near((double)force_axis(&f, adc, other), other != axis ? 0 : axis < 3 ? 10 : 0.1, 1e-3);
    }
    for (int sign = -1; sign <= 1; sign += 2) {
        (void)counts_of(z, counts);
        for (int i = 0; i < N; i++)
            adc[i] = (int16_t)lrint(sign * counts[i]);
        assert_false(force_saturated(adc));
        for (int i = 0; i < N; i++)
            adc[i] = (int16_t)fmax(-32768, fmin(32767, rint(sign * counts[i] * 25.5 / 24)));
        assert_true(force_saturated(adc));
    }
    for (int i = 0; i < N; i++)
        variance += matrix[FORCE_Z][i] * matrix[FORCE_Z][i] / 12;
    printf("z: %.1f counts/N on the first channel, quantization %.3f mN rms\n", counts[0] / 24,
           1e3 * sqrt(variance));
    assert_near(counts[0] / 24, 1280, 80);
    assert_true(sqrt(variance) < 2e-4);
}

static void test_rows(void **state) {
    static const int32_t row[N] = {781250, -1, 0, 123456, -654321, 4000000}, zeros[N] = {0};
    static const int32_t wild[N] = {0, 0, INT32_MIN, 0, 0, 0},
                         most[N] = {2000000000, -2000000000, 1, 0, 0, 0};
    force_sensor f, before;
    int32_t back[N];
    (void)state;
    force_init(&f);
    assert_true(force_set_row(&f, 2, row) && force_get_row(&f, 2, back));
    assert_memory_equal(back, row, sizeof row);
    assert_true(force_set_row(&f, 1, most) && force_get_row(&f, 1, back));
    assert_near(back[0], most[0], 300);
    before = f;
    assert_false(force_set_row(&f, 2, zeros) || force_set_row(&f, 2, wild) || force_set_row(&f, N, row));
    assert_false(force_get_row(&f, N, back));
    assert_memory_equal(&f, &before, sizeof f);
}

/* ---- tare ---- */

static void test_tare(void **state) {
    (void)state;
    srand(2);
    for (int n = 0; n < 300; n++) {
        uint16_t samples = (uint16_t)(n == 0 ? 1 : n == 1 ? FORCE_TARE_MOST : 1 + rand() % 50);
        int centre = rand() % 60000 - 30000;
        double sum[N] = {0};
        int16_t adc[N];
        force_sensor f;
        force_init(&f);
        force_tare_begin(&f, samples);
        for (int k = 0; k < samples; k++) {
            assert_int_equal(f.tare[0], 0); /* the old one holds meanwhile */
            for (int i = 0; i < N; i++) {
                adc[i] = (int16_t)(n == 1 ? INT16_MIN : centre + rand() % 100);
                sum[i] += adc[i];
            }
            force_tare_add(&f, adc);
        }
        assert_int_equal(f.tare_left, 0);
        for (int i = 0; i < N; i++)
            assert_int_equal(f.tare[i], (int)round(16 * sum[i] / samples));
        force_tare_add(&f, (int16_t[N]){0}); /* over: ignored */
        assert_int_equal(f.tare[0], (int)round(16 * sum[0] / samples));
    }
}

static void test_tared(void **state) {
    const int16_t first[N] = {100, -200, 3000, 5, 6, -7}, second[N] = {101, -200, 3000, 5, 6, -7};
    force_sensor f;
    (void)state;
    force_init(&f);
    force_tare_begin(&f, 2);
    force_tare_add(&f, first);
    force_tare_add(&f, second);
    for (uint8_t axis = 0; axis < N; axis++) {
        assert_near((double)force_axis(&f, second, axis), 0.5 * (double)f.matrix[axis][0], 1e-12);
        assert_near((double)force_axis(&f, first, axis), -0.5 * (double)f.matrix[axis][0], 1e-12);
    }
}

static void test_tare_samples(void **state) {
    force_sensor f;
    (void)state;
    force_init(&f);
    force_tare_begin(&f, 0);
    assert_int_equal(f.tare_left, 1);
    force_tare_begin(&f, UINT16_MAX);
    assert_int_equal(f.tare_left, FORCE_TARE_MOST);
}

static void test_saturated(void **state) {
    int16_t adc[N] = {0, 32000, -32000, 0, 0, 0};
    (void)state;
    assert_false(force_saturated(adc));
    for (int i = 0; i < N; i++)
        for (int sign = 0; sign < 2; sign++) {
            int16_t was = adc[i];
            adc[i] = sign ? INT16_MIN : INT16_MAX;
            assert_true(force_saturated(adc));
            adc[i] = was;
        }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_product),   cmocka_unit_test(test_range),
    cmocka_unit_test(test_rows),      cmocka_unit_test(test_tare),
    cmocka_unit_test(test_tared),     cmocka_unit_test(test_tare_samples),
    cmocka_unit_test(test_saturated), {0},
};
