# SPDX-License-Identifier: Apache-2.0
"""Labelled crops of aircraft by Blender's own Python loop, as one would write it without airtruth, for stream.py:

    blender -b --factory-startup -P blender_crops.py -- FOLDER COUNT PICTURE ... -- MODEL.ac ...

Each crop has an aircraft of 10 to 60 px, rendered by Cycles in the light of blender_light.py, over a crop of a picture, and the box
of its opacity; crops are left in FOLDER, boxes printed. The aircraft have no textures, no noise and no blur. Prints seconds of wall-clock time and of CPU time.
"""

import math
import os
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

import bpy
import cv2
import mathutils
import numpy as np

import blender_light as light

SIDE_PX = 256
FOCAL_PX = 240 / math.tan(math.radians(15))  # of 640x480 with a vertical field of view of 30 degrees
SIZES_PX = (10, 60)
SAMPLES = 16  # of Cycles a pixel; chosen: fewer are seen as noise on an aircraft of 60 px


def bodies(models, folder):
    made = []
    for model in models:
        corners, normals = light.corners_and_normals(light.ac_file(model))
        np.savez(f"{folder}/body.npz", corners=corners, normals=normals)
        body = light.add_body(bpy, folder)
        body.data.materials.append(light.paint(bpy))
        body.rotation_mode = "QUATERNION"
        body.hide_render = True
        made.append((body, np.ptp(corners.reshape(-1, 3), axis=0).max()))
    return made


def set_up(folder):
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    view = dict(light.VIEWS["side, sun behind"], focal=FOCAL_PX * light.SIDE_PX / SIDE_PX, eye_ned=[0, 0, 1])
    light.add_sun_and_camera(bpy, mathutils, view)
    bpy.context.scene.camera.location = (0, 0, 0)
    bpy.context.scene.camera.rotation_quaternion = light.looking(mathutils, (0, 1, 0))
    light.sky_and_ground(bpy, view)
    scene = light.cycles_scene(bpy, SIDE_PX, "PNG")
    scene.cycles.samples = SAMPLES
    scene.render.use_persistent_data = True
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.filepath = f"{folder}/layer.png"


def crop(draw, made, pictures, folder):
    body, longest_m = made[draw.integers(len(made))]
    distance_m = FOCAL_PX * longest_m / draw.uniform(*SIZES_PX)
    right, above = draw.uniform(-0.07, 0.07, 2)
    body.location = (distance_m * right, distance_m, distance_m * above)
    body.rotation_quaternion = mathutils.Euler([math.radians(draw.uniform(-b, b)) for b in (20, 10, 180)]).to_quaternion()
    body.hide_render = False
    bpy.ops.render.render(write_still=True)
    body.hide_render = True
    layer = cv2.imread(f"{folder}/layer.png", cv2.IMREAD_UNCHANGED).astype(float)
    picture = pictures[draw.integers(len(pictures))]
    y, x = (draw.integers(side - SIDE_PX) for side in picture.shape[:2])
    alpha = layer[..., 3:] / 255
    made_picture = layer[..., :3] * alpha + picture[y:y + SIDE_PX, x:x + SIDE_PX] * (1 - alpha)
    return made_picture.round().astype(np.uint8), cv2.boundingRect((alpha > 0.5).astype(np.uint8))


def main():
    folder, count, *rest = sys.argv[sys.argv.index("--") + 1:]
    split = rest.index("--")
    pictures = [cv2.imread(path) for path in rest[:split]]
    set_up(folder)
    made, draw = bodies(rest[split + 1:], folder), np.random.default_rng(1)
    crop(draw, made, pictures, folder)  # compiles and loads
    begin = time.monotonic(), time.process_time()
    for number in range(int(count)):
        picture, box = crop(draw, made, pictures, folder)
        cv2.imwrite(f"{folder}/crop{number}.png", picture)
        print("box", number, *box)  # x, y, width, height
    print("seconds", time.monotonic() - begin[0], time.process_time() - begin[1], flush=True)


main()
