// SPDX-License-Identifier: Apache-2.0
// How long one aircraft's layer takes, and how far its colours are from those of 4,096 rays a
// pixel: ./dev bench renderer [--error] [--still | --exposure] [SIZE_PX...] [AIRCRAFT...]
//
// One thread. Each aircraft is seen in random poses (12, 40, 100 and 400 px where no size is given),
// at an instant and during an exposure of 8 ms with 16 ms of readout. Printed: milliseconds of processor time a frame,
// the least of the rounds; with --error the rms, the 99.9 % quantile and the largest error of a
// colour in 8-bit code values over a grey background, and the largest error of alpha. Markdown.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/image/colour.h"
#include "picture/render/renderer.h"
#include "truth/projection/exact_box.h"

namespace {

using namespace airtruth;

constexpr int kRounds = 5;
constexpr int kPoses = 12;
constexpr int kPosesOfError = 4;
constexpr double kFocalPx = 1500;
constexpr int kQuality = 3;
constexpr int kReference = 5;  // 4,096 rays a pixel
// A search box goes beyond the exact box by this much, as the program's own does.
constexpr double kMarginPx = 1.5;

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Scene {
  render::View view;
  render::Instance instance;
  Box search;
};

struct Subject {
  std::shared_ptr<const aircraft::Mesh> mesh;
  render::Model model;
  projection::SilhouettePoints silhouette;
  double size_m;

  explicit Subject(const std::string& name)
      : mesh(std::make_shared<aircraft::Mesh>(aircraft::load_aircraft(name).mesh)),
        model(mesh),
        silhouette{mesh.get(), aircraft::silhouette_points(*mesh)},
        size_m(longest_m()) {}

 private:
  double longest_m() const {
    Eigen::AlignedBox3f box;
    for (const auto& part : silhouette.points)
      for (const Eigen::Vector3f& point : part) box.extend(point);
    return static_cast<double>(box.sizes().maxCoeff());
  }
};

lens::Lens lens_of(int side) {
  return lens::Lens(lens::Pinhole{{kFocalPx, kFocalPx}, {side / 2.0, side / 2.0}}, {side, side});
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
    const auto exact = projection::exact_box(sight,
                                             subject.silhouette,
                                             scene.instance.world_from_body,
                                             0,
                                             scene.instance.twist)
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

image::Layer layer_of(const Scene& scene, int quality) {
  return render::render(scene.view, {}, {scene.instance}, {scene.search}, {quality});
}

double milliseconds_a_frame(const std::vector<Scene>& scenes) {
  double fastest_s = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    const double begin_s = processor_s();
    for (const Scene& scene : scenes) layer_of(scene, kQuality);
    fastest_s = std::min(fastest_s, processor_s() - begin_s);
  }
  return 1e3 * fastest_s / static_cast<double>(scenes.size());
}

struct Errors {
  std::vector<double> colour;
  double alpha = 0;
  double distance_m = 0;
};

double code_of(float colour, float alpha) {
  constexpr float kBackground = 0.25f;  // linear light
  return 255.0 * static_cast<double>(image::srgb_from_linear(colour + (1 - alpha) * kBackground));
}

void compare(const Scene& scene, Errors& errors) {
  const image::Layer here = layer_of(scene, kQuality);
  const image::Layer there = layer_of(scene, kReference);
  for (std::size_t i = 0; i < here.pixels.size(); ++i) {
    const image::LayerPixel& p = here.pixels[i];
    const image::LayerPixel& q = there.pixels[i];
    if (!(p.alpha > 0 || q.alpha > 0)) continue;
    errors.alpha = std::max(errors.alpha, std::abs(static_cast<double>(p.alpha - q.alpha)));
    if (p.alpha > 0 && q.alpha > 0)
      errors.distance_m = std::max(
          errors.distance_m, std::abs(static_cast<double>(here.depth_m[i] - there.depth_m[i])));
    for (const auto channel :
         {&image::LayerPixel::red, &image::LayerPixel::green, &image::LayerPixel::blue})
      errors.colour.push_back(std::abs(code_of(p.*channel, p.alpha) - code_of(q.*channel, q.alpha)));
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

}  // namespace

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<std::string> names(argv + 1, argv + argc);
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
