// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/sample_memory.h"

#include <map>
#include <mutex>
#include <new>
#include <vector>

namespace airtruth::image {
namespace {

// Bytes of a line of the cache.
constexpr std::align_val_t kAlignment{64};
// Smaller blocks are malloc()'s business: it keeps and joins them well.
constexpr std::size_t kMinKeptBytes = 64 << 10;
// The planes of some 50 frames of 1920x1080; beyond it memory goes back to malloc(). Sanitizers
// have to see every plane's end.
#ifdef AIRTRUTH_SANITIZED
constexpr std::size_t kMaxFreeBytes = 0;
#else
constexpr std::size_t kMaxFreeBytes = std::size_t{160} << 20;
#endif

void release(std::uint8_t* samples) noexcept { ::operator delete[](samples, kAlignment); }

// Lives to the end of the process: planes may be given back by destructors of statics.
class Pool {
 public:
  std::uint8_t* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto place = free_.find(bytes);
    if (place == free_.end() || place->second.empty()) return nullptr;
    std::uint8_t* samples = place->second.back();
    place->second.pop_back();
    free_bytes_ -= bytes;
    return samples;
  }

  void give_back(std::uint8_t* samples, std::size_t bytes) noexcept {
    try {
      const std::lock_guard lock(mutex_);
      if (free_bytes_ + bytes <= kMaxFreeBytes) {
        free_[bytes].push_back(samples);
        free_bytes_ += bytes;
        return;
      }
    } catch (const std::bad_alloc&) {  // no room in the list of free blocks
    }
    release(samples);
  }

  std::size_t free_bytes() {
    const std::lock_guard lock(mutex_);
    return free_bytes_;
  }

 private:
  std::mutex mutex_;
  std::map<std::size_t, std::vector<std::uint8_t*>> free_;  // by size in bytes
  std::size_t free_bytes_ = 0;
};

Pool& pool() {
  static Pool& one = *new Pool;
  return one;
}

}  // namespace

void GiveBack::operator()(std::uint8_t* samples) noexcept {
  if (bytes_ < kMinKeptBytes) {
    release(samples);
  } else {
    pool().give_back(samples, bytes_);
  }
}

SampleMemory take_samples(std::size_t bytes) {
  std::uint8_t* samples = bytes < kMinKeptBytes ? nullptr : pool().take(bytes);
  if (samples == nullptr) samples = static_cast<std::uint8_t*>(::operator new[](bytes, kAlignment));
  return SampleMemory(samples, GiveBack(bytes));
}

std::size_t free_sample_bytes() { return pool().free_bytes(); }

}  // namespace airtruth::image
