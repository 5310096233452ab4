// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "runners/network/model_description.h"
#include "runners/network/network_child.h"
#include "runners/results/detections.h"

// A network's outputs as detections.
namespace airtruth::network {

// Of one piece; the strongest are kept. Far above what a frame shows, it bounds the time that
// duplicates take where a threshold is too low.
constexpr std::size_t kMostDetections = 1000;

// The detections in the piece's pixels, the highest score first. `outputs` are in the order of
// output_names(); width and height are of the network's input.
//
// A cell is a detection where its heat is at or above the threshold and no cell of the eight around
// it is hotter. Example: with cells of 4 px, heat 0.8 in the cell of column 10 and row 5, offset
// (0.25, 0.5) and size (12, 6) px the centre is ((10 + 0.25) * 4, (5 + 0.5) * 4) = (41, 22), and
// the box is {35, 19, 12, 6}.
//
// Throws Error, with a text that goes on after the model's name, where the shapes are not as the
// description says, and where a score, or the box of a detection, is not finite.
std::vector<results::Detection> decoded(const std::vector<Tensor>& outputs,
                                        const ModelDescription& description,
                                        int width,
                                        int height);

// A detection with whether its box touches a side at which the frame goes on beyond the piece.
struct PieceDetection {
  results::Detection detection;  // in the frame's pixels
  int piece = 0;
  bool cut = false;
};

// The detections of a frame without duplicates, the highest score first. Two detections of one
// class are duplicates where their intersection over union is above nms_iou, and where they come
// from different pieces and the centre of the smaller one lies within the larger one (two answers
// for an aircraft of 6 px may be 2 px apart, and a cut one is a part of the whole). A whole one is
// kept before a cut one, then the one with the higher score.
std::vector<results::Detection> without_duplicates(std::vector<PieceDetection> detections,
                                                   double nms_iou);

}  // namespace airtruth::network
