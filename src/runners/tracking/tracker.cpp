// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/tracker.h"

#include <algorithm>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "runners/results/detections.h"
#include "runners/results/results_folder.h"
#include "runners/tracking/trax_tracker.h"

namespace airtruth::tracking {

void refuse_unsound(const Box& box, int width, int height) {
  if (!results::is_sound(box) || !intersection(pixels_of(box), {0, 0, width, height}))
    throw Error("the first box has no area within the picture");
}

std::vector<std::string> tracker_names() {
  return words_in(
      "am3 am3s wmil mil opencv-mil opencv-kcf opencv-csrt opencv-boosting opencv-medianflow "
      "opencv-tld opencv-mosse");
}

std::unique_ptr<Tracker> make_tracker(std::string_view name, const TrackerOptions& options) {
  const std::uint64_t seed = options.seed;
  if (auto tracker = make_am3(name, seed)) return tracker;
  if (auto tracker = make_opencv_tracker(name, seed)) return tracker;
  if (auto tracker = make_trax_tracker(name, options)) return tracker;
  const std::vector<std::string> names = tracker_names();
  std::string all;
  for (const std::string& n : names) all += n + ", ";
  throw Error("unknown tracker '" + std::string(name) + "'" +
              did_you_mean(name, names, "; expected one of " + all + "or trax:COMMAND"));
}

bool is_trax(std::string_view tracker) {
  // A command may contain any character; the name before it must not contain a colon.
  const std::string_view word = tracker.substr(0, std::min(tracker.find(':'), tracker.size()));
  const std::size_t equals = word.find('=');
  const std::string_view kind = equals == std::string_view::npos ? word : word.substr(equals + 1);
  return word.size() < tracker.size() && (kind == "trax" || kind == "trax-socket");
}

TrackerName named(std::string_view tracker, const TrackerOptions& options) {
  if (!is_trax(tracker)) return {std::string(tracker), std::string(tracker)};
  const std::size_t equals = tracker.substr(0, tracker.find(':')).find('=');
  if (equals == std::string_view::npos)
    return {trax_name(tracker, options), std::string(tracker), true};
  const std::string_view name = tracker.substr(0, equals);
  if (!results::is_results_name(name))
    throw Error("'" + std::string(name) +
                "' is no name for a tracker's results; expected letters, digits, '-', '_', '.'");
  return {std::string(name), std::string(tracker.substr(equals + 1))};
}

}  // namespace airtruth::tracking
