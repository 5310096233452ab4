// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/finish.h"

#include <string>

namespace airtruth::model {
namespace {

// In English, and in the other languages that models of the catalogue use; blanks around each word.
constexpr std::string_view kGlassWords =
    " glass plexiglass plexiglas perspex window windows windshield windscreen canopy cristal verre "
    "vitre vitres ";
constexpr std::string_view kMetalWords =
    " metal chrome cromo aluminium aluminum steel titanium titanio mirror ";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

Finish finish_named(std::string_view material) {
  Finish finish = Finish::kPaint;
  std::string word = " ";
  for (std::size_t i = 0; i <= material.size(); ++i) {
    if (i < material.size() && is_letter(material[i])) {
      word += static_cast<char>(material[i] | 0x20);  // a small letter
      continue;
    }
    if (word.size() > 1) {
      word += ' ';
      if (kGlassWords.find(word) != std::string_view::npos) return Finish::kGlass;
      if (kMetalWords.find(word) != std::string_view::npos) finish = Finish::kMetal;
    }
    word.resize(1);
  }
  return finish;
}

}  // namespace airtruth::model
