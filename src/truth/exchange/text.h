// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "foundation/base/log.h"
#include "truth/exchange/labels.h"

// What the formats' readers and writers have in common.
namespace airtruth::exchange {

// The lines of a text file, without blank ones and those that begin with '#'.
struct Line {
  int number = 0;  // from 1
  std::string text;
};
std::vector<Line> lines_of(const fs::path& file);

// Numbers of a line, split at commas, semicolons, tabs and blanks. "nan" is a number. Throws Error
// at the line.
std::vector<double> numbers_of(const Line& line, const fs::path& file);

// `key = value` or `key=value` lines; [sections] are passed over.
std::map<std::string, std::string> settings_of(const fs::path& file);
std::optional<double> number_in(const std::map<std::string, std::string>& settings,
                                const std::string& key);

// A clip longer than this (4.6 hours at 30 frames/s) is a slip of the pen.
constexpr std::int64_t kMostFrames = 500'000;

// The number, where it is whole and within [low, high].
std::optional<std::int64_t> whole_in(double value, std::int64_t low, std::int64_t high);
// A picture's side: 0 (unknown) where the number is none.
int side_of(const std::optional<double>& value);

// Whole numbers with zeros in front.
std::string padded(std::int64_t number, int digits);

// "NAME_000123" -> {"NAME", 123}; without a number at the end {whole, empty}.
std::pair<std::string, std::optional<std::int64_t>> name_and_number(const std::string& stem);

// Folders and files of a folder, sorted by name.
std::vector<fs::path> entries(const fs::path& folder);
std::vector<fs::path> files_with(const fs::path& folder, std::string_view extension);

// By number: names sort 10 before 2.
void sort_frames(Clip& clip);

// Width and height of the first picture in a folder; empty where there is none.
std::optional<std::pair<int, int>> size_of_pictures(const fs::path& folder);

// A box that has an area and touches the picture (of unknown size: any). Others are left out of
// what is read, with a warning that names `what`.
bool is_in_picture(const Box& box, int width, int height);

// The part of a box that lies in the picture (of unknown size: all of it); empty where there is
// none.
std::optional<Box> clipped(const Box& box, int width, int height);

// Counts what was left out, and says so once.
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
