// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"

// Results that take long to compute and are kept on the disk from one run to the next: measured
// motion, calibrations, converted models, ambient visibility. A result is named by a hash of all
// that it depends on, so that an entry is never out of date: it is there, or it is missing.
//
//   const disk_cache::Cache cache(disk_cache::user_folder("motion"));
//   const auto key = disk_cache::Key("motion").add(video_sha256).add(options.seed);
//   if (auto known = cache.find(key, motion_from_text)) return *known;
//   cache.keep(key, text_from_motion(motion));
//
// An entry is a file of the key's name: the SHA-256 of the body, as 64 hex digits, and the body. It
// is written beside its place and renamed. An entry that is cut short, damaged, foreign or larger
// than kMaxEntryBytes counts as missing, and so does one in a folder that cannot be read. A folder
// that cannot be written costs the next run the computation, and is no error. A folder that is
// another user's, or that group or others may write, is not used: anybody's entry could lie in it.
namespace airtruth::disk_cache {

// The folder of one kind of results below $XDG_CACHE_HOME/airtruth, else below ~/.cache/airtruth.
// Empty, so that nothing is kept, where the environment names neither by an absolute path.
std::filesystem::path user_folder(const char* kind);

// A folder that was there and that this process has not used, since it is not the user's alone;
// empty: none.
std::filesystem::path refused_folder();

// The largest entry. The largest that a use of the cache makes is a model at its own limits.
constexpr std::size_t kMaxEntryBytes = std::size_t{512} << 20;

// All that a result depends on. The build of the program is always among it, since another build
// may compute another result: no method needs a version number that somebody has to increase.
class Key {
 public:
  // `kind` tells apart the results of different methods: "motion".
  explicit Key(std::string_view kind);
  // Texts are added with their length: ("ab", "c") and ("a", "bc") are different keys.
  Key& add(std::string_view text);
  template <typename Number>
  requires std::is_arithmetic_v<Number> Key& add(Number number) {
    return add(std::string_view(reinterpret_cast<const char*>(&number), sizeof(number)));
  }
  // 64 hex digits.
  std::string name() const;

 private:
  std::string bytes_;
};

class Cache {
 public:
  // Keeps nothing.
  Cache() = default;
  // An empty folder: keeps nothing. A missing folder is made when the first entry is kept.
  explicit Cache(std::filesystem::path folder) : folder_(std::move(folder)) {}
  bool keeps() const { return !folder_.empty(); }

  // The body of the entry.
  std::optional<std::string> find(const Key& key) const;
  // What `parse` makes of the body. A body that it refuses with an Error counts as missing.
  template <typename Parse>
  auto find(const Key& key, const Parse& parse) const
      -> std::optional<decltype(parse(std::string()))> {
    const std::optional<std::string> body = find(key);
    if (!body) return std::nullopt;
    try {
      return parse(*body);
    } catch (const Error&) {
      return std::nullopt;
    }
  }

  // Writes or replaces the entry, and removes entries of the folder that nobody has read or written
  // for 90 days: those of earlier builds, for the most part.
  void keep(const Key& key, std::string_view body) const;

  // A lock for the thread or process that computes the entry, while others wait for its result.
  // Null where nothing is kept. Throws Interrupted where `stop` is requested while it waits.
  std::unique_ptr<WaitingLock> lock(const Key& key, const std::stop_token& stop) const;

 private:
  bool is_own() const;
  void make() const;

  std::filesystem::path folder_;
};

}  // namespace airtruth::disk_cache
