/* test_trajectory_refused.c: segments that are refused. */
#include "trajectory.h"
#include "trajectory_make.h"

static void refused(palp_wire_segment w) {
    assert_int_equal(trajectory_check(&w, (float)SPEED, 24.0f), PALP_WIRE_RESULT_RANGE);
}

static void accepted(palp_wire_segment w) {
    assert_int_equal(trajectory_check(&w, (float)SPEED, 24.0f), PALP_WIRE_RESULT_DONE);
}

#define BUT(which, member, value)                                                                            \
    do {                                                                                                     \
        palp_wire_segment but = good[which];                                                                 \
        but.member = (value);                                                                                \
        refused(but);                                                                                        \
    } while (0)

static void test_refused_strokes(void **state) {
    (void)state;
    for (int i = 0; i < 5; i++)
        accepted(good[i]);
    for (int which = 0; which <= 2; which += 2) {
        BUT(which, rate_nm_s, 0);
        BUT(which, rate_nm_s, 250000100);
        BUT(which, rate_nm_s, UINT32_MAX);
        BUT(which, acceleration_um_s2, 0);
        BUT(which, acceleration_um_s2, 50000100);
        BUT(which, acceleration_um_s2, UINT32_MAX);
    }
    BUT(1, duration_ms, 0);
    BUT(2, cycles, 0);
    for (int kind = PALP_WIRE_SEGMENT_KIND_COUNT; kind < 256; kind++)
        if (kind != (PALP_WIRE_SEGMENT_MOVE | PALP_WIRE_SEGMENT_SMOOTH))
            BUT(0, kind, (uint8_t)kind);
}

static void test_refused_waves(void **state) {
    palp_wire_segment w = good[3];
    (void)state;
    for (int which = 3; which <= 4; which++) {
        BUT(which, target_nm, 0);
        BUT(which, target_nm, INT32_MIN);
        BUT(which, frequency_mHz, 0);
        BUT(which, frequency_mHz, 100001);
        BUT(which, frequency_mHz, UINT32_MAX);
    }
    BUT(3, cycles, 0);
    BUT(3, target_nm, 40000000); /* 0.251 m/s */
    w.target_nm = 39700000;
    accepted(w);
    w = (palp_wire_segment){
        .kind = PALP_WIRE_SEGMENT_SINE, .target_nm = 100000, .frequency_mHz = 88000, .cycles = 3};
    accepted(w); /* 1.6 times 31 m/s2 */
    w.frequency_mHz = 90000;
    refused(w);
    w = good[3];
    w.frequency_mHz = 1; /* 65535 periods: two years */
    refused(w);
    w.cycles = 4294;
    accepted(w);
    BUT(4, frequency_end_mHz, 0);
    BUT(4, frequency_end_mHz, 100001);
    BUT(4, frequency_end_mHz, UINT32_MAX);
    BUT(4, duration_ms, 0);
    BUT(4, duration_ms, 400);       /* less than a period */
    BUT(4, duration_ms, 100000000); /* more than 65535 */
    BUT(4, duration_ms, UINT32_MAX);
    BUT(4, target_nm, 4100000); /* too fast at its end */
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_refused_strokes),
    cmocka_unit_test(test_refused_waves),
    {0},
};
