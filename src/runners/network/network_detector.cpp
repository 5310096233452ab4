// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_detector.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/network/model_description.h"
#include "runners/network/network_child.h"
#include "runners/network/network_input.h"
#include "runners/network/network_output.h"

namespace airtruth::network {
namespace {

constexpr std::size_t kMostModelBytes = std::size_t{512} << 20;  // 130 million parameters
constexpr int kTrialPx = 256;  // side of the first input where the network takes frames of any size

NetworkJob job_of(const ModelDescription& description, std::string onnx) {
  return {description.input.channels(),
          description.input.mean,
          description.input.scale,
          output_names(description),
          std::move(onnx)};
}

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

bool is_centred_in(const image::Picture& picture, const Box& box) {
  const double x = box.x + box.width / 2;
  const double y = box.y + box.height / 2;
  return x >= 0 && y >= 0 && x < picture.width && y < picture.height;
}

// Boxes end at the picture's edges; those that have nothing in it are left out.
void cut_to(const image::Picture& picture, std::vector<results::Detection>& detections) {
  for (results::Detection& one : detections) {
    Box& box = one.box_px;
    const double right = std::min<double>(picture.width, box.right());
    const double bottom = std::min<double>(picture.height, box.bottom());
    box.x = std::max(0.0, box.x);
    box.y = std::max(0.0, box.y);
    box.width = right - box.x;
    box.height = bottom - box.y;
  }
  std::erase_if(detections, [](const results::Detection& d) {
    return d.box_px.width <= 0 || d.box_px.height <= 0;
  });
}

class OnnxDetector : public detector::Detector {
 public:
  OnnxDetector(std::filesystem::path model,
               ModelDescription description,
               NetworkJob job,
               const NetworkOptions& options)
      : model_(std::move(model)),
        description_(std::move(description)),
        job_(std::move(job)),
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
    std::vector<PieceDetection> all;
    const std::vector<Piece> pieces = pieces_of(picture, description_.input);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto& [samples, placement] = pieces[i];
      for (results::Detection& one : answer_to(samples)) {
        const bool cut = !is_letterbox() && is_cut(one.box_px, pieces[i], picture);
        one.box_px = in_frame(one.box_px, placement);
        // The padding of a whole frame and of tiles repeats the frame's last samples: what has its
        // centre there is no part of the frame.
        if (!is_letterbox() && !is_centred_in(picture, one.box_px)) continue;
        all.push_back({std::move(one), static_cast<int>(i), cut});
      }
    }
    std::vector<results::Detection> found =
        without_duplicates(std::move(all), description_.nms_iou);
    if (is_letterbox()) cut_to(picture, found);
    return found;
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
  ModelDescription description = read_description(json);
  NetworkJob job = job_of(description, std::move(onnx));
  return std::make_unique<OnnxDetector>(model, std::move(description), std::move(job), options);
}

}  // namespace airtruth::network
