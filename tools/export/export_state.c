/* export_state.c: the comment on its solid in every scene file, and nodes by their supports. */
#include "export.h"

#include <math.h>
#include <string.h>

const export_law *export_law_of(const export_scene *scene) {
    const export_law *law = scene->target->laws;
    while (law->law != scene->solid.law)
        law++;
    return law;
}

/* ---- what is said of the error ---- */

static double percent_of_peak(const export_scene *s, double force_N) {
    return 100 * force_N / s->info.peak_N;
}

static const char *state_of_time(const export_scene *s) {
    static const char *const text[] = {
        "It has no viscosity: the elastic law that is best for the whole history.",
        "All stresses relax alike, by a Prony series with the relaxation times of the model.",
        "Rayleigh damping by stiffness instead of relaxation.",
        "Damping in proportion to the elastic stress, instead of relaxation.",
        "A shear viscosity instead of relaxation.",
    };
    return text[s->solid.time];
}

/* Letters, digits and single signs, which end neither a comment of XML nor a string of Python. */
static void write_name(const char *name, FILE *to) {
    for (char before = 0; *name; before = *name++) {
        const char c = *name;
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        fputc(letter || (strchr("._+-", c) && c != before) ? c : '_', to);
    }
}

void export_state(const export_scene *s, const char *prefix, FILE *to) {
    fputs(prefix, to);
    write_name(s->model, to);
    cli_say(to, ": a %s solid for %s, fitted by palpate export.", export_law_of(s)->option, s->target->name);
    if (s->n_runs > 0)
        cli_say(to, "%sForce of the plate against %zu recording%s, %zu samples, peak %.6g N:", prefix,
                s->n_runs, s->n_runs > 1 ? "s" : "", s->info.n, s->info.peak_N);
    else
        cli_say(
            to,
            "%sForce of the plate against the model's own (no recording was given), %zu samples, peak %.6g "
            "N:",
            prefix, s->info.n, s->info.peak_N);
    cli_say(to, "%serror at most %.3g %% of the peak, %.3g %% r.m.s.", prefix,
            percent_of_peak(s, s->info.worst_N), percent_of_peak(s, s->info.rms_N));
    if (isfinite(s->lumped_rms_N))
        cli_say(to, "%sThe model itself: %.3g %% r.m.s. of the same recordings.", prefix,
                percent_of_peak(s, s->lumped_rms_N));
    cli_say(to, "%s%s", prefix,
            s->solid.n_arms > 0 ? state_of_time(s) : "The model has no arms, so neither has the solid.");
    cli_say(to, "%sPressed to %.6g mm in %.6g s it gives %.6g N, and %.6g N after %.6g s more.", prefix,
            1e3 * s->depth_m, s->ramp_s, s->ramp_N, s->hold_N, s->hold_s);
    cli_say(to, "%sPoisson's ratio %.6g, plates that %s, these %zu linear tetrahedra.", prefix,
            s->solid.poisson, s->solid.slides ? "slide" : "hold the tissue",
            palp_mesh_tetrahedron_count(s->mesh));
}

/* ---- nodes by their supports ---- */

bool export_has_held(const export_scene *s, unsigned char held) {
    return memchr(s->held, held, palp_mesh_node_count(s->mesh)) != NULL;
}

void export_nodes_held(const export_scene *s, unsigned char held, int first, const char *separator,
                       FILE *to) {
    const char *before = "";
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++) {
        if (s->held[i] == held) {
            fprintf(to, "%s%zu", before, i + (size_t)first);
            before = separator;
        }
    }
}
