# SPDX-License-Identifier: Apache-2.0
"""The shipped TraX clients, and trackers that misbehave, under `airtruth track`: python3 trax_clients_test.py AIRTRUTH CLIENTS EXAMPLE

Makes a little video with a moving block, follows it with the C++ and the Python client (which share no code with the
evaluator or each other), then runs trackers that crash, hang, babble, lie and never
answer over two sequences: each costs its own runs and nothing else.
"""

import os
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT, FRAMES = 160, 120, 24


def place(frame):
    return 40 + 2 * frame, 30 + frame, 14, 10


def png(rows):
    """Grey, 8 bits."""
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))


def make_set(airtruth, root):
    """Two sequences of numbered images with a patterned block on a soft ground."""
    rows = "frame,x,y,w,h\n" + "".join(f"{i},{','.join(map(str, place(i)))}\n" for i in range(FRAMES))
    os.makedirs(root + "/csv")
    for name in ("first", "second"):
        os.makedirs(f"{root}/{name}")
        for i in range(FRAMES):
            x, y, w, h = place(i)
            pixel = lambda c, r: ((40 + 90 * ((c - x) // 3 + (r - y) // 3 & 1)) if x <= c < x + w and y <= r < y + h
                                  else 150 + (c * 7 + r * 3) % 23)
            with open(f"{root}/{name}/{i:04d}.png", "wb") as image:
                image.write(png([bytes(pixel(c, r) for c in range(WIDTH)) for r in range(HEIGHT)]))
        with open(f"{root}/csv/{name}.csv", "w", encoding="utf-8") as file:
            file.write(rows)
    command = [airtruth, "dataset", "import", root + "/csv", "-f", "csv", "-o", root + "/set"]
    for name in ("first", "second"):
        command += ["--video", f"{name}={root}/{name}"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


HELLO = """echo '@@TRAX:hello "trax.name=odd" "trax.version=3" "trax.image=path;" "trax.region=rectangle;"'; n=0; """
LOOP = HELLO + "while read -r line; do n=$((n+1)); case \"$line\" in @@TRAX:quit*) exit;; esac; [ $n -lt 8 ] && echo '@@TRAX:state 10,20,30,40' || { %s; }; done"
ODD = {
    "crashes": (LOOP % "kill -SEGV $$", "was ended by signal 11"),
    "hangs": (LOOP % "sleep 100", "did not answer in time"),
    "babbles": (LOOP % "yes something", "did not answer in time"),
    "lies": (LOOP % "echo '@@TRAX:state here and there'", "the tracker sent a state with 3 regions; expected one"),
    "quits": (LOOP % "echo '@@TRAX:quit'; exit", "the tracker quit"),
    "answers-twice": (LOOP % "printf '@@TRAX:state 1,2,3,4\\n@@TRAX:state 1,2,3,4\\n'", "the tracker answered before it was asked"),
}


# A tracker that says "0", that it has lost its object, from its fifth request on.
LOSES = (HELLO + "while read -r line; do n=$((n+1)); case \"$line\" in @@TRAX:quit*) exit;; esac; "
         "[ $n -lt 5 ] && echo '@@TRAX:state 45,30,30,40' || echo '@@TRAX:state \"0\"'; done")


def expect_lost(root, run):
    """What is lost is a frame without an answer in every protocol, and a failure where a tracker is begun anew after one."""
    with open(root + "/loses.sh", "w", encoding="utf-8") as out:
        out.write(LOSES)
    tracker = f"loses=trax:sh {root}/loses.sh"
    for protocol in ("ope", "restart", "multistart"):
        done = run("track", "set", "--only", "first", "-o", "lost", "-t", tracker, "--protocol", protocol)
        if done.returncode != 0 or done.stderr:
            sys.exit(f"trax_clients_test: lost, {protocol}: {done.returncode}: {done.stderr}")
    video = run("track", "first", "--init", "40,30,14,10", "-o", "lost-video", "-t", tracker)
    box, nan = "45,30,30,40", "nan,nan,nan,nan"
    first = ",".join(map(str, place(0)))
    # The box that it answers with touches the truth in the first frames; then it is lost.
    wanted = {"lost/loses/first.txt": [first] + [box] * 3 + [nan] * (FRAMES - 4),
              "lost/loses/restart/first/first_001.txt": ["1"] + [box] * 3 + (["2"] + ["0"] * 4 + ["1"]) * 3 + ["2", "0"],
              "lost/loses/multistart/first/first_00000000.txt": ["1"] + [box] * 3 + [nan] * (FRAMES - 4),
              "lost-video/loses/first.txt": [first] + [box] * 3 + [nan] * (FRAMES - 4)}
    for name, expected in wanted.items():
        with open(f"{root}/{name}", encoding="utf-8") as result:
            found = result.read().splitlines()
        if found != expected:
            sys.exit(f"trax_clients_test: {name}: {found}; {video.stderr}")


def expect_tried_again(root, run):
    """A run that was broken off is named by `evaluate`, and tried again by the next call, which keeps the others."""
    with open(root + "/flaky.sh", "w", encoding="utf-8") as out:
        out.write(LOOP % f"[ -e {root}/well ] && echo '@@TRAX:state 10,20,30,40' || kill -SEGV $$")
    track = lambda *more: run("track", "set", "-o", "flaky", "-t", f"flaky=trax:sh {root}/flaky.sh", *more)
    evaluate = lambda: run("evaluate", "set", "flaky/flaky", "-o", "evaluation", "--no-page")
    said = "1 runs were broken off (logs/second.log says how)"

    def expect(done, code, told, warned):
        if done.returncode != code or told not in done.stdout or (said in done.stderr) != warned:
            sys.exit(f"trax_clients_test: flaky: {done.returncode}: {done.stdout} {done.stderr}")

    track("--only", "second")
    expect(evaluate(), 2, "", True)
    well = open(root + "/well", "w", encoding="utf-8")
    well.close()
    expect(track("--only", "first"), 0, "1 runs tracked", False)
    os.remove(well.name)
    expect(track(), 1, "0 runs tracked, 1 were there, 1 broken off", False)
    expect(evaluate(), 0, "flaky", True)
    open(well.name, "w", encoding="utf-8").close()
    done = track()
    expect(done, 0, ", 1 were there", False)
    if "1 runs tracked" not in done.stdout or "broken off" in done.stdout or os.path.exists(root + "/flaky/flaky/logs/second.log"):
        sys.exit(f"trax_clients_test: flaky: {done.stdout}")
    expect(evaluate(), 0, "flaky", False)


def expect_negative_told(root, run):
    """A box with a width below 0 is a frame without an answer, which one warning says for all sequences."""
    with open(root + "/negative.sh", "w", encoding="utf-8") as out:
        out.write(HELLO + "while read -r line; do case \"$line\" in @@TRAX:quit*) exit;; esac; echo '@@TRAX:state 45,30,-30,40'; done")
    done = run("track", "set", "-o", "negative", "-t", f"negative=trax:sh {root}/negative.sh")
    if done.returncode != 0 or done.stderr.count("width or height below 0") != 1:
        sys.exit(f"trax_clients_test: negative: {done.returncode}: {done.stderr}")


def main():
    airtruth, clients, example = sys.argv[1:4]
    airtruth = os.path.abspath(airtruth)
    with tempfile.TemporaryDirectory(prefix="airtruth_trax_clients_") as root:
        run = lambda *command: subprocess.run([airtruth, *command], capture_output=True, text=True, cwd=root)
        make_set(airtruth, root)
        good = run("track", "set", "-o", "results", "-t", f"trax:{example}", f"trax:python3 '{clients}/template_tracker.py'")
        if good.returncode != 0 or good.stderr:
            sys.exit(f"trax_clients_test: {good.returncode}: {good.stderr}")
        for name in ("template", "template-python"):
            for sequence in ("first", "second"):
                with open(f"{root}/results/{name}/{sequence}.txt", encoding="utf-8") as file:
                    boxes = [tuple(map(float, line.split(","))) for line in file]
                wanted = [tuple(map(float, place(i))) for i in range(FRAMES)]
                if boxes != wanted:
                    sys.exit(f"trax_clients_test: {name} on {sequence}: {boxes}")
        over_sockets = run("track", "set", "--only", "first", "-o", "sockets", "-t", f"a=trax-socket:{example} --several",
                           f"b=trax-socket:python3 '{clients}/template_tracker.py'")
        if over_sockets.returncode != 0 or over_sockets.stderr:
            sys.exit(f"trax_clients_test: sockets: {over_sockets.stderr}")
        for name in ("a", "b"):
            with open(f"{root}/sockets/{name}/first.txt", encoding="utf-8") as mine, \
                 open(f"{root}/results/template/first.txt", encoding="utf-8") as file:
                if mine.read() != file.read():
                    sys.exit(f"trax_clients_test: {name} over a socket finds other boxes")
        for name, (script, word) in ODD.items():
            file = f"{root}/{name}.sh"
            with open(file, "w", encoding="utf-8") as out:
                out.write(script)
            done = run("track", "set", "-o", "odd", "-t", f"{name}=trax:sh {file}", "--timeout", "3")
            if done.returncode != 1 or done.stderr.count(word) != 2 or "0 runs tracked, 2 broken off" not in done.stdout:
                sys.exit(f"trax_clients_test: {name}: {done.returncode}: {done.stdout} {done.stderr}")
            if sorted(os.listdir(f"{root}/odd/{name}")) != ["logs", "tracker.json"]:
                sys.exit(f"trax_clients_test: {name}: {os.listdir(f'{root}/odd/{name}')} are there of runs that broke off")
            for sequence in ("first", "second"):
                if word not in open(f"{root}/odd/{name}/logs/{sequence}.log", encoding="utf-8").read():
                    sys.exit(f"trax_clients_test: {name}: the log says nothing of it")
        for protocol in ("restart", "multistart"):
            done = run("track", "set", "-o", "odd", "-t", f"crashes=trax:sh {root}/crashes.sh", "--protocol", protocol)
            if done.returncode != 1 or os.path.exists(f"{root}/odd/crashes/{protocol}"):
                sys.exit(f"trax_clients_test: crashes, {protocol}: {done.returncode}: {done.stderr}")
        expect_tried_again(root, run)
        expect_lost(root, run)
        expect_negative_told(root, run)
        # What cannot be started is refused before anything is made.
        for command, word in (("trax:no_such_tracker_4711", "not found"), ("trax:exit 5", "status 5"),
                              ("trax:echo words", "ended with status 0"), ("trax:", "names no command"),
                              ("a/b=trax:cat", "no name"), ("opencv-mill", "did you mean 'opencv-mil'")):
            done = run("track", "set", "-o", "never", "-t", command)
            if done.returncode != 2 or word not in done.stderr or done.stderr.count("\n") != 1 or os.path.exists(root + "/never"):
                sys.exit(f"trax_clients_test: {command}: {done.returncode}: {done.stderr}")
        print(f"two clients agree with the truth, {len(ODD)} that misbehave cost their own runs, 6 are refused")


if __name__ == "__main__":
    main()
