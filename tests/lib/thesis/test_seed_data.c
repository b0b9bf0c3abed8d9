/* test_seed_data.c: the tables and models of data/sedef2008 agree with each other, so that a slip in
 * copying a number shows. */
#include <palpate/model.h>

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DATA "data/sedef2008/"

/* ---- a table ------------------------------------------------------------------------------------- */

enum { COLUMNS = 16, ROWS = 16, NAME = 40, LINE = 512 };

typedef struct table {
    size_t n_rows, n_columns;
    char name[COLUMNS][NAME];
    double value[ROWS][COLUMNS]; /* NAN = an empty field */
    double half[ROWS][COLUMNS];  /* half a unit of the last printed digit */
} table;

/* Cuts a line at its commas; returns how many fields. */
static size_t split(char *line, char *field[COLUMNS]) {
    size_t n = 0;
    line[strcspn(line, "\n")] = '\0';
    for (char *at = line; at; n++) {
        char *comma = strchr(at, ',');
        ck_assert_uint_lt(n, COLUMNS);
        field[n] = at;
        if (comma)
            *comma = '\0';
        at = comma ? comma + 1 : NULL;
    }
    return n;
}

static void read_field(const char *text, double *value, double *half) {
    char *end;
    const char *point = strchr(text, '.');
    *value = *text ? strtod(text, &end) : NAN;
    *half = 0.5 * pow(10.0, point ? -(double)strlen(point + 1) : 0.0);
    ck_assert_msg(!*text || (*end == '\0' && isfinite(*value)), "'%s' is no number", text);
}

/* Reads a table: the line "# Table 5.1: ...", a row of names, then rows of as many numbers. */
static void read_table(const char *number, size_t n_rows, table *t) {
    char path[64], title[32], line[LINE], *field[COLUMNS];
    snprintf(path, sizeof path, DATA "table_%c_%c.csv", number[0], number[2]);
    snprintf(title, sizeof title, "# Table %s: ", number);
    FILE *file = fopen(path, "r");
    ck_assert_msg(file != NULL, "%s", path);
    memset(t, 0, sizeof *t);
    ck_assert_ptr_nonnull(fgets(line, LINE, file));
    ck_assert_int_eq(strncmp(line, title, strlen(title)), 0);
    ck_assert_ptr_nonnull(fgets(line, LINE, file));
    t->n_columns = split(line, field);
    for (size_t c = 0; c < t->n_columns; c++)
        snprintf(t->name[c], NAME, "%s", field[c]);
    for (; fgets(line, LINE, file); t->n_rows++) {
        ck_assert_uint_lt(t->n_rows, ROWS);
        ck_assert_uint_eq(split(line, field), t->n_columns);
        for (size_t c = 0; c < t->n_columns; c++)
            read_field(field[c], &t->value[t->n_rows][c], &t->half[t->n_rows][c]);
    }
    fclose(file);
    ck_assert_uint_eq(t->n_rows, n_rows);
}

static size_t column(const table *t, const char *name) {
    for (size_t c = 0; c < t->n_columns; c++)
        if (strcmp(t->name[c], name) == 0)
            return c;
    ck_abort_msg("no column %s", name);
    return 0;
}

static double at(const table *t, size_t row, const char *name) {
    return t->value[row][column(t, name)];
}

static size_t column_of(const table *t, const char *prefix, int i) {
    char name[2 * NAME];
    snprintf(name, sizeof name, "%sc%d_N", prefix, i);
    return column(t, name);
}

static void same_law(const table *a, size_t a_row, const char *a_prefix, const table *b, size_t b_row,
                     const char *b_prefix) {
    for (int i = 0; i < 5; i++)
        ck_assert_double_eq(a->value[a_row][column_of(a, a_prefix, i)],
                            b->value[b_row][column_of(b, b_prefix, i)]);
}

static void counts_from(const table *t, const char *name, double first, double step) {
    for (size_t row = 0; row < t->n_rows; row++)
        ck_assert_double_eq(at(t, row, name), first + step * (double)row);
}

/* ---- Chapter 4 ----------------------------------------------------------------------------------- */

/* Four fits of the same data: where there are data, they cannot be far apart. */
START_TEST(table_4_1_polynomials_agree) {
    static const double near[3] = {0.05, 0.012, 0.012};
    table t;
    read_table("4.1", 4, &t);
    for (double e = 0.1; e < 0.41; e += 0.05) {
        double force[4] = {0.0, 0.0, 0.0, 0.0};
        for (size_t row = 0; row < 4; row++)
            for (size_t i = 1; i <= 5; i++)
                if (i <= row + 2)
                    force[row] += t.value[row][i] * pow(e, (double)i);
                else
                    ck_assert(isnan(t.value[row][i]));
        for (size_t row = 0; row < 3; row++)
            ck_assert_double_eq_tol(force[row] / force[3], 1.0, near[row]);
    }
    counts_from(&t, "degree", 2.0, 1.0);
    for (size_t row = 1; row < 4; row++)
        ck_assert_double_lt(at(&t, row, "residual_N"), at(&t, row - 1, "residual_N"));
}
END_TEST

/* K_inf was had from a force of four decimals over the strain: times the strain it is one again. */
static void check_relaxation_rows(const table *t) {
    counts_from(t, "depth_mm", 1.5, 0.5);
    for (size_t row = 0; row < t->n_rows; row++) {
        double strain = at(t, row, "depth_mm") / 24.0;
        double force = at(t, row, "Kinf_N") * strain * 1e4;
        ck_assert_double_eq_tol(at(t, row, "strain"), strain, 0.5e-6);
        ck_assert_double_eq_tol(force, round(force), 0.5e-6 * strain * 1e4 + 1e-9);
    }
}

START_TEST(tables_4_2_and_4_3_agree) {
    table one, two;
    read_table("4.2", 12, &one);
    read_table("4.3", 12, &two);
    check_relaxation_rows(&one);
    check_relaxation_rows(&two);
    for (size_t row = 0; row < 12; row++) { /* a second arm leaves a little less to the spring */
        double ratio = at(&one, row, "Kinf_N") / at(&two, row, "Kinf_N");
        ck_assert(ratio > 1.004 && ratio < 1.009);
        double fast = at(&two, row, "b1_Ns") / at(&two, row, "K1_N");
        double slow = at(&two, row, "b2_Ns") / at(&two, row, "K2_N"), lone = at(&one, row, "b1_Ns");
        lone /= at(&one, row, "K1_N");
        ck_assert(fast > 1.3 && fast < 1.7);
        ck_assert(slow > 2.0 * lone && slow < 3.0 * lone);
    }
}
END_TEST

/* The optimum was searched between the lowest and the highest of the twelve. */
static void check_within(const char *optimum, const char *range) {
    table best, all;
    read_table(optimum, 1, &best);
    read_table(range, 12, &all);
    for (size_t c = 0; c < best.n_columns; c++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t row = 0; row < all.n_rows; row++) {
            low = fmin(low, at(&all, row, best.name[c]));
            high = fmax(high, at(&all, row, best.name[c]));
        }
        ck_assert(best.value[0][c] >= low && best.value[0][c] <= high);
    }
}

START_TEST(tables_4_4_and_4_5_are_within_their_ranges) {
    check_within("4.4", "4.2");
    check_within("4.5", "4.3");
}
END_TEST

/* ---- Chapter 5 ----------------------------------------------------------------------------------- */

START_TEST(table_5_1_hands_its_guesses_on) {
    table t, fits;
    read_table("5.1", 10, &t);
    read_table("4.1", 4, &fits);
    counts_from(&t, "iteration", 1.0, 1.0);
    for (int i = 0; i < 5; i++)
        ck_assert_double_eq(t.value[0][column_of(&t, "optimum_", i)], fits.value[3][i + 1]);
    for (size_t row = 0; row + 1 < t.n_rows; row++) {
        same_law(&t, row, "element_", &t, row + 1, "optimum_");
        if (row + 2 < t.n_rows) /* the ninth is the optimum */
            ck_assert_double_lt(at(&t, row + 1, "residual_N"), at(&t, row, "residual_N"));
    }
    ck_assert_double_gt(at(&t, 9, "residual_N"), at(&t, 8, "residual_N"));
}
END_TEST

/* Every guess after the second moves each coefficient less than the one before, by a like factor: the
 * last law, which stands in the table only once, goes on as the others. */
START_TEST(table_5_1_converges_evenly) {
    table t;
    read_table("5.1", 10, &t);
    for (int i = 2; i < 5; i++) {
        size_t c = column_of(&t, "element_", i);
        for (size_t row = 2; row < t.n_rows; row++) {
            double ratio =
                (t.value[row][c] - t.value[row - 1][c]) / (t.value[row - 1][c] - t.value[row - 2][c]);
            ck_assert_msg(ratio > 0.7 && ratio < 0.95, "row %zu, c%d: %g", row, i, ratio);
        }
    }
}
END_TEST

/* Phase 1 divides K1 and b1 by 1 + error (Figure 5.21); the error is cut off to its digits. */
START_TEST(table_5_2_follows_phase_1) {
    table t, start;
    read_table("5.2", 15, &t);
    read_table("4.4", 1, &start);
    counts_from(&t, "iteration", 1.0, 1.0);
    ck_assert_double_eq_tol(at(&t, 0, "K1_N"), at(&start, 0, "K1_N"), 0.5e-6);
    ck_assert_double_eq_tol(at(&t, 0, "b1_Ns"), at(&start, 0, "b1_Ns"), 0.5e-6);
    double ratio = at(&start, 0, "K1_N") / at(&start, 0, "b1_Ns");
    for (size_t row = 0; row < t.n_rows; row++) {
        double k1 = at(&t, row, "K1_N"), b1 = at(&t, row, "b1_Ns");
        ck_assert_double_eq_tol(k1, ratio * b1, 0.5e-6 * (1.0 + ratio));
        if (row == 0)
            continue;
        double previous = at(&t, row - 1, "K1_N"), error = at(&t, row - 1, "peak_error_percent");
        double implied = 100.0 * (previous / k1 - 1.0), print = 100.0 * 0.5e-6 * (1.0 + previous / k1) / k1;
        ck_assert(implied > error - print && implied < error + 0.01 + print);
    }
    ck_assert_double_eq(at(&t, 14, "peak_error_percent"), 0.95);
}
END_TEST

/* Phase 2 divides b1 by 1 - error. */
START_TEST(table_5_3_follows_phase_2) {
    table t, phase_1;
    read_table("5.3", 4, &t);
    read_table("5.2", 15, &phase_1);
    counts_from(&t, "iteration", 1.0, 1.0);
    ck_assert_double_eq(at(&t, 0, "b1_Ns"), at(&phase_1, 14, "b1_Ns"));
    for (size_t row = 1; row < t.n_rows; row++) {
        size_t c = column(&t, "steady_time_error_percent");
        double implied = 100.0 * (1.0 - at(&t, row - 1, "b1_Ns") / at(&t, row, "b1_Ns"));
        double unit = 2.0 * t.half[row - 1][c];
        ck_assert(implied > t.value[row - 1][c] - 1e-4 && implied < t.value[row - 1][c] + unit);
    }
    ck_assert_double_lt(at(&t, 3, "steady_time_error_percent"), 1.0);
}
END_TEST

/* Phase 3 multiplies the law: some factor must give each coefficient of a row, as printed, from the
 * law that the calibration started with. */
static double check_scaled(const table *t, size_t row, const char *prefix, const double start[5]) {
    double low = 0.0, high = INFINITY;
    for (int i = 0; i < 5; i++) {
        double c = fabs(t->value[row][column_of(t, prefix, i)]), from = fabs(start[i]);
        ck_assert((t->value[row][column_of(t, prefix, i)] < 0.0) == (start[i] < 0.0));
        low = fmax(low, (c - 0.005001) / (from + 0.005)); /* two decimals, cut off or rounded alike */
        high = fmin(high, (c + 0.005001) / (from - 0.005));
    }
    ck_assert_msg(low <= high, "row %zu: factor above %.5f and below %.5f", row, low, high);
    ck_assert(low > 0.9 && high < 1.01);
    return 0.5 * (low + high);
}

static const double law_27[5] = {0.54, -2.34, 33.25, -124.03, 177.63}; /* Eq. 5.21 */
static const double law_125[5] = {0.19, -1.0, 13.53, -50.59, 68.69};   /* Eq. 5.22 */

START_TEST(table_5_4_follows_phase_3) {
    table t, search;
    read_table("5.4", 2, &t);
    read_table("5.1", 10, &search);
    counts_from(&t, "iteration", 1.0, 1.0);
    same_law(&t, 0, "", &search, 8, "optimum_");
    ck_assert_double_eq_tol(check_scaled(&t, 0, "", law_27), 1.0, 1e-4);
    double factor = check_scaled(&t, 1, "", law_27);
    ck_assert_double_eq_tol(100.0 * (1.0 - factor), at(&t, 0, "steady_force_error_percent"), 0.05);
}
END_TEST

/* 6 mm from the usual first guess stands in four tables. */
START_TEST(the_result_for_6_mm_is_the_same_everywhere) {
    table result, guesses, depths, phase_3;
    read_table("5.5", 1, &result);
    read_table("5.6", 8, &guesses);
    read_table("5.7", 15, &depths);
    read_table("5.4", 2, &phase_3);
    ck_assert_double_eq(at(&depths, 8, "depth_mm"), 6.0);
    same_law(&result, 0, "", &phase_3, 1, "");
    same_law(&result, 0, "", &guesses, 0, "");
    same_law(&result, 0, "", &depths, 8, "");
    for (int i = 0; i < 2; i++) {
        const char *name = i ? "b1_Ns" : "K1_N";
        ck_assert_double_eq(at(&result, 0, name), at(&guesses, 0, name));
        ck_assert_double_eq(at(&result, 0, name), at(&depths, 8, name));
    }
    for (size_t c = 7; c < result.n_columns; c++)
        ck_assert_double_lt(result.value[0][c], 1.0); /* the bound was 1 % */
}
END_TEST

START_TEST(table_5_6_guesses_and_results_are_near) {
    table t, usual;
    read_table("5.6", 8, &t);
    read_table("4.4", 1, &usual);
    for (size_t row = 0; row < t.n_rows; row++) {
        for (int i = 0; i < 5; i++)
            ck_assert_double_eq(t.value[row][column_of(&t, "initial_", i)], law_27[i]);
        double k = log10(at(&t, row, "initial_K1_N") / at(&usual, 0, "K1_N"));
        double b = log10(at(&t, row, "initial_b1_Ns") / at(&usual, 0, "b1_Ns"));
        ck_assert_double_eq_tol(k, round(k), 2e-4); /* ten times, once or a tenth */
        ck_assert_double_eq_tol(b, round(b), 2e-4);
        ck_assert(fabs(k) < 1.1 && fabs(b) < 1.1);
        ck_assert_double_eq_tol(at(&t, row, "K1_N"), 0.162, 0.0041);
        ck_assert_double_eq_tol(at(&t, row, "b1_Ns"), 2.25, 0.0131);
        check_scaled(&t, row, "", law_27);
    }
}
END_TEST

/* K1 and b1 grow with the depth; the law is the static one times a factor. */
static void check_depths(const char *number, const double law[5], double tau_low, double tau_high) {
    table t;
    read_table(number, 15, &t);
    counts_from(&t, "depth_mm", 2.0, 0.5);
    for (size_t row = 0; row < t.n_rows; row++) {
        double tau = at(&t, row, "b1_Ns") / at(&t, row, "K1_N");
        check_scaled(&t, row, "", law);
        ck_assert_msg(tau > tau_low && tau < tau_high, "%s, row %zu: %g s", number, row, tau);
        if (row > 0) {
            double k_step = at(&t, row, "K1_N") / at(&t, row - 1, "K1_N");
            double b_step = at(&t, row, "b1_Ns") / at(&t, row - 1, "b1_Ns");
            ck_assert(k_step > 1.0 && k_step < 1.2 && b_step > 1.0 && b_step < 1.2);
        }
    }
}

START_TEST(tables_5_7_and_5_8_scale_the_static_law) {
    check_depths("5.7", law_27, 14.0, 16.5);
    check_depths("5.8", law_125, 12.9, 14.8);
}
END_TEST

/* ---- models -------------------------------------------------------------------------------------- */

static palp_model read_model(const char *path, palp_mesh_source *mesh) {
    palp_error error = {PALP_OK, ""};
    palp_model model;
    palp_status status = palp_model_read(path, &model, mesh, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    ck_assert_double_eq_tol(model.height_m, 0.024, 1e-17);
    ck_assert_double_eq_tol(model.radius_m, 0.012, 1e-17);
    ck_assert_int_eq(model.material.law.kind, PALP_LAW_POLYNOMIAL);
    ck_assert_uint_eq(model.material.law.n, 5);
    ck_assert_int_eq(model.material.formulation, PALP_HISTORY);
    return model;
}

static void check_lumped(const char *path, const char *number, size_t n_arms) {
    table fits, arms;
    palp_model model = read_model(path, NULL);
    read_table("4.1", 4, &fits);
    read_table(number, 1, &arms);
    ck_assert_int_eq(model.kind, PALP_MODEL_LUMPED);
    ck_assert_uint_eq(model.material.n_arms, n_arms);
    for (size_t i = 0; i < 5; i++)
        ck_assert_double_eq(model.material.law.coefficients[i], fits.value[3][i + 1]);
    for (size_t j = 0; j < n_arms; j++) {
        ck_assert_double_eq(model.material.arms[j].stiffness_N, arms.value[0][2 * j]);
        ck_assert_double_eq(model.material.arms[j].viscosity_Ns, arms.value[0][2 * j + 1]);
        ck_assert(model.material.arms[j].beta == 0.0 && model.material.arms[j].gamma == 0.0);
    }
}

START_TEST(lumped_models_are_equation_4_3_and_its_arms) {
    check_lumped(DATA "lumped_n1.json", "4.4", 1);
    check_lumped(DATA "lumped_n2.json", "4.5", 2);
}
END_TEST

START_TEST(network_models_are_equation_5_21_on_a_lattice) {
    static const struct {
        const char *path;
        size_t nodes;
    } models[] = {{DATA "network_27.json", 3}, {DATA "network_125.json", 5}};
    palp_mesh_source mesh;
    palp_model model = read_model(models[_i].path, &mesh);
    ck_assert_int_eq(model.kind, PALP_MODEL_NETWORK);
    ck_assert_int_eq(mesh.kind, PALP_MESH_LATTICE);
    ck_assert_int_eq(mesh.neighbourhood, PALP_NEIGHBOURS_26);
    ck_assert_uint_eq(model.material.n_arms, 0);
    for (int i = 0; i < 5; i++)
        ck_assert_double_eq(model.material.law.coefficients[i], law_27[i]);
    for (int axis = 0; axis < 3; axis++) {
        ck_assert_uint_eq(mesh.nodes[axis], models[_i].nodes);
        ck_assert_double_eq_tol(mesh.size_m[axis], 0.024, 1e-17);
    }
}
END_TEST

/* ---- suite --------------------------------------------------------------------------------------- */

void tests(TCase *tc) {
    tcase_add_test(tc, table_4_1_polynomials_agree);
    tcase_add_test(tc, tables_4_2_and_4_3_agree);
    tcase_add_test(tc, tables_4_4_and_4_5_are_within_their_ranges);
    tcase_add_test(tc, table_5_1_hands_its_guesses_on);
    tcase_add_test(tc, table_5_1_converges_evenly);
    tcase_add_test(tc, table_5_2_follows_phase_1);
    tcase_add_test(tc, table_5_3_follows_phase_2);
    tcase_add_test(tc, table_5_4_follows_phase_3);
    tcase_add_test(tc, the_result_for_6_mm_is_the_same_everywhere);
    tcase_add_test(tc, table_5_6_guesses_and_results_are_near);
    tcase_add_test(tc, tables_5_7_and_5_8_scale_the_static_law);
    tcase_add_test(tc, lumped_models_are_equation_4_3_and_its_arms);
    tcase_add_loop_test(tc, network_models_are_equation_5_21_on_a_lattice, 0, 2);
}
