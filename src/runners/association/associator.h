// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runners/association/direction_filter.h"
#include "runners/detector/detector.h"
#include "runners/results/detections.h"

// Makes tracks of the detections of any detector, frame by frame.
//
// Each track predicts where its target is on the sphere, with the camera's measured turn taken into
// account. A detection belongs to a track at most, within a chi-square gate on bearing and size,
// such that all tracks together fit best (the least sum of negative log likelihoods). As in
// ByteTrack (Zhang et al. 2022, section 3) confident detections are given to the declared tracks
// first, then weak ones to the declared tracks that are left, then the remaining confident ones to
// tracks that are not yet declared; what is left of these begins new ones. A weak detection so
// keeps a track alive, and can never begin one.
//
// A track is declared in the frame in which it has its M-th confident detection, where that is one
// of the N frames from its first detection on; otherwise it ends as soon as that is impossible. Its
// detections carry its number from the declaration on. Earlier frames are not changed, since a
// sense-and-avoid system cannot change what it has reported.
//
// Example, with 3 of 5: a target is detected in frames 0, 1, 3 and 4. Its track is declared in
// frame 3, and the detections of frames 3 and 4 have track 1.
namespace airtruth::association {

struct AssociationOptions {
  int declare_m = 3;  // 1 to declare_n
  int declare_n = 5;  // 1 to 1000
  // The least score of a confident detection. Empty: every detection is confident.
  std::optional<double> confident_score;
};

// Throws Error where a value is out of its range.
void validate(const AssociationOptions& options);

class Associator {
 public:
  explicit Associator(const AssociationOptions& options = {});

  // Forgets the tracks of the sequence before. Numbers of tracks begin with 1 again.
  void begin(const detector::SequenceInput& sequence);

  // The same detections in the same order, each with its track where that is declared. Where
  // a shot begins, all tracks end. Where a frame has no turn, the camera may have turned by
  // 0.3 rad/s, and gates are as wide as that asks for. A detection where the lens has no ray
  // belongs to no track. FrameInput's picture is not used.
  std::vector<results::Detection> step(const detector::FrameInput& frame,
                                       std::vector<results::Detection> detections);

 private:
  struct Track {
    DirectionFilter filter;
    std::string category;
    int frames = 1;  // since its first detection, that frame included
    int hits = 1;    // of them, those with a confident detection
    double seen_s = 0;
    std::optional<std::int64_t> number;    // declared
    std::optional<std::size_t> detection;  // of this frame
  };
  struct Seen {
    std::size_t index;  // among the frame's detections
    Sighting sighting;
    bool confident;
    bool taken = false;  // by a track
  };
  std::optional<Sighting> sighting_of(const Box& box) const;
  std::vector<Seen> seen_in(const std::vector<results::Detection>& detections) const;
  void predict(const detector::FrameInput& frame);
  // Gives detections of one confidence to tracks of one state that have none yet.
  void match(const std::vector<results::Detection>& detections,
             std::vector<Seen>& seen,
             bool declared,
             bool confident);
  void begin_tracks(const std::vector<results::Detection>& detections,
                    const std::vector<Seen>& seen);
  void declare(std::vector<results::Detection>& detections);
  void end_tracks();

  AssociationOptions options_;
  std::optional<lens::Lens> lens_;
  double rad_per_px_ = 0;  // in the middle of the picture
  std::vector<Track> tracks_;
  std::int64_t declared_ = 0;
  double time_s_ = 0;  // of the latest frame
};

}  // namespace airtruth::association
