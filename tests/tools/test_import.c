/* test_import.c: fields, numbers, clocks, names of columns and digits of imported files. */
#include "import/import.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static void test_split(void **state) {
    static const struct {
        const char *line;
        char separator;
        size_t n;
        const char *fields[4];
    } cases[] = {{"a,b", ',', 2, {"a", "b"}},
                 {" a b ;\tc;", ';', 2, {"a b", "c"}},
                 {"\"1,5\",2", ',', 2, {"1,5", "2"}},
                 {",,3,,", ',', 3, {"", "", "3"}},
                 {"\"open,2", ',', 1, {"\"open,2"}},
                 {"  1 \t 2  ", ' ', 2, {"1", "2"}},
                 {"", ',', 0, {NULL}},
                 {",,", ',', 0, {NULL}}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[32], *fields[IMPORT_COLUMNS];
        strcpy(line, cases[i].line);
        assert_int_equal(import_split(line, cases[i].separator, fields), cases[i].n);
        for (size_t j = 0; j < cases[i].n; j++) {
            assert_string_equal(fields[j], cases[i].fields[j]);
        }
    }
}

static void test_split_wide(void **state) {
    char line[3 * IMPORT_COLUMNS], *fields[IMPORT_COLUMNS];
    (void)state;
    memset(line, ',', sizeof line);
    for (size_t i = 0; i < sizeof line; i += 2) {
        line[i] = '7';
    }
    line[sizeof line - 1] = '\0';
    assert_int_equal(import_split(line, ',', fields), IMPORT_COLUMNS); /* further fields are dropped */
}

static void test_number(void **state) {
    static const struct {
        const char *text;
        import_dialect dialect;
        double value; /* NAN = it is no number */
    } cases[] = {{"1.5", {',', '.', ','}, 1.5},        {"-.5e-3", {',', '.', ','}, -0.5e-3},
                 {"1,234.5", {';', '.', ','}, 1234.5}, {"1.234,5", {';', ',', '.'}, 1234.5},
                 {"1 234,5", {';', ',', ' '}, 1234.5}, {"12'345.5", {';', '.', ','}, 12345.5},
                 {"+2,25E2", {'\t', ',', '.'}, 225},   {"5.0 mm", {';', '.', ','}, 5},
                 {"12 %", {';', '.', ','}, 12},        {"1D3", {';', '.', ','}, 1000},
                 {"1,23.5", {';', '.', ','}, NAN},     {"1,2345", {';', '.', ','}, NAN},
                 {"", {';', '.', ','}, NAN},           {"-", {';', '.', ','}, NAN},
                 {"x", {';', '.', ','}, NAN},          {"nan", {';', '.', ','}, NAN},
                 {"0x10", {';', '.', ','}, NAN},       {"1e999", {';', '.', ','}, NAN},
                 {"1.2.3", {';', '.', ','}, NAN},      {"5 apples", {';', '.', ','}, NAN}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double x = 0;
        bool is = import_number(cases[i].text, &cases[i].dialect, &x);
        if (is != !isnan(cases[i].value) || (is && x != cases[i].value)) {
            fail_msg("\"%s\": %s %g", cases[i].text, is ? "is" : "is not", x);
        }
    }
}

static void test_clock(void **state) {
    static const struct {
        const char *text;
        double seconds;
        bool dated;
    } cases[] = {{"10:11:12", 36672, false},
                 {"0:01,5", 1.5, false},
                 {"1970-01-02T00:00:01.25", 86401.25, true},
                 {"01.03.2000 00:00:00", 951868800, true},
                 {"3/1/2000 1:00:00 PM", 951915600, true},
                 {"2000/03/01", 951868800, true},
                 {"12:30:00 AM", 1800, false}};
    static const char *const wrong[] = {"",   "10", "10.5", "10:", ":10", "10:xx", "99.99.9999 10:00:00",
                                        "abc"};
    double x;
    bool dated;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (!import_clock(cases[i].text, &x, &dated) || fabs(x - cases[i].seconds) > 1e-6 ||
            dated != cases[i].dated) {
            fail_msg("\"%s\": %.9g", cases[i].text, x);
        }
    }
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_false(import_clock(wrong[i], &x, &dated));
    }
}

static void test_names(void **state) {
    static const struct {
        const char *name;
        int role;
    } cases[] = {{"Pr\xC3\xBC"
                  "fzeit (s)",
                  TIME},
                 {"Standardweg [mm]", DEPTH},
                 {"Force (N)", FORCE},
                 {"d\xC3\xA9placement / mm", DEPTH},
                 {"for\xC3\xA7"
                  "a (kN)",
                  FORCE},
                 {"Spannung in N/mm\xC2\xB2", STRESS},
                 {"Stauchung in %", STRAIN},
                 {"Deformaci\xC3\xB3n (mm)", DEPTH},
                 {"time_ms", TIME},
                 {"Carico, N", FORCE},
                 {"Kanal 3 [mN]", FORCE},
                 {"Timestamp (ms)", TIME}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const import_unit *unit = import_unit_of_name(cases[i].name);
        int best = -1, rank = 0;
        for (int role = 0; role < ROLES; role++) {
            int here = import_name_rank(cases[i].name, unit, role);
            best = here > rank ? role : best;
            rank = here > rank ? here : rank;
        }
        if (best != cases[i].role) {
            fail_msg("%s: %d", cases[i].name, best);
        }
    }
    assert_int_equal(import_name_rank("Speed (mm/min)", import_unit_of_name("Speed (mm/min)"), DEPTH), 0);
    assert_int_equal(import_name_rank("Temperature (C)", import_unit_of_name("Temperature (C)"), TIME), 0);
    assert_null(import_unit_of_name("Force"));
}

static void test_digits(void **state) {
    (void)state;
    assert_true(import_digits(0.1 + 0.2, 0.3) == 0.3);
    assert_true(import_digits(1.1 - 1, 1.1) == 0.1);
    assert_true(import_digits(3e-12 * 1.1, 3.3e-12) == 3.3e-12);
    assert_true(import_digits(0, 1) == 0 && import_digits(123456789e5, 1e13) == 123456789e5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_split), cmocka_unit_test(test_split_wide), cmocka_unit_test(test_number),
        cmocka_unit_test(test_clock), cmocka_unit_test(test_names),      cmocka_unit_test(test_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
