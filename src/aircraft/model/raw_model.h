// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "aircraft/model/mesh.h"
#include "aircraft/texture_file/picture.h"

namespace airtruth::model {

// A model as its reader returns it: plain arrays, with textures as sRGB pictures.
struct RawPicture {
  texture_file::Picture picture;
  bool repeat_u = true;
  bool repeat_v = true;
};

struct RawModel {
  Mesh mesh;  // without textures; Material::texture is an index into `pictures`
  std::vector<RawPicture> pictures;
  std::vector<std::string> warnings;
};

// Limits on the content of a model file, so that an untrusted file cannot exhaust memory or time. A
// model beyond a limit is an Error. Each limit is about ten times the largest value in
// flightgear-data-ai.
constexpr std::size_t kMaxModelBytes = std::size_t{256} << 20;  // the size of one file
constexpr std::size_t kMaxCorners = 6'000'000;                  // over all surfaces of a model
constexpr std::size_t kMaxTriangles = 2'000'000;                // over all surfaces of a model
constexpr double kLargestCoordinate = 1e6;  // in units of the file, or in metres in body axes

// Bounds on the numbers in the result of a reader and in an entry of the cache.
constexpr std::size_t kMaxParts = 1024;
constexpr std::size_t kMaxMaterials = 4096;
constexpr std::size_t kMaxPictures = 1024;
constexpr std::size_t kMaxPixels = std::size_t{64} << 20;  // of all pictures together
constexpr std::size_t kMaxWarnings = 64;

// Throws Error where an array has the wrong length, an index points outside, a number is not finite
// or beyond kLargestCoordinate, a normal is not a unit vector, a colour lies outside 0..1, or a
// limit is exceeded.
void check_model(const RawModel& model);

// The mesh with its textures decoded to linear light, and their mip chains.
Mesh mesh_of(RawModel model);

}  // namespace airtruth::model
