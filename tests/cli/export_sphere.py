#!/usr/bin/env python3
"""export_sphere.py TARGET SCENE RADIUS_MM DEPTH_MM: takes the plate off a scene of palpate export and presses a smooth rigid sphere into the
middle of the top, in CalculiX, MuJoCo or Newton. Prints its force in N, after a rest."""
import math
import os
import subprocess
import sys
import tempfile


def calculix_press(scene, radius, depth, strips=24):
    """A disc of stiff bricks with the sphere's shape, in frictionless contact with the faces of the top."""
    nodes, tets, law, held, mode = {}, {}, [], [], ""
    for line in open(scene):
        if line.startswith("*"):
            mode = line.strip()
            if mode.startswith(("*HYPERELASTIC", "*MATERIAL", "*SOLID")):
                law.append(line)
        elif mode == "*NODE":
            w = line.split(",")
            nodes[int(w[0])] = [float(x) for x in w[1:]]
        elif mode.startswith("*ELEMENT"):
            w = [int(x) for x in line.split(",")]
            tets[w[0]] = w[1:]
        elif mode.startswith("*HYPERELASTIC"):
            law.append(line)
        elif mode == "*NSET,NSET=HELD7":
            held.append(line)
    top = max(p[1] for p in nodes.values())
    middle = [0.5 * (min(p[a] for p in nodes.values()) + max(p[a] for p in nodes.values())) for a in (0, 2)]
    disc = min(0.98 * radius, 1.5 * math.sqrt(2 * radius * depth))
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "tip.inp"), "w") as f:
            f.write("*NODE\n" + "".join("%d,%.9g,%.9g,%.9g\n" % (n, *p) for n, p in nodes.items()))
            f.write("*ELEMENT,TYPE=C3D4,ELSET=TISSUE\n" + "".join("%d,%d,%d,%d,%d\n" % (e, *t) for e, t in tets.items()))
            f.write("".join(law) + "*NSET,NSET=FLOOR\n" + "".join(held) + "*NODE,NSET=TIP\n")
            n0, e0, m = max(nodes), max(tets), strips
            number = lambda i, j, k: n0 + 1 + 2 * (i * (m + 1) + j) + k
            for i in range(m + 1):
                for j in range(m + 1):
                    u, v = 2 * i / m - 1, 2 * j / m - 1
                    x, z = disc * u * math.sqrt(1 - v * v / 2), disc * v * math.sqrt(1 - u * u / 2)
                    up = radius - math.sqrt(radius * radius - x * x - z * z)
                    for k in range(2):
                        f.write("%d,%.9g,%.9g,%.9g\n" % (number(i, j, k), middle[0] + x, top + up + k, middle[1] + z))
            f.write("*ELEMENT,TYPE=C3D8,ELSET=RIGID\n")
            for i in range(m):
                for j in range(m):
                    lower = [number(i, j, 0), number(i, j + 1, 0), number(i + 1, j + 1, 0), number(i + 1, j, 0)]
                    f.write("%d,%s\n" % (e0 + 1 + i * m + j, ",".join(map(str, lower + [x + 1 for x in lower]))))
            f.write("*MATERIAL,NAME=STIFF\n*ELASTIC\n1000,0.3\n*SOLID SECTION,ELSET=RIGID,MATERIAL=STIFF\n")
            f.write("*SURFACE,NAME=STIP,TYPE=ELEMENT\nRIGID,S1\n*SURFACE,NAME=STOP,TYPE=ELEMENT\n")
            for e, t in tets.items():
                for face, corners in enumerate(((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))):
                    p = [nodes[t[c]] for c in corners]
                    if all(q[1] > top - 1e-6 for q in p) and min(math.hypot(q[0] - middle[0], q[2] - middle[1]) for q in p) < disc:
                        f.write("%d,S%d\n" % (e, face + 1))
            f.write("*SURFACE INTERACTION,NAME=TOUCH\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n1,1e-4\n")
            f.write("*CONTACT PAIR,INTERACTION=TOUCH,TYPE=SURFACE TO SURFACE\nSTOP,STIP\n*BOUNDARY\nFLOOR,1,3\nTIP,1,1\nTIP,3,3\n")
            f.write("*STEP,NLGEOM,INC=500\n*STATIC\n0.1,1,1e-4,0.1\n*BOUNDARY\nTIP,2,2,%.9g\n" % -depth)
            f.write("*NODE PRINT,NSET=FLOOR,TOTALS=ONLY\nRF\n*END STEP\n")
        done = subprocess.run(["ccx", "-i", "tip"], cwd=folder, capture_output=True, text=True, env=dict(os.environ, OMP_NUM_THREADS="1"))
        lines = [w for w in (x.split() for x in open(os.path.join(folder, "tip.dat"))) if len(w) == 3]
        if "ERROR" in done.stdout or not lines:
            sys.exit("ccx: " + done.stdout[-300:])
        return float(lines[-1][1])


def mujoco_press(scene, radius, depth):
    """Nodes of the plate become free; the sphere is a geom on a slide. Contact is as stiff as MuJoCo's time step allows."""
    import mujoco
    import xml.etree.ElementTree as xml
    root = xml.parse(scene).getroot()
    world, flex = root.find("worldbody"), root.find("deformable/flex")
    world.remove(next(b for b in world if b.get("name") == "plate"))
    names, places = flex.get("body").split(), [float(x) for x in flex.get("vertex").split()]
    mass = min(float(b.find("inertial").get("mass")) for b in world)
    free = next(b for b in world)
    points = [[float(x) for x in next(b for b in world if b.get("name") == n).get("pos").split()] if n not in ("world", "plate")
              else places[3 * i:3 * i + 3] for i, n in enumerate(names)]
    for i, n in enumerate(names):
        if n == "plate":
            body = xml.fromstring(xml.tostring(free))
            body.set("name", "t%d" % i)
            body.set("pos", "%.9g %.9g %.9g" % tuple(points[i]))
            body.find("inertial").set("mass", "%.9g" % mass)
            world.append(body)
            names[i] = "t%d" % i
            places[3 * i:3 * i + 3] = [0, 0, 0]
    flex.set("body", " ".join(names))
    flex.set("vertex", " ".join("%.9g" % x for x in places))
    flex.find("contact").attrib.update(condim="1", solref="0.004 1", solimp="0.999 0.9999 1e-5")
    low, high = ([f(p[a] for p in points) for a in range(3)] for f in (min, max))
    place = (0.5 * (low[0] + high[0]), high[1] + radius + 1e-5, 0.5 * (low[2] + high[2]))
    world.append(xml.fromstring('<body name="tip" pos="%.9g %.9g %.9g"><joint name="tip" type="slide" axis="0 -1 0"/>'
                                '<geom type="sphere" size="%.9g" mass="0.1" condim="1" solref="0.004 1" '
                                'solimp="0.999 0.9999 1e-5"/></body>' % (*place, radius)))
    root.find("actuator/position").attrib.update(joint="tip", kp="1e6")
    root.find("option").set("timestep", "0.002")
    model = mujoco.MjModel.from_xml_string(xml.tostring(root, encoding="unicode"))
    data = mujoco.MjData(model)
    slide = model.jnt_dofadr[model.joint("tip").id]
    for k in range(3000):
        data.ctrl[0] = (depth + 1e-5) * min(1, k / 1000)
        mujoco.mj_step(model, data)
    inside = max([-data.contact[c].dist for c in range(data.ncon)], default=0)
    print("penetration %.3g mm" % (1e3 * inside), file=sys.stderr)
    return -data.qfrc_constraint[slide]


def newton_press(scene, radius, depth, steps=400, iterations=100):
    """Nodes of the plate become free; the sphere is a shape of the world that moves down. Its force is what the floor's nodes bear."""
    import newton
    import numpy as np
    import warp as wp
    import export_run
    s = export_run.newton_scene(scene)
    top, middle = s.VERTICES[s.TOP[0], 1], s.VERTICES[s.TOP].mean(axis=0)
    s.TOP = s.TOP[:0]

    class WithSphere(newton.ModelBuilder):
        def finalize(self):
            self.add_shape_sphere(-1, radius=radius - self.particle_radius[0])
            return super().finalize()

    s.newton.ModelBuilder = WithSphere
    model = s.build()
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 1e4, 0.0, 0.0
    solver = newton.solvers.SolverVBD(model, iterations=iterations)
    pipeline = newton.CollisionPipeline(model)
    contacts, control = pipeline.contacts(), model.control()
    now, then = model.state(), model.state()
    dt = s.RAMP / steps
    for k in range(1, 3 * steps + 1):
        centre = (middle[0], top + radius - depth * min(1, k / steps), middle[2])
        model.shape_transform.assign(np.array([[*centre, 0, 0, 0, 1]], dtype=np.float32))
        before = wp.array(now.particle_q.numpy(), dtype=wp.vec3)
        now.clear_forces()
        pipeline.collide(now, contacts)
        solver.step(now, then, control, contacts, dt)
        now, then = then, now
    away = np.linalg.norm(now.particle_q.numpy() - centre, axis=1)
    print("penetration %.3g mm" % (1e3 * (radius - away.min())), file=sys.stderr)
    return -float(export_run.newton_forces(model, s, now, before, dt)[s.BOTTOM, 1].sum())


def main():
    target, scene, radius, depth = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
    press = {"calculix": calculix_press, "mujoco": mujoco_press, "newton": newton_press}[target]
    unit = 1 if target == "calculix" else 1e-3
    print("%.6g" % press(scene, unit * radius, unit * depth))


if __name__ == "__main__":
    main()
