// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/names.h"
#include "studio/document/change.h"

namespace airtruth::messages {

enum class Act {
  kOpen,
  kEdit,
  kUndo,
  kRedo,
  kSave,
  kReload,
  kKeep,
  kFrame,
  kPlan,
  kNearMiss,
  kAircraft,
  kCalibrate,
  kRender,
  kCancel
};
constexpr auto enum_names(Act) {
  return std::to_array<EnumName<Act>>({{Act::kOpen, "open"},
                                       {Act::kEdit, "edit"},
                                       {Act::kUndo, "undo"},
                                       {Act::kRedo, "redo"},
                                       {Act::kSave, "save"},
                                       {Act::kReload, "reload"},
                                       {Act::kKeep, "keep"},
                                       {Act::kFrame, "frame"},
                                       {Act::kPlan, "plan"},
                                       {Act::kNearMiss, "near_miss"},
                                       {Act::kAircraft, "aircraft"},
                                       {Act::kCalibrate, "calibrate"},
                                       {Act::kRender, "render"},
                                       {Act::kCancel, "cancel"}});
}

// A straight path through the place of an intruder in a frame, and then past the own aircraft: at a
// distance, on the right or on the left of its course, above it or, where that is empty, level.
struct NearMiss {
  std::size_t intruder = 0;
  std::int64_t frame = 0;
  double miss_m = 0;
  bool is_right = true;
  double speed_mps = 0;
  std::optional<double> above_m;
};

// What a page asks for in one message: {"id": 7, "do": "...", ...}.
struct Request {
  std::int64_t id = 0;
  Act act = Act::kOpen;
  // edit
  std::vector<document::Change> changes;
  std::string merge;
  std::string upon;  // the SHA-256 of the text that it is made upon; "": any
  // frame
  std::int64_t frame = 0;
  bool aircraft = true;
  // The part of the picture that changed since the page's last picture of that frame.
  bool crops_to_change = false;
  double scale = 1;
  NearMiss near_miss;
  // aircraft
  std::string search;
};

// An edit may hold a table as large as a scene file, 16 MiB (scene/scene/tables.h).
inline constexpr std::size_t kMostRequestBytes = std::size_t{16} << 20;

// The id of a message that has one, also where the rest of it is wrong; else empty.
std::optional<std::int64_t> id_of(std::string_view text);

// Throws Error where the text is no message of the page.
Request request_from(std::string_view text);

// The address of an HTTP request, which the server reads itself: of "/thumb?frame=7&name=a%2Fb" the
// path as it stands, and the values without their escapes.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;

  // "" where it is missing.
  std::string value(const std::string& key) const;
  // Empty where it is no whole number from `least` to `most`.
  std::optional<std::int64_t> whole(const std::string& key,
                                    std::int64_t least,
                                    std::int64_t most) const;
};

// Empty for what is no target of this server: one that is too long, or has a wrong escape.
std::optional<Target> target_from(std::string_view text);

// The bytes that a header `Range: bytes=...` asks for of a file of `size`, first and last, at most
// `most` of them; empty for any other form, which means the whole file.
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};
std::optional<ByteRange> range_from(std::string_view header,
                                    std::uint64_t size,
                                    std::uint64_t most);

}  // namespace airtruth::messages
