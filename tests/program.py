# SPDX-License-Identifier: Apache-2.0
"""Runs the program as its users do, in a folder that is removed at the end. A test module defines cases from Case and ends with main()."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

HANG_S = 300  # stops a program that hangs; the longest run here takes 15 s on a quiet core

_airtruth = ""
_root = ""


def path(*names):
    return os.path.join(_root, *names)


def write(name, content):
    os.makedirs(os.path.dirname(path(name)), exist_ok=True)
    with open(path(name), "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path(name)


def read(*names):
    with open(path(*names), encoding="utf-8") as file:
        return file.read()


def built():
    """The folder of the program and its children."""
    return os.path.dirname(_airtruth)


def run(*arguments, at=None):
    """`at`: a copy of the program in place of itself."""
    return subprocess.run([at or _airtruth, *arguments], cwd=_root, capture_output=True, text=True, errors="replace", timeout=HANG_S)


def made(*arguments):
    """Runs a command that must succeed."""
    result = run(*arguments)
    if result.returncode != 0:
        raise AssertionError(f"{arguments}: {result.stderr}")
    return result


def interrupted(arguments, is_working, **environment):
    """Runs a command, sends it the signal of Ctrl-C once `is_working(process)` is true, and returns its exit code and its messages."""
    process = subprocess.Popen([_airtruth, *arguments], cwd=_root, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, **environment})
    until = time.monotonic() + HANG_S
    while process.poll() is None and not is_working(process) and time.monotonic() < until:
        time.sleep(0.01)
    if process.poll() is not None:
        raise AssertionError(f"{arguments} ended before it could be interrupted: {process.communicate()[1]}")
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=HANG_S)
    return process.returncode, errors


def takes_signals(process):
    """For interrupted(): whether the process has blocked SIGINT to handle it, which is the first thing that it does."""
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
        blocked = next(int(line.split()[1], 16) for line in file if line.startswith("SigBlk:"))
    return bool(blocked & (1 << (signal.SIGINT - 1)))


def has_open(name):
    """For interrupted(): whether the process has the file open."""

    def look(process):
        folder = f"/proc/{process.pid}/fd"
        try:
            return any(os.path.realpath(os.path.join(folder, n)) == os.path.realpath(path(name)) for n in os.listdir(folder))
        except OSError:
            return False

    return look


def has_written(name):
    """For interrupted(): whether a file or folder of that name exists."""
    return lambda process: os.path.exists(path(name))


class Case(unittest.TestCase):
    def assert_refused(self, result, *words):
        """One line that says what is wrong, with exit code 2."""
        self.assertEqual(result.returncode, 2, result.stderr)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("airtruth: error: "), lines[0])
        for word in words:
            self.assertIn(word.lower(), lines[0].lower())

    def assert_stopped(self, outcome):
        """What a user sees after Ctrl-C."""
        self.assertEqual(outcome, (130, "airtruth: error: interrupted; no half-written file is left behind\n"))

    def assert_near(self, found, truth, share, what):
        """Within `share` of the true value."""
        self.assertLessEqual(abs(found - truth), share * abs(truth), f"{what}: {found}, expected {truth} within {share:.0%}")


def main(make_inputs):
    """Runs the cases of the module that calls it: python3 MODULE AIRTRUTH"""
    global _airtruth, _root
    _airtruth = os.path.abspath(sys.argv.pop(1))
    _root = tempfile.mkdtemp(prefix="airtruth_test_")
    os.environ["XDG_CACHE_HOME"] = path("cache")
    try:
        make_inputs()
        unittest.main(module="__main__", verbosity=1)
    finally:
        shutil.rmtree(_root, ignore_errors=True)
