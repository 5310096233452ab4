// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/part_names.h"

#include <algorithm>
#include <string_view>

#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::wrapper {
namespace {

bool contains_any(const std::string& text, std::string_view parts) {
  return std::ranges::any_of(words_in<std::string_view>(parts), [&](std::string_view part) {
    return text.find(part) != std::string::npos;
  });
}

std::string without(std::string text, std::string_view word) {
  const auto at = text.find(word);
  return at == std::string::npos ? text : text.erase(at, word.size());
}

bool is_small(char c) { return c >= 'a' && c <= 'z'; }
bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

// The words in small letters, each between blanks. A word is a run of letters, and a capital after
// a small letter begins one: "NavLights-2" is "nav" and "lights".
std::string words_of(std::string_view name) {
  std::string words = " ";
  char before = ' ';
  for (const char c : name) {
    const bool is_letter = is_small(c) || is_capital(c);
    if (!is_letter || (is_capital(c) && is_small(before))) words += ' ';
    if (is_letter) words += static_cast<char>(c | 0x20);  // a small letter
    before = c;
  }
  return words + ' ';
}

bool has_any_word(std::string_view name, std::string_view wanted) {
  const std::vector<std::string> words = words_in(words_of(name));
  return std::ranges::find_first_of(words, words_in(wanted)) != words.end();
}

}  // namespace

bool is_effect_path(const std::string& path) {
  std::string text = path;
  std::replace(text.begin(), text.end(), '\\', '/');
  // "Aircraft/NAME/" says nothing of the part: NAME may be UltraLight.
  constexpr std::string_view kAircraft = "aircraft/";
  const auto at = lower_case(text).find(kAircraft);
  const auto name = at == std::string::npos ? at : at + kAircraft.size();
  if (const auto end = text.find('/', name); end != std::string::npos) text.erase(0, end);
  return contains_any(lower_case(text), "/effects/ /sounds/ /sound/") ||
         has_any_word(text,
                      "light lights navlight navlights landinglight landinglights taxilight "
                      "taxilights beacon beacons strobe strobes halo flare smoke contrail "
                      "contrails rain exhaust exhausts");
}

bool is_effect_name(const std::string& file) {
  std::string text = lower_case(file);
  std::replace(text.begin(), text.end(), '\\', '/');
  // An aircraft; and "train" as well as "trainer".
  text = without(without(std::move(text), "lightning"), "train");
  return contains_any(text,
                      "light beacon strobe halo flare /effects/ smoke contrail rain /sounds/ "
                      "/sound/ exhaust");
}

bool is_effect(const std::string& object) {
  const std::string name = without(lower_case(object), "noshadow");  // "Disk.noshadow" casts none
  return contains_any(name, "halo glow shadow contrail smoke flare beam vapor") ||
         has_any_word(object, "chock chocks") ||
         (object.ends_with("On") && contains_any(name, "light beacon strobe"));
}

bool is_propeller_disc(const std::vector<std::string>& names) {
  if (names.empty()) return false;
  const std::string name = lower_case(names.back());
  if (contains_any(name, "fan eng")) return false;
  const std::string words = words_of(names.back());
  return contains_any(name, "_blur -blur") || words.starts_with(" disk ") ||
         words.starts_with(" disc ") || words.starts_with(" disklh") ||
         words.starts_with(" diskrh") ||  // "disklha"; and no Discus
         (contains_any(name, "prop prplr rotor helice") &&
          contains_any(name, "disk disc disque blur fast"));
}

bool is_wheel(const std::string& object) {
  return contains_any(lower_case(object), "wheel tire tyre roue gear");
}

}  // namespace airtruth::wrapper
