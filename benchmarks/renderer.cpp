// SPDX-License-Identifier: Apache-2.0
// How long one aircraft's layer takes, and how far its colours are from those of a picture of eight
// times as many pixels a side: ./dev bench renderer [--error] [--still | --exposure] [SIZE_PX...]
// [AIRCRAFT...]
//
// One thread. Each aircraft is seen in random poses (12, 40, 100 and 400 px where no size is
// given), at an instant and during an exposure of 8 ms with 16 ms of readout. Printed: milliseconds
// of processor time a frame, the least of the rounds; with --error the rms, the 99.9 % quantile and
// the largest error of a colour in 8-bit code values over a grey background, and the largest error
// of alpha. Markdown.
#include "picture/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "labels/projection/exact_box.h"

namespace {

using namespace airtruth;

constexpr int kRounds = 20;
constexpr int kPoses = 12;
constexpr int kPosesOfError = 4;
constexpr double kFocalPx = 1500;
constexpr int kQuality = 3;
constexpr int kFiner = 8;  // pixels of the reference along a side of one
// A search box goes beyond the exact box by this much, as the program's own does.
constexpr double kMarginPx = 1.5;

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Scene {
  render::View view;
  render::Instance instance;
  Box search;
};

struct Subject {
  std::shared_ptr<const model::Mesh> mesh;
  shade::Model model;
  projection::SilhouettePoints silhouette;
  double size_m;

  explicit Subject(const std::string& name)
      : mesh(std::make_shared<model::Mesh>(fleet::load_aircraft(name).mesh)),
        model(mesh),
        silhouette{mesh.get(), model::silhouette_points(*mesh)},
        size_m(longest_m()) {}

 private:
  double longest_m() const {
    Eigen::AlignedBox3f box;
    for (const auto& part : silhouette.points)
      for (const Eigen::Vector3f& point : part) box.extend(point);
    return static_cast<double>(box.sizes().maxCoeff());
  }
};

// A frame of `side` pixels, each divided into `finer` by `finer`.
lens::Lens lens_of(int side, int finer = 1) {
  const double focal_px = finer * kFocalPx;
  const double middle_px = finer * side / 2.0;
  return lens::Lens(lens::Pinhole{{focal_px, focal_px}, {middle_px, middle_px}},
                    {finer * side, finer * side});
}

std::vector<Scene> scenes_of(const Subject& subject,
                             double size_px,
                             bool exposes,
                             const lens::Lens& lens) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-180, 180);
  std::vector<Scene> scenes;
  const int side = lens.size().width;
  for (int i = 0; i < kPoses; ++i) {
    const double heading = angle(random);
    const double pitch = angle(random) / 6;
    const double roll = angle(random) / 4;
    Scene scene;
    scene.instance = {&subject.model,
                      {world_from_body({heading, pitch, roll}),
                       Vector3(kFocalPx * subject.size_m / size_px, 0.3, -0.2)}};
    scene.view = {&lens,
                  Rigid{cam_from_body().conjugate(), Vector3::Zero()},
                  Homography::Identity(),
                  side,
                  side};
    if (exposes) {
      scene.view.shutter = {0.008, 0.016, Readout::kDown};
      scene.view.camera = {{20, 0, 0}, {0.05, 0.1, 0.1}};
      scene.instance.twist = {{40, 60, 5}, {0.1, 0, 0.2}};
    }
    const projection::Sight sight{&lens,
                                  scene.view.world_from_cam.inverse(),
                                  Homography::Identity(),
                                  scene.view.shutter,
                                  scene.view.camera};
    const auto exact =
        projection::exact_box(
            sight, subject.silhouette, scene.instance.world_from_body, 0, scene.instance.twist)
            .box;
    if (!exact) continue;
    scene.search = {exact->x - kMarginPx,
                    exact->y - kMarginPx,
                    exact->width + 2 * kMarginPx,
                    exact->height + 2 * kMarginPx};
    scenes.push_back(scene);
  }
  return scenes;
}

image::Layer layer_of(const Scene& scene) {
  return render::render(scene.view, {}, {scene.instance}, {scene.search}, {kQuality});
}

double milliseconds_a_frame(const std::vector<Scene>& scenes) {
  double fastest_s = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    const double begin_s = processor_s();
    for (const Scene& scene : scenes) layer_of(scene);
    fastest_s = std::min(fastest_s, processor_s() - begin_s);
  }
  return 1e3 * fastest_s / static_cast<double>(scenes.size());
}

struct Errors {
  std::vector<double> colour;
  double alpha = 0;
  double distance_m = 0;
};

struct Mean {
  double red = 0, green = 0, blue = 0, alpha = 0, depth = 0;
};

// The layer of the same scene by pixels of an eighth of the size, averaged over each pixel of
// `patch`.
std::vector<Mean> reference_of(const Scene& scene, const PixelBox& patch) {
  const lens::Lens lens = lens_of(scene.view.width, kFiner);
  Scene finer = scene;
  finer.view.lens = &lens;
  finer.view.width = finer.view.height = kFiner * scene.view.width;
  finer.search = {kFiner * scene.search.x,
                  kFiner * scene.search.y,
                  kFiner * scene.search.width,
                  kFiner * scene.search.height};
  const image::Layer layer = layer_of(finer);
  std::vector<Mean> means(static_cast<std::size_t>(patch.width) *
                          static_cast<std::size_t>(patch.height));
  constexpr double kShare = 1.0 / (kFiner * kFiner);
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      if (!patch.contains(x / kFiner, y / kFiner)) continue;
      const std::size_t from = layer.index(x, y);
      const image::LayerPixel& pixel = layer.pixels[from];
      if (!(pixel.alpha > 0)) continue;
      Mean& mean = means[static_cast<std::size_t>(y / kFiner - patch.y) *
                             static_cast<std::size_t>(patch.width) +
                         static_cast<std::size_t>(x / kFiner - patch.x)];
      const double alpha = static_cast<double>(pixel.alpha);
      mean.red += kShare * static_cast<double>(pixel.red);
      mean.green += kShare * static_cast<double>(pixel.green);
      mean.blue += kShare * static_cast<double>(pixel.blue);
      mean.alpha += kShare * alpha;
      mean.depth += kShare * alpha * static_cast<double>(layer.depth_m[from]);
    }
  return means;
}

double code_of(double colour, double alpha) {
  constexpr double kBackground = 0.25;  // linear light
  const double linear = colour + (1 - alpha) * kBackground;
  return 255.0 * static_cast<double>(image::srgb_from_linear(static_cast<float>(linear)));
}

void compare(const Scene& scene, Errors& errors) {
  const image::Layer layer = layer_of(scene);
  const std::vector<Mean> means = reference_of(scene, layer.patch);
  for (std::size_t i = 0; i < means.size(); ++i) {
    const image::LayerPixel& pixel = layer.pixels[i];
    const Mean& mean = means[i];
    const double alpha = static_cast<double>(pixel.alpha);
    if (!(alpha > 0 || mean.alpha > 0)) continue;
    errors.alpha = std::max(errors.alpha, std::abs(alpha - mean.alpha));
    if (alpha > 0 && mean.alpha > 0)
      errors.distance_m =
          std::max(errors.distance_m,
                   std::abs(static_cast<double>(layer.depth_m[i]) - mean.depth / mean.alpha));
    const auto add = [&](float colour, double expected) {
      errors.colour.push_back(
          std::abs(code_of(static_cast<double>(colour), alpha) - code_of(expected, mean.alpha)));
    };
    add(pixel.red, mean.red);
    add(pixel.green, mean.green);
    add(pixel.blue, mean.blue);
  }
}

std::string errors_of(const std::vector<Scene>& scenes) {
  Errors errors;
  for (std::size_t i = 0; i < scenes.size() && i < kPosesOfError; ++i) compare(scenes[i], errors);
  std::sort(errors.colour.begin(), errors.colour.end());
  double squares = 0;
  for (const double e : errors.colour) squares += e * e;
  const auto n = static_cast<double>(errors.colour.size());
  return fmt::format(" {:.2f} | {:.1f} | {:.1f} | {:.4f} | {:.2f} |",
                     std::sqrt(squares / n),
                     errors.colour[static_cast<std::size_t>(0.999 * (n - 1))],
                     errors.colour.back(),
                     errors.alpha,
                     errors.distance_m);
}

void print_table(std::vector<std::string> names) {
  const bool with_errors = std::erase(names, "--error") > 0;
  const bool only_still = std::erase(names, "--still") > 0;
  const bool only_exposure = std::erase(names, "--exposure") > 0;
  std::vector<int> sizes_px;
  std::erase_if(names, [&](const std::string& name) {
    const bool is_size = name.find_first_not_of("0123456789") == std::string::npos;
    if (is_size) sizes_px.push_back(std::stoi(name));
    return is_size;
  });
  if (sizes_px.empty()) sizes_px = {12, 40, 100, 400};
  if (names.empty()) names = {"738/738-Ryanair"};
  fmt::print("| aircraft | size px | | ms a frame |{}\n|---|---|---|---|{}\n",
             with_errors ? " rms | 99.9 % | largest | alpha | distance m |" : "",
             with_errors ? "---|---|---|---|---|" : "");
  for (const std::string& name : names) {
    const Subject subject(name);
    for (const bool exposes : {false, true}) {
      if (exposes ? only_still : only_exposure) continue;
      for (const int size_px : sizes_px) {
        const lens::Lens lens = lens_of(2 * size_px);
        const std::vector<Scene> scenes = scenes_of(subject, size_px, exposes, lens);
        fmt::print("| {} | {} | {} | {:.2f} |{}\n",
                   name,
                   size_px,
                   exposes ? "exposure" : "still",
                   milliseconds_a_frame(scenes),
                   with_errors ? errors_of(scenes) : "");
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  // As airtruth does: memory is kept from one frame to the next.
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (std::find(arguments.begin(), arguments.end(), "--help") != arguments.end()) {
    fmt::print(
        "./dev bench renderer [--error] [--still | --exposure] [SIZE_PX...] [AIRCRAFT...]\n");
    return 0;
  }
  try {
    print_table(arguments);
  } catch (const Error& error) {
    fmt::print(stderr, "renderer_bench: {}\n", error.what());
    return 2;
  }
}
