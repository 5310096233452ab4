// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <new>
#include <optional>

#include <onnxruntime_cxx_api.h>

#include "foundation/base/error.h"
#include "runners/network/inference.h"

namespace airtruth::network {
namespace {

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n')).substr(0, 300);
}

// Calls `work`; what onnxruntime throws becomes an Error.
auto guarded(const auto& work) {
  try {
    return work();
  } catch (const Ort::Exception& error) {
    const std::string words = first_line(error.what());
    // The library has no code for it; its allocator ends with std::bad_alloc, whose text this is.
    if (words.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    if (error.GetOrtErrorCode() == ORT_INVALID_PROTOBUF ||
        words.ends_with("Protobuf parsing failed."))
      throw Error("it is no ONNX file, or its end is missing");
    throw Error("onnxruntime says: " + words);
  }
}

// The pool of threads belongs to the environment, which makes it at once; a session would make one
// of its own when it is confined already. Waiting threads sleep.
Ort::Env environment_of(int threads) {
  Ort::ThreadingOptions options;
  options.SetGlobalIntraOpNumThreads(threads);
  options.SetGlobalInterOpNumThreads(1);
  options.SetGlobalSpinControl(0);
  return {options, ORT_LOGGING_LEVEL_FATAL, "airtruth"};
}

Ort::SessionOptions session_options() {
  Ort::SessionOptions options;
  options.DisablePerSessionThreads();
  options.SetLogSeverityLevel(ORT_LOGGING_LEVEL_FATAL);
  return options;
}

Tensor tensor_of(const Ort::Value& output) {
  if (!output.IsTensor()) throw Error("an output is no tensor");
  const Ort::TensorTypeAndShapeInfo info = output.GetTensorTypeAndShapeInfo();
  if (info.GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT)
    throw Error("an output is not of 32-bit numbers");
  Tensor tensor;
  for (const std::int64_t length : info.GetShape())
    tensor.shape.push_back(static_cast<int>(length));
  const float* values = output.GetTensorData<float>();
  tensor.values.assign(values, values + info.GetElementCount());
  return tensor;
}

}  // namespace

struct Inference::Library {
  explicit Library(int threads) : environment(environment_of(threads)) {}

  Ort::Env environment;
  std::optional<Ort::Session> session;
  std::string input;
  std::vector<std::string> outputs;

  void expect_outputs() const {
    Ort::AllocatorWithDefaultOptions allocator;
    std::vector<std::string> known;
    std::string ends;
    for (std::size_t i = 0; i < session->GetOutputCount(); ++i) {
      known.emplace_back(session->GetOutputNameAllocated(i, allocator).get());
      ends += (ends.empty() ? "'" : ", '") + known.back().substr(0, 60) + "'";
    }
    for (const std::string& name : outputs)
      if (std::ranges::find(known, name) == known.end())
        throw Error("it has no output '" + name + "'; it ends with " + ends.substr(0, 300));
  }
};

Inference::Inference(int threads)
    : library_(guarded([&] { return std::make_unique<Library>(threads); })) {}

Inference::~Inference() = default;

void Inference::load(const std::string& onnx, std::vector<std::string> outputs) {
  guarded([&] {
    Library& library = *library_;
    library.outputs = std::move(outputs);
    library.session.emplace(library.environment, onnx.data(), onnx.size(), session_options());
    if (const std::size_t inputs = library.session->GetInputCount(); inputs != 1)
      throw Error("it has " + std::to_string(inputs) + " inputs; expected one");
    Ort::AllocatorWithDefaultOptions allocator;
    library.input = library.session->GetInputNameAllocated(0, allocator).get();
    library.expect_outputs();
  });
}

std::vector<Tensor> Inference::run(Tensor input) {
  return guarded([&] {
    const std::vector<std::int64_t> shape(input.shape.begin(), input.shape.end());
    const auto memory = Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault);
    const Ort::Value value = Ort::Value::CreateTensor<float>(
        memory, input.values.data(), input.values.size(), shape.data(), shape.size());
    const char* input_name = library_->input.c_str();
    std::vector<const char*> names;
    for (const std::string& name : library_->outputs) names.push_back(name.c_str());
    std::vector<Tensor> tensors;
    for (const Ort::Value& output : library_->session->Run(
             Ort::RunOptions{nullptr}, &input_name, &value, 1, names.data(), names.size()))
      tensors.push_back(tensor_of(output));
    return tensors;
  });
}

}  // namespace airtruth::network
