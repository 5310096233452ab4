// SPDX-License-Identifier: Apache-2.0
#include "comparison/evision/evision_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include <Eigen/Cholesky>

#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/median.h"
#include "foundation/base/text.h"
#include "labels/annotation/evision.h"
#include "labels/projection/exact_box.h"
#include "picture/render/renderer.h"
#include "scene/trajectory/path.h"

namespace airtruth::evision {
namespace {

// The data set's virtual camera (evision_table.h): its size and focal length, px, and its rate.
constexpr int kWidth = 1280;
constexpr int kHeight = 960;
constexpr double kFocalPx = 480;
constexpr double kRateHz = 30;
// Positions further away are invalid.
constexpr double kFarthestM = 1e5;

struct Position {
  int number = 0;  // of the frame, from 1
  Vector3 camera_ned_m;
  Vector3 intruder_ned_m;
};

bool is_defined(const Position& p) {
  return p.intruder_ned_m.allFinite() && p.intruder_ned_m.norm() < kFarthestM &&
         !p.intruder_ned_m.isZero();
}

// frame,camera_n_m,camera_e_m,camera_d_m,intruder_n_m,intruder_e_m,intruder_d_m; undefined
// positions left out.
std::vector<Position> read_positions(const fs::path& file) {
  std::istringstream text(read_file(file));
  std::vector<Position> result;
  std::string line;
  std::getline(text, line);
  for (int row = 2; std::getline(text, line); ++row) {
    std::array<double, 7> cell{};
    const std::vector<std::string> texts = cells_of(line);
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const auto number = i < texts.size() ? number_from_text<double>(texts[i]) : std::nullopt;
      if (!number)
        throw Error("'" + line + "'; expected frame and six coordinates", {file.string(), row});
      cell[i] = *number;
    }
    const Position p{
        static_cast<int>(cell[0]), {cell[1], cell[2], cell[3]}, {cell[4], cell[5], cell[6]}};
    if (is_defined(p)) result.push_back(p);
  }
  return result;
}

trajectory::Path path_through(const std::vector<Position>& positions, bool bank) {
  std::vector<Vector3> points;
  std::vector<double> times;
  for (const Position& p : positions) {
    points.push_back(p.intruder_ned_m);
    times.push_back((p.number - 1) / kRateHz);
  }
  trajectory::AttitudeOverride attitude;
  if (!bank) attitude.roll_deg = 0;
  return trajectory::spline_at_times(points, times, attitude);
}

// An aircraft, ready to be projected and to be rendered.
struct Model {
  fleet::Aircraft aircraft;
  projection::SilhouettePoints silhouette;
  shade::Model rays;

  explicit Model(fleet::Aircraft loaded)
      : aircraft(std::move(loaded)),
        silhouette{&aircraft.mesh, model::silhouette_points(aircraft.mesh)},
        rays(aircraft.mesh) {}
  Model(const Model&) = delete;
};

// One frame of one sequence: where things are, and what was published.
struct Frame {
  int number = 0;
  double time_s = 0;
  Rigid from_camera;  // the intruder, in a world about the camera
  PixelBox published;
  Homography frame_from_nominal = Homography::Identity();
};

struct Sequence {
  std::string name;
  const Model* model = nullptr;
  std::vector<Frame> frames;
};

const lens::Lens& pinhole() {
  static const lens::Lens lens = lens::undistorted(false, kFocalPx, {kWidth, kHeight});
  return lens;
}

Rigid looking_north() { return {cam_from_body(), Vector3::Zero()}; }

// Of the projected outline, not clipped; empty where it has none.
std::optional<Box> outline_box(const Model& model, const Frame& frame) {
  const projection::Sight sight{&pinhole(), looking_north(), frame.frame_from_nominal};
  return projection::exact_box(sight, model.silhouette, frame.from_camera, frame.time_s).box;
}

// The pixels that a colour key selects: those of which at least a third is covered, or else the one
// that is covered most.
std::optional<PixelBox> keyed_box(const Model& model, const Frame& frame, const Box& outline) {
  constexpr float kKeyed = 0.3f;  // share of a pixel: "at least a third"
  const render::View view{
      &pinhole(), looking_north().inverse(), frame.frame_from_nominal.inverse(), kWidth, kHeight};
  const Box search{outline.x - 1, outline.y - 1, outline.width + 2, outline.height + 2};
  const image::Layer layer = render::render(
      view, {}, {{&model.rays, frame.from_camera, frame.time_s}}, {search}, {.quality = 2});
  if (layer.empty()) return std::nullopt;
  float most = 0;
  for (const image::LayerPixel& pixel : layer.pixels) most = std::max(most, pixel.alpha);
  if (most == 0) return std::nullopt;
  std::optional<PixelBox> box;
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y) {
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      if (layer.pixels[layer.index(x, y)].alpha < std::min(kKeyed, most)) continue;
      const PixelBox pixel{x, y, 1, 1};
      box = box ? bounds(*box, pixel) : pixel;
    }
  }
  return box;
}

bool is_box(const PixelBox& box) { return box.width > 0 && box.height > 0; }

bool is_in_picture(double x, double y) { return x >= 0 && x < kWidth && y >= 0 && y < kHeight; }

bool touches_border(const PixelBox& box) {
  constexpr int kNear = 3;  // px, as EvisionOptions::spread_px
  return box.x < kNear || box.y < kNear || box.right() > kWidth - kNear ||
         box.bottom() > kHeight - kNear;
}

EvisionOffsets offsets_of(const PixelBox& ours, const PixelBox& published) {
  const double width = published.width, height = published.height;
  const double width_off = std::abs(ours.width - published.width);
  const double height_off = std::abs(ours.height - published.height);
  const Pixel centre_off = centre_of(as_box(ours)) - centre_of(as_box(published));
  return {width,
          height,
          width_off,
          height_off,
          width_off / width,
          height_off / height,
          std::hypot(centre_off.x(), centre_off.y())};
}

double quantile(const std::vector<EvisionOffsets>& compared,
                double EvisionOffsets::*of,
                double share) {
  if (compared.empty()) return 0;
  std::vector<double> values;
  for (const EvisionOffsets& one : compared) values.push_back(one.*of);
  return nth_smallest(
      values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5));
}

Sequence read_sequence(const fs::path& groundtruth,
                       const fs::path& positions_file,
                       const Model& model,
                       bool bank) {
  const annotation::Evision published = annotation::read_evision(groundtruth);
  const std::vector<Position> positions = read_positions(positions_file);
  if (positions.size() < 2)
    throw Error("fewer than two defined positions", {positions_file.string()});
  std::map<int, PixelBox> boxes;
  for (const auto& frame : published.frames)
    if (frame) boxes[frame->number] = frame->rect_px;
  const trajectory::Path path = path_through(positions, bank);
  Sequence sequence{groundtruth.stem().string(), &model, {}};
  for (const Position& position : positions) {
    const auto box = boxes.find(position.number);
    if (box == boxes.end()) continue;
    const double time_s = (position.number - 1) / kRateHz;
    const Quaternion world_from_body = path.at(std::min(time_s, path.end_s()))->world_from_body;
    sequence.frames.push_back({position.number,
                               time_s,
                               {world_from_body, position.intruder_ned_m - position.camera_ned_m},
                               box->second,
                               Homography::Identity()});
  }
  return sequence;
}

// Gives every frame the homography that its background had at that time, from the centres of the
// published boxes.
void recover_motion(std::vector<Sequence>& sequences) {
  std::map<std::pair<char, int>, std::vector<Sighting>>
      sightings;  // of a background (a name's first letter) and frame
  for (const Sequence& sequence : sequences) {
    for (const Frame& frame : sequence.frames) {
      const PixelBox& p = frame.published;
      const auto still = outline_box(*sequence.model, frame);
      if (!still || !is_box(p) || touches_border(p)) continue;
      sightings[{sequence.name[0], frame.number}].push_back(
          {{still->x + still->width / 2, still->y + still->height / 2},
           {p.x + p.width / 2.0, p.y + p.height / 2.0}});
    }
  }
  for (Sequence& sequence : sequences)
    for (Frame& frame : sequence.frames)
      frame.frame_from_nominal = motion_from_sightings(
          sightings[{sequence.name[0], frame.number}], {kWidth / 2.0, kHeight / 2.0}, kFocalPx);
}

EvisionRow compare(const Sequence& sequence, const EvisionOptions& options) {
  EvisionRow row;
  row.sequence = sequence.name;
  std::vector<EvisionOffsets> compared;
  for (const Frame& frame : sequence.frames) {
    if (options.stop.stop_requested()) throw Interrupted();
    ++row.frames;
    row.published_boxes += is_box(frame.published) ? 1 : 0;
    const std::optional<Box> outline = outline_box(*sequence.model, frame);
    // The box as published files would have it; empty where the intruder is not in the picture.
    auto ours = outline ? keyed_box(*sequence.model, frame, *outline) : std::nullopt;
    const bool centre_in_view =
        outline && is_in_picture(outline->x + outline->width / 2, outline->y + outline->height / 2);
    if (!ours && centre_in_view) ++row.without_box_ours;
    const bool whole = ours && !touches_border(*ours);
    if (whole && !is_box(frame.published)) ++row.without_box_published;
    if (ours) ours = wider(*ours, frame.number == 1 ? 0 : options.spread_px);
    if (whole && is_box(frame.published) && !touches_border(frame.published))
      compared.push_back(offsets_of(*ours, frame.published));
    if (options.each) options.each({sequence.name, frame.number, ours, frame.published});
  }
  row.compared = static_cast<int>(compared.size());
  for (double EvisionOffsets::*of : {&EvisionOffsets::published_width_px,
                                     &EvisionOffsets::published_height_px,
                                     &EvisionOffsets::width_off_px,
                                     &EvisionOffsets::height_off_px,
                                     &EvisionOffsets::width_off,
                                     &EvisionOffsets::height_off,
                                     &EvisionOffsets::centre_off_px})
    row.*of = quantile(compared, of, 0.5);
  row.centre_off_p95_px = quantile(compared, &EvisionOffsets::centre_off_px, 0.95);
  return row;
}

std::vector<fs::path> groundtruth_files(const fs::path& folder) {
  if (!fs::is_directory(folder / "groundtruth"))
    throw Error("is no folder; expected the E-Vision annotations with groundtruth/ and positions/",
                {(folder / "groundtruth").string()});
  std::vector<fs::path> files = files_with(folder / "groundtruth", ".xml");
  if (files.empty()) throw Error("holds no .xml", {(folder / "groundtruth").string()});
  return files;
}

}  // namespace

std::vector<EvisionRow> evision_table(const fs::path& folder,
                                      const EvisionOptions& options,
                                      const Warn& warn) {
  const std::vector<fs::path> files = groundtruth_files(folder);
  const model::LoadOptions size{.catalogue_scale = options.scale};
  const Model airliner(fleet::load_aircraft(options.airliner, size, warn));
  const Model light(fleet::load_aircraft(options.light_aircraft, size, warn));
  std::vector<Sequence> sequences;
  for (const fs::path& file : files) {
    const bool is_light = file.stem().string().ends_with("C172");
    sequences.push_back(read_sequence(file,
                                      folder / "positions" / (file.stem().string() + ".csv"),
                                      is_light ? light : airliner,
                                      options.bank));
  }
  if (options.recover_motion) recover_motion(sequences);
  std::vector<EvisionRow> rows;
  for (const Sequence& sequence : sequences) rows.push_back(compare(sequence, options));
  return rows;
}

namespace {

using Parameters = Eigen::Vector4d;  // shift (px), roll (rad), drift

// Standard error of a box's centre, px.
constexpr double kCentrePx = 3;
// Standard deviations of the priors of roll, rad, and of drift.
constexpr double kPrior = 0.1;
constexpr int kIterations = 15;  // of Gauss-Newton: chosen

Homography homography_of(const Parameters& p, const Pixel& centre, double focal_px) {
  Homography to = Homography::Identity();
  to.topRightCorner<2, 1>() = centre;
  Homography from = Homography::Identity();
  from.topRightCorner<2, 1>() = -centre;
  Homography drift = Homography::Identity();
  drift(2, 1) = -p[3] / focal_px;
  Homography turn = Homography::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(p[2]).toRotationMatrix();
  turn.topRightCorner<2, 1>() = p.head<2>();
  return to * turn * drift * from;
}

}  // namespace

Homography motion_from_sightings(const std::vector<Sighting>& sightings,
                                 const Pixel& principal_point_px,
                                 double focal_px) {
  Parameters p = Parameters::Zero();
  if (sightings.empty()) return Homography::Identity();
  const auto rows = static_cast<Eigen::Index>(2 * sightings.size());
  const auto residual = [&](const Parameters& at) {
    const Homography h = homography_of(at, principal_point_px, focal_px);
    Eigen::VectorXd r(rows + 2);
    for (Eigen::Index i = 0; i < rows / 2; ++i) {
      const Sighting& s = sightings[static_cast<std::size_t>(i)];
      r.segment<2>(2 * i) = (apply(h, s.still_px) - s.found_px) / kCentrePx;
    }
    r.tail<2>() = at.tail<2>() / kPrior;
    return r;
  };
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::VectorXd r = residual(p);
    Eigen::MatrixXd jacobian(rows + 2, 4);
    for (Eigen::Index k = 0; k < 4; ++k) {
      // Step of the numerical derivatives, in the unit of each parameter.
      constexpr double kStep = 1e-5;
      Parameters moved = p;
      moved[k] += kStep;
      jacobian.col(k) = (residual(moved) - r) / kStep;
    }
    const Parameters step =
        (jacobian.transpose() * jacobian).ldlt().solve(-jacobian.transpose() * r);
    if (!step.allFinite()) break;
    p += step;
    if (step.norm() < 1e-9) break;
  }
  return homography_of(p, principal_point_px, focal_px);
}

}  // namespace airtruth::evision
