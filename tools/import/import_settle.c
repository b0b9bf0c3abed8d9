/* import_settle.c: signs, contact and zero force of an imported recording. */
#include "import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

enum { WINDOW = 11, REST_LEAST = 5, ROUNDS = 5, AIR_LEAST = 20 };

static const double beyond = 4;         /* sds that a running mean leaves the air by */
static const double doubtful = 2;       /* sds from which on it may have left: how exact the contact is */
static const double unmistakable = 8;   /* noise sds that the force must rise by to tell a sign */
static const double approach_air = 0.8; /* part of an approach that is surely air */
static const double least_travel = 3;   /* in air, in sds of the contact, to be called a stretch of air */
static const double resting = 1e-3;     /* of the travel: not moving yet */
static const double same_place_mm = 2e-3;
static const double kept_variance = 0.76; /* of a Gaussian without its outer 5 % */

/* ---- the shape of a recording ---- */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Noise of one sample from second differences, without the largest, which are corners and spikes. */
static double noise_of(const double *force_N, size_t n, double *bends) {
    size_t used = n - 2 - (n - 2) / 20;
    double squares = 0;
    for (size_t i = 2; i < n; i++) {
        bends[i - 2] = fabs(force_N[i] - 2 * force_N[i - 1] + force_N[i - 2]);
    }
    qsort(bends, n - 2, sizeof *bends, compare);
    for (size_t i = 0; i < used; i++) {
        squares += bends[i] * bends[i];
    }
    return sqrt(squares / (6 * kept_variance * (double)used));
}

/* The running mean over *window samples, malloc'ed, and the noise of one sample. */
static double *running_mean(const import_source *s, size_t *window, double *noise_N) {
    size_t n = s->rows, half = n / 20 < WINDOW / 2 ? n / 20 : WINDOW / 2;
    double *mean = malloc(n * sizeof *mean);
    if (mean) {
        *noise_N = noise_of(s->force_N, n, mean);
    }
    for (size_t i = 0; mean && i < n; i++) {
        size_t from = i > half ? i - half : 0, to = i + half < n ? i + half : n - 1;
        mean[i] = 0;
        for (size_t k = from; k <= to; k++) {
            mean[i] += s->force_N[k] / (double)(to - from + 1);
        }
    }
    *window = 2 * half + 1;
    return mean;
}

/* Where the running mean is furthest from its start. */
static size_t furthest(const double *mean, size_t n) {
    size_t peak = 0;
    for (size_t i = 1; i < n; i++) {
        peak = fabs(mean[i] - mean[0]) > fabs(mean[peak] - mean[0]) ? i : peak;
    }
    return peak;
}

static double average(const double *x, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i];
    }
    return sum / (double)n;
}

/* ---- signs ---- */

static bool listed(const char *list, const char *word) {
    const char *at = list ? strstr(list, word) : NULL;
    return at && (at == list || at[-1] == ',') && (!at[strlen(word)] || at[strlen(word)] == ',');
}

static void apply_signs(import_source *s) {
    for (size_t i = 0; i < s->rows; i++) {
        s->depth_mm[i] *= s->depth_sign;
        s->force_N[i] *= s->force_sign;
    }
    s->first_mm = s->depth_mm[0];
    s->last_mm = s->depth_mm[s->rows - 1];
}

/* Pressing is the motion along which the force's size grows: both are positive there. */
int import_signs(const import_options *o, import_source *s) {
    size_t window;
    double noise_N, *mean = running_mean(s, &window, &noise_N);
    if (!mean) {
        return cli_failure(NAME, "%s: out of memory", s->file);
    }
    size_t peak = furthest(mean, s->rows);
    double rise_N = mean[peak] - mean[0], travel_mm = s->depth_mm[peak] - s->depth_mm[0];
    bool clear = fabs(rise_N) > unmistakable * noise_N;
    free(mean);
    s->depth_sign = listed(o->negate, "depth") ? -1 : 1;
    s->force_sign = listed(o->negate, "force") ? -1 : 1;
    s->sign_rule = o->negate ? "as asked for" : "as recorded: the force never leaves its noise";
    if (o->negate && clear && s->depth_sign * travel_mm * s->force_sign * rise_N < 0) {
        cli_warning(NAME, "%s: with --negate %s the force falls as the depth grows", s->file, o->negate);
    }
    if (!o->negate && clear) {
        if (travel_mm == 0) {
            return cli_failure(NAME,
                               "%s:%zu: the position is the same at the start and at the largest force: "
                               "nothing was pressed, or --map names the wrong column",
                               s->file, s->line[peak]);
        }
        s->depth_sign = travel_mm < 0 ? -1 : 1;
        s->force_sign = rise_N < 0 ? -1 : 1;
        s->sign_rule = s->depth_sign < 0 && s->force_sign < 0 ? "depth and force reversed: the force's size "
                                                                "grows as the position falls"
                       : s->depth_sign < 0 ? "depth reversed: the force grows as the position falls"
                       : s->force_sign < 0 ? "force reversed: its size grows with depth"
                                           : "as recorded: the force grows with depth";
    }
    apply_signs(s);
    return CLI_OK;
}

/* ---- the air before contact ---- */

typedef struct air {
    double level_N, drift_N_s, sd_N; /* line through the force at time 0; sd of the running mean about it */
    size_t contact;                  /* first sample after it; = peak if there is none */
    double contact_sd_mm;
} air;

static double air_at(const air *a, double t) {
    return a->level_N + a->drift_N_s * t;
}

/* Level (and drift, with drifting) of the first n samples. */
static void fit_air(const import_source *s, const double *mean, size_t n, bool drifting, double least_sd,
                    air *a) {
    double t = average(s->time_s, n), f = average(s->force_N, n), tt = 0, tf = 0, squares = 0;
    for (size_t i = 0; i < n; i++) {
        tt += (s->time_s[i] - t) * (s->time_s[i] - t);
        tf += (s->time_s[i] - t) * (s->force_N[i] - f);
    }
    a->drift_N_s = drifting && tt > 0 ? tf / tt : 0;
    a->level_N = f - a->drift_N_s * t;
    for (size_t i = 0; i < n; i++) {
        double off = mean[i] - air_at(a, s->time_s[i]);
        squares += off * off;
    }
    a->sd_N = fmax(sqrt(squares / (double)n), least_sd);
}

/* After the last sample before the peak whose running mean is within so many sds of the air. */
static size_t leaves(const import_source *s, const double *mean, size_t peak, const air *a, double sds) {
    size_t i = peak;
    while (i > 0 && fabs(mean[i] - air_at(a, s->time_s[i])) > sds * a->sd_N) {
        i--;
    }
    return i == peak ? peak : i + 1;
}

/* From where it may have left the air; and the running mean sees contact up to half its window early. */
static double exactness(const import_source *s, const double *mean, size_t window, size_t peak,
                        const air *a) {
    size_t early = leaves(s, mean, peak, a, doubtful), late = a->contact + window / 2;
    const double *depth_mm = s->depth_mm;
    early = early < a->contact ? early : a->contact;
    late = late < s->rows ? late : s->rows - 1;
    return fmax(fabs(depth_mm[a->contact] - depth_mm[early]), fabs(depth_mm[late] - depth_mm[a->contact]));
}

/* An approach is nearly all air, and its load cell drifts while it searches; of another recording only the
 * first samples are surely air, and what is found to be air then says what air is. */
static void find_air(const import_source *s, const double *mean, size_t window, double noise_N, size_t peak,
                     air *a) {
    bool approach = import_is_approach(s);
    double least_sd = fmax(noise_N / sqrt((double)window), 1e-6 * fabs(mean[peak] - mean[0]));
    size_t n = approach ? (size_t)(approach_air * (double)peak) : 5 * window;
    n = n < peak ? n : peak;
    fit_air(s, mean, n > 2 ? n : 2, approach, least_sd, a);
    a->contact = leaves(s, mean, peak, a, beyond);
    for (int round = 0; !approach && round < ROUNDS && a->contact > 3 * window && a->contact < peak;
         round++) {
        fit_air(s, mean, a->contact - window, false, least_sd, a);
        a->contact = leaves(s, mean, peak, a, beyond);
    }
    a->contact_sd_mm = exactness(s, mean, window, peak, a);
}

/* Whether the force of the first samples does not trend, seen in the means of its outer thirds. */
static bool starts_in_air(const import_source *s, size_t window) {
    size_t n = 5 * window < s->rows ? 5 * window : s->rows, third = n / 3;
    double squares = 0, level = average(s->force_N, n);
    for (size_t i = 0; i < n; i++) {
        squares += (s->force_N[i] - level) * (s->force_N[i] - level);
    }
    double trend = n < AIR_LEAST ? 0 : average(s->force_N + n - third, third) - average(s->force_N, third);
    return n >= AIR_LEAST && fabs(trend) <= beyond * sqrt(squares / (double)n / (double)third);
}

static void use_air(const air *a, import_source *s) {
    s->contact_mm = s->depth_mm[a->contact];
    s->contact_sd_mm = a->contact_sd_mm;
    s->zero_N = air_at(a, s->time_s[a->contact]);
    s->contact_rule = import_is_approach(s) ? "find_contact" : "free_air";
}

/* An approach that gave up before the force it looks for has touched nothing. */
static bool touched(const import_source *s) {
    double wanted_N = 9.80665e-3 * import_setting_number(s, "Contact Criteria, gf"),
           largest_N = s->force_N[0];
    for (size_t i = 0; i < s->rows; i++) {
        largest_N = fmax(largest_N, s->force_N[i]);
    }
    return largest_N >= wanted_N;
}

static void not_reached(import_source *s, const air *a) {
    s->contact_rule = "not_reached";
    s->contact_mm = s->depth_mm[0];
    for (size_t i = 0; i < s->rows; i++) {
        s->contact_mm = fmax(s->contact_mm, s->depth_mm[i]);
    }
    s->zero_N = air_at(a, s->time_s[s->rows - 1]);
}

/* ---- no air ---- */

/* First sample that has moved so far from the start. */
static size_t moved(const import_source *s, double by_mm) {
    size_t i = 0;
    while (i + 1 < s->rows && fabs(s->depth_mm[i] - s->depth_mm[0]) <= by_mm) {
        i++;
    }
    return i;
}

/* The travel that a force stands for, by the slope of the first twentieth of the press. */
static double travel_of(const import_source *s, const double *mean, size_t peak, double force_N) {
    double travel_mm = s->depth_mm[peak] - s->depth_mm[0];
    size_t from = moved(s, resting * fabs(travel_mm)), to = moved(s, 0.05 * fabs(travel_mm));
    double rise_N = mean[to] - mean[from], way_mm = s->depth_mm[to] - s->depth_mm[from];
    if (rise_N * way_mm <= 0) {
        rise_N = mean[peak] - mean[0];
        way_mm = travel_mm;
    }
    return rise_N == 0 ? 0 : fabs(force_N * way_mm / rise_N);
}

/* The plate rests on the specimen before it moves: there are depth 0 and force 0. */
static void use_start(import_source *s, const double *mean, size_t peak, double noise_N) {
    size_t rest = (size_t)(0.8 * (double)moved(s, resting * fabs(s->depth_mm[peak] - s->depth_mm[0])));
    s->contact_rule = "ramp_start";
    s->contact_mm = rest < REST_LEAST ? s->depth_mm[0] : average(s->depth_mm, rest);
    s->zero_N = rest < REST_LEAST ? 0 : average(s->force_N, rest);
    s->contact_sd_mm = travel_of(s, mean, peak, fmax(noise_N, fabs(s->zero_N)));
}

static void use_recorded(import_source *s, const double *mean, size_t peak, double noise_N) {
    s->contact_rule = "as_recorded";
    s->contact_sd_mm = travel_of(s, mean, peak, noise_N);
}

/* The approach that ended where s starts, with the same signs. */
static const import_source *approach_before(const import_sources *all, const import_source *s) {
    const import_source *best = NULL;
    double nearest = same_place_mm;
    for (size_t i = 0; i < all->n; i++) {
        const import_source *a = all->source[i];
        if (!a->skip && a->contact_rule && strcmp(a->contact_rule, "find_contact") == 0 &&
            a->depth_sign == s->depth_sign && fabs(a->last_mm - s->first_mm) <= nearest) {
            nearest = fabs(a->last_mm - s->first_mm);
            best = a;
        }
    }
    return best;
}

/* The load cell was set to zero under the force that the approach ended at. */
static void use_approach(const import_source *a, import_source *s) {
    s->contact_rule = "find_contact";
    s->contact_from = a->name;
    s->contact_mm = a->contact_mm;
    s->contact_sd_mm = a->contact_sd_mm;
    s->zero_N -= a->preload_N;
}

/* ---- which rule ---- */

static import_contact automatic(const import_source *s, size_t window, size_t peak, const air *a) {
    double before_mm = fabs(s->depth_mm[a->contact] - s->depth_mm[0]);
    bool seen = a->contact < peak && before_mm > least_travel * a->contact_sd_mm;
    if (s->format == IMPORT_INSTRON) {
        return CONTACT_RECORDED;
    }
    if (s->format == IMPORT_MACH1) {
        return import_is_approach(s) ? CONTACT_AIR : CONTACT_START;
    }
    return seen && starts_in_air(s, window) ? CONTACT_AIR : CONTACT_START;
}

static void choose(const import_options *o, const import_sources *all, const double *mean, size_t window,
                   double noise_N, import_source *s) {
    size_t peak = furthest(mean, s->rows), last = s->rows < WINDOW ? s->rows : WINDOW;
    air a = {0};
    find_air(s, mean, window, noise_N, peak, &a);
    import_contact rule = o->contact ? (import_contact)o->contact : automatic(s, window, peak, &a);
    if (rule == CONTACT_RECORDED) {
        use_recorded(s, mean, peak, noise_N);
    } else if (rule == CONTACT_START) {
        use_start(s, mean, peak, noise_N);
    } else if (a.contact < peak && touched(s)) {
        use_air(&a, s);
    } else {
        not_reached(s, &a);
    }
    const import_source *before =
        o->contact == CONTACT_AUTO && rule == CONTACT_START ? approach_before(all, s) : NULL;
    if (before) {
        use_approach(before, s);
    }
    s->preload_N = average(s->force_N + s->rows - last, last) - s->zero_N;
}

int import_contact_find(const import_options *o, const import_sources *all, import_source *s) {
    size_t window;
    double noise_N, *mean = running_mean(s, &window, &noise_N);
    if (!mean) {
        return cli_failure(NAME, "%s: out of memory", s->file);
    }
    choose(o, all, mean, window, noise_N, s);
    free(mean);
    for (size_t i = 0; i < s->rows; i++) {
        s->depth_mm[i] -= s->contact_mm;
        s->force_N[i] -= s->zero_N;
    }
    return CLI_OK;
}
