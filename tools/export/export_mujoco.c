/* export_mujoco.c: a solid as an MJCF model of MuJoCo, in m, N, s, kg. The plate is a body on a slide, which
 * an actuator moves; the passive force of the slide is that of the tissue. */
#include "export.h"

enum { STEPS = 1000 /* of the ramp */, STIFF = 2000 };

static double volume_of(const double *x, const int32_t *t) {
    double e[3][3];
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            e[k][a] = x[3 * t[k + 1] + a] - x[3 * t[0] + a];
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
            e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
}

/* A quarter of the mass of each tetrahedron around the node. */
static double mass_of(const export_scene *s, size_t node) {
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    double mass = 0;
    for (size_t i = 0; i < 4 * palp_mesh_tetrahedron_count(s->mesh); i++)
        if ((size_t)t[i] == node)
            mass += 0.25 * s->density_kg_m3 * volume_of(palp_mesh_positions(s->mesh), t + i / 4 * 4);
    return mass;
}

static bool fixed(unsigned char held) {
    return (held & 15) == 7;
}

static bool on_plate(unsigned char held) {
    return (held & 15) == 15;
}

/* Axes of a node's joints; a pressed node that slides is a child of the plate. */
static void write_node(const export_scene *s, size_t i, const double *x, FILE *to) {
    static const char *const axis[3] = {"1 0 0", "0 1 0", "0 0 1"};
    const double mass = mass_of(s, i);
    fprintf(to,
            "<body name=\"n%zu\" pos=\"%.9g %.9g %.9g\"><inertial pos=\"0 0 0\" mass=\"%.9g\" "
            "diaginertia=\"%.3g %.3g %.3g\"/>",
            i, x[0], x[1], x[2], mass, 1e-6 * mass, 1e-6 * mass, 1e-6 * mass);
    for (int a = 0; a < 3; a++)
        if (!(s->held[i] >> a & 1))
            fprintf(to, "<joint type=\"slide\" axis=\"%s\"/>", axis[a]);
    fputs("</body>\n", to);
}

static void write_bodies(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh);
    fputs("  <worldbody>\n    <body name=\"plate\"><joint name=\"plate\" type=\"slide\" axis=\"0 -1 0\"/>"
          "<inertial pos=\"0 0 0\" mass=\"0.1\" diaginertia=\"1e-4 1e-4 1e-4\"/>\n",
          to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        if (s->held[i] & 8 && !on_plate(s->held[i]))
            write_node(s, i, x + 3 * i, to);
    fputs("    </body>\n", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        if (!(s->held[i] & 8) && !fixed(s->held[i]))
            write_node(s, i, x + 3 * i, to);
    fputs("  </worldbody>\n", to);
}

static void write_flex(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh), G = palp_solid_shear(&s->solid);
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    fputs("  <deformable>\n    <flex name=\"tissue\" dim=\"3\" radius=\"1e-5\"\n     body=\"", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++) {
        if (fixed(s->held[i]) || on_plate(s->held[i]))
            fputs(fixed(s->held[i]) ? "world " : "plate ", to);
        else
            fprintf(to, "n%zu ", i);
    }
    fputs("\"\n     vertex=\"", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++) {
        if (fixed(s->held[i]) || on_plate(s->held[i]))
            fprintf(to, "%.9g %.9g %.9g\n", x[3 * i], x[3 * i + 1], x[3 * i + 2]);
        else
            fputs("0 0 0\n", to);
    }
    fputs("\"\n     element=\"", to);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(s->mesh); i++)
        fprintf(to, "%d %d %d %d\n", t[4 * i], t[4 * i + 1], t[4 * i + 2], t[4 * i + 3]);
    fprintf(to,
            "\">\n      <elasticity young=\"%.12g\" poisson=\"%.9g\" damping=\"%.9g\"/>\n"
            "      <contact selfcollide=\"none\"/>\n    </flex>\n  </deformable>\n",
            2 * (1 + s->solid.poisson) * G, s->solid.poisson, s->solid.damping);
}

void export_mujoco(const export_scene *s, FILE *to) {
    fputs("<!-- Model:\n", to);
    export_state(s, "  ", to);
    fprintf(
        to,
        "  Units: m, N, s, kg. Set ctrl[0] to the depth of the plate; qfrc_passive[0] is minus its force.\n"
        "  A press to %.9g m in %.9g s, then %.9g s. y points up; there is no gravity. -->\n"
        "<mujoco model=\"tissue\">\n  <option timestep=\"%.9g\" gravity=\"0 0 0\" integrator=\"discrete\"/>\n"
        "  <size memory=\"200M\"/>\n",
        s->depth_m, s->ramp_s, s->hold_s, s->ramp_s / STEPS);
    write_bodies(s, to);
    write_flex(s, to);
    /* The actuator is STIFF times as stiff as the tissue: the depth is smaller by a share of 1 / STIFF. */
    fprintf(to, "  <actuator><position joint=\"plate\" kp=\"%.9g\"/></actuator>\n</mujoco>\n",
            STIFF * s->ramp_N / s->depth_m);
}
