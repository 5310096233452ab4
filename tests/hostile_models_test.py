# SPDX-License-Identifier: Apache-2.0
"""Model files that try to break the program, or to make it do what they want, each end in one line and exit code 2:
python3 hostile_models_test.py AIRTRUTH
Files of AIRTRUTH_SHARED/hostile are tried too, where it is set.
"""

import os
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time

airtruth = os.path.abspath(sys.argv[1])
LIMIT_S = 60  # far above what any of these takes; one that never ends fails

HEAD = 'AC3Db\nMATERIAL "m" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\nOBJECT poly\n'
BODY = "numvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\nkids 0\n"
LUA = 'os.execute("touch pwned")'


def sgi(width, height, channels, table):
    head = struct.pack(">HBBHHHH", 474, 1, 1, 3, width, height, channels)
    return head + bytes(512 - len(head)) + table


FILES = {
    "e.lua": LUA.encode(),
    "texture.ac": (HEAD + 'texture "e.lua"\n' + BODY).encode(),
    "wrapper.xml": b"<PropertyList><path>e.lua</path></PropertyList>",
    "shell.xml": b"<PropertyList><path>x;touch pwned;.tgz</path></PropertyList>",
    "loop.xml": b'<PropertyList include="loop.xml"><path>texture.ac</path></PropertyList>',
    "nest.xml": b"<PropertyList><model><path>nest.xml</path></model><model><path>nest.xml</path></model></PropertyList>",
    "out.xml": b'<PropertyList include="../../etc/passwd"><path>x.ac</path></PropertyList>',
    "proxy.osgt": b'#Ascii Scene\nosg::ProxyNode { FileNames 1 { "e.lua" } }\n',
    "count.ac": (HEAD + BODY).replace("numvert 3", "numvert 4000000000").encode(),
    "refs.ac": (HEAD + BODY).replace("refs 3", "refs 4000000000").encode(),
    "turn.ac": (HEAD + "rot 1 0 0 0 1 0 4294967295 0 1\n" + BODY).encode(),
    "nan.ac": (HEAD + BODY).replace("1 0 0\n0 1", "nan 0 0\n0 1").encode(),
    "deep.ac": ("AC3Db\n" + "OBJECT group\nkids 1\n" * 200000).encode(),
    "big.rgb": sgi(65535, 65535, 4, b""),
    "big.ac": (HEAD + 'texture "big.rgb"\n' + BODY).encode(),
    "run.rgb": sgi(4, 4, 1, struct.pack(">32I", *([640] * 16 + [4] * 16)) + b"\x7f\x01\x00"),
    "run.ac": (HEAD + 'texture "run.rgb"\n' + BODY).encode(),
    "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -2147483648\n",
    "empty.3ds": b"",
    "chunk.3ds": b"MM\xff\xff\xff\xff==\xff\xff\xff\xff",
    "size.glb": b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON",
    "count.ply": b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n",
    "count.stl": bytes(80) + b"\xff\xff\xff\xff",
}


def run(path, folder):
    return subprocess.run([airtruth, "aircraft", "show", str(path), "-o", "x.png"], cwd=folder, capture_output=True,
                          text=True, timeout=LIMIT_S)


def expect_one_line(path, folder):
    done = run(path, folder)
    lines = done.stderr.strip().splitlines()
    assert done.returncode == 2, f"{path}: code {done.returncode}: {done.stderr}"
    assert len(lines) == 1 and "error" in lines[0], f"{path}: {done.stderr}"


def refuses_each(folder):
    for name, content in FILES.items():
        (folder / name).write_bytes(content)
    before = {p.name for p in folder.iterdir()}
    for name in FILES:
        if name.endswith((".lua", ".rgb")):
            continue
        expect_one_line(name, folder)
    left = {p.name for p in folder.iterdir()} - before
    assert not left, f"left behind: {left}"


def refuses_shared(folder):
    shared = os.environ.get("AIRTRUTH_SHARED")
    hostile = pathlib.Path(shared or "/nonexistent") / "hostile"
    if not hostile.is_dir():
        print("skipped: AIRTRUTH_SHARED/hostile is not there")
        return
    endings = {".ac", ".osgt", ".obj", ".3ds", ".xml"}
    models = [p for p in sorted(hostile.iterdir()) if p.suffix in endings]
    assert models
    for path in models:
        expect_one_line(path, folder)
    assert not list(folder.iterdir()), list(folder.iterdir())


def children_of(pid):
    """Processes that run, whose parent is pid."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            stat = (entry / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(stat[1]) == pid and stat[0] != "Z":
            found.append(int(entry.name))
    return found


def is_gone(pid):
    try:
        return (pathlib.Path("/proc") / str(pid) / "stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except OSError:
        return True


def wait_until(condition, what):
    end = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.01)


def ends_with_its_reader(folder, signal_number, code):
    """A reader that never answers: a signal ends the program, and nothing of it is left."""
    reader = folder / "reader"
    reader.write_text("#!/bin/sh\nexec sleep 600\n")
    reader.chmod(0o755)
    (folder / "a.ac").write_text(HEAD + BODY)
    program = subprocess.Popen([airtruth, "aircraft", "show", "a.ac"], cwd=folder, stderr=subprocess.PIPE,
                               env={**os.environ, "AIRTRUTH_MODEL_READER": str(reader)})
    wait_until(lambda: children_of(program.pid), "no reader was started")
    child = children_of(program.pid)[0]
    program.send_signal(signal_number)
    program.communicate(timeout=LIMIT_S)
    assert program.returncode == code, program.returncode
    wait_until(lambda: is_gone(child), "the reader outlives the program")


with tempfile.TemporaryDirectory() as name:
    os.environ["XDG_CACHE_HOME"] = os.path.join(name, "cache")
    for step in ("each", "shared", "stopped"):
        os.mkdir(os.path.join(name, step))
    root = pathlib.Path(name)
    refuses_each(root / "each")
    refuses_shared(root / "shared")
    ends_with_its_reader(root / "stopped", signal.SIGTERM, 130)
print("every hostile model is one line")
