/* main_check.c: the main function of the Check programs, tests/lib. A program is one file, whose tests() adds
 * what it holds. They run in one process, so that a leak is seen at its end and no clock stops a slow
 * machine. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

void tests(TCase *tc);

int main(int argc, char **argv) {
    const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    Suite *suite = suite_create(slash ? slash + 1 : "tests");
    TCase *tc = tcase_create("all");
    tests(tc);
    suite_add_tcase(suite, tc);
    SRunner *runner = srunner_create(suite);
    srunner_set_fork_status(runner, CK_NOFORK);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
