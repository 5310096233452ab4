// SPDX-License-Identifier: Apache-2.0
// A tracker that looks for the first frame's picture of its object around where it was last.
//   g++ -O2 template_tracker.cpp -o template_tracker $(pkg-config --cflags --libs opencv4)
//   airtruth track DIR --tracker "trax:./template_tracker" --out results
#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "airtruth_trax.hpp"

namespace {

constexpr int kSearchPx = 50;  // each way

cv::Rect whole(const airtruth_trax::Region& r, const cv::Mat& frame) {
  const cv::Rect box(static_cast<int>(std::lround(r.x)),
                     static_cast<int>(std::lround(r.y)),
                     std::max(4, static_cast<int>(std::lround(r.width))),
                     std::max(4, static_cast<int>(std::lround(r.height))));
  return box & cv::Rect({0, 0}, frame.size());
}

}  // namespace

int main() {
  airtruth_trax::Server server("template");
  cv::Mat model;
  airtruth_trax::Region last;
  while (const auto request = server.wait()) {
    const cv::Mat frame = cv::imread(request->image, cv::IMREAD_GRAYSCALE);
    if (frame.empty()) return 1;
    if (request->begins) {
      last = request->region;
      model = frame(whole(last, frame)).clone();
      server.reply(last);
      continue;
    }
    const cv::Rect box = whole(last, frame);
    const cv::Rect around = cv::Rect(box.x - kSearchPx,
                                     box.y - kSearchPx,
                                     model.cols + 2 * kSearchPx,
                                     model.rows + 2 * kSearchPx) &
                            cv::Rect({0, 0}, frame.size());
    if (around.width < model.cols || around.height < model.rows) {
      server.reply_lost();
      continue;
    }
    cv::Mat likeness;
    cv::matchTemplate(frame(around), model, likeness, cv::TM_CCOEFF_NORMED);
    double best = 0;
    cv::Point place;
    cv::minMaxLoc(likeness, nullptr, &best, nullptr, &place);
    last.x = around.x + place.x;
    last.y = around.y + place.y;
    server.reply(last, best);
  }
}
