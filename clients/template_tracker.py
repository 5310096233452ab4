# SPDX-License-Identifier: Apache-2.0
"""A tracker that looks for the first frame's picture of its object around where it was last, in plain Python.

    airtruth track DIR --tracker "trax:python3 template_tracker.py" --out results
"""

from airtruth_trax import Server

SEARCH_PX = 24  # each way
MOST_SAMPLES = 64  # of the object that are compared


def green(pixels, x, y):
    width, height, samples = pixels
    return samples[3 * (min(max(y, 0), height - 1) * width + min(max(x, 0), width - 1)) + 1]


def model_of(pixels, region):
    """Samples spread over the object and one pixel around it: (dx, dy, level)."""
    x, y, w, h = (round(v) for v in region)
    step = max(1, round(((w + 2) * (h + 2) / MOST_SAMPLES) ** 0.5))
    return [(dx, dy, green(pixels, x + dx, y + dy)) for dy in range(-1, h + 1, step) for dx in range(-1, w + 1, step)]


def difference(pixels, model, x, y, most):
    total = 0
    for dx, dy, level in model:
        total += abs(green(pixels, x + dx, y + dy) - level)
        if total >= most:
            break
    return total


def main():
    server = Server("template-python", images="memory")
    for request in server:
        pixels = request.pixels()
        if request.begins:
            region = request.region
            model = model_of(pixels, region)
            server.reply(region)
            continue
        x, y = round(region[0]), round(region[1])
        best, place = float("inf"), (x, y)
        # From the middle outward, so that most places are given up early.
        offsets = sorted(((dx * dx + dy * dy, dx, dy) for dx in range(-SEARCH_PX, SEARCH_PX + 1)
                          for dy in range(-SEARCH_PX, SEARCH_PX + 1)))
        for _, dx, dy in offsets:
            found = difference(pixels, model, x + dx, y + dy, best)
            if found < best:
                best, place = found, (x + dx, y + dy)
        region = (*place, *region[2:])
        server.reply(region, confidence=1 / (1 + best / len(model)))


if __name__ == "__main__":
    main()
