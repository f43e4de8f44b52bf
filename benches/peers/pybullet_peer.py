"""PyBullet on a scene; docs/peers.md gives the reasons for the settings.

The table is the frame of reference: PyBullet's bodies without mass have no
velocity that friction could feel. It stands still, and gravity carries the
inertial force, which is the same motion seen from the table.
"""

from importlib.metadata import version

import pybullet as p

from common import Job, Recorder, arguments

# Bullet's tolerances are absolute and made for bodies of about one unit.
SCALE = 100.0


def scaled(vector):
    return [SCALE * c for c in vector]


def hull(body):
    return p.createCollisionShape(p.GEOM_MESH, vertices=[scaled(v) for v in body["vertices_m"]])


def main():
    job = Job(arguments())
    p.connect(p.DIRECT)
    p.setPhysicsEngineParameter(
        fixedTimeStep=1 / job.rate,
        numSubSteps=0,
        numSolverIterations=job.iterations,
        useSplitImpulse=0,
        contactBreakingThreshold=1e-3 * SCALE,
        erp=0.2,
        contactERP=0.2,
        globalCFM=0.0,
        solverResidualThreshold=0.0,
        # 2 mm/s, as Bullet's own threshold is at this scale.
        restitutionVelocityThreshold=0.2,
        deterministicOverlappingPairs=0,
    )
    friction, restitution = job.product_rule("friction"), job.product_rule("restitution")
    start = job.table.velocity(0.0)
    grains = []

    def surface(body, n, **more):
        p.changeDynamics(
            body,
            -1,
            lateralFriction=friction[n],
            restitution=restitution[n],
            rollingFriction=0,
            spinningFriction=0,
            collisionMargin=0,
            contactProcessingThreshold=1e-3 * SCALE,
            **more,
        )

    for piece in job.scene["apparatus"]:
        body = p.createMultiBody(
            0,
            hull(piece),
            basePosition=scaled(piece["position_m"]),
            baseOrientation=piece["quaternion_xyzw"],
            useMaximalCoordinates=1,
        )
        surface(body, 1)
    for grain in job.scene["grains"]:
        body = p.createMultiBody(
            grain["mass_kg"],
            hull(grain),
            basePosition=scaled(grain["position_m"]),
            baseOrientation=grain["quaternion_xyzw"],
            # A plain rigid body, solved by sequential impulses.
            useMaximalCoordinates=1,
        )
        inertia = [SCALE * SCALE * i for i in grain["inertia_kg_m2"]]
        surface(
            body,
            0,
            # Without the mass beside it, the inertia makes the mass zero.
            mass=grain["mass_kg"],
            localInertiaDiagonal=inertia,
            linearDamping=0,
            angularDamping=0,
            activationState=p.ACTIVATION_STATE_DISABLE_SLEEPING,
        )
        velocity = list(grain["linear_velocity_m_per_s"])
        velocity[0] -= start
        p.resetBaseVelocity(body, scaled(velocity), grain["angular_velocity_rad_per_s"])
        grains.append(body)
    p.setGravity(*scaled(job.gravity))
    recorder = Recorder(job, f"{version('pybullet')} double")
    dt = 1 / job.rate

    def step(t):
        if job.table.moves:
            x = job.gravity[0] - job.table.mean_acceleration(t, dt)
            p.setGravity(SCALE * x, SCALE * job.gravity[1], SCALE * job.gravity[2])
        p.stepSimulation()

    def places():
        return [p.getBasePositionAndOrientation(body) for body in grains]

    recorder.run(dt, step, lambda: [at[2] / SCALE for at, _ in places()])
    x = job.table.x(recorder.time)
    poses = [[at[0] / SCALE + x, at[1] / SCALE, at[2] / SCALE, *q] for at, q in places()]
    recorder.write(poses, x)


main()
