/* test_realtime_ways.c: a rough tool on many random ways, with friction of 0 to 1 and 1 to 10 corrections a tick.
 * check: all */
#include "realtime_rough.h"

START_TEST(many_random_ways) {
    const size_t corrections[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    double mean[10] = {0.0};
    rough_ways(5, 45, corrections, 10, mean);
    ck_assert_double_lt(mean[1], 0.1 * mean[0]);
    ck_assert_double_lt(mean[2], 0.2 * mean[0]);
    ck_assert_double_lt(mean[5], 0.5 * mean[2]);
    ck_assert_double_lt(mean[9], 0.5 * mean[5]);
}
END_TEST

START_TEST(further_ways) {
    const size_t corrections[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    double mean[10] = {0.0};
    rough_ways(1001, 1061, corrections, 10, mean);
    ck_assert_double_lt(mean[1], 0.1 * mean[0]);
    ck_assert_double_lt(mean[9], 0.1 * mean[1]);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, many_random_ways);
    tcase_add_test(tc, further_ways);
}
