// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/toml_guard.h"

#include "foundation/base/error.h"

namespace airtruth::scene {
namespace {

constexpr int kDeepestBrackets = 32;
constexpr int kMaxDots = 16;

// Scans TOML as its lexer does: it skips strings and comments. On text that is not TOML the scan
// and the parser may disagree, but only after the place where the parser stops.
class Walk {
 public:
  Walk(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  void run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#')
        skip_comment();
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        step(c);
    }
  }

 private:
  void step(char c) {
    if (c == '[' || c == '{') ++brackets_;
    if ((c == ']' || c == '}') && brackets_ > 0) --brackets_;
    if (c == '.') ++dots_;
    if (c == '\n' || c == ',' || c == '=' || c == '{' || c == '}') dots_ = 0;
    if (c == '\n') ++line_;
    if (brackets_ > kDeepestBrackets || dots_ > kMaxDots)
      throw Error("is nested too deeply; a scene needs two levels", {file_, line_, 0});
    ++at_;
  }

  void skip_comment() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  bool starts_with(std::string_view token) const {
    return text_.substr(at_, token.size()) == token;
  }

  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool multiline = starts_with(three);
    const std::string end = multiline ? three : std::string(1, quote);
    at_ += end.size();
    while (at_ < text_.size() && !starts_with(end)) {
      if (text_[at_] == '\n') {
        if (!multiline) return;
        ++line_;
      }
      at_ += quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n'
                 ? 2
                 : 1;
    }
    at_ += end.size();
    // A multi-line string may end in one or two quotes that belong to its text.
    while (multiline && at_ < text_.size() && text_[at_] == quote) ++at_;
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_ = 1;
  int brackets_ = 0;
  int dots_ = 0;
};

}  // namespace

void refuse_deep_nesting(std::string_view text, const std::string& file) { Walk(text, file).run(); }

}  // namespace airtruth::scene
