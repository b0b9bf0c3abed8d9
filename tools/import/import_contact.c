/* import_contact.c: signs, contact and zero force of an imported recording. */
#include "import.h"

#include <palpate/segments.h>

#include <math.h>
#include <string.h>

static const char NAME[] = "import";

enum { REST_LEAST = 5, LAST = 11 };

static const double unmistakable = 8; /* rise of the force, in sds of noise, needed to find a sign */
static const double same_place =
    0.02; /* share of the travel of the run that starts where an approach ended */

static double average(const double *x, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i];
    return sum / (double)n;
}

static double highest(const double *x, size_t n) {
    double high = x[0];
    for (size_t i = 1; i < n; i++)
        high = fmax(high, x[i]);
    return high;
}

/* How far the plate went. */
static double way_mm(const import_source *s) {
    double low = s->depth_mm[0];
    for (size_t i = 1; i < s->rows; i++)
        low = fmin(low, s->depth_mm[i]);
    return highest(s->depth_mm, s->rows) - low;
}

static int look(const import_source *s, palp_press *press) {
    if (palp_press_create(s->rows, s->time_s, s->depth_mm, s->force_N, press))
        return cli_failure(NAME, "%s: out of memory", s->file);
    return CLI_OK;
}

/* Whether --negate, whose words were checked, names a quantity. */
static bool negated(const import_options *o, const char *quantity) {
    return o->negate && strstr(o->negate, quantity);
}

static void apply_signs(import_source *s) {
    for (size_t i = 0; i < s->rows; i++) {
        s->depth_mm[i] *= s->depth_sign;
        s->force_N[i] *= s->force_sign;
    }
    s->first_mm = s->depth_mm[0];
    s->last_mm = s->depth_mm[s->rows - 1];
}

/* Chooses signs so that depth and force grow while the plate presses. */
int import_signs(const import_options *o, import_source *s) {
    palp_press press;
    if (look(s, &press))
        return CLI_FAILURE;
    size_t peak = press.peak;
    double rise_N = press.mean_N[peak] - press.mean_N[0], travel_mm = s->depth_mm[peak] - s->depth_mm[0];
    bool clear = fabs(rise_N) > unmistakable * press.noise_N;
    palp_press_free(&press);
    s->depth_sign = negated(o, "depth") ? -1 : 1;
    s->force_sign = negated(o, "force") ? -1 : 1;
    s->sign_rule = o->negate ? "as asked for" : "as recorded: the force never exceeds its noise";
    if (o->negate && clear && s->depth_sign * travel_mm * s->force_sign * rise_N < 0)
        cli_warning(NAME, "%s: with --negate %s the force falls as the depth grows", s->file, o->negate);
    if (!o->negate && clear) {
        if (travel_mm == 0)
            return cli_failure(NAME,
                               "%s:%zu: the position at the largest force is that of the start: "
                               "nothing was pressed, or --map names the wrong column",
                               s->file, s->line[peak]);
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

static void use_air(const palp_air *air, import_source *s) {
    s->contact_mm = air->contact_depth;
    s->contact_sd_mm = air->contact_sd;
    s->zero_N = palp_air_force(air, s->time_s[air->contact]);
    s->contact_rule = import_is_approach(s) ? "find_contact" : "free_air";
}

/* Whether the approach reached the force that it looks for; one that did not has touched nothing. */
static bool touched(const import_source *s) {
    double wanted_N = 9.80665e-3 * import_setting_number(s, "Contact Criteria, gf");
    return highest(s->force_N, s->rows) >= wanted_N;
}

static void not_reached(import_source *s, const palp_air *air) {
    s->contact_rule = "not_reached";
    s->contact_mm = highest(s->depth_mm, s->rows);
    s->zero_N = palp_air_force(air, s->time_s[s->rows - 1]);
}

/* The plate rests on the specimen before it moves: depth and force are 0 there. */
static void use_start(const palp_press *press, import_source *s) {
    size_t rest = (size_t)(0.8 * (double)palp_press_rest(press));
    s->contact_rule = "ramp_start";
    s->contact_mm = rest < REST_LEAST ? s->depth_mm[0] : average(s->depth_mm, rest);
    s->zero_N = rest < REST_LEAST ? 0 : average(s->force_N, rest);
    s->contact_sd_mm = fmin(palp_press_travel(press, fmax(press->noise_N, fabs(s->zero_N))),
                            fabs(s->depth_mm[press->peak] - s->depth_mm[0]));
}

static void use_recorded(const palp_press *press, import_source *s) {
    s->contact_rule = "as_recorded";
    s->contact_sd_mm = palp_press_travel(press, press->noise_N);
}

/* The approach that ended where s starts, with the same signs. */
static const import_source *approach_before(const import_sources *all, const import_source *s) {
    const import_source *best = NULL;
    double nearest = same_place * way_mm(s);
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

/* Adds the force at the end of the approach, at which the load cell was zeroed. */
static void use_approach(const import_source *a, import_source *s) {
    s->contact_rule = "find_contact";
    s->contact_from = a->name;
    s->contact_mm = a->contact_mm;
    s->contact_sd_mm = a->contact_sd_mm;
    s->zero_N -= a->preload_N;
}

static import_contact automatic(const import_source *s, const palp_press *press, const palp_air *air) {
    size_t rest = palp_press_rest(press);
    if (s->format == IMPORT_INSTRON)
        return CONTACT_RECORDED;
    if (s->format == IMPORT_MACH1)
        return import_is_approach(s) ? CONTACT_AIR : CONTACT_START;
    return air->seen && (rest >= REST_LEAST || palp_press_starts_in_air(press)) ? CONTACT_AIR : CONTACT_START;
}

int import_contact_rule(const import_options *o, import_source *s) {
    palp_press press;
    if (look(s, &press))
        return CLI_FAILURE;
    palp_air air = palp_press_air(&press, import_is_approach(s));
    s->rule = o->contact ? (import_contact)o->contact : automatic(s, &press, &air);
    palp_press_free(&press);
    return CLI_OK;
}

/* Whether two presses have the same start, travel and duration. */
static bool same_press(const import_source *a, const import_source *b) {
    double way_a = way_mm(a), way_b = way_mm(b), within = same_place * fmax(way_a, way_b);
    double long_a = a->time_s[a->rows - 1] - a->time_s[0], long_b = b->time_s[b->rows - 1] - b->time_s[0];
    return fabs(a->first_mm - b->first_mm) <= within && fabs(way_a - way_b) <= within &&
           fabs(long_a - long_b) <= same_place * fmax(long_a, long_b);
}

void import_contact_agree(import_sources *all) {
    for (size_t i = 0; i < all->n; i++) {
        size_t air = 0, start = 0;
        import_source *s = all->source[i];
        if (s->skip || s->agreed || (s->rule != CONTACT_AIR && s->rule != CONTACT_START))
            continue;
        for (int count = 1; count >= 0; count--) {
            for (size_t j = i; j < all->n; j++) {
                import_source *other = all->source[j];
                if (other->skip || other->agreed || import_is_approach(other) != import_is_approach(s) ||
                    !same_press(s, other))
                    continue;
                air += count && other->rule == CONTACT_AIR;
                start += count && other->rule == CONTACT_START;
                other->agreed = !count;
                other->rule = count ? other->rule : 2 * air >= air + start ? CONTACT_AIR : CONTACT_START;
            }
        }
    }
}

static void choose(const import_options *o, const import_sources *all, const palp_press *press,
                   import_source *s) {
    size_t last = s->rows < LAST ? s->rows : LAST;
    palp_air air = palp_press_air(press, import_is_approach(s));
    if (s->rule == CONTACT_RECORDED)
        use_recorded(press, s);
    else if (s->rule == CONTACT_START)
        use_start(press, s);
    else if (air.contact < press->peak && touched(s))
        use_air(&air, s);
    else
        not_reached(s, &air);
    const import_source *before =
        o->contact == CONTACT_AUTO && s->rule == CONTACT_START ? approach_before(all, s) : NULL;
    if (before)
        use_approach(before, s);
    s->preload_N = average(s->force_N + s->rows - last, last) - s->zero_N;
}

/* Makes depth and force relative to contact. A gap gives the height there; the deflection of a cantilever
 * reduces the depth. */
static void shift(import_source *s) {
    double bend_mm_N = s->piezo && s->spring_N_m > 0 ? 1e3 / s->spring_N_m : 0;
    if (s->gap && s->height_mm <= 0) {
        s->height_mm = fabs(s->contact_mm);
        s->height_from = "the gap at contact";
    }
    for (size_t i = 0; i < s->rows; i++) {
        double force_N = fmax(fabs(s->force_N[i]), fabs(s->zero_N)),
               depth_mm = fmax(fabs(s->depth_mm[i]), fabs(s->contact_mm));
        s->force_N[i] = import_digits(s->force_N[i] - s->zero_N, force_N);
        s->depth_mm[i] = import_digits(s->depth_mm[i] - s->contact_mm, depth_mm);
        s->depth_mm[i] -= bend_mm_N * s->force_N[i];
    }
}

int import_contact_find(const import_options *o, const import_sources *all, import_source *s) {
    palp_press press;
    if (look(s, &press))
        return CLI_FAILURE;
    choose(o, all, &press, s);
    palp_press_free(&press);
    shift(s);
    return CLI_OK;
}
