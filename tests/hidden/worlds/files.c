/* files.c: a case as the command gets it (experiment CSV), and its truth for the judge. */
#include "worlds.h"

#include <math.h>
#include <string.h>

enum { PATH = 1024 };

static void header_write(FILE *f, const truth *t, size_t i) {
    const run *r = &t->session.run[i];
    enum header_kind kind = t->lab->header;
    fprintf(f, "# palpate.experiment: 1\n");
    if (kind != THREE)
        fprintf(f, "# specimen.height_mm: %.9g\n", 1e3 * t->lab->height);
    if (kind == FULL) {
        fprintf(f, "# specimen.kind: \"cylinder\"\n# protocol.kind: \"%s\"\n# protocol.order: %d\n", r->kind,
                r->order);
        fprintf(f, "# session.start_s: %.9g\n", r->session);
    }
    if (kind == FULL && t->lab->differ > 0)
        fprintf(f, "# specimen.name: \"%zu\"\n", i + 1);
    fprintf(f, "time_s,depth_mm,force_N\n");
}

static bool run_write(const truth *t, size_t i, const char *folder) {
    const run *r = &t->session.run[i];
    double step = t->lab->kind == QUANTIZED ? 1e-3 * lab_travel(t->lab) : 0;
    char path[PATH];
    int length = snprintf(path, sizeof path, "%s/%s/run_%02zu.csv", folder, t->name, i + 1);
    FILE *f = length > 0 && length < PATH ? fopen(path, "w") : NULL;
    if (!f)
        return false;
    header_write(f, t, i);
    random_state rng = random_make(2000 + i, (uint64_t)(1e9 * fabs(t->force[r->first + r->n / 2])));
    for (size_t k = 0, hint = 0; k < r->n; k++) {
        double d = lab_depth(t->lab, r, lab_time(t->lab, r, i, k), &hint, &rng);
        if (step > 0)
            d = step * floor(d / step + 0.5);
        fprintf(f, "%.9g,%.9g,%.9g\n", (double)k / r->Hz, 1e3 * d, t->force[r->first + k]);
    }
    bool good = !ferror(f);
    return fclose(f) == 0 && good;
}

bool truth_files(const truth *t, const char *folder) {
    for (size_t i = 0; i < t->session.n_runs; i++)
        if (!run_write(t, i, folder))
            return false;
    return true;
}

static void effect_line(FILE *f, const truth *t, int id) {
    const effect_kind *kind = &effect_kinds[id];
    fprintf(f, "{\"id\": \"%s\", \"parameters\": {", kind->id);
    for (size_t k = 0; k < kind->n; k++)
        fprintf(f, "%s\"%s\": %.9g", k ? ", " : "", kind->key[k], t->solid.effect[id][k] / kind->unit[k]);
    fprintf(f, "}}");
}

static void cosine_line(FILE *f, const double cosine[EFFECTS]) {
    fprintf(f, "\"cosine\": {");
    for (int i = 0, n = 0; i < EFFECTS; i++)
        if (cosine[i] >= 0.3)
            fprintf(f, "%s\"%s\": %.3f", n++ ? ", " : "", effect_kinds[i].id, cosine[i]);
    fprintf(f, "}");
}

void truth_line(FILE *f, const truth *t) {
    static const char *const outside[ALL_OUTSIDES] = {"",
                                                      "wave in one run",
                                                      "zeros that warm up",
                                                      "specimen slips in one run",
                                                      "zeros that wander",
                                                      "zeros that jump",
                                                      "zeros that follow the room",
                                                      "hysteresis of the load cell",
                                                      "backlash",
                                                      "curing within a run",
                                                      "gain of the position",
                                                      "slip at the grip",
                                                      "a frame that rings",
                                                      "warm-up of each run",
                                                      "room over the session",
                                                      "damping of power 0.4",
                                                      "a side wall"};
    fprintf(f, "{\"case\": \"%s\", \"world\": \"%s\", \"noise_N\": %.6g, \"rows\": %zu, \"arms\": %zu, ",
            t->name, t->lab->name, sqrt(t->white * t->white + t->step * t->step / 12), t->session.n,
            t->solid.n_arms);
    fprintf(f, "\"characterize\": \"--specimen-height-mm %.9g%s\", \"effect\": ", 1e3 * t->lab->height,
            t->effect == RELAXATION_ARM ? " --arms 1" : "");
    if (t->effect == EFFECTS)
        fprintf(f, "null");
    else
        effect_line(f, t, t->effect);
    fprintf(f, ", \"outside\": \"%s\", \"nats\": %.4g, ", outside[t->outside], t->evidence);
    if (t->outside == EACH_WARM_UP)
        fprintf(f, "\"form\": {\"form\": \"exponential\", \"shape\": %.6g}, ",
                60 * t->solid.outside_place / t->lab->Hz);
    if (t->outside == DAMPER)
        fprintf(f, "\"form\": {\"form\": \"power\", \"shape\": 0.4}, ");
    cosine_line(f, t->cosine);
    if (t->second != EFFECTS) {
        fprintf(f, ", \"second\": {\"effect\": ");
        effect_line(f, t, t->second);
        fprintf(f, ", \"nats\": %.4g, ", t->second_evidence);
        cosine_line(f, t->second_cosine);
        fprintf(f, "}");
    }
    fprintf(f, "}");
}
