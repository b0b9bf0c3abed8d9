/* test_explain_words.c: what palpate explain says of results that contradict themselves, or that are no
 * numbers. */
#include "explain/explain.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* What the terminal says of it, as one text; the page has the same sentences. */
static char *said_of(const char *result) {
    json_error_t error;
    json_t *all = json_loads(result, 0, &error);
    char *text;
    FILE *to = tmpfile();
    if (!all)
        fail_msg("%s: %s", error.text, result);
    assert_non_null(to);
    explain_add_words(all);
    explain_say(to, all);
    long size = ftell(to);
    text = calloc((size_t)size + 1, 1);
    assert_non_null(text);
    rewind(to);
    assert_int_equal(fread(text, 1, (size_t)size, to), size);
    fclose(to);
    json_decref(all);
    return text;
}

/* Whether a word is there, and not within another one. */
static bool has_word(const char *text, const char *word) {
    const char *letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
    for (const char *at = text; (at = strstr(at, word)) != NULL; at++)
        if ((at == text || !strchr(letters, at[-1])) && !strchr(letters, at[strlen(word)]))
            return true;
    return false;
}

/* A result with this verdict, gap and closed share; one effect, if closed is any. */
static char *result_of(const char *verdict, const char *before, const char *after, const char *rest,
                       const char *closed) {
    char *text = malloc(4096), effect[1024] = "";
    assert_non_null(text);
    if (closed)
        snprintf(effect, sizeof effect,
                 "{\"id\": \"sensor_lag\", \"class\": [\"sensor_lag\"], \"parameters\": {\"time_s\": %s}, "
                 "\"intervals\": {\"time_s\": [3, %s]}, "
                 "\"evidence\": %s, \"evidence_standard_error\": null, \"gap_closed\": %s}",
                 before, after, rest, closed);
    snprintf(
        text, 4096,
        "{\"verdict\": \"%s\", \"effects\": [%s], \"null_threshold\": null, \"gap\": {\"noise_level_N\": "
        "0.004, \"before_N\": %s, "
        "\"after_N\": %s, \"heldout_before_N\": %s, \"heldout_after_N\": %s, \"unexplained_N\": %s, "
        "\"closed\": %s}, "
        "\"scatter\": [{\"id\": \"zero_scatter\", \"sd_N\": %s, \"gap_before_N\": %s, \"gap_after_N\": %s}], "
        "\"noise_level\": {\"white_N\": %s, \"correlated_N\": 0, \"correlation_s\": null, \"gain_scatter\": "
        "null, "
        "\"contact_scatter_mm\": null}, \"profile\": {\"experiments\": [{\"experiment\": \"a.csv\", "
        "\"after_N\": %s}, {\"experiment\": "
        "\"b.csv\", \"after_N\": null}]}, \"rejected\": [{\"id\": \"toe_region\", \"reason\": \"r\", "
        "\"score\": %s, \"explained_N\": null}], "
        "\"steps\": [{\"taken\": null, \"rejected\": [{\"id\": \"toe_region\", \"reason\": \"r\", \"score\": "
        "%s, \"explained_N\": null}]}], "
        "\"next_experiment\": null}",
        verdict, effect, before, after, before, after, rest, closed ? closed : "null", rest, before, after,
        rest, after, rest, rest);
    return text;
}

static void check(const char *verdict, const char *before, const char *after, const char *rest,
                  const char *closed) {
    static const char *const never[] = {"nan", "-nan", "inf", "-inf", "null"};
    char *result = result_of(verdict, before, after, rest, closed), *text = said_of(result);
    for (size_t i = 0; i < sizeof never / sizeof *never; i++)
        if (has_word(text, never[i]))
            fail_msg("\"%s\" of %s:\n%.200s", never[i], result, strstr(text, never[i]) - 100);
    for (const char *at = text; (at = strchr(at, '%')) != NULL; at++) {
        const char *from = at;
        while (from > text && strchr(" .-0123456789", from[-1]))
            from--;
        double share = strtod(from, NULL);
        if (strncmp(at, "% of the", 8) == 0 && !(share >= 0 && share <= 100))
            fail_msg("%g %% of %s:\n%s", share, result, text);
    }
    free(text);
    free(result);
}

static void test_no_number_is_none(void **state) {
    static const char *const verdict[] = {"agrees",      "explained", "ambiguous",
                                          "unexplained", "suspected", "another_law"};
    static const char *const number[] = {"null", "0", "-1", "0.003", "0.1", "1e308", "-1e308", "1e-300"};
    static const char *const closed[] = {NULL, "null", "-3", "0.5", "1.0001", "400"};
    (void)state;
    enum { NUMBERS = sizeof number / sizeof *number };
    for (size_t v = 0; v < sizeof verdict / sizeof *verdict; v++)
        for (size_t c = 0; c < sizeof closed / sizeof *closed; c++)
            for (size_t n = 0; n < NUMBERS * NUMBERS; n++)
                check(verdict[v], number[n % NUMBERS], number[n / NUMBERS], number[(3 * n + c) % NUMBERS],
                      closed[c]);
}

static bool says(const char *verdict, const char *before, const char *after, const char *rest,
                 const char *closed, const char *what) {
    char *result = result_of(verdict, before, after, rest, closed), *text = said_of(result);
    bool found = strstr(text, what) != NULL;
    free(text);
    free(result);
    return found;
}

static void test_sentences_agree_with_their_numbers(void **state) {
    (void)state;
    const char *shape = "but not its shape";
    assert_true(says("unexplained", "0.1", "0.003", "0.002", NULL,
                     shape)); /* the residual is less than the noise of 4 mN */
    assert_false(says("unexplained", "0.1", "0.05", "0.049", NULL, shape));
    assert_false(says("unexplained", "0.1", "0.003", "0", NULL, "Beyond the noise"));
    assert_true(says("explained", "0.1", "0.003", "0", "0.9", "falls from 100 mN, rms, to 3 mN"));
    assert_false(says("explained", "0.1", "0.2", "0", "0.9", "falls from"));
    assert_true(says("explained", "0.1", "0.2", "0", "0.9", "goes up from 100 mN, rms, to 200 mN"));
    assert_true(says("explained", "null", "0.2", "0", "0.9", "could not be computed"));
    assert_true(says("explained", "0.1", "0.003", "0", "1.7", "closes 100 % of the gap"));
    assert_true(says("explained", "0.1", "0.003", "0", "-2", "closes 0 % of the gap"));
    assert_true(says("explained", "0.1", "0.003", "0", NULL, "another law of the material"));
    assert_false(
        says("explained", "5", "2", "0", "1", "(3 to 2)")); /* an interval whose ends are exchanged */
    assert_true(says("explained", "5", "4", "0", "1", "(3 to 4)"));
}

/* Which runs press no specimen is said by their names, and where it is only an assumption. */
static void test_runs_without_a_specimen_are_named(void **state) {
    static const char pressed[] =
        "{\"verdict\": \"agrees\", \"pressed\": ["
        "{\"experiment\": \"runs/a.csv\", \"object\": \"specimen\", \"declared\": false},"
        "{\"experiment\": \"runs/b.csv\", \"object\": \"%s\", \"declared\": %s},"
        "{\"experiment\": \"runs/c.csv\", \"object\": \"%s\", \"declared\": %s}]}";
    static const struct {
        const char *object, *declared, *said;
    } cases[] = {{"air", "true", "In air, as the file says: b.csv, c.csv."},
                 {"block", "true", "On a rigid block, as the file says: b.csv, c.csv."},
                 {"block", "false", "Taken for a rigid block, by force and travel: b.csv, c.csv."},
                 {"air", "false", "Taken for a run in air, as it has almost no force: b.csv, c.csv."}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char result[1024];
        snprintf(result, sizeof result, pressed, cases[i].object, cases[i].declared, cases[i].object,
                 cases[i].declared);
        char *text = said_of(result);
        assert_non_null(strstr(text, cases[i].said));
        assert_null(strstr(text, "a.csv"));
        assert_int_equal(strstr(text, "it would be a dead sensor") != NULL, i == 3);
        free(text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_number_is_none),
                                       cmocka_unit_test(test_sentences_agree_with_their_numbers),
                                       cmocka_unit_test(test_runs_without_a_specimen_are_named)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
