// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "scene/scene/limits.h"

// Records the keys that readers of TOML tables use, so that a test can visit every key of a format
// without its own list. This header is not installed.
namespace airtruth::scene {

enum class NumberShape { kOne, kList, kTuple, kPoints };

struct NumberKey {
  NumberShape shape = NumberShape::kOne;
  // One range for all numbers, or one for each place of a tuple or point.
  std::vector<Limits> limits;
};
struct WholeKey {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

// While a KeyLog exists, every TableReader of the same thread records the keys that it accepts, the
// keys that it reads and their ranges. A key is named by its path: "background[0].lens.focal_px". A
// thread holds one KeyLog at a time.
class KeyLog {
 public:
  KeyLog();
  ~KeyLog();
  KeyLog(const KeyLog&) = delete;
  KeyLog& operator=(const KeyLog&) = delete;

  const std::set<std::string>& known() const { return known_; }
  const std::set<std::string>& read() const { return read_; }
  const std::map<std::string, NumberKey>& numbers() const { return numbers_; }
  const std::map<std::string, WholeKey>& wholes() const { return wholes_; }

  // TableReader calls these functions. They do nothing while the thread has no KeyLog.
  static void note_known(const std::string& path);
  static void note_read(const std::string& path);
  static void note_numbers(const std::string& path,
                           NumberShape shape,
                           const std::vector<Limits>& limits);
  static void note_whole(const std::string& path, std::int64_t low, std::int64_t high);

 private:
  std::set<std::string> known_;
  std::set<std::string> read_;
  std::map<std::string, NumberKey> numbers_;
  std::map<std::string, WholeKey> wholes_;
};

}  // namespace airtruth::scene
