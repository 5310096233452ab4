// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

// ONNX files made by hand, for tests: the messages of onnx.proto in Protocol Buffers' encoding.
// Field numbers are those of onnx.proto, IR version 6.
namespace airtruth::test_support::onnx {

inline std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<char>((value & 0x7f) | 0x80));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}
inline std::string number(int field, std::int64_t value) {
  return varint(static_cast<std::uint64_t>(field) << 3) + varint(static_cast<std::uint64_t>(value));
}
inline std::string message(int field, const std::string& bytes) {
  return varint((static_cast<std::uint64_t>(field) << 3) | 2) + varint(bytes.size()) + bytes;
}

inline std::string ints(const std::string& name, const std::vector<std::int64_t>& values) {
  std::string bytes = message(1, name) + number(20, 7);  // AttributeProto, type INTS
  for (const std::int64_t value : values) bytes += number(8, value);
  return bytes;
}

inline std::string floats(const std::string& name,
                          const std::vector<std::int64_t>& shape,
                          const std::vector<float>& values) {
  std::string raw(values.size() * sizeof(float), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  std::string bytes;  // TensorProto
  for (const std::int64_t length : shape) bytes += number(1, length);
  return bytes + number(2, 1) + message(8, name) + message(9, raw);
}

inline std::string integers(const std::string& name, const std::vector<std::int64_t>& values) {
  std::string raw(values.size() * sizeof(std::int64_t), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  return number(1, static_cast<std::int64_t>(values.size())) + number(2, 7) + message(8, name) +
         message(9, raw);
}

inline std::string node(const std::string& type,
                        const std::vector<std::string>& inputs,
                        const std::string& output,
                        const std::vector<std::string>& attributes = {}) {
  std::string bytes;
  for (const std::string& input : inputs) bytes += message(1, input);
  bytes += message(2, output) + message(3, output) + message(4, type);
  for (const std::string& attribute : attributes) bytes += message(5, attribute);
  return bytes;
}

// A dimension that the network leaves open.
inline constexpr std::int64_t kAnyLength = -1;

inline std::string value(const std::string& name, const std::vector<std::int64_t>& shape) {
  std::string dimensions;
  for (std::size_t i = 0; i < shape.size(); ++i)
    dimensions += message(
        1, shape[i] == kAnyLength ? message(2, name + std::to_string(i)) : number(1, shape[i]));
  return message(1, name) + message(2, message(1, number(1, 1) + message(2, dimensions)));
}

struct Graph {
  std::vector<std::string> nodes, tensors, inputs, outputs;
};

inline std::string model(const Graph& graph) {
  std::string bytes;
  for (const std::string& one : graph.nodes) bytes += message(1, one);
  bytes += message(2, "graph");
  for (const std::string& one : graph.tensors) bytes += message(5, one);
  for (const std::string& one : graph.inputs) bytes += message(11, one);
  for (const std::string& one : graph.outputs) bytes += message(12, one);
  return number(1, 6) + message(7, bytes) + message(8, message(1, "") + number(2, 11));
}

// Cells of 4 px. Heat is the brightest sample of the cell, the offset is (0.25, 0.5), and the size
// is exp(`log_size`) px on both sides. The input is 1 x 1 x any height x any width.
inline std::string brightness_model(float log_size) {
  const std::vector<std::string> stride = {ints("kernel_shape", {4, 4}), ints("strides", {4, 4})};
  Graph graph;
  graph.nodes = {node("MaxPool", {"grey"}, "heat", stride),
                 node("Conv", {"grey", "zero", "offsets"}, "offset", stride),
                 node("Conv", {"grey", "zero", "sizes"}, "size", stride)};
  graph.tensors = {floats("zero", {2, 1, 4, 4}, std::vector<float>(32, 0.0f)),
                   floats("offsets", {2}, {0.25f, 0.5f}),
                   floats("sizes", {2}, {log_size, log_size})};
  graph.inputs = {value("grey", {1, 1, kAnyLength, kAnyLength})};
  graph.outputs = {value("heat", {1, 1, kAnyLength, kAnyLength}),
                   value("offset", {1, 2, kAnyLength, kAnyLength}),
                   value("size", {1, 2, kAnyLength, kAnyLength})};
  return model(graph);
}

// One row of YOLOv5's output, the same for every input of 3 x side x side: `row`.
inline std::string constant_yolo_model(int side, const std::vector<float>& row) {
  const auto columns = static_cast<std::int64_t>(row.size());
  Graph graph;
  graph.nodes = {node("Conv",
                      {"images", "zero", "row"},
                      "map",
                      {ints("kernel_shape", {side, side}), ints("strides", {side, side})}),
                 node("Reshape", {"map", "shape"}, "output")};
  graph.tensors = {
      floats("zero",
             {columns, 3, side, side},
             std::vector<float>(static_cast<std::size_t>(columns * 3 * side * side), 0.0f)),
      floats("row", {columns}, row),
      integers("shape", {1, 1, columns})};
  graph.inputs = {value("images", {1, 3, side, side})};
  graph.outputs = {value("output", {1, 1, columns})};
  return model(graph);
}

}  // namespace airtruth::test_support::onnx
