// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/wrapper_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <pugixml.hpp>

#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::aircraft {
namespace {

constexpr int kMaxConditionDepth = 64;

std::string trimmed(const char* text) {
  std::string result = text;
  const auto first = result.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return result.substr(first, result.find_last_not_of(" \t\r\n") - first + 1);
}

std::string text_of(const pugi::xml_node& node, const char* child) {
  return trimmed(node.child_value(child));
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* begin = text.c_str() + (text.rfind('+', 0) == 0 ? 1 : 0);
  const auto [rest, failed] = std::from_chars(begin, text.c_str() + text.size(), value);
  (void)rest;  // FlightGear reads "23,1722" as 23
  if (failed != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

double number(const pugi::xml_node& node, const char* child, double otherwise) {
  return number(text_of(node, child)).value_or(otherwise);
}

// Fields are spelled ".../x" or ".../x-m".
Vector3 vector(const pugi::xml_node& node, const char* suffix) {
  Vector3 v;
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    v[i] = number(node, (std::string(names[i]) + suffix).c_str(), number(node, names[i], 0));
  return v;
}

Condition condition_of(const pugi::xml_node& node, int depth = 0);

std::vector<Condition> parts_of(const pugi::xml_node& node, int depth) {
  std::vector<Condition> parts;
  if (depth > kMaxConditionDepth) return parts;
  for (const pugi::xml_node child : node.children())
    if (child.type() == pugi::node_element) parts.push_back(condition_of(child, depth + 1));
  return parts;
}

Condition comparison(const pugi::xml_node& node, Condition::Kind kind) {
  Condition condition;
  condition.kind = kind;
  const pugi::xml_node first = node.child("property");
  condition.property = trimmed(first.child_value());
  if (const pugi::xml_node second = first.next_sibling("property"))
    condition.other_property = trimmed(second.child_value());
  const std::string value = text_of(node, "value");
  const std::optional<double> stated = value == "true" ? 1 : number(value);
  condition.value = stated.value_or(0);
  condition.compares_text = !stated && !value.empty() && value != "false";
  return condition;
}

Condition condition_of(const pugi::xml_node& node, int depth) {
  using Kind = Condition::Kind;
  static const std::vector<std::pair<std::string, Kind>> kComparisons = {
      {"less-than", Kind::kLess},
      {"less-than-equals", Kind::kLessEquals},
      {"greater-than", Kind::kGreater},
      {"greater-than-equals", Kind::kGreaterEquals},
      {"equals", Kind::kEquals},
      {"not-equals", Kind::kNotEquals}};
  const std::string name = node.name();
  for (const auto& [word, kind] : kComparisons)
    if (name == word) return comparison(node, kind);
  Condition condition;
  if (name == "property") {
    condition.kind = Kind::kTrue;
    condition.property = trimmed(node.child_value());
    return condition;
  }
  // <condition> means the same as <and>.
  condition.kind = name == "or" ? Kind::kOr : name == "not" ? Kind::kNot : Kind::kAnd;
  condition.parts = parts_of(node, depth);
  return condition;
}

void read_axis(const pugi::xml_node& node, Animation& animation) {
  animation.centre = vector(node.child("center"), "-m");
  const pugi::xml_node axis = node.child("axis");
  animation.axis_object = text_of(axis, "object-name");
  if (axis.child("x1-m") || axis.child("y1-m") || axis.child("z1-m")) {
    const Vector3 a(number(axis, "x1-m", 0), number(axis, "y1-m", 0), number(axis, "z1-m", 0));
    const Vector3 b(number(axis, "x2-m", 0), number(axis, "y2-m", 0), number(axis, "z2-m", 0));
    animation.axis = b - a;
    if (!node.child("center")) animation.centre = 0.5 * (a + b);
  } else {
    animation.axis = vector(axis, "");
  }
}

std::vector<std::pair<double, double>> table_of(const pugi::xml_node& node) {
  std::vector<std::pair<double, double>> table;
  for (const pugi::xml_node entry : node.children("entry"))
    table.emplace_back(number(entry, "ind", 0), number(entry, "dep", 0));
  std::stable_sort(
      table.begin(), table.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return table;
}

// `prefix` and `suffix` of its fields: "" and "-deg", "-m", or "x-" and "".
Driven driven_by(const pugi::xml_node& node,
                 const std::string& prefix,
                 const std::string& suffix,
                 double offset) {
  const auto field = [&](const char* name) {
    const auto plain = number(text_of(node, (prefix + name).c_str()));
    return plain ? plain : number(text_of(node, (prefix + name + suffix).c_str()));
  };
  Driven driven;
  driven.property = text_of(node, "property");
  driven.factor = field("factor").value_or(prefix.empty() ? 1 : 0);
  driven.offset = field("offset").value_or(offset);
  driven.least = field("min");
  driven.most = field("max");
  return driven;
}

Animation animation_of(const pugi::xml_node& node) {
  Animation animation;
  animation.type = text_of(node, "type");
  animation.name = text_of(node, "name");
  for (const pugi::xml_node name : node.children("object-name"))
    animation.objects.push_back(trimmed(name.child_value()));
  if (const pugi::xml_node condition = node.child("condition"))
    animation.condition = condition_of(condition);
  const bool turns = animation.type == "rotate" || animation.type == "spin";
  animation.value = driven_by(node, "", turns ? "-deg" : "-m", 0);
  animation.value.table = table_of(node.child("interpolation"));
  animation.table_file = node.child("interpolation").attribute("include").value();
  if (animation.type == "scale")
    animation.scale = {
        driven_by(node, "x-", "", 1), driven_by(node, "y-", "", 1), driven_by(node, "z-", "", 1)};
  animation.least_m = number(node, "min-m", animation.least_m);
  animation.most_m = number(node, "max-m", animation.most_m);
  animation.texture = text_of(node, "texture");
  read_axis(node, animation);
  return animation;
}

// Pitch about y, then roll about x, then heading about z, then the translation.
Eigen::Affine3d offsets_of(const pugi::xml_node& node) {
  using Eigen::AngleAxisd;
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  if (!node) return result;
  result.translate(vector(node, "-m"));
  result.rotate(AngleAxisd(radians(number(node, "heading-deg", 0)), Vector3::UnitZ()) *
                AngleAxisd(radians(number(node, "roll-deg", 0)), Vector3::UnitX()) *
                AngleAxisd(radians(number(node, "pitch-deg", 0)), Vector3::UnitY()));
  return result;
}

pugi::xml_node load(pugi::xml_document& document, std::string_view text, const fs::path& name) {
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(std::string("is not XML: ") + parsed.description(),
                {name.string(), line_of(text, parsed.offset)});
  const pugi::xml_node root = document.child("PropertyList");
  if (!root) throw Error("has no <PropertyList>; expected a model of FlightGear", {name.string()});
  return root;
}

}  // namespace

WrapperText parse_wrapper(std::string_view text, const fs::path& name) {
  pugi::xml_document document;
  const pugi::xml_node root = load(document, text, name);
  WrapperText result;
  result.include = root.attribute("include").value();
  result.path = text_of(root, "path");
  result.texture_path = text_of(root, "texture-path");
  if (root.child("offsets")) result.parent_from_model = offsets_of(root.child("offsets"));
  for (const pugi::xml_node node : root.children("animation"))
    result.animations.push_back(animation_of(node));
  for (const pugi::xml_node node : root.children("model")) {
    WrapperText::Nested nested;
    nested.path = text_of(node, "path");
    nested.name = text_of(node, "name");
    nested.parent_from_model = offsets_of(node.child("offsets"));
    if (const pugi::xml_node condition = node.child("condition"))
      nested.condition = condition_of(condition);
    result.nested.push_back(std::move(nested));
  }
  return result;
}

std::vector<std::pair<double, double>> parse_table(std::string_view text, const fs::path& name) {
  pugi::xml_document document;
  return table_of(load(document, text, name));
}

}  // namespace airtruth::aircraft
