// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <pugixml.hpp>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxBytes = 8u << 20;
constexpr int kMaxDepth = 12;
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

double number(const std::string& text, double otherwise) {
  double value = 0;
  const char* begin = text.c_str() + (text.rfind('+', 0) == 0 ? 1 : 0);
  const auto [rest, failed] = std::from_chars(begin, text.c_str() + text.size(), value);
  (void)rest;
  return failed == std::errc() && std::isfinite(value) ? value : otherwise;
}

double number(const pugi::xml_node& node, const char* child, double otherwise) {
  const pugi::xml_node at = node.child(child);
  return at ? number(trimmed(at.child_value()), otherwise) : otherwise;
}

// PropertyList fields have ".../x" and ".../x-m" spellings.
Vector3 vector(const pugi::xml_node& node, const char* suffix) {
  Vector3 v;
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    v[i] = number(node, (std::string(names[i]) + suffix).c_str(), number(node, names[i], 0));
  return v;
}

Condition condition_of(const pugi::xml_node& node, int depth);

std::vector<Condition> parts_of(const pugi::xml_node& node, int depth) {
  std::vector<Condition> parts;
  if (depth > kMaxConditionDepth) return parts;
  for (const pugi::xml_node child : node.children())
    if (child.type() == pugi::node_element) parts.push_back(condition_of(child, depth + 1));
  return parts;
}

Condition condition_of(const pugi::xml_node& node, int depth) {
  using Kind = Condition::Kind;
  const std::string name = node.name();
  Condition condition;
  if (name == "or" || name == "not") {
    condition.kind = name == "or" ? Kind::kOr : Kind::kNot;
    condition.parts = parts_of(node, depth);
    return condition;
  }
  static const std::vector<std::pair<std::string, Kind>> kComparisons = {
      {"less-than", Kind::kLess},
      {"less-than-equals", Kind::kLessEquals},
      {"greater-than", Kind::kGreater},
      {"equals", Kind::kEquals},
      {"greater-than-equals", Kind::kGreaterEquals},
      {"not-equals", Kind::kNotEquals}};
  for (const auto& [word, kind] : kComparisons) {
    if (name != word) continue;
    condition.kind = kind;
    const pugi::xml_node first = node.child("property");
    condition.property = trimmed(first.child_value());
    if (const pugi::xml_node second = first.next_sibling("property"))
      condition.other_property = trimmed(second.child_value());
    condition.value = text_of(node, "value") == "true" ? 1 : number(node, "value", 0);
    return condition;
  }
  if (name == "property") {
    condition.kind = Kind::kTrue;
    condition.property = trimmed(node.child_value());
    return condition;
  }
  condition.parts = parts_of(node, depth);  // <condition> and <and>
  return condition;
}

void read_axis(const pugi::xml_node& node, Animation& animation) {
  animation.centre = vector(node.child("center"), "-m");
  const pugi::xml_node axis = node.child("axis");
  if (!axis) return;
  if (axis.child("x1-m") || axis.child("y1-m") || axis.child("z1-m")) {
    const Vector3 a(number(axis, "x1-m", 0), number(axis, "y1-m", 0), number(axis, "z1-m", 0));
    const Vector3 b(number(axis, "x2-m", 0), number(axis, "y2-m", 0), number(axis, "z2-m", 0));
    animation.axis = b - a;
    if (!node.child("center")) animation.centre = 0.5 * (a + b);
  } else {
    animation.axis = vector(axis, "");
  }
}

Animation animation_of(const pugi::xml_node& node) {
  Animation animation;
  animation.type = text_of(node, "type");
  for (const pugi::xml_node name : node.children("object-name"))
    animation.objects.push_back(trimmed(name.child_value()));
  if (const pugi::xml_node condition = node.child("condition"))
    animation.condition = condition_of(condition, 0);
  animation.property = text_of(node, "property");
  animation.factor = number(node, "factor", 1);
  const bool turns = animation.type == "rotate" || animation.type == "spin";
  animation.offset = number(node, turns ? "offset-deg" : "offset-m", number(node, "offset", 0));
  for (const pugi::xml_node entry : node.child("interpolation").children("entry"))
    animation.interpolation.emplace_back(number(entry, "ind", 0), number(entry, "dep", 0));
  std::stable_sort(animation.interpolation.begin(),
                   animation.interpolation.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (animation.type == "scale")
    animation.scale = {
        number(node, "x-offset", 1), number(node, "y-offset", 1), number(node, "z-offset", 1)};
  read_axis(node, animation);
  return animation;
}

// Pitch about y, then roll about x, then heading about z, then the shift.
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

// What one PropertyList says, before files that it names are looked for.
struct Raw {
  std::string path;
  std::string texture_path;
  std::string include;
  std::optional<Eigen::Affine3d> offsets;
  std::vector<Animation> animations;
  struct Nested {
    std::string path;
    Eigen::Affine3d parent_from_model;
    std::optional<Condition> condition;
  };
  std::vector<Nested> nested;
};

Raw parse(std::string_view text, const fs::path& name) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    const auto end = text.begin() + std::clamp<std::ptrdiff_t>(
                                        parsed.offset, 0, static_cast<std::ptrdiff_t>(text.size()));
    throw Error(std::string("is not XML: ") + parsed.description(),
                {name.string(), 1 + static_cast<int>(std::count(text.begin(), end, '\n'))});
  }
  const pugi::xml_node root = document.child("PropertyList");
  if (!root) throw Error("has no <PropertyList>; expected a model of FlightGear", {name.string()});
  Raw raw;
  raw.include = root.attribute("include").value();
  raw.path = text_of(root, "path");
  raw.texture_path = text_of(root, "texture-path");
  if (root.child("offsets")) raw.offsets = offsets_of(root.child("offsets"));
  for (const pugi::xml_node node : root.children("animation"))
    raw.animations.push_back(animation_of(node));
  for (const pugi::xml_node node : root.children("model")) {
    Raw::Nested nested{text_of(node, "path"), offsets_of(node.child("offsets")), std::nullopt};
    if (const pugi::xml_node condition = node.child("condition"))
      nested.condition = condition_of(condition, 0);
    raw.nested.push_back(std::move(nested));
  }
  return raw;
}

fs::path resolved(const std::string& path, const fs::path& folder, const fs::path& data_root) {
  std::string clean = path;
  std::replace(clean.begin(), clean.end(), '\\', '/');
  if (fs::exists(folder / clean)) return folder / clean;
  return data_root / clean;
}

// The included file first, then what this one says over it.
Raw with_includes(const fs::path& file, std::vector<fs::path>& sources, int depth) {
  if (depth > kMaxDepth) throw Error("includes itself", {file.string()});
  sources.push_back(file);
  Raw own = parse(read_file(file, kMaxBytes), file);
  if (own.include.empty()) return own;
  Raw base = with_includes(file.parent_path() / own.include, sources, depth + 1);
  if (!own.path.empty()) base.path = own.path;
  if (!own.texture_path.empty()) base.texture_path = own.texture_path;
  if (own.offsets) base.offsets = own.offsets;
  base.animations.insert(base.animations.end(), own.animations.begin(), own.animations.end());
  base.nested.insert(base.nested.end(), own.nested.begin(), own.nested.end());
  return base;
}

// Procedural lamps are glowing discs of metres, drawn for the night.
bool is_lamp(const std::string& path) {
  return path.find("Light") != std::string::npos || path.find("light") != std::string::npos;
}

Wrapper read_at(const fs::path& file,
                const fs::path& data_root,
                std::vector<fs::path>& sources,
                std::set<std::string>& missing,
                int depth) {
  if (depth > kMaxDepth) throw Error("nests itself", {file.string()});
  const Raw raw = with_includes(file, sources, 0);
  const fs::path folder = file.parent_path();
  Wrapper wrapper;
  wrapper.file = file;
  if (!raw.path.empty()) {
    wrapper.model = resolved(raw.path, folder, data_root);
    if (!fs::exists(wrapper.model))
      throw Error("names the model " + raw.path + ", which does not exist", {file.string()});
  }
  if (!raw.texture_path.empty())
    wrapper.texture_folders.push_back(resolved(raw.texture_path, folder, data_root));
  if (raw.offsets) wrapper.parent_from_model = *raw.offsets;
  wrapper.animations = raw.animations;
  for (const Raw::Nested& nested : raw.nested) {
    if (is_lamp(nested.path)) continue;
    const fs::path path = resolved(nested.path, folder, data_root);
    if (nested.path.empty() || !fs::is_regular_file(path)) {
      missing.insert(nested.path);
      continue;
    }
    Wrapper child;
    if (path.extension() == ".xml") {
      child = read_at(path, data_root, sources, missing, depth + 1);
    } else {
      child.file = path;
      child.model = path;
    }
    child.parent_from_model = nested.parent_from_model * child.parent_from_model;
    if (nested.condition)
      child.animations.push_back({.type = "select", .condition = nested.condition});
    wrapper.nested.push_back(std::move(child));
  }
  return wrapper;
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

Wrapper read_wrapper(const fs::path& file,
                     const fs::path& data_root,
                     std::vector<fs::path>& sources,
                     std::set<std::string>& missing) {
  return read_at(file, data_root, sources, missing, 0);
}

Wrapper parse_wrapper(std::string_view text, const fs::path& name) {
  Raw raw = parse(text, name);
  Wrapper wrapper;
  wrapper.file = name;
  wrapper.model = raw.path;
  if (raw.offsets) wrapper.parent_from_model = *raw.offsets;
  wrapper.animations = std::move(raw.animations);
  return wrapper;
}

double property_value(const std::string& property, const Cruise& cruise) {
  constexpr double kGearUpAboveFt = 500;
  constexpr double kIdlePropellerRpm = 2300;
  if (contains(property, "airspeed-kt")) return cruise.airspeed_kt;
  if (contains(property, "altitude-agl-ft") || contains(property, "altitude-ft"))
    return cruise.altitude_agl_ft;
  if (contains(property, "gear") && contains(property, "position-norm"))
    return cruise.altitude_agl_ft > kGearUpAboveFt ? 0 : 1;
  if (contains(property, "gear-down")) return cruise.altitude_agl_ft > kGearUpAboveFt ? 0 : 1;
  if (contains(property, "rotors/main/rpm")) return 300;
  if (contains(property, "rotors/tail/rpm")) return 1500;
  if (contains(property, "rpm")) return kIdlePropellerRpm;
  if (contains(property, "/n1") || contains(property, "/n2")) return 80;
  if (contains(property, "running")) return 1;
  return 0;  // surfaces, canopies, switches, speed brakes at rest
}

bool holds(const Condition& c, const Cruise& cruise) {
  using Kind = Condition::Kind;
  const auto value = [&] { return property_value(c.property, cruise); };
  const double other = c.other_property ? property_value(*c.other_property, cruise) : c.value;
  const auto part_holds = [&](const Condition& part) { return holds(part, cruise); };
  switch (c.kind) {
    case Kind::kAnd:
      return std::all_of(c.parts.begin(), c.parts.end(), part_holds);
    case Kind::kOr:
      return std::any_of(c.parts.begin(), c.parts.end(), part_holds);
    case Kind::kNot:
      return !std::all_of(c.parts.begin(), c.parts.end(), part_holds);
    case Kind::kLess:
      return value() < other;
    case Kind::kLessEquals:
      return value() <= other;
    case Kind::kGreater:
      return value() > other;
    case Kind::kGreaterEquals:
      return value() >= other;
    case Kind::kEquals:
      return value() == other;
    case Kind::kNotEquals:
      return value() != other;
    case Kind::kTrue:
      return value() != 0;
  }
  return true;
}

double animated_value(const Animation& animation, const Cruise& cruise) {
  const double x = animation.property.empty() ? 0 : property_value(animation.property, cruise);
  const auto& table = animation.interpolation;
  if (table.empty()) return animation.factor * x + animation.offset;
  if (x <= table.front().first) return table.front().second;
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (x > table[i].first) continue;
    const double span = table[i].first - table[i - 1].first;
    const double t = span > 0 ? (x - table[i - 1].first) / span : 1;
    return table[i - 1].second + t * (table[i].second - table[i - 1].second);
  }
  return table.back().second;
}

}  // namespace airtruth::aircraft
