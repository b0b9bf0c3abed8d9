#!/usr/bin/env python3
"""export_run.py TARGET SCENE RESULT.json: presses a scene of palpate export in MuJoCo or Newton by its ramp and dwell. Prints the
plate's force at the end of both, as the other program has it and as the result says."""
import importlib.util
import json
import sys


def mujoco_press(scene, result):
    """The passive force on the plate's slide."""
    import mujoco
    model = mujoco.MjModel.from_xml_path(scene)
    data = mujoco.MjData(model)
    depth, ramp, hold = 1e-3 * result["depth_mm"], result["ramp_s"], result["hold_s"]
    steps = round(ramp / model.opt.timestep)
    force = []
    for end, last in ((1, steps), (2, steps + round(hold / model.opt.timestep))):
        for k in range(1 if end == 1 else steps + 1, last + 1):
            data.ctrl[0] = depth * min(1, k / steps)
            mujoco.mj_step(model, data)
        force.append(-data.qfrc_passive[0])
    return force


def newton_scene(path):
    """The script as a module."""
    spec = importlib.util.spec_from_file_location("scene", path)
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    return scene


def newton_forces(model, scene, now, before, dt):
    """The nodes' forces by Newton's own law, at the end of a step of VBD that began at these places."""
    import warp as wp
    from newton._src.solvers.vbd import particle_vbd_kernels as kernels

    @wp.kernel
    def forces(pos: wp.array[wp.vec3], before: wp.array[wp.vec3], tets: wp.array2d[wp.int32], pose: wp.array[wp.mat33],
               material: wp.array2d[float], dt: float, force: wp.array[wp.vec3]):
        t = wp.tid()
        for c in range(4):
            f, h = kernels.evaluate_volumetric_neo_hookean_force_and_hessian(
                t, c, before, pos, tets, pose[t], material[t, 0], material[t, 1], material[t, 2], dt)
            wp.atomic_add(force, tets[t, c], f)

    force = wp.zeros(len(scene.VERTICES), dtype=wp.vec3)
    wp.launch(forces, dim=len(scene.TETRAHEDRA),
              inputs=[now.particle_q, before, model.tet_indices, model.tet_poses, model.tet_materials, dt, force])
    return force.numpy()


def newton_press(scene, result, steps=200, iterations=40):
    """The sum of these forces over the plate's nodes."""
    import newton
    import warp as wp
    s = newton_scene(scene)
    model = s.build()
    solver = newton.solvers.SolverVBD(model, iterations=iterations)
    now, then, control = model.state(), model.state(), model.control()
    dt = s.RAMP / steps
    found = []
    for k in range(1, 3 * steps + 1):
        q = now.particle_q.numpy()
        q[s.TOP] = s.VERTICES[s.TOP] - [0, s.DEPTH * min(1, k / steps), 0]
        now.particle_q.assign(q)
        before = wp.array(q.copy(), dtype=wp.vec3)
        now.clear_forces()
        solver.step(now, then, control, None, dt)
        now, then = then, now
        if k in (steps, 3 * steps):
            found.append(float(newton_forces(model, s, now, before, dt)[s.TOP, 1].sum()))
    return found


def main():
    with open(sys.argv[3], encoding="utf-8") as f:
        result = json.load(f)
    press = {"mujoco": mujoco_press, "newton": newton_press}[sys.argv[1]]
    ramp, dwell = press(sys.argv[2], result)
    print("ramp %.6g %.6g" % (ramp, result["ramp_N"]))
    print("dwell %.6g %.6g" % (dwell, result["dwell_N"]))


if __name__ == "__main__":
    main()
