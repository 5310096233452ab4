// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <airtruth/labels.h>

#include "foundation/base/files.h"
#include "foundation/base/log.h"

// Helpers that the formats' readers and writers share.
namespace airtruth::exchange {

// True where a set has this file. Throws Error where it is a pipe or a device.
bool is_there(const fs::path& file);

// The lines of a text file, without blank lines and those that begin with '#'.
struct Line {
  // From 1.
  int number = 0;
  std::string text;
  // A blank line lies between it and the one before it, or the file's begin.
  bool is_behind_blank = false;
};
std::vector<Line> lines_of(const fs::path& file);

// The text as a finite number, with or without blanks around it; empty where it is not one.
std::optional<double> number_in(std::string_view text);
// The shortest text that reads back as the same number.
std::string number(double value);

// The numbers of a line, split at commas or semicolons, tabs and blanks. "nan" is a number. Throws
// Error with the line and the column, also for an empty cell that others follow and for a line with
// commas and semicolons, whose commas are decimal ones.
std::vector<double> numbers_of(const Line& line, const fs::path& file);

// Lines of the form `key = value` or `key=value`; [sections] are skipped.
std::map<std::string, std::string> settings_of(const fs::path& file);
std::optional<double> number_in(const std::map<std::string, std::string>& settings,
                                const std::string& key);

// Largest number of frames of a clip, 4.6 hours at 30 frames/s. A longer clip is taken for an error
// in its file.
constexpr std::int64_t kMaxFrames = 500'000;

// Largest id of a track in a file.
constexpr std::int64_t kMaxTracks = 1'000'000'000;

// The number as an integer where it is whole and within [low, high]; else empty.
std::optional<std::int64_t> whole_in(double value, std::int64_t low, std::int64_t high);

// The side of a picture, in pixels; 0 (unknown) where the value is missing or invalid.
int side_of(const std::optional<double>& value);

// The text with a blank for each control character: a category, which other formats let hold line
// ends, on a line of a file.
std::string one_line(std::string text);

// "NAME_000123" -> {"NAME", 123}. Without a number at the end the result is {the whole text,
// empty}.
std::pair<std::string, std::optional<std::int64_t>> name_and_number(const std::string& stem);

// True for a box that has an area and touches the picture (of unknown size: any such box). The
// readers omit other boxes with a warning.
bool is_in_picture(const Box& box, int width, int height);

// Why a label is left out whose box has no area or lies outside the picture.
inline constexpr const char* kOutside = "boxes that are empty or outside their image";

// The part of a box that lies in the picture (of unknown size: the whole box); empty where none
// does.
std::optional<Box> clipped(const Box& box, int width, int height);

// The bounds of the ones of a mask in VOT's words: x, y, width, height of its window, and run
// lengths along the rows of that, of which the first counts zeros. The runs fit the window.
// `origin_px`: the coordinate that the numbers give to the first pixel, 0 or 1; the bounds count
// from 0. Empty where the mask has no ones.
std::optional<Box> bounds_of_mask(const std::vector<double>& numbers, int origin_px = 0);

// Counts omitted items by reason, and warns once for each reason when it is destroyed.
class LeftOut {
 public:
  explicit LeftOut(const Warn& warn) : warn_(warn) {}
  ~LeftOut();
  void add(const std::string& why, const std::string& first);

 private:
  const Warn& warn_;
  std::map<std::string, std::pair<int, std::string>> found_;
};

}  // namespace airtruth::exchange
