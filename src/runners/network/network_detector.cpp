// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_detector.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "evaluation/matching/boxes.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/network/model_description.h"
#include "runners/network/network_child.h"
#include "runners/network/network_input.h"
#include "runners/network/network_output.h"
#include "runners/results/results_folder.h"

namespace airtruth::network {
namespace {

constexpr std::size_t kMostModelBytes = std::size_t{512} << 20;  // 130 million parameters
constexpr int kTrialPx = 256;  // side of the first input where the network takes frames of any size

// A grey input of the size that the network will see.
cv::Mat trial_of(const NetworkInput& input) {
  const int multiple = input.multiple_px;
  const int side = (kTrialPx + multiple - 1) / multiple * multiple;
  const cv::Size size = input.fit == NetworkInput::Fit::kFrame
                            ? cv::Size(side, side)
                            : cv::Size(input.width, input.height);
  return {size, CV_8UC(input.channels()), cv::Scalar::all(128)};
}

// Whether a box touches a side of its tile on which the frame goes on: its object may be cut.
bool is_cut(const Box& box, const Piece& tile, const image::Picture& picture) {
  const auto& [samples, place] = tile;
  return (place.x_px > 0 && box.x <= 0) || (place.y_px > 0 && box.y <= 0) ||
         (place.x_px + samples.cols < picture.width && box.right() >= samples.cols) ||
         (place.y_px + samples.rows < picture.height && box.bottom() >= samples.rows);
}

// Boxes end at the picture's edges; those that have nothing in it, or less than is written, are
// left out.
std::vector<results::Detection> cut_to(const Box& frame,
                                       std::vector<results::Detection> detections) {
  std::vector<results::Detection> kept;
  for (results::Detection& one : detections) {
    const auto inside = intersection(one.box_px, frame);
    if (!inside || std::min(inside->width, inside->height) < results::kWrittenStep_px) continue;
    one.box_px = *inside;
    kept.push_back(std::move(one));
  }
  return kept;
}

class OnnxDetector : public detector::Detector {
 public:
  OnnxDetector(std::filesystem::path model,
               ModelDescription description,
               std::string onnx,
               const NetworkOptions& options)
      : model_(std::move(model)),
        description_(std::move(description)),
        job_{description_.input.channels(),
             description_.input.mean,
             description_.input.scale,
             output_names(description_),
             std::move(onnx)},
        options_(options) {
    try {
      start();
      answer_to(trial_of(description_.input));
    } catch (const Error& error) {
      throw Error(error.message(), {model_.string()});
    }
  }

  void begin(const detector::SequenceInput&) override {
    if (child_) return;
    try {
      start();
    } catch (const Error& error) {
      throw process::Failure("cannot begin: " + model_.filename().string() + " " + error.message());
    }
  }

  std::vector<results::Detection> detect(const detector::FrameInput& frame) override {
    if (!child_) throw process::Failure("has failed before");
    try {
      return found_in(*frame.picture);
    } catch (const Error& error) {
      child_.reset();
      throw process::Failure(fmt::format(
          "failed in frame {}: {} {}", frame.index, model_.filename().string(), error.message()));
    }
  }

  bool needs_motion() const override { return false; }

  std::optional<double> confident_score() const override { return description_.confident_score; }

 private:
  void start() { child_ = std::make_unique<NetworkChild>(job_, options_.threads, options_.stop); }

  std::vector<results::Detection> answer_to(const cv::Mat& samples) {
    const auto outputs = child_->run(
        samples.cols, samples.rows, {samples.data, samples.total() * samples.elemSize()});
    return decoded(outputs, description_, samples.cols, samples.rows);
  }
  bool is_letterbox() const { return description_.input.fit == NetworkInput::Fit::kLetterbox; }

  std::vector<results::Detection> found_in(const image::Picture& picture) {
    const Box frame{0, 0, double(picture.width), double(picture.height)};
    std::vector<PieceDetection> all;
    const std::vector<Piece> pieces = pieces_of(picture, description_.input);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto& [samples, placement] = pieces[i];
      for (results::Detection& one : answer_to(samples)) {
        const bool cut = !is_letterbox() && is_cut(one.box_px, pieces[i], picture);
        one.box_px = in_frame(one.box_px, placement);
        // The padding of a whole frame and of tiles repeats the frame's last samples: what has its
        // centre there is no part of the frame.
        if (!is_letterbox() && !matching::centre_is_in(one.box_px, frame)) continue;
        all.push_back({std::move(one), static_cast<int>(i), cut});
      }
    }
    std::vector<results::Detection> found =
        without_duplicates(std::move(all), description_.nms_iou);
    return is_letterbox() ? cut_to(frame, std::move(found)) : found;
  }

  std::filesystem::path model_;
  ModelDescription description_;
  NetworkJob job_;
  NetworkOptions options_;
  std::unique_ptr<NetworkChild> child_;
};

}  // namespace

std::unique_ptr<detector::Detector> make_network_detector(const std::filesystem::path& model,
                                                          const NetworkOptions& options) {
  std::string onnx = read_file(model, kMostModelBytes);
  if (onnx.empty()) throw Error("is empty; expected an ONNX network", {model.string()});
  const std::filesystem::path json = description_path(model);
  if (!std::filesystem::exists(json)) {
    throw Error(fmt::format("has no description beside it; expected {}, as docs/formats/"
                            "detector-model.md has it",
                            json.filename().string()),
                {model.string()});
  }
  return std::make_unique<OnnxDetector>(model, read_description(json), std::move(onnx), options);
}

}  // namespace airtruth::network
