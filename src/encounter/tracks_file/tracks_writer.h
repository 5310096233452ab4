// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "encounter/tracks_file/tracks_file.h"

// Writes a file of encounters piece by piece, so that a large set never stands in memory.
namespace airtruth::encounter {

// The bytes of encounter `number` (from 1) in a file whose encounters have `aircraft` aircraft.
// Throws Error where the format cannot hold it.
std::string bytes_of(const Encounter& encounter,
                     TracksFormat format,
                     std::uint64_t number,
                     std::uint32_t aircraft);

// A file under a temporary name, which gets its final name in finish(). Where the object goes
// without finish(), the file is removed. Every function throws Error where the disk refuses.
class TracksWriter {
 public:
  // Announces the number of encounters and of aircraft in each.
  TracksWriter(const fs::path& file, std::uint32_t encounters, std::uint32_t aircraft);
  TracksWriter(const TracksWriter&) = delete;
  TracksWriter& operator=(const TracksWriter&) = delete;
  ~TracksWriter();

  // Appends what bytes_of() gave, encounter after encounter.
  void append(std::string_view bytes);
  void finish();

 private:
  struct Part;
  std::unique_ptr<Part> part_;
};

// Writes all encounters, which fitted() fits to the file's format. Throws Error where the format
// cannot hold them or the file cannot be written.
void write_encounters(const fs::path& file, const std::vector<Encounter>& encounters);

}  // namespace airtruth::encounter
