# SPDX-License-Identifier: Apache-2.0
"""A tracker that looks for the first frame's picture of its object around where it was last, in plain Python; of several objects at a
time with --several.

    airtruth track DIR --tracker "trax:python3 template_tracker.py" --out results
"""

import sys

from airtruth_trax import Server, TraxError, decodable

SEARCH_PX = 24  # each way
MOST_SAMPLES = 64  # of the object that are compared
# From the middle outward, so that most places are given up early.
OFFSETS = sorted((dx * dx + dy * dy, dx, dy) for dx in range(-SEARCH_PX, SEARCH_PX + 1) for dy in range(-SEARCH_PX, SEARCH_PX + 1))


def green(pixels, x, y):
    width, height, samples = pixels
    return samples[3 * (min(max(y, 0), height - 1) * width + min(max(x, 0), width - 1)) + 1]


class Follower:
    def __init__(self, region, pixels):
        self.region = region
        # Samples spread over the object and one pixel around it: (dx, dy, level).
        x, y, w, h = (round(v) for v in region)
        step = max(1, round(((w + 2) * (h + 2) / MOST_SAMPLES) ** 0.5))
        self._model = [(dx, dy, green(pixels, x + dx, y + dy)) for dy in range(-1, h + 1, step) for dx in range(-1, w + 1, step)]

    def _difference(self, pixels, x, y, most):
        total = 0
        for dx, dy, level in self._model:
            total += abs(green(pixels, x + dx, y + dy) - level)
            if total >= most:
                break
        return total

    def follow(self, pixels):
        x, y = round(self.region[0]), round(self.region[1])
        best, place = float("inf"), (x, y)
        for _, dx, dy in OFFSETS:
            found = self._difference(pixels, x + dx, y + dy, best)
            if found < best:
                best, place = found, (x + dx, y + dy)
        self.region = (*place, *self.region[2:])
        return self.region, 1 / (1 + best / len(self._model)), {}


def run(server):
    followers = []
    for request in server:
        pixels = request.pixels()
        if request.begins:
            followers = []
        answers = [follower.follow(pixels) for follower in followers]
        for region, _ in request.objects:
            followers.append(Follower(region, pixels))
            answers.append(region)
        server.reply_all(answers)


def main():
    server = Server("template-python", images=decodable(), takes_several="--several" in sys.argv)
    try:
        run(server)
    except TraxError as error:
        server.quit(str(error))
        sys.exit(f"template_tracker: {error}")


if __name__ == "__main__":
    main()
