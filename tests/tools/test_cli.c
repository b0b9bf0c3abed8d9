/* test_cli.c: options, lists, output files, first guesses, tables and lumped presses of the command. */
#define _POSIX_C_SOURCE 200809L
#include "export/calculix.h"
#include "calibrate/calibrate.h"
#include "shared/cli.h"
#include "shared/press.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.17g is not %.17g to %g", got, wanted, tolerance);
}

/* ---- numbers and lists ---- */

static void test_number(void **state) {
    static const char *const wrong[] = {"", "abc", "3mm", "3 ", "nan", "inf", "-inf", "1e999", "3,4", "--3"};
    double x = 7;
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_false(cli_read_number(wrong[i], &x));
    assert_true(x == 7);
    assert_true(cli_read_number("-2.5e-3", &x) && x == -2.5e-3);
}

static void test_list(void **state) {
    static const char *const wrong[] = {"", ",", "3,", ",3", "3,,4", "3,a", "3 4"};
    char many[4 * CLI_LIST_MAX] = "1";
    cli_list list;
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_false(cli_read_list(wrong[i], &list));
    assert_true(cli_read_list("1.5,2,-3e1", &list));
    assert_int_equal(list.n, 3);
    assert_true(list.value[0] == 1.5 && list.value[1] == 2 && list.value[2] == -30);
    for (int i = 1; i < CLI_LIST_MAX; i++)
        strcat(many, ",1");
    assert_true(cli_read_list(many, &list) && list.n == CLI_LIST_MAX);
    strcat(many, ",1");
    assert_false(cli_read_list(many, &list));
}

static void test_spread(void **state) {
    const cli_list one = {1, {5}}, two = {2, {5, 6}}, three = {3, {5, 6, 7}};
    double value[3];
    (void)state;
    assert_true(cli_spread(&one, value) && value[0] == 5 && value[1] == 5 && value[2] == 5);
    assert_true(cli_spread(&three, value) && value[0] == 5 && value[1] == 6 && value[2] == 7);
    assert_false(cli_spread(&two, value));
}

/* ---- command lines ---- */

typedef struct targets {
    bool flag;
    const char *text;
    int choice;
    double number, positive;
    size_t count;
    cli_list numbers, counts;
    const char *words[2];
    size_t n_words;
} targets;

/* Parses words up to a NULL; what it wrote to stderr goes to line. */
static int parse(targets *t, char *line, size_t size, ...) {
    const cli_option options[] = {
        cli_heading("All kinds"),
        cli_flag("flag", &t->flag, "a flag"),
        cli_text("text", "FILE", &t->text, "a text"),
        cli_choice("choice", "red|green|blue", &t->choice, "a choice"),
        cli_number("number", "S", -1, 10, &t->number, "from -1 to 10"),
        cli_positive("positive", "MM", 10, &t->positive, "above 0"),
        cli_count("count", "N", 2, 9, &t->count, "2 to 9"),
        cli_numbers("numbers", "LIST", 10, &t->numbers, "above 0"),
        cli_counts("counts", "LIST", 2, 9, &t->counts, "2 to 9"),
    };
    const cli_command command = {
        "try", "[options]", "Tries.", "  palpate try\n", options, sizeof options / sizeof options[0]};
    char name[] = "try", *argv[12] = {name};
    int argc = 1, kept = dup(STDERR_FILENO);
    FILE *to = tmpfile();
    va_list words;
    va_start(words, size);
    while ((argv[argc] = va_arg(words, char *)) != NULL)
        argc++;
    va_end(words);
    assert_non_null(to);
    memset(t, 0, sizeof *t);
    t->choice = -1;
    dup2(fileno(to), STDERR_FILENO);
    int code = cli_parse(&command, argc, argv, t->words, 2, &t->n_words);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    rewind(to);
    line[fread(line, 1, size - 1, to)] = '\0';
    fclose(to);
    return code;
}

static void test_parse_good(void **state) {
    targets t;
    char line[400];
    (void)state;
    assert_int_equal(parse(&t, line, sizeof line, "a.json", "--flag", "--text", "out.csv", "--choice=green",
                           "--number", "-0.5", "b.csv", "--counts", "3,4,5", NULL),
                     CLI_OK);
    assert_string_equal(line, "");
    assert_true(t.flag && t.number == -0.5 && t.choice == 1 && t.counts.n == 3 && t.counts.value[2] == 5);
    assert_string_equal(t.text, "out.csv");
    assert_int_equal(t.n_words, 2);
    assert_string_equal(t.words[0], "a.json");
    assert_string_equal(t.words[1], "b.csv");
    assert_int_equal(
        parse(&t, line, sizeof line, "--positive", "10", "--count", "9", "--numbers", "0.5", NULL), CLI_OK);
    assert_true(t.positive == 10 && t.count == 9 && t.numbers.n == 1 && !t.flag && t.choice == -1);
}

static void test_parse_bad(void **state) {
    static const struct {
        const char *option, *value, *says;
    } wrong[] = {
        {"--other", NULL, "no such option: --other"},
        {"-q", NULL, "no such option: -q"},
        {"--text", NULL, "--text needs a value"},
        {"--flag=yes", NULL, "--flag=yes takes no value"},
        {"--choice", "purple", "must be one of red|green|blue, not \"purple\""},
        {"--choice", "gree", "not \"gree\""},
        {"--choice", "", "not \"\""},
        {"--number", "abc", "must be a number (S), not \"abc\""},
        {"--number", "11", "must be from -1 to 10, not 11"},
        {"--positive", "0", "must be above 0 and at most 10, not 0"},
        {"--positive", "-3", "not -3"},
        {"--positive", "10.5", "at most 10"},
        {"--count", "1", "must be from 2 to 9"},
        {"--count", "2.5", "must be a whole number"},
        {"--count", "1e300", "must be from 2 to 9"},
        {"--numbers", "1,0", "must be above 0"},
        {"--numbers", "1,,2", "separated by commas"},
        {"--counts", "3,1", "must be from 2 to 9"},
        {"--text", "", "needs a name"},
    };
    targets t;
    char line[400];
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_int_equal(parse(&t, line, sizeof line, wrong[i].option, wrong[i].value, NULL), CLI_USAGE);
        assert_ptr_equal(strstr(line, "palpate try: "), line);
        if (!strstr(line, wrong[i].says))
            fail_msg("\"%s\" lacks \"%s\"", line, wrong[i].says);
        assert_ptr_equal(strchr(line, '\n'), line + strlen(line) - 1); /* one line */
    }
    assert_int_equal(parse(&t, line, sizeof line, "a", "b", "c", NULL), CLI_USAGE);
    assert_non_null(strstr(line, "one argument too many: \"c\""));
}

/* An output that is the last of many inputs. */
static void test_output_of_many(void **state) {
    enum { MANY = 3000 };
    char word[] = "input", last[] = "last", out[] = "--out", name[] = "test";
    const char *to = NULL, **words = malloc(MANY * sizeof *words);
    char **argument = malloc((MANY + 4) * sizeof *argument);
    const cli_option options[] = {cli_out("out", "FILE", &to, "a file")};
    const cli_command command = {"test", "", "", "", options, 1};
    size_t n = 0;
    (void)state;
    assert_non_null(words);
    assert_non_null(argument);
    for (size_t i = 0; i < MANY; i++)
        argument[i + 1] = i + 1 < MANY ? word : last;
    argument[0] = name;
    argument[MANY + 1] = out;
    argument[MANY + 2] = last;
    argument[MANY + 3] = NULL;
    assert_int_equal(cli_parse(&command, MANY + 3, argument, words, MANY, &n), CLI_FAILURE);
    assert_int_equal(n, MANY);
    free(words);
    free(argument);
}

static void test_help_lists_every_option(void **state) {
    const cli_option options[] = {
        cli_heading("Group"),
        cli_flag("short", NULL, "first\nsecond"),
        cli_number("an-option-with-a-long-name", "MM", 0, 0, NULL, "its help"),
    };
    const cli_command command = {"try", "[options]", "Tries.", "  palpate try\n", options, 3};
    char text[1000];
    FILE *to = tmpfile();
    (void)state;
    assert_non_null(to);
    cli_help(&command, to);
    rewind(to);
    text[fread(text, 1, sizeof text - 1, to)] = '\0';
    fclose(to);
    assert_non_null(strstr(text, "Usage: palpate try [options]\n"));
    assert_non_null(strstr(text, "\nGroup\n"));
    assert_non_null(strstr(text, "  --short                 first\n                          second\n"));
    assert_non_null(strstr(text, "  --an-option-with-a-long-name MM\n                          its help\n"));
}

static void test_status_codes(void **state) {
    static const struct {
        palp_status status;
        int code;
    } codes[] = {{PALP_ERR_INPUT, CLI_FAILURE},
                 {PALP_ERR_FILE, CLI_FAILURE},
                 {PALP_ERR_NO_MEMORY, CLI_FAILURE},
                 {PALP_ERR_NOT_CONVERGED, CLI_NOT_CONVERGED},
                 {PALP_ERR_BUCKLED, CLI_NOT_CONVERGED}};
    int kept = dup(STDERR_FILENO);
    FILE *to = tmpfile();
    (void)state;
    assert_non_null(to);
    dup2(fileno(to), STDERR_FILENO);
    int got[5];
    for (size_t i = 0; i < 5; i++)
        got[i] = cli_status("try", codes[i].status, NULL);
    dup2(kept, STDERR_FILENO);
    close(kept);
    fclose(to);
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(got[i], codes[i].code);
}

/* ---- output files ---- */

static void test_file(void **state) {
    char folder[] = "/tmp/palpate-cli-XXXXXX", path[64], text[16] = "";
    struct stat entry;
    palp_file file;
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/out", folder);
    assert_int_equal(cli_file_open("try", path, &file), CLI_OK);
    fputs("new", file.stream);
    assert_int_not_equal(stat(path, &entry), 0); /* not there before it is whole */
    assert_int_equal(cli_file_close("try", &file), CLI_OK);
    assert_int_equal(cli_file_open("try", path, &file), CLI_OK);
    fputs("half", file.stream);
    palp_file_abandon(&file);
    FILE *from = fopen(path, "r");
    assert_non_null(from);
    assert_non_null(fgets(text, sizeof text, from));
    assert_string_equal(text, "new");
    fclose(from);
    assert_int_equal(remove(path), 0);
    assert_int_equal(rmdir(folder), 0); /* empty: no temporary file is left */
}

/* ---- tables of CalculiX ---- */

static double table_at(size_t n, const double *e, const double *force, double x) {
    size_t i = 0;
    while (i + 2 < n && e[i + 1] < x)
        i++;
    return force[i] + (force[i + 1] - force[i]) * (x - e[i]) / (e[i + 1] - e[i]);
}

/* A straight line is its own table. For a parabola the error is that of the best piecewise linear function:
 * no bias, and at most half of the interpolation error d h^2 / 4 in the inner intervals. */
static void test_table(void **state) {
    enum { N = 41 };
    const double line[] = {3}, bent[] = {1, 5};
    double e[N], force[N], h = 0.5 / (N - 1), sum = 0;
    palp_law law;
    (void)state;
    for (size_t i = 0; i < N; i++)
        e[i] = h * (double)i;
    assert_int_equal(palp_law_polynomial(1, line, &law), PALP_OK);
    calculix_table(&law, N, e, force);
    for (size_t i = 0; i < N; i++)
        assert_near(force[i], 3 * e[i], 1e-13);
    assert_int_equal(palp_law_polynomial(2, bent, &law), PALP_OK);
    calculix_table(&law, N, e, force);
    assert_true(force[0] == 0);
    for (int k = 0; k < 400; k++) {
        double x = 0.1 + 0.3 * (k + 0.5) / 400, miss = table_at(N, e, force, x) - (x + 5 * x * x);
        assert_true(fabs(miss) <= 5 * h * h / 6 * 1.001); /* d h^2 / 6 at the knots, / 12 between */
        sum += miss;
    }
    assert_near(sum / 400, 0, 1e-3 * 5 * h * h);
}

/* ---- first guesses ---- */

static void test_guess_polynomial(void **state) {
    const double c[] = {8.18, -0.70, 47.47, -131.36, 146.89};
    palp_law law, same, lower;
    (void)state;
    assert_int_equal(palp_law_polynomial(5, c, &law), PALP_OK);
    assert_int_equal(guess_polynomial(&law, 6, 0.4, &same), PALP_OK);
    assert_int_equal(same.n, 7);
    for (size_t i = 0; i < 7; i++)
        assert_near(same.coefficients[i], i < 5 ? c[i] : 0, 0);
    /* One degree less: the best approximation errs by c4 (w / 4)^4 2, w the half width x 2 (Chebyshev). */
    assert_int_equal(guess_polynomial(&law, 3, 0.4, &lower), PALP_OK);
    assert_int_equal(lower.n, 4);
    for (int i = 0; i <= 100; i++) {
        double a, b;
        palp_law_stiffness(&law, 0.004 * i, &a, NULL);
        palp_law_stiffness(&lower, 0.004 * i, &b, NULL);
        assert_near(b, a, 146.89 * 2 * pow(0.1, 4) * (1 + 1e-9));
    }
}

static void test_guess_arms(void **state) {
    palp_material lumped = {.n_arms = 2, .arms = {{2, 2, 0, 0}, {1, 20, 0, 0}}}, guess = {0};
    (void)state;
    guess_arms(&lumped, 2, 0.1, &guess);
    assert_int_equal(guess.n_arms, 2);
    assert_near(guess.arms[1].stiffness_N, 0.1, 1e-15);
    assert_near(guess.arms[1].viscosity_Ns, 2, 1e-15);
    guess_arms(&lumped, 3, 1, &guess); /* relaxation times 1 to 20 s */
    assert_int_equal(guess.n_arms, 3);
    double total = 0;
    for (size_t j = 0; j < 3; j++) {
        assert_near(guess.arms[j].viscosity_Ns / guess.arms[j].stiffness_N, pow(20, (double)j / 2), 1e-12);
        total += guess.arms[j].stiffness_N;
    }
    assert_near(total, 3, 1e-14);
}

/* ---- records and presses ---- */

static void test_record(void **state) {
    record r = {0};
    (void)state;
    for (int i = 0; i < 1000; i++)
        assert_int_equal(record_add(&r, i, 1e-3 * i, -2.0 * i), PALP_OK);
    assert_int_equal(record_add(&r, 999, 1, 5), PALP_OK); /* replaces */
    assert_int_equal(r.n, 1000);
    assert_near(record_peak(&r), 2 * 998, 0);
    assert_near(record_at(&r, 10.5), -21, 1e-12);
    assert_near(record_at(&r, -1), 0, 0);
    assert_near(record_at(&r, 2000), 5, 0);
    assert_near(record_at(&r, 998.5), 0.5 * (5 - 2 * 998), 1e-12);
    record_free(&r);
    assert_int_equal(r.n, 0);
}

static void test_press_times(void **state) {
    const press_settings fixed = {.dt_s = 0.3}, graded = {0}, corners = {.corners = true};
    double *t;
    size_t n;
    palp_path path;
    (void)state;
    assert_int_equal(palp_path_ramp_hold(0.006, 1, 100, &path), PALP_OK);
    assert_int_equal(press_times(&path, &fixed, &n, &t), PALP_OK);
    assert_int_equal(n, 1 + 4 + 334);
    assert_near(t[1], 0.25, 1e-15);
    assert_near(t[4], 1, 0);
    assert_near(t[n - 1], 101, 0);
    free(t);
    assert_int_equal(press_times(&path, &corners, &n, &t), PALP_OK);
    assert_int_equal(n, 3);
    free(t);
    assert_int_equal(press_times(&path, &graded, &n, &t), PALP_OK);
    for (size_t i = 1; i < n; i++)
        assert_true(t[i] > t[i - 1]);
    for (size_t i = 103; i < n; i++) /* the hold: growing steps */
        assert_true(t[i] - t[i - 1] > t[i - 1] - t[i - 2]);
    assert_near(t[n - 1], 101, 0);
    free(t);
    palp_path_free(&path);
}

/* A force path pressed on a specimen, and the depth it gives pressed again, are each other's inverse. */
static void test_creep_is_the_inverse(void **state) {
    const double c[] = {8.18, -0.70, 47.47, -131.36, 146.89};
    const press_settings settings = {.dt_s = 0.05, .tolerance = 1e-4},
                         at_corners = {.dt_s = 0.05, .corners = true};
    palp_material material = {.n_arms = 2, .arms = {{1.3, 17.9, 0, 0}, {0.7, 0.4, 0, 0}}};
    record creep = {0}, press = {0};
    palp_path force, depth;
    (void)state;
    assert_int_equal(palp_law_polynomial(5, c, &material.law), PALP_OK);
    assert_int_equal(palp_path_creep(1.5, 1, 20, &force), PALP_OK);
    assert_int_equal(press_lumped(&material, 0.024, &force, &settings, &creep), PALP_OK);
    assert_int_equal(palp_path_create(creep.n, creep.time_s, creep.depth_m, &depth), PALP_OK);
    assert_int_equal(press_lumped(&material, 0.024, &depth, &at_corners, &press), PALP_OK);
    assert_int_equal(press.n, creep.n);
    for (size_t i = 0; i < press.n; i++)
        assert_near(press.force_N[i], fmin(1.5 * creep.time_s[i], 1.5), 1e-11);
    assert_true(creep.depth_m[creep.n - 1] > creep.depth_m[20]); /* it creeps */
    record_free(&creep);
    record_free(&press);
    palp_path_free(&force);
    palp_path_free(&depth);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_number),
    cmocka_unit_test(test_list),
    cmocka_unit_test(test_spread),
    cmocka_unit_test(test_parse_good),
    cmocka_unit_test(test_parse_bad),
    cmocka_unit_test(test_output_of_many),
    cmocka_unit_test(test_help_lists_every_option),
    cmocka_unit_test(test_status_codes),
    cmocka_unit_test(test_file),
    cmocka_unit_test(test_table),
    cmocka_unit_test(test_guess_polynomial),
    cmocka_unit_test(test_guess_arms),
    cmocka_unit_test(test_record),
    cmocka_unit_test(test_press_times),
    cmocka_unit_test(test_creep_is_the_inverse),
    {0},
};
