/* test_import.c: fields and numbers of imported files. */
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
    assert_int_equal(import_split(line, ',', fields), IMPORT_COLUMNS); /* the rest is left out */
}

static void test_number(void **state) {
    static const char *const wrong[] = {"",    "-",    "x",     "1 2",     "nan",
                                        "inf", "0x10", "1e999", "1.234,5", "1,2,3"};
    double x = 0;
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_false(import_number(wrong[i], ';', &x));
    }
    assert_false(import_number("1,5", ',', &x));
    assert_true(import_number("1,5", ';', &x) && x == 1.5);
    assert_true(import_number("-,5e-3", '\t', &x) && x == -0.5e-3);
    assert_true(import_number("+2.25E2", ',', &x) && x == 225);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_split),
        cmocka_unit_test(test_split_wide),
        cmocka_unit_test(test_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
