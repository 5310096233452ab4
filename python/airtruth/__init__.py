# SPDX-License-Identifier: Apache-2.0
"""3D intruders in real onboard video, with the exact truth of every frame.

Arrays are NumPy's. Boxes are (x, y, width, height) in pixels; pixel (0, 0) is the top-left corner of the image and the centre of
the first pixel is (0.5, 0.5). The world is north, east, down in metres; the camera is x right, y down, z forward.

What is wrong with a file or a value is an airtruth.Error of one line; a wrong type is a TypeError, a wrong shape or number a
ValueError. Long calls let other threads of Python run. Renderings and readers belong to the process that made them; frames,
lenses, sequences and data sets can be sent to others. Lenses are equal by their facts, and objects that hold arrays to themselves
alone.
"""

import importlib as _importlib
from types import ModuleType as _ModuleType

from . import evaluate
from ._core import version as __version__
from ._aircraft import Aircraft, AircraftModel, aircraft, left_out_aircraft, show_aircraft
from ._calibrate import Calibration, CameraProfile, Measured, calibrate, camera_profiles
from ._dataset import DataSet, Sequence
from ._encounters import Encounters, sample_encounters
from ._error import Error
from ._frames import Encounter, Frame, FrameTruth, Intruder, Volume
from ._labels import Clip, Label, LabelledFrame, convert_labels, read_labels
from ._lens import Lens
from ._mine import FalseAlarm, HardNegatives, mine
from ._motion import GyroAgreement, Motion, motion
from ._program import run
from ._render import Rendering, render
from ._source import toml_of
from ._stream import Sample, Stream
from ._video import VideoInfo, VideoReader

__all__ = [
    "render", "Rendering", "Frame", "FrameTruth", "Intruder", "Encounter", "Volume", "toml_of",
    "Stream", "Sample",
    "DataSet", "Sequence", "VideoReader", "VideoInfo", "Lens",
    "motion", "Motion", "GyroAgreement",
    "mine", "HardNegatives", "FalseAlarm",
    "calibrate", "Calibration", "Measured", "camera_profiles", "CameraProfile",
    "aircraft", "Aircraft", "left_out_aircraft", "show_aircraft", "AircraftModel",
    "sample_encounters", "Encounters",
    "read_labels", "convert_labels", "Clip", "LabelledFrame", "Label",
    "run",
    "evaluate", "Error",
]

# The package is where they are found, whatever module holds them.
for _name in __all__:
    if isinstance(globals()[_name], type) or callable(globals()[_name]):
        globals()[_name].__module__ = __name__


def __getattr__(name: str) -> _ModuleType:
    """airtruth.torch is imported where it is first used; nothing else needs torch."""
    if name == "torch":
        return _importlib.import_module(".torch", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
