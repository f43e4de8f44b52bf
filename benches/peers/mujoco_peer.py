"""MuJoCo on a scene; docs/peers.md gives the reasons for the settings.

The table is the frame of reference: it stands still, and gravity carries the
inertial force, which is the same motion seen from the table.
"""

import math

import mujoco
import numpy as np

from common import Job, Recorder, arguments

# Contacts are damped springs with this time constant in s. Times the damping
# ratio it must be two steps at least: with 0.001 the packing explodes.
TIME_CONSTANT = 0.003


def numbers(values):
    return " ".join(repr(float(v)) for v in values)


def scalar_first(q):
    return [q[3], q[0], q[1], q[2]]


def model(job):
    e = job.grain["restitution"]
    # Damping ratio of an oscillator that rebounds with e.
    ratio = -math.log(e) / math.hypot(math.pi, math.log(e)) if e > 0 else 1.0
    contact = f'solref="{max(TIME_CONSTANT, 2 / (job.rate * ratio))} {ratio}" condim="3"'
    lines = [
        '<mujoco><compiler inertiafromgeom="false" angle="radian"/>',
        f'<option timestep="{1 / job.rate!r}" iterations="{job.iterations}" tolerance="1e-8" '
        'solver="CG" cone="elliptic" impratio="10" integrator="Euler">'
        '<flag multiccd="enable" nativeccd="enable"/></option>',
        '<size memory="2G"/>',
        "<asset>",
    ]
    bodies = []
    for n, piece in enumerate(job.scene["apparatus"]):
        lines.append(mesh(f"w{n}", piece))
        # What takes priority decides the pair; else MuJoCo takes the larger friction.
        bodies.append(
            f'<geom type="mesh" mesh="w{n}" pos="{numbers(piece["position_m"])}" '
            f'quat="{numbers(scalar_first(piece["quaternion_xyzw"]))}" priority="1" '
            f'friction="{job.wall["friction"]} 0 0" {contact}/>'
        )
    for n, grain in enumerate(job.scene["grains"]):
        lines.append(mesh(f"g{n}", grain))
        bodies.append(
            f'<body pos="{numbers(grain["position_m"])}" '
            f'quat="{numbers(scalar_first(grain["quaternion_xyzw"]))}"><freejoint/>'
            f'<inertial pos="0 0 0" mass="{grain["mass_kg"]!r}" '
            f'diaginertia="{numbers(grain["inertia_kg_m2"])}"/>'
            f'<geom type="mesh" mesh="g{n}" friction="{job.grain["friction"]} 0 0" {contact}/></body>'
        )
    lines += ["</asset><worldbody>", *bodies, "</worldbody></mujoco>"]
    return mujoco.MjModel.from_xml_string("".join(lines))


def mesh(name, body):
    vertices = " ".join(numbers(v) for v in body["vertices_m"])
    return f'<mesh name="{name}" vertex="{vertices}" inertia="convex"/>'


def main():
    job = Job(arguments())
    m = model(job)
    data = mujoco.MjData(m)
    count = len(job.scene["grains"])
    start = job.table.velocity(0.0)
    velocities = data.qvel.reshape(count, 6)
    for n, grain in enumerate(job.scene["grains"]):
        velocities[n, :3] = grain["linear_velocity_m_per_s"]
        velocities[n, 0] -= start
        # MuJoCo has the angular velocity of a free joint in the body's axes.
        turned = np.zeros(3)
        q = np.array(scalar_first(grain["quaternion_xyzw"]))
        q[1:] *= -1
        mujoco.mju_rotVecQuat(turned, np.array(grain["angular_velocity_rad_per_s"]), q)
        velocities[n, 3:] = turned
    m.opt.gravity[:] = job.gravity
    places = data.qpos.reshape(count, 7)
    recorder = Recorder(job, f"{mujoco.__version__} double")

    def step(t):
        if job.table.moves:
            m.opt.gravity[0] = job.gravity[0] - job.table.mean_acceleration(t, m.opt.timestep)
        mujoco.mj_step(m, data)

    recorder.run(m.opt.timestep, step, lambda: places[:, 2])
    x = job.table.x(recorder.time)
    poses = [[p[0] + x, p[1], p[2], p[4], p[5], p[6], p[3]] for p in places]
    recorder.write(poses, x)


main()
