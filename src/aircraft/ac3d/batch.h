// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "aircraft/model/finish.h"

namespace airtruth::aircraft {

// Triangles of a model file that share one material, in the file's own frame, whatever its format.
struct Batch {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  // one a position; of any length
  std::vector<Eigen::Vector2f> uvs;      // one a position; v up from the picture's bottom
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::array<float, 3> diffuse{0.8f, 0.8f, 0.8f};  // sRGB
  std::array<float, 3> emission{};                 // sRGB
  std::array<float, 3> specular{};                 // sRGB
  float shininess = 0;
  float opacity = 1;
  Finish finish = Finish::kPaint;
  std::string texture;   // the file's name for it; empty: none
  int texture_line = 0;  // where the file names it; 0: unknown
  int picture = -1;      // index into RawModel::pictures, in place of `texture`: inside the file
  bool repeat_u = true;
  bool repeat_v = true;
};

}  // namespace airtruth::aircraft
