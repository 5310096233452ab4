// SPDX-License-Identifier: Apache-2.0
// Reads a data set: its sequences, their frames and the truth of each frame.
//
//   read_dataset SET
#include <cstdio>
#include <string>

#include <airtruth/dataset.h>
#include <airtruth/error.h>
#include <airtruth/video.h>

int main(int argc, char** argv) try {
  if (argc != 2) throw airtruth::Error("expected SET");
  const airtruth::DataSet set(argv[1]);
  for (const std::string& name : set.names()) {
    const airtruth::Sequence sequence = set.sequence(name);
    if (!sequence.truth) continue;  // an imported clip has labels alone
    airtruth::VideoReader video(sequence.video);
    while (const auto frame = video.next()) {
      const auto& truth = sequence.truth->frames.at(static_cast<std::size_t>(frame->index));
      for (const airtruth::IntruderTruth& intruder : truth.intruders) {
        if (!intruder.covered_box_px) continue;
        const airtruth::PixelBox& box = *intruder.covered_box_px;
        std::printf("%s %d %s %d %d %d %d %.17g luma %d\n",
                    name.c_str(),
                    static_cast<int>(frame->index),
                    intruder.id.c_str(),
                    box.x,
                    box.y,
                    box.width,
                    box.height,
                    *intruder.range_m,
                    frame->picture.planes[0].row(box.y)[box.x]);
      }
    }
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
