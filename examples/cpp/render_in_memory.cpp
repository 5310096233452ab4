// SPDX-License-Identifier: Apache-2.0
// Puts a scene's intruders into its video, frame by frame in memory, with the truth of each frame:
// what a training loop reads. No file is written.
//
//   render_in_memory SCENE.toml
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/renderer.h>

int main(int argc, char** argv) try {
  if (argc != 2) throw airtruth::Error("expected SCENE.toml");
  airtruth::RenderOptions options;
  options.use_cache = false;
  options.warn = [](const std::string& message) { std::fprintf(stderr, "%s\n", message.c_str()); };
  airtruth::Renderer renderer(argv[1], options);
  while (const auto frame = renderer.next()) {
    const std::vector<std::uint8_t> rgb = rgb_of(frame->picture);  // width * height * 3
    const double mean = std::accumulate(rgb.begin(), rgb.end(), 0.0) / double(rgb.size());
    std::fprintf(stderr, "frame %d: mean %.2f\n", static_cast<int>(frame->truth.frame), mean);
    std::printf("%s\n", truth_line(frame->truth, renderer.lens()).c_str());
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
