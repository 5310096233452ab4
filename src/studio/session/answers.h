// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "calibration/camera_file/calibration.h"
#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// What a session says to its pages, as bytes. Text that is not UTF-8 has other letters in its
// place.
namespace airtruth::session {

std::string text_of(const nlohmann::ordered_json& json);
// {"id", "ok"} and {"id", "error"}.
std::string ok(std::int64_t id, const nlohmann::ordered_json& result);
std::string error(std::int64_t id, const std::string& line);

// A picture: 4 bytes with the length of its header, little end first; the header; the JPEG.
std::string framed(const nlohmann::ordered_json& header, const std::string& jpeg);

// A part of a picture as the bytes of a .jpg, `scale` times as large (0 < scale <= 1).
std::string jpeg_of(const image::Picture& picture, const PixelBox& part, double scale);
std::string jpeg_of(const image::Rgb8& rgb);

// [{"key", "value", "error", "missing"}] of each quantity of a camera file; value and error are
// null where it was not measured.
nlohmann::ordered_json values_of(const camera_file::Calibration& found);

// [[frame, [{"id", "box"}]]] of what is visible in a rendered video, by its truth.jsonl.
nlohmann::ordered_json boxes_of_film(const std::filesystem::path& truth);

}  // namespace airtruth::session
