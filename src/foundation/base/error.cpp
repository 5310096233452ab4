// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/error.h"

#include <algorithm>
#include <stdexcept>

namespace airtruth {
namespace {

std::string with_place(std::string_view message, const Where& where) {
  const std::string place = to_string(where);
  return place.empty() ? std::string(message) : place + ": " + std::string(message);
}

}  // namespace

std::string to_string(const Where& where) {
  std::string text = where.file;
  if (where.line > 0) {
    text += ":" + std::to_string(where.line);
    if (where.column > 0) text += ":" + std::to_string(where.column);
  }
  return text;
}

std::string without_nul(std::string_view text) {
  std::string shown(text);
  std::ranges::replace(shown, '\0', '?');
  return shown;
}

Error::Error(std::string_view message, Where where)
    : std::runtime_error(without_nul(with_place(message, where))),
      message_(without_nul(message)),
      where_(std::move(where)) {}

Error::~Error() = default;

Interrupted::Interrupted() : std::runtime_error("interrupted") {}
Interrupted::~Interrupted() = default;

void check(bool condition, std::string_view what) {
  if (!condition) throw std::logic_error("internal error: " + std::string(what));
}

}  // namespace airtruth
