#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is the light on an aircraft what a path tracer makes of it? blender_light.py [--airtruth PROGRAM] [--out DIR] [BODY ...]

Renders bodies by `airtruth render` and by Cycles, Blender's path tracer, from the same place, in the same pose, under the same
sun, overcast sky (Moon and Spencer 1942) and ground, in the same paint: Lambert under a clear coat (Fresnel by Schlick 1994).
A BODY is `sphere`, `aeroplane` (a plain one, made here; these two are the default) or an AC3D file (an aircraft of
flightgear-data-ai, say), of which the opaque geometry is taken, without its textures. Prints the mean linear luminance of both over what looks up and is in the sun,
what looks up and is in shadow, sides, and what looks down. Leaves the pictures side by side in DIR.

Needs blender (3.4 or later), python3-opencv and numpy; says so and ends well where there is no blender.
"""

import argparse
import json
import math
import os
import shlex
import shutil
import subprocess
import sys
import tempfile

import numpy as np

SIDE_PX = 360
LENGTHS_AWAY = 20
SUN_COLOUR = (1.0, 0.965, 0.91)  # of `exposure`: docs/formats/scene.md
PAINT = 0.6  # linear albedo
GLOSS_ROUGHNESS = math.sqrt(0.1)  # of the clear coat: a GGX of alpha 0.1
SAMPLES = 64
SUN_DEG = 0.53
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

# Eye as seen from the body: azimuth from its nose towards its right wing, and elevation. Sun likewise, in world axes (the nose
# points north). Light as [light] of a scene has it.
VIEWS = {
    "above, sun aside": dict(eye=(-50, 35), sun=(40, 35), exposure=0.7, sky=(0.16, 0.2, 0.26), ground=(0.07, 0.06, 0.05)),
    "side, sun behind": dict(eye=(90, 5), sun=(-60, 40), exposure=0.7, sky=(0.16, 0.2, 0.26), ground=(0.07, 0.06, 0.05)),
    "below, sun high": dict(eye=(130, -30), sun=(80, 60), exposure=0.9, sky=(0.16, 0.2, 0.26), ground=(0.1, 0.1, 0.07)),
    "below, low sun": dict(eye=(-30, -20), sun=(-80, 12), exposure=0.6, sky=(0.12, 0.14, 0.2), ground=(0.03, 0.03, 0.02)),
    "side, overcast": dict(eye=(60, 3), sun=(0, 45), exposure=1e-6, sky=(0.6, 0.6, 0.6), ground=(0.08, 0.08, 0.06)),
}


# ---- bodies: (corners of triangles in body axes, k x 3 x 3; their normals, alike)


def box(low, high):
    (a, b, c), (d, e, f) = low, high
    p = np.array([[x, y, z] for x in (a, d) for y in (b, e) for z in (c, f)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return [(p[q[0]], p[q[i]], p[q[i + 1]]) for q in quads for i in (1, 2)]


def turned(profile, steps=48, at=(0, 0, 0)):
    """About the x axis; profile: (x, radius)."""
    faces = []
    ring = lambda x, r: [np.array([x, r * math.cos(t), r * math.sin(t)]) + at for t in np.linspace(0, 2 * math.pi, steps + 1)]
    for (x0, r0), (x1, r1) in zip(profile, profile[1:]):
        near, far = ring(x0, r0), ring(x1, r1)
        for i in range(steps):
            faces += [(near[i], far[i], far[i + 1]), (near[i], far[i + 1], near[i + 1])]
    return faces


def sphere():
    return turned([(-4 * math.cos(t), 4 * math.sin(t)) for t in np.linspace(0, math.pi, 49)], 96)


def aeroplane():
    t = np.linspace(0, math.pi / 2, 9)
    hull = [(-10 - 5 * math.cos(a), math.sin(a)) for a in t] + [(12 + 3 * math.sin(a), math.cos(a)) for a in t]
    faces = turned(hull)
    faces += box((-2, -14, 0.1), (2.5, 14, 0.5))  # wing
    faces += box((-14, -5, -0.8), (-11.5, 5, -0.6))  # tailplane
    faces += box((-14.5, -0.15, -6), (-11, 0.15, -0.5))  # fin
    for y in (-5, 5):
        faces += turned([(0, 0), (0, 0.9), (4, 0.9), (4, 0)], at=(0.5, y, 1.6))
    return faces


def ac_file(path):
    """Opaque triangles of an AC3D file, but for propellers, whose discs lie in one place twice. Its x points aft, y up, z left."""
    lines = iter(open(path, encoding="latin-1").read().splitlines())
    clear, faces = [], []

    def read(shift):
        points, own, spins = [], shift, False
        for line in lines:
            word, *rest = shlex.split(line) if '"' in line else (line.split() or [""])
            if word == "MATERIAL":
                clear.append(float(rest[rest.index("trans") + 1]) > 0)
            elif word == "OBJECT" and rest[0] == "world":
                continue
            elif word == "name":
                spins = "prop" in rest[0].lower()
            elif word == "loc":
                own = shift + np.array([float(v) for v in rest])
            elif word == "numvert":
                points = [own + np.array([float(v) for v in next(lines).split()[:3]]) for _ in range(int(rest[0]))]
            elif word == "SURF":
                material = int(next(lines).split()[1])
                corners = [points[int(next(lines).split()[0])] for _ in range(int(next(lines).split()[1]))]
                if int(rest[0], 16) & 15 == 0 and not clear[material] and not spins:
                    faces.extend((corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1))
            elif word == "kids":
                for _ in range(int(rest[0])):
                    if next(lines, None) is not None:  # OBJECT
                        read(own)
                return

    read(np.zeros(3))
    return [tuple(np.array([-p[0], -p[2], -p[1]]) for p in face) for face in faces]


def corners_and_normals(faces):
    """Normals averaged, by area, over the faces that meet at less than 40 degrees."""
    corners = np.array(faces, float)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(area, axis=1)
    corners, area, size = corners[size > 1e-9], area[size > 1e-9], size[size > 1e-9]
    unit = area / size[:, None]
    keys = np.round(corners.reshape(-1, 3), 4)
    _, vertex = np.unique(keys, axis=0, return_inverse=True)
    vertex = vertex.reshape(-1, 3)
    at = {}
    for face, row in enumerate(vertex):
        for v in row:
            at.setdefault(v, []).append(face)
    normals = np.empty_like(corners)
    for face, row in enumerate(vertex):
        for k, v in enumerate(row):
            others = np.array(at[v])
            near = others[unit[others] @ unit[face] > math.cos(math.radians(40))]
            total = area[near].sum(0)
            normals[face, k] = total / np.linalg.norm(total)
    return corners, normals


# ---- the same picture twice


def direction(azimuth_deg, elevation_deg):
    """North, east, down."""
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), -math.sin(e)])


def write_obj(path, corners, normals):
    with open(path[:-3] + "mtl", "w") as out:
        out.write(f"newmtl paint\nKd {' '.join([f'{coded(PAINT):.6f}'] * 3)}\nKs 0.5 0.5 0.5\nNs 50\n")
    with open(path, "w") as out:
        out.write(f"mtllib {os.path.basename(path)[:-3]}mtl\nusemtl paint\n")
        for p in corners.reshape(-1, 3):
            out.write("v %.6f %.6f %.6f\n" % tuple(p))
        for n in normals.reshape(-1, 3):
            out.write("vn %.6f %.6f %.6f\n" % tuple(n))
        for i in range(len(corners)):
            out.write("f " + " ".join(f"{3 * i + k}//{3 * i + k}" for k in (1, 2, 3)) + "\n")


def coded(linear):
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def linear(codes):
    c = codes / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


SCENE = """name = "body"
[background]
video = "black/%05d.png"
frame_rate_hz = 25
[lens]
model = "pinhole"
focal_px = [{focal}, {focal}]
[camera]
position_ned_m = {eye}
attitude_yaw_pitch_roll_deg = [{yaw}, {pitch}, 0]
[motion]
model = "none"
[light]
sun_azimuth_deg = {sun_azimuth}
sun_elevation_deg = {sun_elevation}
exposure = {exposure}
sky_colour = {sky}
ground_colour = {ground}
[[intruder]]
aircraft = "body.obj"
model_forward = "x"
model_up = "-z"
waypoints_ned_m = [[0, 0, 0], [100, 0, 0]]
speed_mps = 0.01
yaw_deg = 0
pitch_deg = 0
roll_deg = 0
[render]
quality = 4
[output]
video = "png"
masks = true
"""


def by_airtruth(program, folder, view, focal, eye):
    import cv2

    os.makedirs(f"{folder}/black", exist_ok=True)
    for i in range(2):
        cv2.imwrite(f"{folder}/black/{i:05d}.png", np.zeros((SIDE_PX, SIDE_PX, 3), np.uint8))
    with open(f"{folder}/scene.toml", "w") as out:
        out.write(SCENE.format(focal=focal, eye=list(eye), yaw=view["eye"][0] + 180, pitch=-view["eye"][1], sun_azimuth=view["sun"][0],
                               sun_elevation=view["sun"][1], exposure=view["exposure"], sky=list(view["sky"]),
                               ground=list(view["ground"])))
    shutil.rmtree(f"{folder}/out", ignore_errors=True)
    subprocess.run([program, "render", f"{folder}/scene.toml", "--out", f"{folder}/out"], check=True, capture_output=True, text=True)
    pictures = sorted(os.path.join(at, name) for at, _, names in os.walk(f"{folder}/out") for name in names if name.endswith(".png"))
    masks = [p for p in pictures if "/masks" in p]
    frames = [p for p in pictures if "/masks" not in p]
    rgb = linear(cv2.imread(frames[0])[..., ::-1].astype(float))
    alpha = cv2.imread(masks[0], cv2.IMREAD_GRAYSCALE) / 255.0
    return rgb @ LUMINANCE, alpha


def by_cycles(folder, view, focal, eye, corners, normals):
    os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
    import cv2

    np.savez(f"{folder}/body.npz", corners=corners, normals=normals)
    job = dict(view, folder=folder, focal=focal, eye_ned=list(eye))
    with open(f"{folder}/job.json", "w") as out:
        json.dump(job, out)
    done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", os.path.abspath(__file__), "--",
                           f"{folder}/job.json"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-3000:] + done.stderr[-3000:])
    read = lambda name: cv2.imread(f"{folder}/{name}.exr", cv2.IMREAD_UNCHANGED)[..., [2, 1, 0, 3]].astype(float)
    light, sun, normal = read("light"), read("sun"), read("normal")
    # What is brighter than white clips in a picture of 8 bits.
    return np.minimum(light[..., :3], 1) @ LUMINANCE, light[..., 3], sun[..., :3] @ LUMINANCE, normal[..., :3]


def regions(view, sun, normal, alpha):
    """Masks by name. normal: NED, 0.5 + 0.5 n."""
    n = 2 * normal - 1
    up = -n[..., 2]
    lit = n @ direction(*view["sun"])
    full = view["exposure"] * PAINT * np.clip(lit, 0, 1)
    in_sun = (lit > 0.1) & (sun > 0.8 * full)
    in_shadow = (sun < 0.05 * view["exposure"] * PAINT)
    whole = alpha > 0.999
    return {"up, in the sun": whole & (up > 0.4) & in_sun, "up, in shadow": whole & (up > 0.4) & in_shadow,
            "side, in the sun": whole & (abs(up) <= 0.4) & in_sun, "side, in shadow": whole & (abs(up) <= 0.4) & in_shadow,
            "belly": whole & (up < -0.4) & in_shadow}


def compare(program, name, faces, out):
    import cv2

    corners, normals = corners_and_normals(faces)
    length = np.ptp(corners.reshape(-1, 3), axis=0).max()
    focal = 0.85 * SIDE_PX * LENGTHS_AWAY
    centre = (corners.reshape(-1, 3).max(0) + corners.reshape(-1, 3).min(0)) / 2
    corners = corners - centre
    for title, view in VIEWS.items():
        eye = LENGTHS_AWAY * length * direction(*view["eye"])
        with tempfile.TemporaryDirectory() as folder:
            write_obj(f"{folder}/body.obj", corners, normals)
            ours, alpha = by_airtruth(program, folder, view, focal, eye)
            theirs, cover, sun, normal = by_cycles(folder, view, focal, eye, corners, normals)
        for region, mask in regions(view, sun, normal, np.minimum(alpha, cover)).items():
            if mask.sum() >= 60:
                a, b = ours[mask].mean(), theirs[mask].mean()
                print(f"| {name} | {title} | {region} | {mask.sum()} | {b:.4f} | {a:.4f} | {100 * (a / b - 1):+.1f} % |", flush=True)
        overlap = np.minimum(alpha, cover).sum() / np.maximum(alpha, cover).sum()
        if overlap < 0.97:
            print(f"the two see {name} in different places: overlap {overlap:.3f}", file=sys.stderr)
        if out:
            os.makedirs(out, exist_ok=True)
            pair = np.hstack([theirs, ours])
            codes = 255 * np.vectorize(coded)(np.clip(pair, 0, 1))
            cv2.imwrite(f"{out}/{name}, {title}.png".replace(" ", "-").replace(",", ""), codes.astype(np.uint8))


# ---- within Blender


def blender_axes(ned):
    """East, north, up."""
    ned = np.asarray(ned)
    return np.stack([ned[..., 1], ned[..., 0], -ned[..., 2]], -1)


def add_body(bpy, folder):
    data = np.load(f"{folder}/body.npz")
    points = blender_axes(data["corners"]).reshape(-1, 3)
    # The change of axes mirrors nothing, but the order of corners is kept so that normals point as before.
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(points.tolist(), [], np.arange(len(points)).reshape(-1, 3).tolist())
    mesh.use_auto_smooth = True
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.normals_split_custom_set(blender_axes(data["normals"]).reshape(-1, 3).tolist())
    body = bpy.data.objects.new("body", mesh)
    bpy.context.collection.objects.link(body)
    return body


def node_maker(tree):
    tree.nodes.clear()

    def make(kind, operation=None, inputs=()):
        node = tree.nodes.new(kind)
        if operation:
            node.operation = operation
        for slot, value in inputs:
            if hasattr(value, "is_output"):
                tree.links.new(value, node.inputs[slot])
            else:
                node.inputs[slot].default_value = value
        return node

    return make


def paint(bpy):
    material = bpy.data.materials.new("paint")
    material.use_nodes = True
    make = node_maker(material.node_tree)
    geometry = make("ShaderNodeNewGeometry").outputs
    dot = make("ShaderNodeVectorMath", "DOT_PRODUCT", [(0, geometry["Normal"]), (1, geometry["Incoming"])]).outputs["Value"]
    cosine = make("ShaderNodeMath", "ABSOLUTE", [(0, dot)]).outputs[0]
    off = make("ShaderNodeMath", "SUBTRACT", [(0, 1.0), (1, cosine)]).outputs[0]
    fifth = make("ShaderNodeMath", "POWER", [(0, off), (1, 5.0)]).outputs[0]
    share = make("ShaderNodeMath", "MULTIPLY_ADD", [(0, fifth), (1, 0.96), (2, 0.04)]).outputs[0]
    below = make("ShaderNodeBsdfDiffuse", inputs=[("Color", (PAINT, PAINT, PAINT, 1))])
    coat = make("ShaderNodeBsdfGlossy", inputs=[("Color", (1, 1, 1, 1)), ("Roughness", GLOSS_ROUGHNESS)])
    both = make("ShaderNodeMixShader", inputs=[(0, share), (1, below.outputs[0]), (2, coat.outputs[0])])
    make("ShaderNodeOutputMaterial", inputs=[("Surface", both.outputs[0])])
    return material


def lambert(bpy):
    material = bpy.data.materials.new("lambert")
    material.use_nodes = True
    make = node_maker(material.node_tree)
    below = make("ShaderNodeBsdfDiffuse", inputs=[("Color", (PAINT, PAINT, PAINT, 1))])
    make("ShaderNodeOutputMaterial", inputs=[("Surface", below.outputs[0])])
    return material


def normals_shown(bpy):
    """0.5 + 0.5 n, in north, east, down."""
    material = bpy.data.materials.new("normals")
    material.use_nodes = True
    make = node_maker(material.node_tree)
    normal = make("ShaderNodeNewGeometry").outputs["Normal"]
    half = make("ShaderNodeVectorMath", "MULTIPLY_ADD", [(0, normal), (1, (0.5, 0.5, -0.5)), (2, (0.5, 0.5, 0.5))]).outputs[0]
    split = make("ShaderNodeSeparateXYZ", inputs=[(0, half)]).outputs
    turned_axes = make("ShaderNodeCombineXYZ", inputs=[(0, split[1]), (1, split[0]), (2, split[2])]).outputs[0]
    shown = make("ShaderNodeEmission", inputs=[("Color", turned_axes), ("Strength", 1.0)])
    make("ShaderNodeOutputMaterial", inputs=[("Surface", shown.outputs[0])])
    return material


def sky_and_ground(bpy, job):
    """Moon and Spencer's sky, of irradiance over pi `sky` on a level surface, over an even ground."""
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    make = node_maker(world.node_tree)
    up = make("ShaderNodeSeparateXYZ", inputs=[(0, make("ShaderNodeTexCoord").outputs["Generated"])]).outputs[2]
    bright = make("ShaderNodeMath", "MULTIPLY_ADD", [(0, up), (1, 9 / 7 * 2 / 3), (2, 9 / 7 / 3)]).outputs[0]
    above = make("ShaderNodeBackground", inputs=[("Color", (*job["sky"], 1)), ("Strength", bright)])
    below = make("ShaderNodeBackground", inputs=[("Color", (*job["ground"], 1)), ("Strength", 1.0)])
    is_up = make("ShaderNodeMath", "GREATER_THAN", [(0, up), (1, 0.0)]).outputs[0]
    both = make("ShaderNodeMixShader", inputs=[(0, is_up), (1, below.outputs[0]), (2, above.outputs[0])])
    make("ShaderNodeOutputWorld", inputs=[("Surface", both.outputs[0])])


def looking(mathutils, forward):
    """Rotation of what looks along its own -z, in Blender's axes."""
    return mathutils.Vector(forward).to_track_quat("-Z", "Y")


def add_sun_and_camera(bpy, mathutils, job):
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy = math.pi * job["exposure"]
    sun.color = SUN_COLOUR
    sun.angle = math.radians(SUN_DEG)
    lamp = bpy.data.objects.new("sun", sun)
    lamp.rotation_mode = "QUATERNION"
    lamp.rotation_quaternion = looking(mathutils, -blender_axes(direction(*job["sun"])))
    camera = bpy.data.cameras.new("camera")
    camera.sensor_width = 36
    camera.lens = 36 * job["focal"] / SIDE_PX
    camera.clip_end = 1e6
    eye = bpy.data.objects.new("camera", camera)
    eye.location = blender_axes(job["eye_ned"])
    eye.rotation_mode = "QUATERNION"
    eye.rotation_quaternion = looking(mathutils, -blender_axes(job["eye_ned"]))
    for thing in (lamp, eye):
        bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = eye


def cycles_scene(bpy, side_px, file_format):
    """The scene, rendered by the processor into squares with an alpha channel."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = side_px
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = file_format
    scene.render.image_settings.color_mode = "RGBA"
    return scene


def in_blender(path):
    import bpy
    import mathutils

    job = json.load(open(path))
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    body = add_body(bpy, job["folder"])
    add_sun_and_camera(bpy, mathutils, job)
    scene = cycles_scene(bpy, SIDE_PX, "OPEN_EXR")
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1
    scene.cycles.max_bounces = 8
    scene.render.image_settings.color_depth = "32"

    def shoot(name, material, samples):
        body.data.materials.clear()
        body.data.materials.append(material)
        scene.cycles.samples = samples
        scene.render.filepath = f"{job['folder']}/{name}.exr"
        bpy.ops.render.render(write_still=True)

    sky_and_ground(bpy, job)
    shoot("light", paint(bpy), SAMPLES)
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    shoot("normal", normals_shown(bpy), 16)
    scene.cycles.max_bounces = 0
    shoot("sun", lambert(bpy), 32)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bodies", nargs="*", default=["sphere", "aeroplane"])
    parser.add_argument("--airtruth", default="build/release/src/cli/airtruth", help="the program")
    parser.add_argument("--out", help="folder for the pictures; Cycles is on the left")
    arguments = parser.parse_args()
    if shutil.which("blender") is None:
        print("skipped: there is no blender here")
        return
    print("| body | view | region | pixels | Cycles | airtruth | difference |\n|---|---|---|---:|---:|---:|---:|")
    for body in arguments.bodies:
        faces = {"sphere": sphere, "aeroplane": aeroplane}.get(body, lambda: ac_file(body))()
        compare(arguments.airtruth, os.path.splitext(os.path.basename(body))[0], faces, arguments.out)


if __name__ == "__main__":
    if "--" in sys.argv and "bpy" in sys.modules:
        in_blender(sys.argv[sys.argv.index("--") + 1])
    else:
        main()
