/* main_cmocka.c: the main function of the cmocka programs, tests/tools and tests/firmware, for those that
 * have none of their own. A program is one file with its tests[], which ends with an empty one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

extern const struct CMUnitTest tests[];

int main(void) {
    size_t n = 0;
    while (tests[n].test_func)
        n++;
    struct CMUnitTest all[n];
    memcpy(all, tests, sizeof all);
    return cmocka_run_group_tests(all, NULL, NULL);
}
