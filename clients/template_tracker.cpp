// SPDX-License-Identifier: Apache-2.0
// A tracker that looks for the first frame's picture of its object around where it was last; of
// several objects at a time with --several.
//   g++ -O2 template_tracker.cpp -o template_tracker $(pkg-config --cflags --libs opencv4)
//   airtruth track DIR --tracker "trax:./template_tracker" --out results
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "airtruth_trax.hpp"

namespace {

using airtruth_trax::Answer;
using airtruth_trax::Image;
using airtruth_trax::Region;

constexpr int kSearchPx = 50;  // each way

// Empty for a picture that cannot be read.
cv::Mat grey_of(Image image) {
  if (image.kind == Image::Kind::kPath) return cv::imread(image.path, cv::IMREAD_GRAYSCALE);
  if (image.kind == Image::Kind::kData) return cv::imdecode(image.bytes, cv::IMREAD_GRAYSCALE);
  if (image.kind == Image::Kind::kUrl) return {};
  const int type = image.format == "rgb" ? CV_8UC3 : image.format == "gray16" ? CV_16U : CV_8U;
  const cv::Mat samples(image.height, image.width, type, image.bytes.data());
  cv::Mat grey;
  if (type == CV_8UC3) cv::cvtColor(samples, grey, cv::COLOR_RGB2GRAY);
  if (type == CV_16U) samples.convertTo(grey, CV_8U, 1.0 / 256);
  if (type == CV_8U) grey = samples.clone();
  return grey;
}

class Follower {
 public:
  Follower(const Region& region, const cv::Mat& frame)
      : last_(region), model_(frame(whole(frame)).clone()) {}

  Answer follow(const cv::Mat& frame) {
    const cv::Rect box = whole(frame);
    const cv::Rect around = cv::Rect(box.x - kSearchPx,
                                     box.y - kSearchPx,
                                     model_.cols + 2 * kSearchPx,
                                     model_.rows + 2 * kSearchPx) &
                            cv::Rect({0, 0}, frame.size());
    if (model_.empty() || around.width < model_.cols || around.height < model_.rows) return {};
    cv::Mat likeness;
    cv::matchTemplate(frame(around), model_, likeness, cv::TM_CCOEFF_NORMED);
    double best = 0;
    cv::Point place;
    cv::minMaxLoc(likeness, nullptr, &best, nullptr, &place);
    last_.x = around.x + place.x;
    last_.y = around.y + place.y;
    return {last_, best, {}};
  }

 private:
  cv::Rect whole(const cv::Mat& frame) const {
    const cv::Rect box(static_cast<int>(std::lround(last_.x)),
                       static_cast<int>(std::lround(last_.y)),
                       std::max(4, static_cast<int>(std::lround(last_.width))),
                       std::max(4, static_cast<int>(std::lround(last_.height))));
    return box & cv::Rect({0, 0}, frame.size());
  }

  Region last_;
  cv::Mat model_;
};

void run(airtruth_trax::Server& server) {
  std::vector<Follower> followers;
  while (const auto request = server.wait()) {
    const cv::Mat frame = grey_of(request->picture());
    if (frame.empty())
      throw std::runtime_error("cannot read the picture " + request->image.substr(0, 200));
    if (request->begins) followers.clear();
    std::vector<Answer> answers;
    for (Follower& follower : followers) answers.push_back(follower.follow(frame));
    for (const airtruth_trax::Object& object : request->objects) {
      followers.emplace_back(object.region, frame);
      answers.push_back({object.region, 1, {}});
    }
    server.reply(answers);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool several = argc > 1 && std::string(argv[1]) == "--several";
  airtruth_trax::Server server("template", "path;memory;buffer", several);
  try {
    run(server);
  } catch (const std::exception& error) {
    server.quit(error.what());
    std::cerr << "template_tracker: " << error.what() << '\n';
    return 1;
  }
}
