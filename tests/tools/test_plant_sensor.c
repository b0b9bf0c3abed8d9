/* test_plant_sensor.c: the simulated indenter's force sensor and thermistor. */
/* check: valgrind */
#include "plant_make.h"

/* The inverse of the matrix, to half a count a channel; at rest there is 0.1 N sideways. */
static void test_sensor_inverse(void **state) {
    force_sensor f;
    plant_settings s = in_air();
    plant_in in;
    (void)state;
    force_init(&f);
    for (double bias = -24; bias <= 24; bias += 0.37) {
        s.sensor.bias_N = bias;
        plant *p = make(&s);
        plant_first(p, &in);
        for (uint8_t axis = 0; axis < FORCE_AXES; axis++) {
            double half = 0;
            for (int i = 0; i < PALP_WIRE_CHANNELS; i++) {
                half += 0.5 * fabs((double)f.matrix[axis][i]);
            }
            double wanted = axis == FORCE_Z ? bias : axis == 0 ? 0.1 : 0;
            near((double)force_axis(&f, in.adc, axis), wanted, half + 3e-6);
        }
        plant_free(p);
    }
}

static void test_noise_drift_hum(void **state) {
    enum { N = 20000 };
    plant_settings s = in_air();
    double mean = 0, square = 0, sine = 0, cosine = 0;
    (void)state;
    s.sensor = (plant_sensor){
        .noise_N = 5e-3, .hum_N = 0.02, .bias_N = 0.5, .drift_N_s = 0.01, .gain = 1, .seed = 3};
    plant *p = make(&s);
    for (int i = 0; i < N; i++) {
        plant_in in;
        double time = step(p, 0, false, &in).time_s, z = z_of(&in) - 0.5 - 0.01 * time;
        double angle = 2 * 3.14159265358979323846 * 50 * time;
        sine += 2 * z * sin(angle) / N;
        cosine += 2 * z * cos(angle) / N;
        z -= 0.02 * sin(angle);
        mean += z / N;
        square += z * z / N;
    }
    near(sine, 0.02, 4 * 5e-3 * sqrt(2.0 / N));
    near(cosine, 0, 4 * 5e-3 * sqrt(2.0 / N));
    near(mean, 0, 4 * 5e-3 / sqrt(N));
    near(sqrt(square), 5e-3, 5e-3 * 4 / sqrt(2.0 * N));
    plant_free(p);
}

static void test_range_and_rails(void **state) {
    plant_settings s = in_air();
    plant_in in;
    (void)state;
    s.sensor.range_N = 4;
    s.sensor.bias_N = 9;
    plant *p = make(&s);
    plant_first(p, &in);
    near(z_of(&in), 4, 2e-3);
    assert_false(force_saturated(in.adc));
    plant_free(p);
    s.sensor.range_N = 0;
    s.sensor.bias_N = -90;
    p = make(&s);
    plant_first(p, &in);
    assert_true(force_saturated(in.adc));
    assert_int_equal(in.adc[0], INT16_MIN);
    plant_free(p);
}

/* No reading is beyond the range by more than rounding, however noisy; half of them stand at it. */
static void test_range_clips_noise(void **state) {
    enum { N = 1000 };
    plant_settings s = in_air();
    int at_end = 0;
    (void)state;
    s.sensor = (plant_sensor){.noise_N = 0.05, .bias_N = 4, .range_N = 4, .gain = 1, .seed = 5};
    plant *p = make(&s);
    for (int i = 0; i < N; i++) {
        plant_in in;
        step(p, 0, false, &in);
        double z = z_of(&in);
        assert_true(z <= 4 + half_count_N());
        at_end += z >= 4 - half_count_N();
    }
    assert_in_range(at_end, N / 2 - 60, N / 2 + 60);
    plant_free(p);
}

/* 10 kOhm at 25 C is the middle of the divider; 25/85: R falls by exp(B (1/T0 - 1/T)). */
static void test_thermistor(void **state) {
    static const double celsius[] = {-20, 0, 25, 50, 85, 110};
    (void)state;
    for (size_t i = 0; i < 6; i++) {
        plant_settings s = in_air();
        plant_in in;
        s.actuator.ambient_C = celsius[i];
        plant *p = make(&s);
        plant_first(p, &in);
        double ohm = 1e4 * in.thermistor / (4095.0 - in.thermistor),
               half = 1e4 * 0.5 * 4095 / pow(4095.0 - in.thermistor, 2);
        double exact = 1e4 * exp(3950 * (1 / (celsius[i] + 273.15) - 1 / 298.15));
        near(ohm, exact, 1.01 * half);
        plant_free(p);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_sensor_inverse),  cmocka_unit_test(test_noise_drift_hum),
    cmocka_unit_test(test_range_and_rails), cmocka_unit_test(test_range_clips_noise),
    cmocka_unit_test(test_thermistor),      {0},
};
