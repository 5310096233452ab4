# SPDX-License-Identifier: Apache-2.0
"""Clips whose frames carry their number as pixels, so that a page can be asked which frame it shows."""

import os
import struct
import zlib

WIDTH, HEIGHT, BLOCK = 320, 240, 24

# In a page: the number that the picture on a canvas (or in a video) carries, whatever its size.
READ_NUMBER = """
const numberOn = (picture) => {
  const copy = document.createElement('canvas');
  copy.width = 320; copy.height = 240;
  const context = copy.getContext('2d', { willReadFrequently: true });
  context.drawImage(picture, 0, 0, 320, 240);
  let number = 0;
  for (let bit = 0; bit < 12; ++bit) {
    const [r, g, b] = context.getImageData((bit % 4) * 24 + 12, Math.floor(bit / 4) * 24 + 12, 1, 1).data;
    if (r + g + b > 384) number += 1 << bit;
  }
  return number;
};
"""


def rows_of(number):
    """Grey, with twelve bits of the number as blocks in the upper left corner: black or white."""
    rows = []
    for y in range(HEIGHT):
        row = bytearray([128 + (x + y + number) % 16 for x in range(WIDTH)])
        if y < 3 * BLOCK:
            for column in range(4):
                bit = 4 * (y // BLOCK) + column
                row[column * BLOCK:(column + 1) * BLOCK] = bytes([235 if number >> bit & 1 else 20]) * BLOCK
        rows.append(bytes(row))
    return rows


def box_of(number):
    """Where the target is: a box that wanders below the blocks."""
    return (100 + number, 120, 20, 14)


def write_png(path, number):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    data = zlib.compress(b"".join(b"\0" + row for row in rows_of(number)))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)) +
                   chunk(b"IDAT", data) + chunk(b"IEND", b""))


def write_otb(root, names, count):
    """Clips in OTB's form below `root`: pictures 0001.png on, which carry 0, 1, ..."""
    for name in names:
        os.makedirs(os.path.join(root, name, "img"))
        for number in range(count):
            write_png(os.path.join(root, name, "img", f"{number + 1:04}.png"), number)
        with open(os.path.join(root, name, "groundtruth_rect.txt"), "w", encoding="utf-8") as file:
            for number in range(count):
                x, y, width, height = box_of(number)
                file.write(f"{x + 1},{y + 1},{width},{height}\n")  # OTB's first pixel is 1
