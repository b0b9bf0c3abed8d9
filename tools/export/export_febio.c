/* export_febio.c: a solid as an FEBio 4 model, in mm, N, MPa, s. */
#include "export.h"

static void write_material(const palp_solid *solid, FILE *to) {
    fputs("  <Material>\n    <material id=\"1\" name=\"tissue\" type=\"viscoelastic\">\n", to);
    for (size_t j = 0; j < solid->n_arms; j++)
        fprintf(to, "      <t%zu>%.12g</t%zu><g%zu>%.12g</g%zu>\n", j + 1, solid->tau_s[j], j + 1, j + 1,
                solid->share[j], j + 1);
    const double G = 1e-6 * palp_solid_shear(solid);
    fprintf(
        to,
        "      <g0>1</g0>\n      <elastic type=\"neo-Hookean\"><density>1e-9</density><E>%.12g</E><v>%.9g</v>"
        "</elastic>\n    </material>\n  </Material>\n",
        2 * (1 + solid->poisson) * G, solid->poisson);
}

static void write_mesh(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh);
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    fputs("  <Mesh>\n    <Nodes name=\"tissue\">\n", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        fprintf(to, "      <node id=\"%zu\">%.12g,%.12g,%.12g</node>\n", i + 1, 1e3 * x[3 * i],
                1e3 * x[3 * i + 1], 1e3 * x[3 * i + 2]);
    fputs("    </Nodes>\n    <Elements type=\"tet4\" name=\"tissue\">\n", to);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(s->mesh); i++)
        fprintf(to, "      <elem id=\"%zu\">%d,%d,%d,%d</elem>\n", i + 1, t[4 * i] + 1, t[4 * i + 1] + 1,
                t[4 * i + 2] + 1, t[4 * i + 3] + 1);
    fputs("    </Elements>\n", to);
    for (unsigned char held = 1; held < 16; held++) {
        if (export_has_held(s, held)) {
            fprintf(to, "    <NodeSet name=\"held%d\">", held);
            export_nodes_held(s, held, 1, ",", to);
            fputs("</NodeSet>\n", to);
        }
    }
    fputs("  </Mesh>\n  <MeshDomains><SolidDomain name=\"tissue\" mat=\"tissue\"/></MeshDomains>\n", to);
}

static void write_supports(const export_scene *s, FILE *to) {
    fputs("  <Boundary>\n", to);
    for (unsigned char held = 1; held < 16; held++) {
        if (!export_has_held(s, held))
            continue;
        const int y = held & 8 ? 0 : held >> 1 & 1;
        if ((held & 5) || y)
            fprintf(to,
                    "    <bc name=\"hold%d\" node_set=\"held%d\" type=\"zero displacement\"><x_dof>%d</x_dof>"
                    "<y_dof>%d</y_dof><z_dof>%d</z_dof></bc>\n",
                    held, held, held & 1, y, held >> 2 & 1);
        if (held & 8)
            fprintf(
                to,
                "    <bc name=\"press%d\" node_set=\"held%d\" type=\"prescribed displacement\"><dof>y</dof>"
                "<value lc=\"1\">%.12g</value><relative>0</relative></bc>\n",
                held, held, -1e3 * s->depth_m);
    }
    fputs("  </Boundary>\n", to);
}

static void write_output(const export_scene *s, FILE *to) {
    fputs("  <Output>\n    <plotfile type=\"febio\"><var type=\"displacement\"/><var "
          "type=\"stress\"/></plotfile>\n"
          "    <logfile>\n",
          to);
    for (unsigned char held = 8; held < 16; held++)
        if (export_has_held(s, held))
            fprintf(to, "      <node_data data=\"Ry\" node_set=\"held%d\" file=\"force%d.txt\"/>\n", held,
                    held);
    fputs("    </logfile>\n  </Output>\n</febio_spec>\n", to);
}

void export_febio(const export_scene *s, FILE *to) {
    const double end_s = s->ramp_s + s->hold_s;
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Model:\n", to);
    export_state(s, "  ", to);
    fprintf(to,
            "  Units: mm, N, MPa, s. Run: febio4 -i FILE. The sum of Ry in force15.txt (force10.txt where "
            "plates\n"
            "  slide) is minus the force of the plate. -->\n<febio_spec version=\"4.0\">\n"
            "  <Module type=\"solid\"/>\n  <Control>\n    <analysis>STATIC</analysis>\n"
            "    <time_steps>%d</time_steps>\n    <step_size>%.9g</step_size>\n"
            "    <solver type=\"solid\"><symmetric_stiffness>symmetric</symmetric_stiffness></solver>\n"
            "    <time_stepper type=\"default\"><max_retries>10</max_retries><opt_iter>15</opt_iter>"
            "<dtmin>%.3g</dtmin><dtmax lc=\"2\">1</dtmax></time_stepper>\n  </Control>\n",
            200, end_s / 200, 1e-6 * s->ramp_s);
    write_material(&s->solid, to);
    write_mesh(s, to);
    write_supports(s, to);
    fprintf(to,
            "  <LoadData>\n    <load_controller id=\"1\" type=\"loadcurve\"><interpolate>LINEAR</interpolate>"
            "<points><pt>0,0</pt><pt>%.9g,1</pt><pt>%.9g,1</pt></points></load_controller>\n"
            "    <load_controller id=\"2\" type=\"loadcurve\"><interpolate>STEP</interpolate>"
            "<points><pt>0,%.9g</pt><pt>%.9g,%.9g</pt><pt>%.9g,%.9g</pt></points></load_controller>\n"
            "  </LoadData>\n",
            s->ramp_s, end_s, s->ramp_s / 50, s->ramp_s, s->ramp_s / 50, end_s, s->hold_s / 50);
    write_output(s, to);
}
