# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import warnings
from typing import IO, Any, Dict, Iterator, List, Optional, Sequence

from . import _core
from ._error import Error
from ._progress import Line, Progress, checked
from ._video import Path

_END_S = 5  # for the program to end by itself once it is told to


def _program() -> str:
    """The program `airtruth` of this package: in its build or beside it in the system, else the one that the shell finds."""
    stated = os.environ.get("AIRTRUTH_PROGRAM")
    if stated:
        return stated
    package = pathlib.Path(_core.__file__).parent
    for place in (package.parents[1] / "src" / "cli" / "airtruth", package.parents[3] / "bin" / "airtruth"):
        if os.access(place, os.X_OK):
            return str(place)
    found = shutil.which("airtruth")
    if found is None:
        raise Error("the program airtruth is not installed; install airtruth whole, or set AIRTRUTH_PROGRAM to it")
    return found


def _options(options: Dict[str, Any]) -> Iterator[str]:
    for name, value in options.items():
        flag = f"--{name.rstrip('_').replace('_', '-')}"
        if value is None or value is False:
            continue
        if value is True:
            yield flag
        elif isinstance(value, (list, tuple)):
            yield from (f"{flag}={one}" for one in value)
        else:
            yield f"{flag}={os.fspath(value) if isinstance(value, os.PathLike) else value}"


@contextlib.contextmanager
def _ended(process: subprocess.Popen[bytes]) -> Iterator[None]:
    """The program ends with this block, whatever ends it: told to first, which leaves nothing half-made behind."""
    try:
        yield
    except BaseException:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
        raise
    finally:
        process.wait()


class _Log:
    """What the program writes on standard error: a JSON object a line (`--json-log`)."""

    def __init__(self, progress: Optional[Progress]) -> None:
        self.errors: List[str] = []
        self.warnings: List[str] = []
        self._line = Line("")
        self._progress = progress

    def read(self, stream: IO[bytes]) -> None:
        try:
            for text in stream:
                self._take(text.decode(errors="replace").rstrip("\n"))
        finally:
            self._line.erase()

    def _take(self, text: str) -> None:
        try:
            said = json.loads(text)
            level, message = said["level"], said.get("message", "")
        except (ValueError, TypeError, KeyError):  # of a child of the program
            level, message = "warning", text
        if level != "progress":
            (self.errors if level == "error" else self.warnings).append(" ".join(message.splitlines()))
        elif self._progress:
            self._progress(said["done"], said["total"])
        else:
            self._line.draw(said["done"], said["total"], said["stage"])


def run_from(depth: int, command: str, arguments: Sequence[Path], options: Dict[str, Any], progress: Optional[Progress]) -> str:
    """run() for a function of the package; `depth`: of the frame that warnings are of, as `stacklevel` counts from here."""
    log = _Log(checked(progress))
    line = [_program(), *command.split(), "--json-log", *_options(options), "--", *(os.fspath(argument) for argument in arguments)]
    try:
        # In a group of its own: a terminal's Ctrl-C reaches it once, from here.
        process = subprocess.Popen(
            line, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
        )
    except OSError as error:
        raise Error(f"{line[0]}: {error.strerror}") from None
    results, messages = process.stdout, process.stderr
    assert results is not None and messages is not None
    printed: List[bytes] = []
    reader = threading.Thread(target=printed.extend, args=(results,), daemon=True)
    with results, messages, _ended(process):
        reader.start()
        log.read(messages)
        reader.join()
    failed = None
    if process.returncode != 0:
        said = log.errors or log.warnings  # a detector that breaks off is a warning of the program
        failed = Error(said.pop() if said else f"airtruth {command} ended with status {process.returncode}")
    for remark in log.warnings + log.errors:
        warnings.warn(remark, stacklevel=depth)
    if failed:
        raise failed
    return b"".join(printed).decode(errors="replace")


def run(command: str, *arguments: Path, progress: Optional[Progress] = None, **options: Any) -> str:
    """Runs a command of the program `airtruth`, and returns what it prints. Commands, options and defaults are those of the command
    line (docs/reference/commands.md).

    `command`: its name, "render" or "dataset build". `arguments`: what stands without an option, in the command line's order.
    `options` by their names, with _ in place of -, and class_ for --class: out="set" is --out=set; True is the option alone; False and
    None leave it out; a list repeats it.
    `progress(done, total)` is called as the work goes on; without it a terminal shows a line.

    airtruth.Error holds the program's own line, and what the program warns of goes to Python's `warnings`, as do the errors before the
    last. Ctrl-C ends the work within 2 s, and leaves nothing half-made behind.

    >>> airtruth.run("synth", out="flight.mkv", frames=8, width=160, height=120)
    'flight.mkv: 8 frames of 160x120\\n'
    >>> airtruth.run("overlay", "set/across", out="boxes.mp4")
    'boxes.mp4: 6 frames\\n'
    >>> airtruth.run("dataset verify", "none")
    Traceback (most recent call last):
    airtruth.Error: none: ...
    """
    if not isinstance(command, str):
        raise TypeError(f"command is of the type {type(command).__name__}; expected a text")
    return run_from(3, command, arguments, options, progress)
