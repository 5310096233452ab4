// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// The order of pictures by their names, and the series that the pictures of a folder form.
namespace airtruth::picture_series {

// True for a file whose ending is that of a picture (.png, .jpg, .jpeg, .bmp, .tif, .tiff, .ppm,
// .pgm, .webp), whatever the case of its letters.
bool is_picture_file(const std::filesystem::path& file);

// The names of the pictures in a folder, sorted, without hidden ones. Throws Error where one is a
// pipe or a device.
std::vector<std::string> pictures_in(const std::filesystem::path& folder);

// Compares texts, with every run of digits as a number of any length.
//
//   is_numbered_before("f9.png", "f10.png"), !is_numbered_before("f10.png", "f9.png")
bool is_numbered_before(std::string_view a, std::string_view b);

// A series: pictures of one clip, as their places in a list of names, in the order of the names.
using Series = std::vector<std::size_t>;

// What a picture is whose name has no other of its series.
enum class Stray {
  kOfOneSeries,  // with it all pictures are one series, as those are whose names are UUIDs
  kApart,        // a series of its own beside others; where all are strays, they are one series
};

// The series of the pictures of one folder. Names of one series differ in their numbers alone; they
// end alike, whatever the case of their letters. Where names differ in several numbers and the last
// one begins anew at 0 or 1 ("pass-1_000000", "pass-2_000000"), each beginning is a series.
// A suffix ".rf." with hexadecimal digits, which Roboflow adds to every name, is left out.
//
//   series_of({"b_2.jpg", "a_1.jpg", "b_1.jpg", "a_2.jpg"}, stray) == {{1, 3}, {2, 0}}
std::vector<Series> series_of(std::span<const std::string> names, Stray stray);

// What the names of a series have in common before the number that counts them, without '_', '-',
// '.' and blanks at its end: "pass-1" of "pass-1_000000.jpg" and "pass-1_000012.jpg". It may be
// empty.
std::string common_name(std::span<const std::string> names);

}  // namespace airtruth::picture_series
