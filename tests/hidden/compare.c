/* compare.c: the generator's physics against the library's, effect by effect, on the generator's sessions.
 * Prints the largest rms difference over a few materials, in noise levels; exit code 1 above the limit. Alone
 * here in linking the library. */
#include "hidden.h"

#include <math.h>
#include <palpate/forward.h>
#include <stdlib.h>
#include <string.h>

enum { MATERIALS = 3, NOTHING = -2, PARTICLES = -1 }; /* ids before the effects' */
static const double NOISE_LEVEL = 2e-3, STRONG = 10,
                    AS_MANY = 17.945; /* of the peak; noise levels; a cube's elements */

/* In noise levels. What jumps where the plate comes to rest cannot be had exactly from depths at the samples.
 */
static double limit(int id) {
    return id == COULOMB_FRICTION || id == RATE_STIFFENING || id == PLATE_INERTIA ? 0.6 : 0.05;
}

static bool library_effect(const world *w, int id, palp_effect *effect) {
    palp_effect_id found;
    if (palp_effect_parse(effect_kinds[id].id, &found) || palp_effect_default(found, effect))
        return false;
    for (size_t k = 0; k < effect_kinds[id].n; k++)
        effect->value[k] = w->value[id][k];
    return true;
}

static bool library_model(const world *w, palp_model *m, palp_mesh_source *mesh) {
    memset(m, 0, sizeof *m);
    m->height_m = w->height;
    m->kind = w->cube ? PALP_MODEL_NETWORK : PALP_MODEL_LUMPED;
    m->mesh = mesh;
    *mesh = (palp_mesh_source){
        .nodes = {3, 3, 3}, .size_m = {w->height, w->height, w->height}, .neighbourhood = PALP_NEIGHBOURS_26};
    if (palp_law_polynomial(LAW, w->law, &m->material.law))
        return false;
    for (size_t i = 0; i < w->n_arms; i++) {
        palp_arm *a = &m->material.arms[m->material.n_arms++];
        a->stiffness_N = w->arms[i].stiffness;
        a->viscosity_Ns = w->arms[i].stiffness * w->arms[i].time;
    }
    for (int id = 0; id < EFFECTS; id++)
        if (w->value[id][0] != 0 && !library_effect(w, id, &m->effects[m->n_effects++]))
            return false;
    return true;
}

static bool library_run(const palp_model *m, const run *r, palp_load_history *worn, double *force) {
    double *t = malloc(2 * r->n * sizeof *t), *d = t ? t + r->n : NULL, v, a;
    palp_error error;
    if (!t)
        return false;
    for (size_t k = 0, hint = 0; k < r->n; k++) {
        t[k] = (double)k / r->Hz;
        path_at(r, t[k], &hint, &d[k], &v, &a);
    }
    palp_forward_run given = {.n = r->n, .time_s = t, .depth_m = d};
    given.session_s = r->session;
    given.hum_phase = r->hum_phase;
    given.history = worn;
    bool network = m->kind == PALP_MODEL_NETWORK;
    palp_status status = network ? palp_forward_network(m, NULL, &given, force, &error)
                                 : palp_forward_force(m, &given, force, NULL, &error);
    free(t);
    return status == PALP_OK;
}

typedef struct difference {
    double rms, most;
    const char *where;
} difference;

/* In noise levels; the longest difference names its run. */
static bool differ(const world *w, const session *s, double noise_level, difference *out) {
    palp_model m;
    palp_mesh_source mesh;
    double *ours = malloc(2 * s->n * sizeof *ours), *theirs = ours ? ours + s->n : NULL, sum = 0;
    bool good = ours && library_model(w, &m, &mesh);
    if (good)
        world_session(w, s, 0.002, false, NULL, ours);
    palp_load_history kept = {0};
    for (size_t i = 0; i < s->n_runs && good; i++) {
        const run *r = &s->run[i];
        good = library_run(&m, r, s->lasting && !w->cube ? &kept : NULL, theirs + r->first);
        for (size_t k = r->first; k < r->first + r->n && good; k++) {
            double off = fabs(ours[k] - theirs[k]) / noise_level;
            sum += off * off;
            if (off > out->most) {
                out->most = off;
                out->where = r->kind;
            }
        }
    }
    out->rms = fmax(out->rms, sqrt(sum / (double)s->n));
    free(ours);
    return good;
}

/* The effect in the middle of its shapes, STRONG in the records. */
static void hide(const judge *j, int id, uint64_t i, world *w) {
    const effect_kind *kind = &effect_kinds[id];
    double shape[VALUES] = {kind->either_sign && i % 2 == 0 ? -1 : 1, 0, 0};
    for (size_t k = 1; k < kind->n; k++)
        shape[k] = kind->low[k] + (kind->high[k] - kind->low[k]) * 0.2 * (1 + (double)i);
    judge_strengthen(j, w, id, shape, STRONG * NOISE_LEVEL * j->peak, true);
}

static bool look(int id, uint64_t i, difference *out) {
    random_state rng = random_make(77, i);
    world plain = {.height = 0.02, .law = {6, 2, 30, 10, 40}, .n_arms = 2, .arms = {{2, 0.4}, {1.5, 30}}};
    session s;
    judge j;
    plain.arms[0].time *= pow(2, (double)i);
    if (i < 2)
        session_rich(&s, &rng, plain.height, 1);
    else
        session_seed(&s, &rng, plain.height);
    s.lasting = i % 2 == 1;
    if (!judge_make(&j, &plain, &s, 0.02))
        return false;
    world w = plain;
    w.cube = id == PARTICLES;
    for (int k = 0; k < LAW && w.cube; k++)
        w.law[k] /= AS_MANY;
    for (size_t k = 0; k < w.n_arms && w.cube; k++)
        w.arms[k].stiffness /= AS_MANY;
    if (id >= 0)
        hide(&j, id, i, &w);
    bool good = differ(&w, &s, NOISE_LEVEL * j.peak, out);
    judge_free(&j);
    return good;
}

int main(void) {
    int failed = 0;
    printf(
        "Difference from the library, in noise levels of %g of the peak force; effects at %g noise levels\n",
        NOISE_LEVEL, STRONG);
    printf("%-22s %8s %8s %8s  largest in\n", "effect", "rms", "largest", "limit");
    for (int id = NOTHING; id < EFFECTS; id++) {
        difference d = {0, 0, ""};
        bool close = true;
        for (uint64_t i = 0; i < MATERIALS; i++)
            close = look(id, i, &d) && close;
        close = close && d.rms < limit(id);
        const char *name = id == NOTHING ? "none" : "none, of particles";
        printf("%-22s %8.4f %8.3f %8.2f  %s%s\n", id < 0 ? name : effect_kinds[id].id, d.rms, d.most,
               limit(id), d.where, close ? "" : "  TOO FAR");
        failed += !close;
    }
    return failed > 0;
}
