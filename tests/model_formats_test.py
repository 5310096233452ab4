# SPDX-License-Identifier: Apache-2.0
"""One shape, written in every model format by a writer of this test's own, is read with one size, one colour and one set of axes.

The shape has its nose along x and z upwards: 3 m ahead, 2 m to the left, 1 m high, in two triangles."""

import base64
import json
import re
import struct
import unittest
import zlib

from program import Case, main, path, run, write

POINTS = [(0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1)]
FACES = [(0, 1, 2), (0, 2, 3)]
RED = (0.8, 0.1, 0.05)


def obj():
    write("a.mtl", "newmtl red\nKd %g %g %g\n" % RED)
    lines = ["mtllib a.mtl"] + ["v %g %g %g" % p for p in POINTS] + ["usemtl red"]
    return write("a.obj", "\n".join(lines + ["f %d %d %d" % tuple(i + 1 for i in f) for f in FACES]) + "\n")


def stl():
    """Binary: 80 bytes of title, the number of facets, for each a normal and three points."""
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *POINTS[a], *POINTS[b], *POINTS[c], 0) for a, b, c in FACES)
    return write("a.stl", b"made by a test".ljust(80, b" ") + struct.pack("<I", len(FACES)) + facets)


def ply():
    """Binary, little-endian."""
    head = ("ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 2\nproperty list uchar int vertex_indices\nend_header\n")
    body = b"".join(struct.pack("<3f", *p) for p in POINTS) + b"".join(struct.pack("<B3i", 3, *f) for f in FACES)
    return write("a.ply", head.encode() + body)


def gltf_parts():
    points = b"".join(struct.pack("<3f", *p) for p in POINTS)
    indices = b"".join(struct.pack("<3H", *f) for f in FACES)
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [*RED, 1]}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [3, 2, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)}],
        "buffers": [{"byteLength": len(points) + len(indices)}],
    }
    return scene, points + indices


def gltf_inside():
    scene, data = gltf_parts()
    scene["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return write("inside.gltf", json.dumps(scene))


def gltf_beside():
    scene, data = gltf_parts()
    write("parts/a.bin", data)
    scene["buffers"][0]["uri"] = "parts/a.bin"
    return write("beside.gltf", json.dumps(scene))


def glb():
    """A header, a chunk of JSON and a chunk of binary data, each padded to four bytes."""
    scene, data = gltf_parts()
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return write("a.glb", struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def dae():
    numbers = " ".join("%g" % x for p in POINTS for x in p)
    return write("a.dae", f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>{RED[0]} {RED[1]} {RED[2]} 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">{numbers}</float_array><technique_common><accessor source="#pa" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2" material="s"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
""")


def three_ds():
    """Chunks: a number, the length with those inside, the content."""
    def chunk(kind, *content):
        body = b"".join(content)
        return struct.pack("<HI", kind, 6 + len(body)) + body

    points = chunk(0x4110, struct.pack("<H", len(POINTS)), *(struct.pack("<3f", *p) for p in POINTS))
    group = chunk(0x4130, b"red\0", struct.pack("<H2H", 2, 0, 1))
    faces = chunk(0x4120, struct.pack("<H", len(FACES)), *(struct.pack("<4H", *f, 0) for f in FACES), group)
    colour = chunk(0x0011, bytes(round(255 * c) for c in RED))
    material = chunk(0xAFFF, chunk(0xA000, b"red\0"), chunk(0xA020, colour))
    editor = chunk(0x3D3D, material, chunk(0x4000, b"shape\0", chunk(0x4100, points, faces)))
    return write("a.3ds", chunk(0x4D4D, editor))


def fbx():
    """The ASCII form, in metres (a unit of 100 cm)."""
    numbers = ",".join("%g" % x for p in POINTS for x in p)
    corners = ",".join("%d,%d,%d" % (a, b, -c - 1) for a, b, c in FACES)
    return write("a.fbx", f"""; FBX 7.3.0 project file
FBXHeaderExtension:  {{
	FBXVersion: 7300
}}
GlobalSettings:  {{
	Version: 1000
	Properties70:  {{
		P: "UnitScaleFactor", "double", "Number", "",100
	}}
}}
Objects:  {{
	Geometry: 1001, "Geometry::", "Mesh" {{
		Vertices: *12 {{
			a: {numbers}
		}}
		PolygonVertexIndex: *6 {{
			a: {corners}
		}}
		LayerElementMaterial: 0 {{
			Version: 101
			Name: ""
			MappingInformationType: "AllSame"
			ReferenceInformationType: "IndexToDirect"
			Materials: *1 {{
				a: 0
			}}
		}}
	}}
	Model: 1002, "Model::shape", "Mesh" {{
		Version: 232
	}}
	Material: 1003, "Material::red", "" {{
		Version: 102
		ShadingModel: "lambert"
		Properties70:  {{
			P: "DiffuseColor", "Color", "", "A",{RED[0]},{RED[1]},{RED[2]}
		}}
	}}
}}
Connections:  {{
	C: "OO",1002,0
	C: "OO",1001,1002
	C: "OO",1003,1002
}}
""")


WRITERS = {"obj": obj, "stl": stl, "ply": ply, "gltf": gltf_inside, "gltf with a file beside it": gltf_beside, "glb": glb, "dae": dae, "3ds": three_ds, "fbx": fbx}


def size_of(text):
    """length, span and height in metres, as `aircraft show` prints them."""
    found = re.search(r"length ([\d.]+) m.*span ([\d.]+) m.*height ([\d.]+) m", text, re.S)
    return tuple(float(x) for x in found.groups()) if found else text


class EveryFormat(Case):
    def test_has_the_shape_s_size(self):
        for name, writer in WRITERS.items():
            with self.subTest(name):
                shown = run("aircraft", "show", writer(), "--forward", "x", "--up", "z")
                self.assertEqual(shown.returncode, 0, shown.stderr)
                self.assertEqual(size_of(shown.stdout), (3, 2, 1))

    def test_is_scaled_and_turned_as_asked(self):
        for name in ("glb", "dae", "fbx"):
            writer = WRITERS[name]
            with self.subTest(name):
                shown = run("aircraft", "show", writer(), "--forward", "-y", "--up", "x", "--scale", "0.5")
                self.assertEqual(shown.returncode, 0, shown.stderr)
                self.assertEqual(size_of(shown.stdout), (1, 0.5, 1.5))

    def test_cut_short_or_spoilt_is_one_line(self):
        for name, writer in WRITERS.items():
            file = writer()
            with open(file, "rb") as whole:
                content = whole.read()
            ending = file[file.rindex("."):]
            for kind, bad in {"cut": content[: len(content) // 3], "noise": zlib.compress(content) * 3}.items():
                with self.subTest(f"{name}, {kind}"):
                    shown = run("aircraft", "show", write("bad" + ending, bad))
                    # A reader may accept the first part of a file of lines; a fault is one line that names the file.
                    if shown.returncode == 0:
                        self.assertEqual(kind, "cut")
                        continue
                    self.assertEqual(shown.returncode, 2, shown.stderr)
                    self.assertEqual(len(shown.stderr.strip().splitlines()), 1, shown.stderr)
                    self.assertIn("bad" + ending, shown.stderr)

    def test_an_extension_of_gltf_that_is_not_read_is_named(self):
        scene, data = gltf_parts()
        scene["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        scene["images"] = [{"uri": "a.webp"}]
        scene["textures"] = [{"extensions": {"EXT_texture_webp": {"source": 0}}}]
        scene["extensionsUsed"] = ["EXT_texture_webp"]
        scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        shown = run("aircraft", "show", write("webp.gltf", json.dumps(scene)), "--forward", "x", "--up", "z")
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("EXT_texture_webp of glTF is not read", shown.stderr)

    def test_collada_that_is_transparent_by_mistake_is_opaque_and_said(self):
        with open(dae(), encoding="utf-8") as whole:
            text = whole.read()
        clear = text.replace("</diffuse>", "</diffuse><transparent><color>1 1 1 1</color></transparent><transparency><float>0</float></transparency>")
        self.assertNotEqual(text, clear)
        shown = run("aircraft", "show", write("clear.dae", clear), "--forward", "x", "--up", "z")
        self.assertEqual((shown.returncode, size_of(shown.stdout)), (0, (3, 2, 1)), shown.stderr)
        self.assertIn("is shown opaque", shown.stderr)

    def test_files_outside_of_its_folder_are_not_read(self):
        scene, data = gltf_parts()
        write("outside.bin", data)
        scene["buffers"][0]["uri"] = "../outside.bin"
        shown = run("aircraft", "show", write("inner/a.gltf", json.dumps(scene)))
        self.assertEqual(shown.returncode, 2)
        self.assertEqual(len(shown.stderr.strip().splitlines()), 1, shown.stderr)


if __name__ == "__main__":
    main(lambda: None)
