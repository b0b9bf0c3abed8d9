/* forward_adaptive.c: a run of a network solved at adaptive samples. Between them the plate's force is a
 * cubic in time. The tangent corrects it for the difference between the recorded depth and the depth's own
 * cubic. The sensor reads every sample. Where the plate meets, pulls or leaves the specimen, every sample is
 * solved. */
#include "base/file.h"
#include "base/statistics.h"
#include "data/segments_internal.h"
#include "forward_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double GROWTH = 0.22; /* step relative to the time since the last corner or contact */
static const double REACH = 0.08;  /* step of depth relative to the largest depth; */
static const double REACH_DAMAGED =
    0.02; /* the same for damaged springs, whose force has kinks at former peaks */
static const double
    STRAIGHT = 5e-4,
    ROUGH = 3e-3; /* relative to the largest depth: deviation of a straight path, without and with noise */

typedef struct adaptive {
    const palp_forward_run *run;
    forward_network *network;
    forward_plate plate, kept;
    size_t n_columns, block; /* block: size in doubles of the plate's rows */
    size_t n, *at;           /* [run->n] samples solved */
    unsigned char *end,
        *corner; /* [run->n] solved samples with no interpolation behind them; samples at corners */
    double *force, *slope, *row; /* [run->n], [run->n], [run->n n_columns] at solved samples, on the plate */
    size_t gone;                 /* a plate that lets go from this sample on does not return */
    double *plate_rows;          /* [block] copy of the plate's rows */
    double reach, stride;        /* largest depth; longest step of depth */
} adaptive;

/* ---- corners ---- */

/* The sample between a and b farthest from the straight line, and its distance. */
static size_t sample_farthest_from_chord(const palp_forward_run *run, size_t a, size_t b, double *off) {
    const double *t = run->time_s, *d = run->depth_m, rate = (d[b] - d[a]) / (t[b] - t[a]);
    size_t worst = a + 1;
    *off = 0.0;
    for (size_t i = a + 1; i < b; i++) {
        double miss = fabs(d[i] - d[a] - rate * (t[i] - t[a]));
        if (miss > *off) {
            *off = miss;
            worst = i;
        }
    }
    return worst;
}

/* Allowed distance from a straight path: some sds of the encoder's noise, by the median second difference. */
static double allowed_path_deviation(const adaptive *k) {
    double *bend = k->force, low = STRAIGHT * k->reach; /* used as scratch */
    size_t n = k->run->n;
    if (n < 3)
        return low;
    segments_bends(n, k->run->depth_m, bend);
    return fmin(fmax(low, 3.0 * statistics_median(bend, n - 2)), ROUGH * k->reach);
}

/* Extends a straight piece from each corner while a line through its first sample passes all others closely.
 * The next corner is the sample farthest from the line between its ends. */
static void find_path_corners(adaptive *k) {
    const palp_forward_run *run = k->run;
    const double *t = run->time_s, *d = run->depth_m, close = allowed_path_deviation(k);
    for (size_t a = 0; a + 1 < run->n;) {
        segments_cone cone = segments_cone_open();
        bool straight = true;
        double off;
        size_t b = a + 1;
        for (; b < run->n && straight; b++)
            straight = segments_cone_take(&cone, t[b] - t[a], d[b] - d[a], close);
        if (straight)
            return;
        a = b - 1 > a + 1 ? sample_farthest_from_chord(run, a, b - 1, &off) : a + 1;
        k->corner[a] = 1;
    }
}

/* ---- solving ---- */

/* The next sample to solve after i; grade: start of the growth of steps. */
static size_t choose_next_sample(const adaptive *k, size_t i, size_t grade) {
    const double *t = k->run->time_s, *d = k->run->depth_m;
    size_t j = i + 1;
    if (k->corner[i] || k->plate.bond != 0.0)
        return j;
    while (j + 1 < k->run->n && !k->corner[j] && !k->corner[j + 1] &&
           t[j + 1] - t[i] <= GROWTH * (t[i] - t[grade]) && fabs(d[j + 1] - d[i]) <= k->stride)
        j++;
    return j;
}

static void store_solved_sample(adaptive *k, size_t i, bool end) {
    const bool first = i == 0,
               beside = (!first && k->corner[i - 1]) || (i + 1 < k->run->n && k->corner[i + 1]);
    k->at[k->n] = i;
    k->end[k->n] = end || first || k->corner[i] || beside;
    k->force[k->n] = k->plate.force;
    k->slope[k->n] = forward_plate_stiffness(&k->plate, forward_network_slope(k->network));
    memcpy(k->row + k->n * k->n_columns, k->plate.force_p, k->n_columns * sizeof *k->row);
    k->n++;
}

static palp_status move_plate_to_sample(adaptive *k, size_t i) {
    k->plate.abandons = i > k->gone;
    const forward_place to = forward_place_at(k->plate.plan, k->run, i, 1.0);
    return forward_plate_move(&k->plate, &to);
}

static void save_plate_and_network(adaptive *k) {
    k->kept = k->plate;
    memcpy(k->plate_rows, k->plate.force_p, k->block * sizeof *k->plate_rows);
    forward_network_keep(k->network);
}

static void restore_plate_and_network(adaptive *k) {
    k->plate = k->kept;
    memcpy(k->plate.force_p, k->plate_rows, k->block * sizeof *k->plate_rows);
    forward_network_back(k->network);
}

/* Solves every sample from i + 1 to j. */
static palp_status solve_every_sample(adaptive *k, size_t i, size_t j) {
    palp_status status = PALP_OK;
    k->end[k->n - 1] = 1;
    while (i < j && !status) {
        status = move_plate_to_sample(k, ++i);
        if (!status)
            store_solved_sample(k, i, true);
    }
    return status;
}

/* The last straight piece into the air, if it lasts to the end of the run. The plate is then ahead of the
 * surface, which slows down. */
static size_t find_departure_for_good(const adaptive *k) {
    size_t i = k->run->n;
    for (; i > 0; i--) {
        const forward_place place = forward_place_at(k->plate.plan, k->run, i - 1, 1.0);
        if (!forward_plate_clear(&k->plate, &place))
            break;
    }
    if (i == k->run->n)
        return i;
    while (i > 0 && !k->corner[i])
        i--;
    return i;
}

/* State of the contact: apart, pressed, or pulled on a bond. */
static int contact_state_of_plate(const forward_plate *plate) {
    return !plate->touching ? 0 : plate->bond == 0.0 ? 1 : 2;
}

static palp_status solve_chosen_samples(adaptive *k, palp_error *error) {
    const palp_forward_run *run = k->run;
    size_t i = 0, grade = 0;
    k->gone = find_departure_for_good(k);
    const forward_place first = forward_place_at(k->plate.plan, run, 0, 1.0);
    palp_status status = forward_plate_start(&k->plate, &first);
    if (!status)
        store_solved_sample(k, 0, true);
    while (!status && i + 1 < run->n && (k->plate.touching || i < k->gone)) {
        size_t j = choose_next_sample(k, i, grade);
        const int was = contact_state_of_plate(&k->plate);
        if (j > i + 1)
            save_plate_and_network(k);
        status = move_plate_to_sample(k, j);
        const bool changed = contact_state_of_plate(&k->plate) != was;
        if (j > i + 1 && (status || changed)) {
            restore_plate_and_network(k);
            status = solve_every_sample(k, i, j);
            grade = j;
        } else if (!status) {
            if (changed)
                k->end[k->n - 1] = 1;
            store_solved_sample(k, j, changed);
            grade = k->corner[j] || changed ? j : grade;
        }
        i = j;
    }
    if (status)
        return palp_error_set(error, status, "at about %.6g s, depth %.6g mm: %s", run->time_s[i],
                              1e3 * run->depth_m[i], palp_status_text(status));
    return PALP_OK;
}

/* ---- interpolation ---- */

/* The solved samples for interpolation in the interval from q on, and their weights at sample i. */
static size_t interpolation_stencil(const adaptive *k, size_t q, size_t i, size_t *first, double weight[4]) {
    const double *t = k->run->time_s;
    size_t a = k->end[q] ? q : q - 1, b = k->end[q + 1] || q + 2 == k->n ? q + 1 : q + 2;
    for (size_t u = a; u <= b; u++) {
        double w = 1.0;
        for (size_t v = a; v <= b; v++)
            if (v != u)
                w *= (t[i] - t[k->at[v]]) / (t[k->at[u]] - t[k->at[v]]);
        weight[u - a] = w;
    }
    *first = a;
    return b - a + 1;
}

/* Force on the plate at sample i and its derivatives; q is the last solved sample at or before i. */
static double interpolate_plate_force(const adaptive *k, size_t q, size_t i, double *force_p) {
    double weight[4], force = 0.0, depth = 0.0;
    size_t first, n = k->n_columns;
    memset(force_p, 0, n * sizeof *force_p);
    if (k->at[q] == i)
        memcpy(force_p, k->row + q * n, n * sizeof *force_p);
    if (k->at[q] == i || q + 1 == k->n) /* at the last one the plate has left finally */
        return k->at[q] == i ? k->force[q] : 0.0;
    size_t count = interpolation_stencil(k, q, i, &first, weight);
    for (size_t u = 0; u < count; u++) {
        const double *row = k->row + (first + u) * n;
        force += weight[u] * k->force[first + u];
        depth += weight[u] * k->run->depth_m[k->at[first + u]];
        for (size_t c = 0; c < n; c++)
            force_p[c] += weight[u] * row[c];
    }
    return force + k->slope[q + 1] * (k->run->depth_m[i] - depth);
}

static palp_status read_sensor_at_all_samples(const adaptive *k, const forward_plan *plan, double *force_N,
                                              double *gradient) {
    forward_sensor s;
    palp_status status = forward_sensor_create(plan, k->n_columns, forward_fastest(k->run), &s);
    if (status)
        return status;
    for (size_t i = 0, q = 0; i < k->run->n; i++) {
        effect_moment at = forward_moment(k->run, i);
        while (q + 1 < k->n && k->at[q + 1] <= i)
            q++;
        double force = interpolate_plate_force(k, q, i, s.force_p);
        force_N[i] = forward_sensor_read(&s, &at, force + (k->run->added_N ? k->run->added_N[i] : 0.0));
        for (size_t c = 0; c < k->n_columns; c++)
            gradient[c * k->run->n + i] = s.force_p[c];
    }
    forward_sensor_free(&s);
    return PALP_OK;
}

/* ---- the run ---- */

static palp_status allocate_adaptive_run(adaptive *k) {
    const size_t n = k->run->n;
    k->at = malloc((n + 1) * sizeof *k->at);
    k->end = calloc(2 * n + 1, 1);
    k->force = malloc(((2 + k->n_columns) * n + k->block + 1) * sizeof *k->force);
    if (!k->at || !k->end || !k->force)
        return PALP_ERR_NO_MEMORY;
    k->corner = k->end + n;
    k->slope = k->force + n;
    k->row = k->slope + n;
    k->plate_rows = k->row + k->n_columns * n;
    for (size_t i = 0; i < n; i++)
        k->reach = fmax(k->reach, fabs(k->run->depth_m[i]));
    return PALP_OK;
}

palp_status forward_run_adaptive(const forward_plan *plan, forward_network *network,
                                 const palp_forward_run *run, double *force_N, double *gradient,
                                 palp_error *error) {
    forward_specimen specimen = forward_network_specimen(network);
    adaptive k = {.run = run,
                  .network = network,
                  .n_columns = specimen.n_columns,
                  .block = (3 + FORWARD_WORK) * specimen.n_columns};
    palp_status status = forward_check_run(run, error);
    if (status || run->n == 0)
        return status;
    status = forward_plate_create(plan, &specimen, &k.plate);
    if (!status)
        status = allocate_adaptive_run(&k);
    if (!status) {
        k.stride = (plan->damaged ? REACH_DAMAGED : REACH) * k.reach;
        find_path_corners(&k);
        status = solve_chosen_samples(&k, error);
    }
    if (!status)
        status = read_sensor_at_all_samples(&k, plan, force_N, gradient);
    free(k.at);
    free(k.end);
    free(k.force);
    forward_plate_free(&k.plate);
    return status;
}
