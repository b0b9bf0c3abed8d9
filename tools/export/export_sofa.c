/* export_sofa.c: a solid as a scene of SOFA, in m, N, s, kg. */
#include "export.h"

static void write_mesh(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh);
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    fputs("    <TetrahedronSetTopologyContainer name=\"topology\" position=\"", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        fprintf(to, "%.9g %.9g %.9g\n", x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    fputs("\"\n     tetrahedra=\"", to);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(s->mesh); i++)
        fprintf(to, "%d %d %d %d\n", t[4 * i], t[4 * i + 1], t[4 * i + 2], t[4 * i + 3]);
    fputs("\"/>\n    <TetrahedronSetGeometryAlgorithms template=\"Vec3d\"/>\n"
          "    <MechanicalObject name=\"tissue\" template=\"Vec3d\" src=\"@topology\"/>\n",
          to);
}

static void write_law(const export_scene *s, FILE *to) {
    const palp_solid *solid = &s->solid;
    fprintf(to,
            "    <TetrahedronHyperelasticityFEMForceField name=\"law\" materialName=\"%s\" ParameterSet=\"",
            export_law_of(s)->name);
    if (solid->law == PALP_SOLID_MOONEY_RIVLIN_LOG) /* the energy's K/2 (ln J)^2: k0 / 2 (ln J)^2 there */
        fprintf(to, "%.12g %.12g %.12g", solid->c_Pa[0], solid->c_Pa[1], palp_solid_bulk(solid));
    else
        fprintf(to, "%.12g %.12g", palp_solid_shear(solid), palp_solid_lambda(solid));
    fprintf(to, "\"/>\n    <MeshMatrixMass massDensity=\"%.9g\" topology=\"@topology\"/>\n",
            s->density_kg_m3);
}

static void write_supports(const export_scene *s, FILE *to) {
    for (unsigned char held = 1; held < 16; held++) {
        if (!export_has_held(s, held))
            continue;
        if (held & 8)
            fprintf(to,
                    "    <LinearMovementProjectiveConstraint template=\"Vec3d\" keyTimes=\"0 %.9g %.9g\" "
                    "movements=\"0 0 0 0 %.9g 0 0 %.9g 0\" indices=\"",
                    s->ramp_s, s->ramp_s + s->hold_s, -s->depth_m, -s->depth_m);
        else
            fprintf(to, "    <PartialFixedProjectiveConstraint fixedDirections=\"%d %d %d\" indices=\"",
                    held & 1, held >> 1 & 1, held >> 2 & 1);
        export_nodes_held(s, held, 0, " ", to);
        fputs("\"/>\n", to);
    }
}

void export_sofa(const export_scene *s, FILE *to) {
    static const char *const plugin[] = {"Constraint.Projective",
                                         "LinearSolver.Direct",
                                         "Mass",
                                         "ODESolver.Backward",
                                         "SolidMechanics.FEM.HyperElastic",
                                         "StateContainer",
                                         "Topology.Container.Dynamic"};
    fputs("<?xml version=\"1.0\"?>\n<!-- Model:\n", to);
    export_state(s, "  ", to);
    fprintf(
        to,
        "  Units: m, N, s, kg. The force of the plate is the sum over its nodes of the law's force along y.\n"
        "  -->\n<Node name=\"root\" gravity=\"0 0 0\" dt=\"%.9g\">\n",
        s->ramp_s / 200);
    for (size_t i = 0; i < sizeof plugin / sizeof *plugin; i++)
        fprintf(to, "  <RequiredPlugin name=\"Sofa.Component.%s\"/>\n", plugin[i]);
    fprintf(to,
            "  <DefaultAnimationLoop/>\n  <Node name=\"tissue\">\n"
            "    <EulerImplicitSolver rayleighStiffness=\"%.9g\" rayleighMass=\"0\"/>\n"
            "    <SparseLDLSolver template=\"CompressedRowSparseMatrixMat3x3d\"/>\n",
            s->solid.damping);
    write_mesh(s, to);
    write_law(s, to);
    write_supports(s, to);
    fputs("  </Node>\n</Node>\n", to);
}
