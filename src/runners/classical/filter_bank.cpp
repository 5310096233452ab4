// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/filter_bank.h"

#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"

namespace airtruth::classical {
namespace {

// Odds have a rim of one cell, so that every cell has neighbours. The rim keeps the odds 1: a
// target may enter there as anywhere.
constexpr int kRim = 4;  // columns; a whole vector, so that rows stay aligned

cv::Mat cells_of(const cv::Mat& rimmed) {
  return rimmed({kRim, 1, rimmed.cols - 2 * kRim, rimmed.rows - 2});
}

// x ^ kRemembers for positive x. The bits of a float, as a whole number, are its logarithm to base
// 2 but for a scale, an offset and an error below 0.09: the power is a product. Within 4 %.
constexpr float kBitsOfOne = 127 * (1 << 23);

cv::v_float32x4 remembered(const cv::v_float32x4& x) {
  constexpr float kPower = static_cast<float>(FilterBank::kRemembers);
  const cv::v_float32x4 bits = cv::v_cvt_f32(cv::v_reinterpret_as_s32(x));
  return cv::v_reinterpret_as_f32(
      cv::v_round(bits * cv::v_setall_f32(kPower) + cv::v_setall_f32((1 - kPower) * kBitsOfOne)));
}

// One filter's row, of a multiple of four cells. `there` is the row, and `dx` the column, from
// which a target comes.
void update_row(const float* here,
                const float* there,
                int dx,
                const float* ratio,
                float* out,
                float* mean,
                int width) {
  const cv::v_float32x4 stays = cv::v_setall_f32(static_cast<float>(FilterBank::kStays / 4));
  const cv::v_float32x4 born = cv::v_setall_f32(static_cast<float>(1 - FilterBank::kStays));
  const cv::v_float32x4 quarter = cv::v_setall_f32(0.25F);
  for (int x = 0; x < width; x += 4) {
    const cv::v_float32x4 sum = (cv::v_load(here + x) + cv::v_load(here + x + dx)) +
                                (cv::v_load(there + x) + cv::v_load(there + x + dx));
    const cv::v_float32x4 odds = cv::v_load(ratio + x) * remembered(stays * sum + born);
    cv::v_store(out + x, odds);
    cv::v_store(mean + x, cv::v_load(mean + x) + quarter * odds);
  }
}

}  // namespace

FilterBank::FilterBank(const cv::Size& cells) : mean_(cells, CV_32F, cv::Scalar(1)) {
  check(cells.width % 4 == 0, "a row of cells is a whole number of vectors");
  for (auto* bank : {&odds_, &before_})
    for (cv::Mat& odds : *bank)
      odds = cv::Mat(cells.height + 2, cells.width + 2 * kRim, CV_32F, cv::Scalar(1));
}

void FilterBank::carry(const cv::Mat& former_from_new) {
  for (cv::Mat& odds : odds_) {
    cv::Mat moved;
    cv::remap(cells_of(odds),
              moved,
              former_from_new,
              {},
              cv::INTER_LINEAR,
              cv::BORDER_CONSTANT,
              cv::Scalar(1));
    moved.copyTo(cells_of(odds));
  }
}

void FilterBank::update(const cv::Mat& ratio) {
  std::swap(odds_, before_);
  mean_.setTo(0);
  for (std::size_t filter = 0; filter < odds_.size(); ++filter) {
    const int dx = filter % 2 == 0 ? -1 : 1, dy = filter < 2 ? -1 : 1;
    for (int y = 0; y < mean_.rows; ++y)
      update_row(before_[filter].ptr<float>(y + 1) + kRim,
                 before_[filter].ptr<float>(y + 1 + dy) + kRim,
                 dx,
                 ratio.ptr<float>(y),
                 odds_[filter].ptr<float>(y + 1) + kRim,
                 mean_.ptr<float>(y),
                 mean_.cols);
  }
}

}  // namespace airtruth::classical
