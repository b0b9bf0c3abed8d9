/* test_plant_link.c: the lockstep records byte for byte. */
#include "plant_link.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void test_in(void **state) {
    static const uint8_t wanted[] = {0x04, 0x03, 0x02, 0x01, 0xfe, 0xff, 0xff, 0xff, /* tick, position */
                                     0x01, 0x00, 0xff, 0xff, 0x00, 0x80, 0xff, 0x7f,
                                     0x34, 0x12, 0x00, 0x00,             /* adc */
                                     0xff, 0x0f, 0x81, 0x05, 0x02, 0x03, /* thermistor ... rx_count */
                                     0x61, 0x62, 0x63};
    const plant_in in = {0x01020304, -2, {1, -1, INT16_MIN, INT16_MAX, 0x1234, 0}, 0x0fff, 0x81, 5, 2, 3,
                         "abc",      0};
    uint8_t byte[PLANT_LINK_IN];
    plant_in back;
    (void)state;
    memset(byte, 0xee, sizeof byte);
    memset(&back, 0xee, sizeof back);
    plant_link_put_in(&in, byte);
    assert_memory_equal(byte, wanted, sizeof wanted);
    for (size_t i = sizeof wanted; i < sizeof byte; i++)
        assert_int_equal(byte[i], 0);
    plant_link_get_in(byte, &back);
    assert_memory_equal(&back, &in, offsetof(plant_in, rx) + sizeof in.rx); /* then padding */
}

static void test_out(void **state) {
    static const uint8_t wanted[PLANT_LINK_OUT] = {0x04, 0x03, 0x02,      0x01, 0x00, 0x80, 1,    0,    0xff,
                                                   0xfe, 0xfd, 0xfc,      0x04, 0x00, 0x0c, 0x0b, 0x03, 0x61,
                                                   0x62, 0x63, [109] = 1, 4,    3,    2,    1};
    const plant_out out = {0x01020304, INT16_MIN, 1,     0, 0xfcfdfeff, PLANT_LINK_VERSION,
                           0x0b0c,     3,         "abc", 1, 0x01020304};
    uint8_t byte[PLANT_LINK_OUT];
    plant_out back;
    (void)state;
    plant_link_put_out(&out, byte);
    assert_memory_equal(byte, wanted, sizeof byte);
    plant_link_get_out(byte, &back);
    assert_memory_equal(&back, &out, offsetof(plant_out, tx) + sizeof out.tx); /* then padding */
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_in),
    cmocka_unit_test(test_out),
    {0},
};
