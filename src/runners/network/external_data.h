// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace airtruth::network {

// The name of the file beside an ONNX network in which its weights lie (external data, onnx.proto's
// TensorProto.external_data), or nothing where the network holds all of them. Bytes that are no
// Protocol Buffers message give nothing.
std::optional<std::string> external_data_of(std::string_view onnx);

}  // namespace airtruth::network
