# SPDX-License-Identifier: Apache-2.0
"""What a notebook shows: pictures as PNG, and tables."""

from __future__ import annotations

import base64
import html
import math
import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

from ._error import Error
from ._frames import Frame, Numbers, Samples, rows_of

if TYPE_CHECKING:
    from ._dataset import DataSet

_BOX_RGB = (255, 160, 0)
_MOST_ROWS = 50


def _png(rgb: Samples) -> bytes:
    height, width, _ = rgb.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + rgb[y].tobytes() for y in range(height))  # each row with filter 0
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b"")


def _draw_box(rgb: Samples, box: Numbers) -> None:
    """A line of one pixel around the box, as far as it is in the picture."""
    height, width, _ = rgb.shape
    x, y, w, h = (float(value) for value in box)
    left, right = (max(-1, min(width, math.floor(v))) for v in (x - 1, math.ceil(x + w)))
    top, bottom = (max(-1, min(height, math.floor(v))) for v in (y - 1, math.ceil(y + h)))
    rows, columns = slice(max(0, top), bottom + 1), slice(max(0, left), right + 1)
    for line in (top, bottom):
        if 0 <= line < height:
            rgb[line, columns] = _BOX_RGB
    for line in (left, right):
        if 0 <= line < width:
            rgb[rows, line] = _BOX_RGB


def html_of_frame(frame: Frame) -> str:
    rgb = frame.rgb
    words = [f"frame {frame.index}, {frame.time_s:.3f} s"]
    for intruder, covered, exact in zip(frame.intruders, rows_of(frame.boxes()), rows_of(frame.boxes("exact"))):
        box = exact if np.isnan(covered).any() else covered
        if np.isfinite(box).all():
            _draw_box(rgb, box)
        distance = "" if intruder.range_m is None else f", {intruder.range_m:.0f} m"
        words.append(f"{intruder.id}: {intruder.state}{distance}")
    data = base64.b64encode(_png(rgb)).decode()
    return f'<img alt="frame {frame.index}" src="data:image/png;base64,{data}"><br>{html.escape("; ".join(words))}'


def html_of_set(data: DataSet) -> str:
    rows = []
    for name in data.names[:_MOST_ROWS]:
        try:
            sequence = data[name]
            aircraft = ", ".join(sorted(set(map(str, sequence.truth["aircraft"]))))
            cells = [name, str(len(sequence)), aircraft]
        except Error as error:
            cells = [name, "", str(error)]
        rows.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>")
    more = len(data.names) - _MOST_ROWS
    if more > 0:
        rows.append(f"<tr><td>and {more} more</td><td></td><td></td></tr>")
    return "<table><tr><th>sequence</th><th>frames</th><th>aircraft</th></tr>" + "".join(rows) + "</table>"
