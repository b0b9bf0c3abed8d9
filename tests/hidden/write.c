/* write.c: a case as the command gets it (model JSON, experiment CSV), and its truth for the scorer. */
#include "hidden.h"

#include <math.h>
#include <string.h>

enum { PATH = 1024 };

static FILE *open_in(const char *folder, const char *name, const char *file) {
    char path[PATH];
    int length = snprintf(path, sizeof path, "%s/%s/%s", folder, name, file);
    return length > 0 && length < PATH ? fopen(path, "w") : NULL;
}

static bool closed(FILE *f) {
    bool good = f && !ferror(f);
    return f && fclose(f) == 0 && good;
}

static void key_number(FILE *f, const char *key, double value) {
    if (value != 0)
        fprintf(f, "# %s: %.9g\n", key, value);
}

static bool run_write(const hidden_case *c, size_t i, const char *folder) {
    const run *r = &c->session.run[i];
    char name[32];
    snprintf(name, sizeof name, "run_%02zu.csv", i + 1);
    FILE *f = open_in(folder, c->name, name);
    if (!f)
        return false;
    fprintf(f, "# palpate.experiment: 1\n# specimen.height_mm: %.9g\n# specimen.radius_mm: %.9g\n",
            1e3 * c->world.height, 1e3 * c->world.radius);
    if (!c->session.lasting)
        fprintf(f, "# specimen.name: \"%zu\"\n", i + 1);
    fprintf(f, "# specimen.kind: \"cylinder\"\n# protocol.kind: \"%s\"\n", r->kind);
    key_number(f, "protocol.depth_mm", 1e3 * r->depth);
    key_number(f, "protocol.rate_mm_s", 1e3 * r->rate);
    key_number(f, "protocol.ramp_s", r->ramp);
    key_number(f, "protocol.hold_s", r->hold);
    key_number(f, "protocol.cycles", r->cycles);
    key_number(f, "protocol.order", r->order);
    key_number(f, "protocol.repeat", r->repeat);
    fprintf(f, "# session.start_s: %.9g\ntime_s,depth_mm,force_N\n", r->session);
    for (size_t k = 0, hint = 0; k < r->n; k++) {
        double t = (double)k / r->Hz, d, v, a;
        path_at(r, t, &hint, &d, &v, &a);
        fprintf(f, "%.6f,%.6f,%.6f\n", t, 1e3 * d, c->force[r->first + k]);
    }
    return closed(f);
}

/* 10 to 30 per cent off. */
static double off(random_state *rng, double x) {
    return x * (1 + random_sign(rng) * random_uniform(rng, 0.1, 0.3));
}

/* A law that was fitted to a network has terms that cancel: they are off by one factor. */
static void law_write(FILE *f, const hidden_case *c, random_state *rng) {
    bool fitted = c->plan.group == NETWORK;
    double factor = fitted ? off(rng, 1) : 1;
    for (int i = 0; i < LAW; i++) {
        double true_value = c->plain.law[i];
        fprintf(f, "%s%.5g", i ? ", " : "", fitted ? factor * true_value : off(rng, true_value));
    }
}

static bool model_write(const hidden_case *c, const char *folder, random_state *rng) {
    const world *w = &c->plain;
    FILE *f = open_in(folder, c->name, "model.json");
    if (!f)
        return false;
    fprintf(f, "{\n    \"palpate\": {\"model\": 1},\n    \"kind\": \"lumped\",\n");
    fprintf(f, "    \"specimen\": {\"kind\": \"cylinder\", \"height_mm\": %.9g, \"radius_mm\": %.9g},\n",
            1e3 * w->height, 1e3 * w->radius);
    fprintf(f, "    \"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [");
    law_write(f, c, rng);
    fprintf(f, "]},\n    \"arms\": [");
    for (size_t i = 0; i < w->n_arms; i++) {
        double stiffness = off(rng, w->arms[i].stiffness);
        fprintf(f, "%s{\"stiffness_N\": %.5g, \"viscosity_Ns\": %.5g}", i ? ", " : "", stiffness,
                stiffness * off(rng, w->arms[i].time));
    }
    fprintf(f, "],\n    \"formulation\": \"history\"\n}\n");
    return closed(f);
}

bool case_write(const hidden_case *c, const char *folder) {
    random_state rng = c->left_over;
    for (size_t i = 0; i < c->session.n_runs; i++)
        if (!run_write(c, i, folder))
            return false;
    return model_write(c, folder, &rng);
}

/* ---- truth ---- */

static void cosines_write(FILE *f, const double cosine[EFFECTS]) {
    fprintf(f, "{");
    for (int i = 0, n = 0; i < EFFECTS; i++)
        if (fabs(cosine[i]) >= 0.3)
            fprintf(f, "%s\"%s\": %.3f", n++ ? ", " : "", effect_kinds[i].id, cosine[i]);
    fprintf(f, "}");
}

static void class_write(FILE *f, const hidden_effect *e) {
    fprintf(f, "[\"%s\"", effect_kinds[e->id].id);
    for (int i = 0; i < EFFECTS; i++)
        if (i != e->id && e->cosine[i] > 0.9)
            fprintf(f, ", \"%s\"", effect_kinds[i].id);
    fprintf(f, "]");
}

static void effect_write(FILE *f, const hidden_case *c, const hidden_effect *e) {
    const effect_kind *kind = &effect_kinds[e->id];
    fprintf(f, "{\"id\": \"%s\", \"parameters\": {", kind->id);
    for (size_t k = 0; k < kind->n; k++)
        fprintf(f, "%s\"%s\": %.9g", k ? ", " : "", kind->key[k], c->world.value[e->id][k] / kind->unit[k]);
    fprintf(f,
            "}, \"noise_levels_aimed_at\": %g, \"noise_levels_raw\": %.4g, \"noise_levels_left\": %.4g, "
            "\"class\": ",
            e->strength, e->seen.raw / c->noise_level, e->seen.left / c->noise_level);
    class_write(f, e);
    fprintf(f, ", \"cosine\": ");
    cosines_write(f, e->cosine);
    fprintf(f, "}");
}

static void outside_write(FILE *f, const hidden_case *c) {
    const world *w = &c->world;
    fprintf(f,
            ", \"outside\": {\"name\": \"%s\", \"size\": %.6g, \"noise_levels_raw\": %.4g, "
            "\"noise_levels_left\": %.4g, "
            "\"cosine\": ",
            foreign_name(w->foreign), w->foreign_size, c->foreign.raw / c->noise_level,
            c->foreign.left / c->noise_level);
    cosines_write(f, c->foreign_cosine);
    fprintf(f, "}");
}

/* Its geometry: what is true of it whatever else is. */
static void network_write(FILE *f, const hidden_case *c) {
    static const char *const kinds[NETWORK_KINDS] = {"mild", "bent", "faulty"};
    fprintf(f,
            ", \"network\": {\"kind\": \"%s\", \"noise_levels_raw\": %.4g, \"noise_levels_left\": %.4g, "
            "\"class\": [",
            kinds[c->plan.effect], c->foreign.raw / c->noise_level, c->foreign.left / c->noise_level);
    for (int i = 0, n = 0; i < EFFECTS; i++)
        if (c->foreign_cosine[i] > 0.9)
            fprintf(f, "%s\"%s\"", n++ ? ", " : "", effect_kinds[i].id);
    fprintf(f, "], \"cosine\": ");
    cosines_write(f, c->foreign_cosine);
    fprintf(f, "}");
}

void truth_write(FILE *f, const hidden_case *c) {
    static const char *const names[GROUPS] = {"single",          "null",   "two", "outside",
                                              "thesis_protocol", "network"};
    fprintf(f,
            "{\"case\": \"%s\", \"group\": \"%s\", \"noise_level_N\": %.6g, \"white_N\": %.6g, "
            "\"correlated_N\": %.6g, "
            "\"peak_N\": %.6g, \"rows\": %zu, \"effects\": [",
            c->name, names[c->plan.group], c->noise_level, c->white, c->correlated, c->peak, c->session.n);
    for (size_t i = 0; i < c->n_effects; i++) {
        fprintf(f, "%s", i ? ", " : "");
        effect_write(f, c, &c->effect[i]);
    }
    fprintf(f, "]");
    if (c->plan.group == OUTSIDE)
        outside_write(f, c);
    if (c->plan.group == NETWORK)
        network_write(f, c);
    fprintf(f, "}");
}
