// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/key_log.h"

#include "foundation/base/error.h"

namespace airtruth::scene {
namespace {

thread_local KeyLog* t_key_log = nullptr;

}  // namespace

KeyLog::KeyLog() {
  check(t_key_log == nullptr, "one key log lives at a time");
  t_key_log = this;
}

KeyLog::~KeyLog() { t_key_log = nullptr; }

void KeyLog::note_known(const std::string& path) {
  if (t_key_log != nullptr) t_key_log->known_.insert(path);
}

void KeyLog::note_read(const std::string& path) {
  if (t_key_log != nullptr) t_key_log->read_.insert(path);
}

void KeyLog::note_numbers(const std::string& path,
                          NumberShape shape,
                          const std::vector<Limits>& limits) {
  if (t_key_log != nullptr) t_key_log->numbers_[path] = {shape, limits};
}

void KeyLog::note_whole(const std::string& path, std::int64_t low, std::int64_t high) {
  if (t_key_log != nullptr) t_key_log->wholes_[path] = {low, high};
}

}  // namespace airtruth::scene
