/* test_number.c: decimal numbers against strtod and printf of the C library. */
#define _POSIX_C_SOURCE 200809L
#include "base/number.h"

#include <check.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t random_next(uint64_t *state) { /* xorshift64* (Vigna 2016) */
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * UINT64_C(2685821657736338717);
}

static uint64_t bits(double value) {
    uint64_t b;
    memcpy(&b, &value, sizeof b);
    return b;
}

/* Both the value and the end are strtod's. */
static void as_strtod(const char *text) {
    double value = -1;
    char *end;
    double want = strtod(text, &end);
    const char *stop = palp_number_parse(text, &value);
    ck_assert_msg(stop == end && bits(value) == bits(want), "\"%s\": %a, strtod %a", text, value, want);
}

/* Any finite double, every bit pattern as likely. */
static double random_double(uint64_t *state) {
    double value;
    do {
        uint64_t b = random_next(state);
        memcpy(&value, &b, sizeof value);
    } while (!isfinite(value));
    return value;
}

START_TEST(million_doubles_read_as_strtod_reads_them) {
    static const char *const format[] = {"%.17g", "%.16g", "%.15g", "%.6g", "%.3f", "%.9f", "%.12e", "%.20g"};
    uint64_t state = 20240607;
    char text[400];
    for (int i = 0; i < 1000000; i++) {
        int kind = i % 8;
        double value = kind == 4 || kind == 5 || i % 3 == 0 ? (double)(int64_t)random_next(&state) * 1e-17
                                                            : random_double(&state);
        snprintf(text, sizeof text, format[kind], value);
        as_strtod(text);
    }
}
END_TEST

/* Random digits, a point anywhere, exponents about the limits of the exact path. */
START_TEST(random_decimals_read_as_strtod_reads_them) {
    uint64_t state = 7;
    char text[80];
    for (int i = 0; i < 300000; i++) {
        int n = 1 + (int)(random_next(&state) % 22), point = (int)(random_next(&state) % 24), length = 0;
        for (int k = 0; k < n; k++) {
            if (k == point)
                text[length++] = '.';
            text[length++] = (char)('0' + random_next(&state) % 10);
        }
        int exponent = (int)(random_next(&state) % 61) - 30;
        snprintf(text + length, sizeof text - (size_t)length, i % 2 ? "e%d" : "E%+d", exponent);
        as_strtod(text);
    }
}
END_TEST

START_TEST(edges_read_as_strtod_reads_them) {
    static const char *const text[] = {"0",
                                       "-0",
                                       "+0",
                                       "0.0",
                                       "-0.000",
                                       "1",
                                       "-1",
                                       "+1.5",
                                       ".5",
                                       "5.",
                                       "-.5e1",
                                       "1e0",
                                       "1E+2",
                                       "1e-2",
                                       "007",
                                       "1e22",
                                       "1e23",
                                       "1e-22",
                                       "1e-23",
                                       "9007199254740992",
                                       "9007199254740993",
                                       "9007199254740993e22",
                                       "9007199254740992e-22",
                                       "123456789012345678",
                                       "1234567890123456789",
                                       "12345678901234567890",
                                       "18446744073709551615",
                                       "18446744073709551616",
                                       "0.000000000000000000000000000001",
                                       "1.7976931348623157e308",
                                       "1.7976931348623159e308",
                                       "1e309",
                                       "-1e400",
                                       "1e99999999999999999999",
                                       "1e-99999999999999999999",
                                       "2.2250738585072011e-308",
                                       "2.2250738585072014e-308",
                                       "4.9406564584124654e-324",
                                       "2.4703282292062327e-324",
                                       "2.4703282292062328e-324",
                                       "5e-324",
                                       "0e999",
                                       "1e",
                                       "1e+",
                                       "1ex",
                                       "1.5.5",
                                       "1,5",
                                       "12 ",
                                       "3-",
                                       "8.5e3e2",
                                       "100000000000000000000000000000000000000000e-41",
                                       "0.1000000000000000055511151231257827021181583404541015625",
                                       "9007199254740993.00000000000000000000000000000000000000001"};
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++)
        as_strtod(text[i]);
}
END_TEST

START_TEST(what_is_no_plain_decimal_is_refused) {
    static const char *const text[] = {"",    "-",    "+",        ".", "-.", "e5", ".e5", "nan", "NaN",
                                       "inf", "-inf", "infinity", "x", ",",  " 1", "\n1", "--1", "+-1"};
    double value;
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++)
        ck_assert_msg(palp_number_parse(text[i], &value) == NULL, "\"%s\"", text[i]);
    const char *hexadecimal = "0x10";
    ck_assert_ptr_eq(palp_number_parse(hexadecimal, &value), hexadecimal + 1);
}
END_TEST

START_TEST(format_is_the_shortest_that_reads_back) {
    static const struct {
        double value;
        const char *text;
    } known[] = {{0, "0"},
                 {24, "24"},
                 {0.1, "0.1"},
                 {-2.5, "-2.5"},
                 {0.1 + 0.2, "0.30000000000000004"},
                 {1e300, "1e+300"},
                 {1.0 / 3, "0.3333333333333333"},
                 {DBL_MAX, "1.7976931348623157e+308"},
                 {5e-324, "4.94065645841247e-324"},
                 {123456.789, "123456.789"}};
    char text[PALP_NUMBER_TEXT];
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        ck_assert_uint_eq(palp_number_format(known[i].value, text), strlen(known[i].text));
        ck_assert_str_eq(text, known[i].text);
    }
    uint64_t state = 99;
    for (int i = 0; i < 100000; i++) {
        double value = random_double(&state);
        size_t n = palp_number_format(value, text);
        ck_assert_uint_eq(n, strlen(text));
        ck_assert_uint_lt(n, PALP_NUMBER_TEXT);
        ck_assert_uint_eq(bits(strtod(text, NULL)), bits(value));
    }
}
END_TEST

/* Nothing here depends on the program's locale; skipped where no locale with a comma is installed. */
START_TEST(comma_locale_changes_nothing) {
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "tr_TR.UTF-8"};
    size_t i = 0;
    palp_locale scope;
    char text[PALP_NUMBER_TEXT];
    double value;
    while (i < 4 && !setlocale(LC_ALL, names[i]))
        i++;
    ck_assert(palp_locale_enter(&scope));
    ck_assert_ptr_nonnull(palp_number_parse("0.30000000000000004", &value));
    ck_assert_double_eq(value, 0.1 + 0.2);
    palp_number_format(0.1 + 0.2, text);
    ck_assert_str_eq(text, "0.30000000000000004");
    palp_locale_leave(&scope);
    snprintf(text, sizeof text, "%.1f", 0.5);
    ck_assert_str_eq(text, i < 4 ? "0,5" : "0.5"); /* and the program's own is back */
    setlocale(LC_ALL, "C");
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, million_doubles_read_as_strtod_reads_them);
    tcase_add_test(tc, random_decimals_read_as_strtod_reads_them);
    tcase_add_test(tc, edges_read_as_strtod_reads_them);
    tcase_add_test(tc, what_is_no_plain_decimal_is_refused);
    tcase_add_test(tc, format_is_the_shortest_that_reads_back);
    tcase_add_test(tc, comma_locale_changes_nothing);
}
