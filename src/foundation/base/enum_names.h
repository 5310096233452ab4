// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Enums whose values have names in files. The module that owns an enum writes one table of the
// names beside it, as a function that argument-dependent lookup finds:
//
//   enum class Method { kMatte, kChromaKey };
//   constexpr auto enum_names(Method) {
//     return std::to_array<EnumName<Method>>(
//         {{Method::kMatte, "matte"}, {Method::kChromaKey, "chroma-key"}});
//   }
//   enum_name(Method::kMatte)           -> "matte"
//   enum_named<Method>("chroma-key")    -> Method::kChromaKey
//   enum_named<Method>("mat")           -> empty
namespace airtruth {

template <typename Enum>
struct EnumName {
  Enum value;
  // A string literal.
  const char* name;
};

// The name of a value; nullptr where the table lacks the value.
template <typename Enum>
constexpr const char* enum_name(Enum value) {
  for (const EnumName<Enum>& known : enum_names(value))
    if (known.value == value) return known.name;
  return nullptr;
}

// The value of that name; empty where no value has it. Letter case matters.
template <typename Enum>
constexpr std::optional<Enum> enum_named(std::string_view name) {
  for (const EnumName<Enum>& known : enum_names(Enum{}))
    if (known.name == name) return known.value;
  return std::nullopt;
}

// All names, in the order of the table.
template <typename Enum>
std::vector<std::string> all_enum_names() {
  std::vector<std::string> names;
  for (const EnumName<Enum>& known : enum_names(Enum{})) names.emplace_back(known.name);
  return names;
}

}  // namespace airtruth
