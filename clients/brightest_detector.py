# SPDX-License-Identifier: Apache-2.0
"""A detector that finds the brightest pixel of every frame, in plain Python: what a program of one's own begins with.

    airtruth detect DIR --detector "brightest=exec:python3 brightest_detector.py" --out results
"""

import sys

from airtruth_detector import Server, detection


def main():
    server = Server(samples="gray", frames="shared_memory" if "--shared" in sys.argv else "pipe")
    for frame in server:
        samples = bytes(frame.samples)
        most = max(samples)
        y, x = divmod(samples.index(most), frame.sequence.width)
        server.reply([detection((x - 2, y - 2, 5, 5), most / 255)])


if __name__ == "__main__":
    main()
