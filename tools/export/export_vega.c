/* export_vega.c: a solid as a .veg mesh of Vega FEM with its material, in m, N, s, kg. */
#include "export.h"

void export_vega(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh);
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    const bool hooke = s->solid.law == PALP_SOLID_ST_VENANT;
    export_state(s, "# ", to);
    fprintf(to,
            "# Units: m, N, s, kg. In the configuration of the simulator (vertices count from 1):\n"
            "# *deformableObjectMethod\n# %s\n",
            hooke ? "StVK" : "InvertibleFEM");
    if (!hooke)
        fputs("# *invertibleMaterial\n# neoHookean\n", to);
    fprintf(
        to,
        "# *dampingStiffnessCoef\n# %.9g\n# *dampingMassCoef\n# 0\n# *fixedVertices (the plate at rest)\n# ",
        s->solid.damping);
    for (unsigned char held = 1; held < 8; held++)
        if (export_has_held(s, held) && held & 2)
            export_nodes_held(s, held, 1, " ", to);
    fputs("\n# vertices of the plate that presses\n# ", to);
    for (unsigned char held = 8; held < 16; held++)
        if (export_has_held(s, held))
            export_nodes_held(s, held, 1, " ", to);
    fprintf(to, "\n\n*VERTICES\n%zu 3 0 0\n", palp_mesh_node_count(s->mesh));
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        fprintf(to, "%zu %.12g %.12g %.12g\n", i + 1, x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    fprintf(to, "\n*ELEMENTS\nTET\n%zu 4 0\n", palp_mesh_tetrahedron_count(s->mesh));
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(s->mesh); i++)
        fprintf(to, "%zu %d %d %d %d\n", i + 1, t[4 * i] + 1, t[4 * i + 1] + 1, t[4 * i + 2] + 1,
                t[4 * i + 3] + 1);
    fprintf(to, "\n*MATERIAL tissue\nENU, %.9g, %.12g, %.9g\n\n*REGION\nallElements, tissue\n",
            s->density_kg_m3, 2 * (1 + s->solid.poisson) * palp_solid_shear(&s->solid), s->solid.poisson);
}
