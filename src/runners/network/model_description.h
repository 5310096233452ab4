// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// What the JSON file beside an ONNX network says about it: docs/formats/detector-model.md.
namespace airtruth::network {

// How the network sees a frame.
struct NetworkInput {
  enum class Layout { kGrey, kRgb, kBgr };
  // kFrame: the whole frame at its own size. kTiles: pieces of a fixed size that overlap.
  // kLetterbox: the whole frame scaled to a fixed size, with its aspect kept and grey beside it.
  enum class Fit { kFrame, kTiles, kLetterbox };

  Layout layout = Layout::kGrey;
  // A sample of 0..255 is given as (sample - mean) * scale.
  std::array<float, 3> mean{};
  std::array<float, 3> scale{1, 1, 1};
  Fit fit = Fit::kFrame;
  int width = 0;  // px; of kTiles and kLetterbox
  int height = 0;
  // Of letterbox, where the frame is made smaller: the mean of the samples that an input's pixel
  // covers, or bilinear interpolation between four of them.
  enum class Resize { kArea, kLinear };
  Resize resize = Resize::kArea;
  int overlap_px = 0;   // of kTiles
  int multiple_px = 1;  // of kFrame: both sides are rounded up to a multiple of it

  int channels() const { return layout == Layout::kGrey ? 1 : 3; }
};

// Three outputs over cells: how likely an object's centre lies in the cell, where in the cell, and
// the object's size (Zhou, Wang and Kraehenbuehl 2019, "Objects as Points").
struct HeatMapOutput {
  std::string heat;               // 1 x classes x h x w
  std::string offset;             // 1 x 2 x h x w: x and y, in cells from the cell's corner
  std::string size;               // 1 x 2 x h x w: width and height
  bool needs_sigmoid = false;     // the heat; else it is a probability already
  bool is_size_log = false;       // the natural logarithm of the size; else the size itself
  bool is_size_in_cells = false;  // else in px
};

// One output of the YOLO family: of each box the centre's x and y, width and height in pixels of
// the input, and each class's probability.
struct YoloOutput {
  std::string boxes;
  // kYolov5: 1 x n x (5 + classes), as YOLOv5 writes it, with the objectness before the classes.
  // Else 1 x (4 + classes) x n, as YOLOv8 to YOLO12 write it, without objectness. kFromShape: the
  // shape decides whether the values of a box or the boxes come first.
  enum class Order { kYolov5, kFromShape, kValuesFirst, kBoxesFirst };
  Order order = Order::kFromShape;
};

struct ModelDescription {
  NetworkInput input;
  std::variant<HeatMapOutput, YoloOutput> output;
  std::vector<std::string> classes;
  double score_threshold = 0.1;
  // A detection at or above it may begin a track.
  std::optional<double> confident_score;
  // Of two boxes of one class whose intersection over union is above it, the weaker is left out.
  double nms_iou = 0.5;
};

// The names of the network's outputs, in the order in which the decoder takes them.
std::vector<std::string> output_names(const ModelDescription& description);

// MODEL.json for MODEL.onnx.
std::filesystem::path description_path(const std::filesystem::path& model);

// Throws Error where the file is missing, is no JSON, has an unknown key, or states what no network
// can have.
ModelDescription read_description(const std::filesystem::path& json);
// The same from a text; `file` is its name in messages.
ModelDescription description_from(std::string_view text, const std::string& file);

}  // namespace airtruth::network
