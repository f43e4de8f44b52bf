"""YADE's polyhedra on a scene; docs/peers.md gives the reasons for the settings.

The table is the frame of reference: it stands still, and gravity carries the
inertial force, which is the same motion seen from the table.
"""

import math
import os
import sys

from yade import polyhedra_utils

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))
from common import Job, Recorder, arguments  # noqa: E402

# Force for each volume of overlap in N/m3: a grain of 10 mm under a pile of 16
# sinks in by some hundredths of a millimetre.
STIFFNESS = 1e9
# A tenth of the period in which the lightest grain would swing on its largest face.
TIME_STEP = 1e-5
# YADE's polyhedra have no restitution: what takes energy out is friction and
# this, its own default share of each force against the motion.
DAMPING = 0.2


def main():
    job = Job(arguments())
    grain_mass = job.scene["grains"][0]["mass_kg"] / job.scene["grains"][0]["volume_m3"]

    def material(friction):
        # The smaller friction of the two decides.
        return PolyhedraMat(
            density=grain_mass,
            young=STIFFNESS,
            poisson=0.2,
            frictionAngle=math.atan(friction),
        )

    of_grain, wall = material(job.grain["friction"]), material(job.wall["friction"])
    if job.wall["friction"] > job.grain["friction"]:
        raise SystemExit("friction on walls above that between grains cannot be had here")
    start = job.table.velocity(0.0)

    def add(what, of, fixed):
        """YADE turns a body into axes of its own; gives the body and that turn."""
        body = polyhedra_utils.polyhedra(of, v=[Vector3(*v) for v in what["vertices_m"]], fixed=fixed)
        offset, turn = Vector3(body.state.pos), Quaternion(body.state.ori)
        x, y, z, w = what["quaternion_xyzw"]
        q = Quaternion(w, x, y, z)
        body.state.pos = Vector3(*what["position_m"]) + q * offset
        body.state.ori = q * turn
        O.bodies.append(body)
        return body, turn

    for piece in job.scene["apparatus"]:
        add(piece, wall, True)
    grains = []
    for grain in job.scene["grains"]:
        body, turn = add(grain, of_grain, False)
        velocity = Vector3(*grain["linear_velocity_m_per_s"])
        velocity[0] -= start
        body.state.vel = velocity
        body.state.angVel = Vector3(*grain["angular_velocity_rad_per_s"])
        grains.append((body, turn))
    newton = NewtonIntegrator(damping=DAMPING, gravity=Vector3(*job.gravity))
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Polyhedra_Aabb()], verletDist=5e-4),
        InteractionLoop(
            [Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
            [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
            [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
        ),
        newton,
    ]
    O.dt = 1 / job.rate if job.rate else TIME_STEP
    recorder = Recorder(job, f"{yade.config.version} double")

    def step(t):
        if job.table.moves:
            x = job.gravity[0] - job.table.mean_acceleration(t, O.dt)
            newton.gravity = Vector3(x, job.gravity[1], job.gravity[2])
        O.step()

    recorder.run(O.dt, step, lambda: [body.state.pos[2] for body, _ in grains])
    x = job.table.x(recorder.time)

    def pose(body, turn):
        p, q = body.state.pos, body.state.ori * turn.conjugate()
        # Of an Eigen quaternion: x, y, z, w.
        return [p[0] + x, p[1], p[2], q[0], q[1], q[2], q[3]]

    recorder.write([pose(body, turn) for body, turn in grains], x)


main()
