// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/make_detector.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/lazy_library/lazy_library.h"
#include "runners/classical/classical.h"
#include "runners/detector/detector.h"
#include "runners/network/model_description.h"
#include "runners/network/network_detector.h"
#include "runners/results/results_folder.h"

namespace airtruth::runs {
namespace {

constexpr std::string_view kExec = "exec:";
constexpr std::string_view kNetwork = "onnx:";
constexpr const char* kShippedModel = "network-detector/aircraft.onnx";

// "exec" for exec:COMMAND: two of them need names. "aircraft" for onnx:models/aircraft.onnx.
std::string usual_name(const std::string& command) {
  const std::string scheme = command.substr(0, command.find(':'));
  if (!command.starts_with(kNetwork)) return scheme;
  const std::string stem = std::filesystem::path(command.substr(kNetwork.size())).stem().string();
  return stem.empty() ? scheme : stem;
}

std::filesystem::path shipped_model() {
  std::error_code ignored;
  for (const std::filesystem::path& place : lazy_library::data_places_of(kShippedModel))
    if (std::filesystem::is_regular_file(place, ignored)) return place;
  throw Error(
      fmt::format("the network that ships, {}, is not there; install airtruth whole, or "
                  "name another: onnx:MODEL.onnx",
                  kShippedModel));
}

// Of a network, empty for other detectors.
std::optional<std::filesystem::path> model_of(std::string_view command) {
  if (command == kShippedDetector) return shipped_model();
  if (!command.starts_with(kNetwork)) return std::nullopt;
  return command.substr(kNetwork.size());
}

}  // namespace

std::vector<std::string> detector_names() {
  std::vector<std::string> names = classical::classical_names();
  names.insert(names.begin(), kShippedDetector);
  return names;
}

std::vector<std::filesystem::path> files_of(std::string_view command) {
  const auto model = model_of(command);
  if (!model) return {};
  return {*model, network::description_path(*model)};
}

std::vector<std::string> detector_forms() {
  return {"onnx:MODEL.onnx for a network (docs/formats/detector-model.md)",
          "exec:COMMAND for a program that speaks docs/detector-protocol.md"};
}

DetectorName named_detector(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':');
  const bool is_named =
      equals != std::string::npos && (colon == std::string::npos || equals < colon);
  const std::string command = is_named ? text.substr(equals + 1) : text;
  const std::string name = is_named ? text.substr(0, equals) : usual_name(command);
  if (!results::is_results_name(name))
    throw Error("'" + name.substr(0, 80) +
                "' is no name for a detector's results; expected letters, digits, - _ .");
  return {name, command};
}

std::unique_ptr<detector::Detector> make_detector(std::string_view command,
                                                  const DetectorOptions& options) {
  if (command.starts_with(kExec)) {
    const std::string program(command.substr(kExec.size()));
    if (program.find_first_not_of(' ') == std::string::npos)
      throw Error("'" + std::string(command) + "' names no command");
    return detector::make_external(program, options);
  }
  if (auto classical = classical::make_classical(command)) return classical;
  if (const auto model = model_of(command)) {
    if (model->empty()) throw Error("'onnx:' names no file; expected onnx:MODEL.onnx");
    return network::make_network_detector(*model, {options.threads, options.stop});
  }
  const std::string scheme(command.substr(0, command.find(':')));
  const bool has_scheme = scheme.size() < command.size();
  throw Error(fmt::format(
      "there is no detector '{}'{}",
      command.substr(0, 80),
      did_you_mean(has_scheme ? scheme + ":" : scheme,
                   has_scheme ? std::vector<std::string>{"onnx:", "exec:"} : detector_names(),
                   fmt::format("; expected {}, onnx:MODEL.onnx or exec:COMMAND",
                               fmt::join(detector_names(), ", ")))));
}

}  // namespace airtruth::runs
