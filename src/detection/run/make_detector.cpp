// SPDX-License-Identifier: Apache-2.0
#include "detection/run/make_detector.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detection/classical/classical.h"
#include "detection/network/model_description.h"
#include "detection/network/network_detector.h"
#include "foundation/base/error.h"
#include "foundation/base/suggest.h"

namespace airtruth::detection {
namespace {

constexpr std::string_view kNetwork = "onnx:";

bool is_file_name(const std::string& name) {
  return !name.empty() && name.size() <= 80 && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ||
                  c == '.';
         });
}

}  // namespace

std::vector<std::string> detector_names() {
  std::vector<std::string> names = classical_names();
  names.push_back(std::string(kNetwork) + "MODEL.onnx");
  return names;
}

std::vector<std::filesystem::path> files_of(std::string_view command) {
  if (!command.starts_with(kNetwork)) return {};
  const std::filesystem::path model = command.substr(kNetwork.size());
  return {model, description_path(model)};
}

DetectorName named_detector(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':');
  DetectorName named{text, text};
  if (text.starts_with(kNetwork))  // onnx:models/aircraft.onnx is named aircraft
    named.name = std::filesystem::path(text.substr(kNetwork.size())).stem().string();
  if (equals != std::string::npos && (colon == std::string::npos || equals < colon))
    named = {text.substr(0, equals), text.substr(equals + 1)};
  if (!is_file_name(named.name))
    throw Error("'" + named.name.substr(0, 80) +
                "' is no name for a detector's results; expected letters, digits, - _ .");
  return named;
}

std::unique_ptr<Detector> make_detector(std::string_view command, const DetectorOptions& options) {
  if (auto classical = make_classical(command)) return classical;
  if (command.starts_with(kNetwork)) {
    const std::filesystem::path model = command.substr(kNetwork.size());
    if (model.empty()) throw Error("'onnx:' names no file; expected onnx:MODEL.onnx");
    return make_network_detector(model, {options.threads, options.stop});
  }
  const std::vector<std::string> names = detector_names();
  const auto near = nearest_spelling(command, names);
  throw Error(fmt::format(
      "there is no detector '{}'; {}",
      command.substr(0, 80),
      near ? "did you mean '" + *near + "'?" : fmt::format("expected {}", fmt::join(names, ", "))));
}

}  // namespace airtruth::detection
