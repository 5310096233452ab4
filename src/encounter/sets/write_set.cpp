// SPDX-License-Identifier: Apache-2.0
#include "encounter/sets/write_set.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"

namespace airtruth::sets {
namespace {

// A thread draws a block at a time; a window of blocks stands in memory.
constexpr std::uint64_t kBlock = 64;
constexpr std::uint64_t kBlocksOfWindow = 32;
// The number of encounters is 32 bits wide in a waypoint file.
constexpr std::uint64_t kMaxCount = 0xffffffff;

struct Block {
  std::string bytes;
  std::vector<track::Encounter> encounters;  // where the bytes are those of all of them at once
  SetSummary summary;
};

void add(SetSummary& sum, const SetSummary& more) {
  sum.encounters += more.encounters;
  sum.draws += more.draws;
  sum.weight_sum += more.weight_sum;
  sum.weight_squares += more.weight_squares;
}

bool is_stream(tracks_file::TracksFormat format) {
  return format == tracks_file::TracksFormat::kCsv ||
         format == tracks_file::TracksFormat::kWaypoints;
}

// The bytes are those of `format`, where it is given.
Block drawn_block(const DrawEncounter& draw,
                  std::uint64_t begin,
                  std::uint64_t end,
                  std::optional<tracks_file::TracksFormat> format) {
  Block block;
  for (std::uint64_t i = begin; i < end; ++i) {
    DrawnEncounter drawn = draw(i);
    const double weight = drawn.encounter.weight;
    add(block.summary, {1, static_cast<std::uint64_t>(drawn.draws), weight, weight * weight});
    const auto aircraft = static_cast<std::uint32_t>(drawn.encounter.aircraft.size());
    if (format)
      block.bytes += tracks_file::bytes_of(drawn.encounter, *format, i + 1, aircraft);
    else
      block.encounters.push_back(std::move(drawn.encounter));
  }
  return block;
}

// Calls take(block) for each block in order.
template <typename Take>
void for_each_block(const DrawEncounter& draw,
                    const SetOptions& options,
                    std::optional<tracks_file::TracksFormat> format,
                    const Take& take) {
  const std::uint64_t blocks = (options.count + kBlock - 1) / kBlock;
  for (std::uint64_t first = 0; first < blocks; first += kBlocksOfWindow) {
    std::vector<Block> window(std::min(kBlocksOfWindow, blocks - first));
    const auto draw_one = [&](std::size_t k) {
      const std::uint64_t begin = (first + k) * kBlock;
      window[k] = drawn_block(draw, begin, std::min(begin + kBlock, options.count), format);
    };
    in_parallel(window.size(), options.jobs, draw_one, {}, options.stop);
    for (Block& block : window) take(block);
    if (options.progress)
      options.progress(
          static_cast<std::int64_t>(std::min((first + window.size()) * kBlock, options.count)),
          static_cast<std::int64_t>(options.count));
  }
}

void expect_count(std::uint64_t count, std::uint64_t most) {
  if (count < 1 || count > most)
    throw Error(fmt::format("{} encounters are asked for; expected 1 to {}", count, most));
}

}  // namespace

DrawnSet draw_set(const DrawEncounter& draw, const SetOptions& options) {
  expect_count(options.count, kMaxInMemory);
  DrawnSet set;
  for_each_block(draw, options, {}, [&](Block& block) {
    add(set.summary, block.summary);
    std::move(block.encounters.begin(), block.encounters.end(), std::back_inserter(set.encounters));
  });
  return set;
}

SetSummary write_set(const std::filesystem::path& file,
                     const DrawEncounter& draw,
                     const SetOptions& options) {
  expect_count(options.count, kMaxCount);
  const tracks_file::TracksFormat format = tracks_file::tracks_format_of(file);
  if (!is_stream(format)) {
    DrawnSet set = draw_set(draw, options);
    tracks_file::write_encounters(file,
                                  tracks_file::fitted(std::move(set.encounters), format, file));
    return set.summary;
  }
  SetSummary summary;
  const auto aircraft = static_cast<std::uint32_t>(draw(0).encounter.aircraft.size());
  write_file(file, [&](const AddBytes& add_bytes) {
    add_bytes(tracks_file::head_of(format, static_cast<std::uint32_t>(options.count), aircraft));
    for_each_block(draw, options, format, [&](const Block& block) {
      add(summary, block.summary);
      add_bytes(block.bytes);
    });
  });
  return summary;
}

}  // namespace airtruth::sets
