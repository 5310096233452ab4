// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "world/scene/limits.h"

// What readers of tables ask for, so that a test can walk every key of a format without a list of
// its own. Not installed.
namespace airtruth::scene {

enum class NumberShape { kOne, kList, kTuple, kPoints };

struct NumberKey {
  NumberShape shape = NumberShape::kOne;
  std::vector<Limits> limits;  // one, or one for each place of a tuple or point
};
struct WholeKey {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

// While one lives, the TableReaders of its thread write down which keys they know, which they read,
// and within what ranges. A key is named by its path: "background[0].lens.focal_px". One at a time
// on a thread.
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

  // For TableReader; each does nothing where no log lives.
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
