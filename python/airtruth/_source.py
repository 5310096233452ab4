# SPDX-License-Identifier: Apache-2.0
"""Scenes and catalogues as callers give them: a path, a text or a dict."""

from __future__ import annotations

import json
import math
import os
import pathlib
from typing import Any, Mapping, Optional, Tuple, Union

import numpy as np

from ._video import Path

Source = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def _value(value: Any, where: str) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value)) if math.isfinite(value) else str(float(value))
    if isinstance(value, (str, os.PathLike)):
        # Control characters are the one difference between the strings of JSON and of TOML.
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(one, where) for one in value) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key, where)} = {_value(one, f'{where}.{key}')}" for key, one in value.items()) + "}"
    raise TypeError(f"{where} is a {type(value).__name__}; expected a number, a text, a list or a dict")


def _key(key: Any, where: str) -> str:
    if not isinstance(key, str):
        raise TypeError(f"{where} has the key {key!r}; expected a text")
    return json.dumps(key, ensure_ascii=False)


def toml_of(source: Mapping[str, Any]) -> str:
    """A dict of the keys of a scene or a catalogue as the text of its file, a line for each key.

    >>> print(airtruth.toml_of({"name": "a", "camera": {"position_ned_m": (0, 0, -150)}}))
    "name" = "a"
    "camera" = {"position_ned_m" = [0, 0, -150]}
    <BLANKLINE>
    """
    if not isinstance(source, Mapping):
        raise TypeError(f"source is of the type {type(source).__name__}; expected a dict")
    try:
        return "".join(f"{_key(key, 'the dict')} = {_value(value, str(key))}\n" for key, value in source.items())
    except RecursionError:
        raise ValueError("the dict holds itself, or lies too deep") from None


def source_of(source: Source, folder: Optional[Path]) -> Tuple[Union[str, pathlib.Path], str]:
    """The text or the path, and the folder that relative paths of a text belong to."""
    base = os.fspath(folder) if folder is not None else os.getcwd()
    if isinstance(source, Mapping):
        return toml_of(source), base
    if isinstance(source, str) and "\n" in source:
        return source, base
    return pathlib.Path(source), base


def cache_of(cache: Union[bool, Path]) -> Union[bool, pathlib.Path]:
    return cache if isinstance(cache, bool) else pathlib.Path(cache)
