# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
import pathlib
from dataclasses import dataclass
from typing import Dict, List, Optional

from . import _core
from ._video import Path


@dataclass
class Aircraft:
    """One name of the catalogue: a model in one livery, with the published size of its type."""

    name: str  # as scenes name it; what stands before the slash is the model's folder
    type: str  # "Cessna 172P", or in words what it is where it is no type of aircraft; empty where nothing is published
    span_m: Optional[float]  # published; None: unknown
    length_m: Optional[float]
    height_m: Optional[float]
    source: str  # where they are published


@dataclass
class AircraftModel:
    """An aircraft as its model has it."""

    name: str
    file: pathlib.Path
    length_m: float
    span_m: float
    height_m: float
    triangles: int
    textures: int
    catalogue_scale: float  # by which a model of the catalogue is brought to its published size
    liveries: List[str]  # names of the same model in other liveries


def aircraft(filter: str = "") -> List[Aircraft]:
    """The aircraft that can be flown, sorted by name, as `airtruth aircraft list` tells them.

    `filter`: names that contain this, or that it fits with * and ?, whatever the case of letters. airtruth.Error with the nearest names
    where there is none.

    >>> [(one.name, one.type, one.span_m) for one in airtruth.aircraft("c172/n*")]
    [('c172/n4456r', 'Cessna 172P', 11.0), ('c172/n737bq', 'Cessna 172P', 11.0), ('c172/news', 'Cessna 172P', 11.0)]
    >>> len({one.type for one in airtruth.aircraft()}) > 100
    True
    """
    return [Aircraft(**fields) for fields in _core.aircraft(filter)]


def left_out_aircraft(filter: str = "") -> Dict[str, str]:
    """Names of the installed package that are not offered, with the reason. `filter` as in aircraft().

    >>> len(airtruth.left_out_aircraft()) > 10
    True
    """
    return _core.left_out_aircraft(filter)


def show_aircraft(name: Path, *, forward: str = "", up: str = "", scale: float = 0) -> AircraftModel:
    """Reads one aircraft: a name of aircraft(), or a model file (.ac .obj .3ds .stl .ply .dae .gltf .glb .fbx, FlightGear's .xml),
    which a confined process reads. Of a model file that does not state them, `forward` and `up` are the axes (x, -y, ...) that are
    the nose and up, and `scale` is the metres per unit.

    >>> news = airtruth.show_aircraft("c172/news")
    >>> round(news.span_m, 2), round(news.catalogue_scale, 3), len(news.liveries)
    (11.0, 1.142, 11)
    """
    return AircraftModel(**_core.show_aircraft(os.fspath(name), forward, up, scale))
