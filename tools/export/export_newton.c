/* export_newton.c: a solid as a Python script of Newton (warp), in m, N, s, kg. */
#include "export.h"

static void write_arrays(const export_scene *s, FILE *to) {
    const double *x = palp_mesh_positions(s->mesh);
    const int32_t *t = palp_mesh_tetrahedra(s->mesh);
    fputs("VERTICES = np.array([\n", to);
    for (size_t i = 0; i < palp_mesh_node_count(s->mesh); i++)
        fprintf(to, "    (%.9g, %.9g, %.9g),\n", x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    fputs("])\nTETRAHEDRA = np.array([\n", to);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(s->mesh); i++)
        fprintf(to, "    (%d, %d, %d, %d),\n", t[4 * i], t[4 * i + 1], t[4 * i + 2], t[4 * i + 3]);
    fputs("])\n", to);
    for (unsigned char held = 7; held < 16; held += 8) {
        fprintf(to, "%s = np.array([", held == 7 ? "BOTTOM" : "TOP");
        export_nodes_held(s, held, 0, ", ", to);
        fputs("])\n", to);
    }
}

void export_newton(const export_scene *s, FILE *to) {
    const palp_solid *solid = &s->solid;
    fputs("\"\"\"Model:\n", to);
    export_state(s, "", to);
    fputs("Units: m, N, s, kg. build() makes Newton's model; place the TOP at the depth of the plate each "
          "step.\n"
          "The script presses it by VBD and prints time, depth and the height of the middle of the tissue.\n"
          "\"\"\"\n"
          "import newton\nimport numpy as np\nimport warp as wp\n\n",
          to);
    write_arrays(s, to);
    /* Newton's k_damp is the power over the square of the rate of C = F'F, half of the viscosity. */
    fprintf(
        to,
        "DEPTH, RAMP, HOLD = %.9g, %.9g, %.9g\nDENSITY = %.9g\nMU, LAMBDA, DAMP = %.12g, %.12g, %.12g\n\n\n",
        s->depth_m, s->ramp_s, s->hold_s, s->density_kg_m3, palp_solid_shear(solid), palp_solid_lambda(solid),
        0.5 * solid->damping);
    fputs("def build():\n"
          "    \"\"\"The model; nodes of the plates have no mass and stay where they are put.\"\"\"\n"
          "    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))\n"
          "    builder.add_soft_mesh(pos=wp.vec3(0.0, 0.0, 0.0), rot=wp.quat_identity(), scale=1.0,\n"
          "                          vel=wp.vec3(0.0, 0.0, 0.0), vertices=[wp.vec3(*v) for v in VERTICES],\n"
          "                          indices=TETRAHEDRA.flatten().tolist(), density=DENSITY,\n"
          "                          k_mu=MU, k_lambda=LAMBDA, k_damp=DAMP, particle_radius=1e-4)\n"
          "    for i in np.concatenate([BOTTOM, TOP]):\n"
          "        builder.particle_mass[i] = 0.0\n"
          "    builder.color()\n"
          "    return builder.finalize()\n\n\n"
          "def main(frames=100, substeps=10, iterations=40):\n"
          "    model = build()\n"
          "    solver = newton.solvers.SolverVBD(model, iterations=iterations)\n"
          "    now, then, control = model.state(), model.state(), model.control()\n"
          "    step = (RAMP + HOLD) / (frames * substeps)\n"
          "    middle = np.argmin(np.sum((VERTICES - VERTICES.mean(axis=0)) ** 2, axis=1))\n"
          "    for k in range(1, frames * substeps + 1):\n"
          "        depth = DEPTH * min(1.0, k * step / RAMP)\n"
          "        q = now.particle_q.numpy()\n"
          "        q[TOP] = VERTICES[TOP] - [0.0, depth, 0.0]\n"
          "        now.particle_q.assign(q)\n"
          "        now.clear_forces()\n"
          "        solver.step(now, then, control, None, step)\n"
          "        now, then = then, now\n"
          "        if k % substeps == 0:\n"
          "            print(f\"{k * step:.6g} {depth:.6g} {now.particle_q.numpy()[middle, 1]:.6g}\")\n\n\n"
          "if __name__ == \"__main__\":\n"
          "    main()\n",
          to);
}
