// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "foundation/geometry/box.h"

// TraX, the protocol between a tracker and the program that evaluates it (Čehovin 2017, "TraX: The
// visual Tracking eXchange protocol and library", Neurocomputing 260; the encoding is that of
// libtrax 4). A message is one line: "@@TRAX:", the type, then arguments and properties. Each of
// these is a bare word or a quoted string with \" \\ and \n.
namespace airtruth::tracking {

enum class Type { kHello, kInitialize, kFrame, kState, kQuit };

struct Message {
  Type type = Type::kQuit;
  std::vector<std::string> arguments;
  std::vector<std::pair<std::string, std::string>> properties;  // key=value; keys [A-Za-z0-9._]
  bool operator==(const Message&) const = default;

  // The value of a property; "" where there is none.
  std::string_view property(std::string_view key) const;
};

// The beginning of every message.
constexpr std::string_view kPrefix = "@@TRAX:";

// Parses a line without its line end. Returns empty for a line that is not a message. Throws
// process::Failure for a message of unknown type or with an open quote.
std::optional<Message> parse_line(std::string_view line);

// Returns the message as a line with its line end.
std::string line_of(const Message& message);

// Reads the region that a tracker reports: "x,y,w,h"; a polygon "x0,y0,x1,y1,x2,y2,..."; a mask
// "mask:x,y,w,h,n0,n1,..." of run lengths by rows, of which the first run is empty pixels; or one
// number, which means that there is no region. Polygons and masks become their bounding box.
// Returns empty for one number, for numbers that are not finite, and for a region without area.
// Throws process::Failure for any other text.
std::optional<Box> box_of(std::string_view region);
// True for "x,y,w,h" with a width or height below 0. Throws as box_of().
bool has_negative_side(std::string_view region);

std::string rectangle_of(const Box& box);
std::string polygon_of(const Box& box);  // its corners
std::string mask_of(const Box& box);     // the whole pixels that it covers by half

}  // namespace airtruth::tracking
