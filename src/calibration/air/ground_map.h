// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/air/ground_track.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"

// Views of level ground, rectified to the ground plane and registered with one another. Lengths are
// in heights: multiples of the camera's height above the ground.
namespace airtruth::air {

// The registration of one view with another.
struct Laid {
  // Motion of the camera.
  Eigen::Vector2d moved;
  // Correlation of the aligned views, -1 to 1.
  double agreement = 0;
};

// The maps of several views: rows north, columns east.
class GroundMaps {
 public:
  // The level frame, in which the ground is z = 1, is that of `level_from_world`. `cell`: the size
  // of a cell. `max_displacement`: the largest displacement, by row or by column, at which two maps
  // are compared.
  GroundMaps(const Scenery& scenery,
             const Quaternion& level_from_world,
             double cell,
             double max_displacement);

  std::size_t size() const { return spectra_.size(); }
  // Registers the ground of view `from` in view `to` by masked correlation (Padfield 2012, "Masked
  // object registration in the Fourier domain"). The search covers the displacements within `reach`
  // of `expected`, by row and by column. Empty where no displacement gives a positive correlation.
  std::optional<Laid> laid_over(std::size_t from,
                                std::size_t to,
                                const Eigen::Vector2d& expected,
                                double reach) const;

 private:
  // Of the map's contrast, which is 0 where nothing is seen, and of the mask of what is seen.
  struct Spectra {
    cv::Mat contrast, seen;
  };
  double cell_;
  std::vector<Spectra> spectra_;
};

// The position, from -1/2 to 1/2, of the maximum of a parabola through three neighbouring values.
double peak_offset(double before, double middle, double after);

}  // namespace airtruth::air
