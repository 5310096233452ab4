// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_output.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"

namespace airtruth::network {
namespace {

constexpr double kMostSizePx = 1e5;  // a box beyond it is no answer

[[noreturn]] void wrong_shape(const std::string& name,
                              const Tensor& tensor,
                              const std::string& expected) {
  throw Error(fmt::format(
      "its output '{}' has the shape {}; expected {}", name, in_words(tensor.shape), expected));
}

double sigmoid(double value) { return 1 / (1 + std::exp(-value)); }

void keep_strongest(std::vector<results::Detection>& detections) {
  results::sort_by_score(detections);
  if (detections.size() > kMostDetections) detections.resize(kMostDetections);
}

results::Detection detection_about(
    double x, double y, double width, double height, double score, const std::string& category) {
  for (const double value : {x, y, width, height}) {
    if (!(std::abs(value) <= kMostSizePx)) {
      throw Error(
          fmt::format("gives a box of {:g} x {:g} px at ({:g}, {:g})", width, height, x, y));
    }
  }
  return {{x - width / 2, y - height / 2, width, height}, score, category, {}};
}

// The cells of the heat map and what is read there.
class HeatMap {
 public:
  HeatMap(const std::vector<Tensor>& outputs,
          const ModelDescription& description,
          int width,
          int height)
      : names_(std::get<HeatMapOutput>(description.output)),
        description_(description),
        heat_(outputs[0]),
        offset_(outputs[1]),
        size_(outputs[2]) {
    const auto classes = static_cast<int>(description.classes.size());
    if (heat_.shape.size() != 4 || heat_.shape[0] != 1 || heat_.shape[1] != classes) {
      wrong_shape(
          names_.heat, heat_, fmt::format("1 x {} x rows x columns, for the classes", classes));
    }
    rows_ = heat_.shape[2];
    columns_ = heat_.shape[3];
    if (rows_ < 1 || columns_ < 1 || width % columns_ != 0 || height % rows_ != 0 ||
        width / columns_ != height / rows_) {
      wrong_shape(
          names_.heat,
          heat_,
          fmt::format("cells that divide the input of {} x {} px into squares", width, height));
    }
    cell_px_ = width / columns_;
    const std::vector<int> pair = {1, 2, rows_, columns_};
    if (offset_.shape != pair) wrong_shape(names_.offset, offset_, in_words(pair));
    if (size_.shape != pair) wrong_shape(names_.size, size_, in_words(pair));
  }

  std::vector<results::Detection> detections() const {
    std::vector<results::Detection> found;
    for (int of_class = 0; of_class < heat_.shape[1]; ++of_class) {
      for (int row = 0; row < rows_; ++row) {
        for (int column = 0; column < columns_; ++column) {
          const double score = score_at(of_class, row, column);
          if (score < description_.score_threshold || !is_peak(of_class, row, column)) continue;
          found.push_back(at(of_class, row, column, score));
        }
      }
    }
    keep_strongest(found);
    return found;
  }

 private:
  double value(const Tensor& tensor, int channel, int row, int column) const {
    const auto index = (static_cast<std::ptrdiff_t>(channel) * rows_ + row) * columns_ + column;
    return tensor.values[static_cast<std::size_t>(index)];
  }

  double score_at(int of_class, int row, int column) const {
    const double heat = value(heat_, of_class, row, column);
    if (!std::isfinite(heat)) {
      throw Error(
          fmt::format("gives a score that is not finite ({}), in row {} and column {} of '{}'",
                      heat,
                      row,
                      column,
                      names_.heat));
    }
    return names_.needs_sigmoid ? sigmoid(heat) : heat;
  }

  // Of cells that are equally hot the first one is the peak.
  bool is_peak(int of_class, int row, int column) const {
    const double here = value(heat_, of_class, row, column);
    for (int y = std::max(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x) {
        const double beside = value(heat_, of_class, y, x);
        const bool earlier = std::tie(y, x) < std::tie(row, column);
        if (beside > here || (earlier && beside == here)) return false;
      }
    }
    return true;
  }

  results::Detection at(int of_class, int row, int column, double score) const {
    const double unit = names_.is_size_in_cells ? cell_px_ : 1;
    const auto length = [&](int side) {
      const double told = value(size_, side, row, column);
      return unit * (names_.is_size_log ? std::exp(told) : told);
    };
    return detection_about((column + value(offset_, 0, row, column)) * cell_px_,
                           (row + value(offset_, 1, row, column)) * cell_px_,
                           length(0),
                           length(1),
                           score,
                           description_.classes[static_cast<std::size_t>(of_class)]);
  }

  const HeatMapOutput& names_;
  const ModelDescription& description_;
  const Tensor& heat_;
  const Tensor& offset_;
  const Tensor& size_;
  int rows_ = 0;
  int columns_ = 0;
  int cell_px_ = 0;
};

// The boxes of a network of the YOLO family: value v of box i is values[i * box + v * value].
struct YoloBoxes {
  const std::string& name;
  const Tensor& tensor;
  int boxes = 0;
  std::ptrdiff_t box = 0;
  std::ptrdiff_t value = 0;
  int classes_from = 0;  // the first class's value; objectness is the one before where it is 5

  double at(int i, int v) const {
    return tensor.values[static_cast<std::size_t>(i * box + v * value)];
  }
};

YoloBoxes yolov5_boxes(const Tensor& tensor, const std::string& name, int classes) {
  const int values = 5 + classes;
  const std::vector<int>& shape = tensor.shape;
  if (shape.size() != 3 || shape[0] != 1 || shape[2] != values) {
    const bool as_yolov8 =
        shape.size() == 3 && shape[0] == 1 && (shape[1] == values - 1 || shape[2] == values - 1);
    wrong_shape(name,
                tensor,
                fmt::format("1 x boxes x {}, for the classes{}",
                            values,
                            as_yolov8 ? "; this is the shape of kind \"yolov8\"" : ""));
  }
  return {name, tensor, shape[1], values, 1, 5};
}

// Both orders fit where there are as many boxes as values. A shape of 1 x boxes x 6 is also that of
// networks that leave out duplicates themselves (YOLOv10, YOLO26): two corners, score and class.
YoloBoxes yolov8_boxes(const Tensor& tensor, const YoloOutput& output, int classes) {
  using Order = YoloOutput::Order;
  const int values = 4 + classes;
  const std::vector<int>& shape = tensor.shape;
  const bool flat = shape.size() == 3 && shape[0] == 1;
  const bool values_first = flat && output.order != Order::kBoxesFirst && shape[1] == values;
  const bool boxes_first = flat && output.order != Order::kValuesFirst && shape[2] == values;
  if (!values_first && !boxes_first) {
    wrong_shape(output.boxes,
                tensor,
                output.order == Order::kValuesFirst ? fmt::format("1 x {} x boxes", values)
                : output.order == Order::kBoxesFirst
                    ? fmt::format("1 x boxes x {}", values)
                    : fmt::format("1 x {0} x boxes or 1 x boxes x {0}, "
                                  "for the classes",
                                  values));
  }
  if (output.order == Order::kFromShape && boxes_first && (values_first || values == 6)) {
    wrong_shape(
        output.boxes,
        tensor,
        "\"order\" in its description, \"values_first\" or \"boxes_first\": the shape alone "
        "does not say what its numbers are");
  }
  if (values_first) return {output.boxes, tensor, shape[2], 1, shape[2], 4};
  return {output.boxes, tensor, shape[1], values, 1, 4};
}

YoloBoxes yolo_boxes(const Tensor& tensor, const ModelDescription& description) {
  const auto classes = static_cast<int>(description.classes.size());
  const auto& output = std::get<YoloOutput>(description.output);
  return output.order == YoloOutput::Order::kYolov5 ? yolov5_boxes(tensor, output.boxes, classes)
                                                    : yolov8_boxes(tensor, output, classes);
}

std::vector<results::Detection> of_yolo(const YoloBoxes& all, const ModelDescription& description) {
  std::vector<results::Detection> found;
  for (int i = 0; i < all.boxes; ++i) {
    int best = 0;
    for (int c = 1; c < static_cast<int>(description.classes.size()); ++c) {
      if (all.at(i, all.classes_from + c) > all.at(i, all.classes_from + best)) best = c;
    }
    const double objectness = all.classes_from == 5 ? all.at(i, 4) : 1;
    const double score = objectness * all.at(i, all.classes_from + best);
    if (!std::isfinite(score)) {
      throw Error(fmt::format(
          "gives a score that is not finite ({}), in row {} of '{}'", score, i, all.name));
    }
    if (score < description.score_threshold) continue;
    found.push_back(detection_about(all.at(i, 0),
                                    all.at(i, 1),
                                    all.at(i, 2),
                                    all.at(i, 3),
                                    score,
                                    description.classes[static_cast<std::size_t>(best)]));
  }
  keep_strongest(found);
  return found;
}

bool is_centred_in(const Box& box, const Box& other) {
  const double x = box.x + box.width / 2;
  const double y = box.y + box.height / 2;
  return x >= other.x && x <= other.right() && y >= other.y && y <= other.bottom();
}

bool duplicates(const PieceDetection& a, const PieceDetection& b, double nms_iou) {
  if (a.detection.category != b.detection.category) return false;
  const Box& first = a.detection.box_px;
  const Box& second = b.detection.box_px;
  const auto common = intersection(first, second);
  if (!common) return false;
  const double shared = common->area();
  if (shared > nms_iou * (first.area() + second.area() - shared)) return true;
  return a.piece != b.piece && (first.area() < second.area() ? is_centred_in(first, second)
                                                             : is_centred_in(second, first));
}

}  // namespace

std::vector<results::Detection> decoded(const std::vector<Tensor>& outputs,
                                        const ModelDescription& description,
                                        int width,
                                        int height) {
  const std::size_t wanted = output_names(description).size();
  if (outputs.size() != wanted) {
    throw Error(fmt::format("gives {} outputs; expected {}", outputs.size(), wanted));
  }
  std::vector<results::Detection> found =
      std::holds_alternative<HeatMapOutput>(description.output)
          ? HeatMap(outputs, description, width, height).detections()
          : of_yolo(yolo_boxes(outputs[0], description), description);
  std::erase_if(found, [](const results::Detection& d) {
    return d.box_px.width <= 0 || d.box_px.height <= 0;
  });
  return found;
}

std::vector<results::Detection> without_duplicates(std::vector<PieceDetection> detections,
                                                   double nms_iou) {
  std::ranges::stable_sort(detections, [](const PieceDetection& a, const PieceDetection& b) {
    return std::tuple(a.cut, -a.detection.score) < std::tuple(b.cut, -b.detection.score);
  });
  std::vector<PieceDetection> kept;
  for (PieceDetection& candidate : detections) {
    const bool known = std::ranges::any_of(
        kept, [&](const PieceDetection& other) { return duplicates(candidate, other, nms_iou); });
    if (!known) kept.push_back(std::move(candidate));
  }
  std::vector<results::Detection> found;
  for (PieceDetection& one : kept) found.push_back(std::move(one.detection));
  keep_strongest(found);
  return found;
}

}  // namespace airtruth::network
