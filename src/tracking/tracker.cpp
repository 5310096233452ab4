// SPDX-License-Identifier: Apache-2.0
#include "tracking/tracker.h"

#include <algorithm>

#include "base/error.h"
#include "base/suggest.h"
#include "tracking/am3.h"
#include "tracking/opencv_trackers.h"

namespace airtruth::tracking {

std::vector<std::string> tracker_names() {
  return {"am3",
          "wmil",
          "mil",
          "opencv-mil",
          "opencv-kcf",
          "opencv-csrt",
          "opencv-boosting",
          "opencv-medianflow",
          "opencv-tld",
          "opencv-mosse"};
}

std::unique_ptr<Tracker> make_tracker(std::string_view name, std::uint64_t seed) {
  if (name == "am3") {
    Am3Options options;
    options.seed = seed;
    return make_am3(options);
  }
  if (name == "wmil") return make_am3(wmil_options(seed));
  if (name == "mil") return make_am3(mil_options(seed));
  if (auto tracker = make_opencv_tracker(name, seed)) return tracker;
  const std::vector<std::string> names = tracker_names();
  const auto nearest = nearest_spelling(name, names);
  std::string all;
  for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
  throw Error("unknown tracker '" + std::string(name) + "'" +
              (nearest ? "; did you mean '" + *nearest + "'?" : "; expected one of " + all));
}

}  // namespace airtruth::tracking
