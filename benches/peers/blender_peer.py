"""Blender's rigid bodies on a scene; docs/peers.md gives the reasons for the settings.

Blender lets nobody set velocities or inertia: grains start at rest, with the
inertia that Blender gives them.
"""

import os
import sys

import bpy
import mathutils

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from common import Job, Recorder, arguments  # noqa: E402

# Bullet's tolerances are absolute and made for bodies of about one unit.
SCALE = 100.0
# Blender takes no mass below 1 g; only ratios of masses matter here.
MASS_SCALE = 1000.0
FRAMES_PER_S = 60


def main():
    job = Job(arguments())
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.render.fps = FRAMES_PER_S
    frames = round(job.seconds * FRAMES_PER_S)
    scene.frame_start, scene.frame_end = 1, frames + 2
    # SCALE units of Blender are a metre.
    scene.gravity = [SCALE * g for g in job.gravity]
    bpy.ops.rigidbody.world_add()
    world = scene.rigidbody_world
    world.collection = bpy.data.collections.new("bodies")
    substeps = max(1, round(job.rate / FRAMES_PER_S))
    world.substeps_per_frame = substeps
    world.solver_iterations = job.iterations
    world.use_split_impulse = False
    world.point_cache.frame_start, world.point_cache.frame_end = 1, frames + 2
    friction, restitution = job.product_rule("friction"), job.product_rule("restitution")

    table = bpy.data.objects.new("table", None)
    scene.collection.objects.link(table)

    def add(name, what, n):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([[SCALE * c for c in v] for v in what["vertices_m"]], [], what["faces"])
        body = bpy.data.objects.new(name, mesh)
        x, y, z, w = what["quaternion_xyzw"]
        body.rotation_mode = "QUATERNION"
        body.location = [SCALE * c for c in what["position_m"]]
        body.rotation_quaternion = (w, x, y, z)
        scene.collection.objects.link(body)
        # Makes it a rigid body, without an operator call for each.
        world.collection.objects.link(body)
        rigid = body.rigid_body
        rigid.collision_shape = "CONVEX_HULL"
        rigid.use_margin, rigid.collision_margin = True, 0.0
        rigid.friction, rigid.restitution = friction[n], restitution[n]
        rigid.linear_damping = rigid.angular_damping = 0.0
        rigid.use_deactivation = False
        return body, rigid

    for n, piece in enumerate(job.scene["apparatus"]):
        body, rigid = add(f"wall {n}", piece, 1)
        rigid.type = "PASSIVE"
        if piece["motion"] == "table":
            rigid.kinematic = True
            body.parent = table
    grains = []
    for n, grain in enumerate(job.scene["grains"]):
        body, rigid = add(f"grain {n}", grain, 0)
        rigid.type = "ACTIVE"
        rigid.mass = MASS_SCALE * grain["mass_kg"]
        grains.append(body)
    if job.table.moves:
        # One key a frame; within it Blender goes at constant speed.
        for frame in range(frames + 2):
            table.location[0] = SCALE * job.table.x(frame / FRAMES_PER_S)
            table.keyframe_insert("location", index=0, frame=frame + 1)
        for key in table.animation_data.action.fcurves[0].keyframe_points:
            key.interpolation = "LINEAR"

    scene.frame_set(1)
    recorder = Recorder(job, f"{bpy.app.version_string} single")

    def step(t):
        scene.frame_set(2 + round(t * FRAMES_PER_S))

    def placed():
        graph = bpy.context.evaluated_depsgraph_get()
        return [body.evaluated_get(graph).matrix_world for body in grains]

    recorder.run(1 / FRAMES_PER_S, step, lambda: [m.translation[2] / SCALE for m in placed()])
    recorder.steps *= substeps
    x = job.table.x(recorder.time)

    def pose(matrix):
        place, turn, _ = matrix.decompose()
        return [*(c / SCALE for c in place), turn.x, turn.y, turn.z, turn.w]

    recorder.write([pose(m) for m in placed()], x)


main()
