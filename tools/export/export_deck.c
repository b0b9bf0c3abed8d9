/* export_deck.c: a solid as a CalculiX or Abaqus deck, in mm, N, MPa, s. */
#include "export.h"

#include <math.h>

static void write_mesh(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh);
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    fputs("*NODE\n", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        fprintf(to, "%zu,%.12g,%.12g,%.12g\n", i + 1, 1e3 * x[3 * i], 1e3 * x[3 * i + 1], 1e3 * x[3 * i + 2]);
    fputs("*ELEMENT,TYPE=C3D4,ELSET=TISSUE\n", to);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(s->mesh); i++)
        fprintf(to, "%zu,%d,%d,%d,%d\n", i + 1, t[4 * i] + 1, t[4 * i + 1] + 1, t[4 * i + 2] + 1,
                t[4 * i + 3] + 1);
}

/* Coefficients, then D1 = 2 / K; further D so large that they add nothing (CalculiX takes 0 for a default).
 */
static void write_law(const export_scene *s, FILE *to) {
    const palp_solid *solid = &s->solid;
    const size_t n = palp_solid_count(solid->law);
    fprintf(to, "*MATERIAL,NAME=TISSUE\n*HYPERELASTIC,%s%s\n", export_law_of(s)->name,
            solid->time == PALP_SOLID_PRONY ? ",MODULI=LONG TERM" : "");
    for (size_t k = 0; k < n; k++)
        fprintf(to, "%.12g,", 1e-6 * solid->c_Pa[k]);
    fprintf(to, "%.12g%s\n", 2e6 / palp_solid_bulk(solid), solid->law == PALP_SOLID_YEOH ? ",1e20,1e20" : "");
}

/* Shares of the stiffness at once, of shear and of volume. */
static void write_prony(const palp_solid *solid, FILE *to) {
    double whole = 1;
    for (size_t j = 0; j < solid->n_arms; j++)
        whole += solid->share[j];
    fputs("*VISCOELASTIC,TIME=PRONY\n", to);
    for (size_t j = 0; j < solid->n_arms; j++)
        fprintf(to, "%.12g,%.12g,%.12g\n", solid->share[j] / whole, solid->share[j] / whole, solid->tau_s[j]);
}

static void write_section(FILE *to) {
    fputs("*SOLID SECTION,ELSET=TISSUE,MATERIAL=TISSUE\n", to);
}

static void write_supports(const export_scene *s, FILE *to) {
    for (unsigned char held = 1; held < 16; held++) {
        if (!export_has_held(s, held))
            continue;
        fprintf(to, "*NSET,NSET=HELD%d\n", held);
        export_nodes_held(s, held, 1, "\n", to);
        fputs("\n*BOUNDARY\n", to);
        for (int axis = 0; axis < 3; axis++)
            if (held >> axis & 1)
                fprintf(to, "HELD%d,%d,%d\n", held, axis + 1, axis + 1);
    }
}

static void write_press(const export_scene *s, const char *procedure, double period_s, const char *totals,
                        FILE *to) {
    fprintf(to, "*STEP,NLGEOM,INC=100000\n%s\n%.9g,%.9g,%.3g,%.9g\n*BOUNDARY\n", procedure, 0.02 * period_s,
            period_s, 1e-8 * period_s, 0.02 * period_s);
    for (unsigned char held = 8; held < 16; held++)
        if (export_has_held(s, held))
            fprintf(to, "HELD%d,2,2,%.12g\n*NODE PRINT,NSET=HELD%d,TOTALS=%s\n", held, -1e3 * s->depth_m,
                    held, totals);
    fputs("*END STEP\n", to);
}

void export_calculix(const export_scene *s, FILE *to) {
    export_state(s, "** ", to);
    fputs("** Units: mm, N, MPa. CalculiX has no *VISCOELASTIC. Run: ccx -i DECK (without .inp);\n"
          "** DECK.dat gets the total reaction RF of the pressed nodes over the time of the ramp.\n",
          to);
    write_mesh(s, to);
    write_law(s, to);
    write_section(to);
    write_supports(s, to);
    write_press(s, "*STATIC", s->ramp_s, "ONLY\nRF", to);
}

void export_abaqus(const export_scene *s, FILE *to) {
    export_state(s, "** ", to);
    fputs("** Units: mm, N, MPa, s. Run: abaqus job=DECK; a ramp, then a dwell.\n*HEADING\n tissue\n", to);
    write_mesh(s, to);
    write_law(s, to);
    const bool relaxes = s->solid.time == PALP_SOLID_PRONY;
    const char *procedure = relaxes ? "*VISCO,CETOL=0.01" : "*STATIC";
    if (relaxes)
        write_prony(&s->solid, to);
    write_section(to);
    write_supports(s, to);
    write_press(s, procedure, s->ramp_s, "YES\nRF2", to);
    write_press(s, procedure, s->hold_s, "YES\nRF2", to);
}
