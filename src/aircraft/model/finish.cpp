// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/finish.h"

#include <algorithm>
#include <array>
#include <string>

namespace airtruth::aircraft {
namespace {

// In English, and in the other languages that models of the catalogue use.
constexpr std::array<std::string_view, 13> kGlassWords = {"glass",
                                                          "plexiglass",
                                                          "plexiglas",
                                                          "perspex",
                                                          "window",
                                                          "windows",
                                                          "windshield",
                                                          "windscreen",
                                                          "canopy",
                                                          "cristal",
                                                          "verre",
                                                          "vitre",
                                                          "vitres"};
constexpr std::array<std::string_view, 9> kMetalWords = {
    "metal", "chrome", "cromo", "aluminium", "aluminum", "steel", "titanium", "titanio", "mirror"};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

template <std::size_t kCount>
bool is_one_of(const std::array<std::string_view, kCount>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

Finish finish_named(std::string_view material) {
  Finish finish = Finish::kPaint;
  std::string word;
  for (std::size_t i = 0; i <= material.size(); ++i) {
    if (i < material.size() && is_letter(material[i])) {
      word += static_cast<char>(material[i] | 0x20);
      continue;
    }
    if (is_one_of(kGlassWords, word)) return Finish::kGlass;
    if (is_one_of(kMetalWords, word)) finish = Finish::kMetal;
    word.clear();
  }
  return finish;
}

}  // namespace airtruth::aircraft
