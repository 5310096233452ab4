// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runners/classical/blobs.h"
#include "runners/classical/free_view.h"
#include "runners/detector/detector.h"

// The detectors that need no training (docs/detection.md):
//   cmo               close-minus-open of single frames, confirmed at the same bearing in the
//                     frames before; the score is a contrast-to-noise ratio
//   cmo-hmm           a hidden Markov model of a target that moves slowly over the sphere, on
//                     close-minus-open: track before detect
//   frame-difference  what differs from the frame before, once the camera's turn is taken out: the
//                     floor that a detector should clear
// All find aircraft of two to about a hundred pixels, brighter or darker than what is behind them.
// They are deterministic and have no memory beyond the sequence. Nothing is detected on the own
// aircraft where the sequence states its mask. Each has a confident score that follows from its
// statistic: noise alone reaches it once in an hour (below).
namespace airtruth::classical {

std::vector<std::string> classical_names();
// nullptr for a name that is none of these.
std::unique_ptr<detector::Detector> make_classical(std::string_view name);

std::unique_ptr<detector::Detector> make_close_minus_open();
std::unique_ptr<detector::Detector> make_hidden_markov();
std::unique_ptr<detector::Detector> make_frame_difference();

// What the detectors share.

class ClassicalDetector : public detector::Detector {
 public:
  void begin(const detector::SequenceInput& sequence) override {
    lens_.emplace(sequence.lens);
    view_ = FreeView(sequence.own_aircraft.get());
  }
  bool needs_motion() const override { return true; }
  bool leaves_out_own_aircraft() const override { return true; }
  std::optional<double> confident_score() const override { return confident_; }

 protected:
  std::optional<lens::Lens> lens_;
  FreeView view_;
  std::optional<double> confident_;
};

// A detection whose score has four digits.
results::Detection detection_of(const Box& box_px, double score);

// Weaker blobs are noise more often than not at any size: in a frame of 1280x960 white noise a
// sample of some thousand independent ones exceeds this many standard deviations.
inline constexpr double kLeastContrastToNoise = 4;

// A rate where the video states none.
inline constexpr double kUsualRateHz = 30;

// The blobs as detections, the strongest first, without those below `least` and without a weaker
// one of the same object. Scores are the contrast-to-noise ratios.
std::vector<results::Detection> detections_of(std::vector<Blob> blobs, double least);

// Noise alone reaches a detector's confident score this often.
inline constexpr double kNoiseAlarmsPerHour = 1;

// The number of standard deviations that independent normal samples exceed, to either side,
// kNoiseAlarmsPerHour times in an hour: 2 n Q(z) of a frame, with n samples. Neighbouring samples
// of a smoothed picture are not independent, and exceed it less often.
double confident_deviations(double samples_per_frame, double frame_rate_hz);
// The log likelihood ratio that is exceeded as often at most. Where there is no target, the mean of
// a likelihood ratio is 1, so that it exceeds x with a probability of at most 1 / x (Markov).
double confident_log_ratio(double cells_per_frame, double frame_rate_hz);

}  // namespace airtruth::classical
