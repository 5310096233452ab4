// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/wrapper.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include <pugixml.hpp>

#include "aircraft/wrapper/part_names.h"
#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "foundation/geometry/units.h"

namespace airtruth::wrapper {
namespace {

using Node = pugi::xml_node;

constexpr int kMostBlades = 32;  // of a rotor; a bound for untrusted files

std::string text_of(const Node& node) { return std::string(trimmed(node.child_value())); }
std::string text_of(const Node& node, const char* child) { return text_of(node.child(child)); }

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* begin = text.c_str() + (text.rfind('+', 0) == 0 ? 1 : 0);
  const auto [rest, failed] = std::from_chars(begin, text.c_str() + text.size(), value);
  (void)rest;  // FlightGear reads "23,1722" as 23
  if (failed != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

double number(const Node& node, const char* child, double otherwise) {
  return number(text_of(node, child)).value_or(otherwise);
}

// Fields are spelled ".../x" or ".../x-m".
Vector3 vector(const Node& node, const char* suffix) {
  Vector3 v;
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    v[i] = number(node, (std::string(names[i]) + suffix).c_str(), number(node, names[i], 0));
  return v;
}

double property_value(const std::string& property, const Cruise& cruise) {
  constexpr double kGearUpAboveFt = 500;  // chosen: an approach is stabilised by then, gear down
  constexpr double kKtOfMach1 = 661.5;    // at sea level in the standard atmosphere
  const auto contains = [&](const char* part) { return property.find(part) != std::string::npos; };
  const double gear_down = cruise.altitude_agl_ft > kGearUpAboveFt ? 0 : 1;
  if (contains("gear/gear")) return contains("position-norm") ? gear_down : 0;
  if (contains("gear-down")) return gear_down;
  if (contains("speed-kt")) return cruise.airspeed_kt;  // air and ground
  if (contains("uBody-fps")) return cruise.airspeed_kt * kMpsOfKnot / kMetresOfFoot;
  if (contains("velocities/mach")) return cruise.airspeed_kt / kKtOfMach1;
  if (contains("altitude-agl-ft") || contains("altitude-ft")) return cruise.altitude_agl_ft;
  // Usual speeds at cruise, in revolutions a minute: of a helicopter's main and tail rotor, and of
  // a piston engine's propeller.
  if (contains("rotors/main/rpm")) return 300;
  if (contains("rotors/tail/rpm")) return 1500;
  if (contains("engine") && contains("rpm")) return 2300;
  if (contains("/n1") || contains("/n2")) return 80;  // percent
  if (contains("running")) return 1;
  return 0;  // surfaces, canopies, switches, speed brakes at rest
}

// Whether a comparison of a property with a value, or with another property, holds; empty where the
// element is no comparison. A word that is no number equals no property here.
std::optional<bool> compared(const Node& node, const Cruise& cruise) {
  const std::string name = node.name();
  const std::string stated = text_of(node, "value");
  const std::optional<double> value = stated == "true" ? 1 : number(stated);
  const bool is_word = !value && !stated.empty() && stated != "false";
  const Node first = node.child("property");
  const Node second = first.next_sibling("property");
  const double a = property_value(text_of(first), cruise);
  const double b = second ? property_value(text_of(second), cruise) : value.value_or(0);
  if (name == "less-than") return a < b;
  if (name == "less-than-equals") return a <= b;
  if (name == "greater-than") return a > b;
  if (name == "greater-than-equals") return a >= b;
  if (name == "equals") return !is_word && a == b;
  if (name == "not-equals") return is_word || a != b;
  return std::nullopt;
}

// <condition> means the same as <and>.
bool holds(const Node& node, const Cruise& cruise, int depth = 0) {
  constexpr int kMaxConditionDepth = 64;  // bounds the recursion over a hostile file
  if (const auto comparison = compared(node, cruise)) return *comparison;
  const std::string name = node.name();
  if (name == "property") return property_value(text_of(node), cruise) != 0;
  bool all = true;
  bool any = false;
  for (const Node child : node.children()) {
    if (depth > kMaxConditionDepth || child.type() != pugi::node_element) continue;
    const bool part = holds(child, cruise, depth + 1);
    all = all && part;
    any = any || part;
  }
  return name == "or" ? any : all != (name == "not");
}

std::optional<bool> condition_of(const Node& node, const Cruise& cruise) {
  const Node condition = node.child("condition");
  return condition ? std::optional(holds(condition, cruise)) : std::nullopt;
}

// A blade of a rotor in "rotors/main/blade[1]/position-deg"; empty for another property.
std::optional<std::pair<std::string, int>> blade_of(std::string_view property) {
  constexpr std::string_view kRotors = "rotors/", kBlade = "/blade[", kPlace = "]/position-deg";
  const std::size_t rotor = property.find(kRotors);
  const std::size_t blade = property.find(kBlade);
  if (rotor == std::string_view::npos || blade == std::string_view::npos ||
      blade < rotor + kRotors.size() || !property.ends_with(kPlace))
    return std::nullopt;
  const std::size_t begin = blade + kBlade.size();
  const auto number =
      number_from_text<int>(property.substr(begin, property.size() - kPlace.size() - begin));
  if (!number || *number < 0 || *number >= kMostBlades) return std::nullopt;
  const std::size_t name = rotor + kRotors.size();
  return std::pair(std::string(property.substr(name, blade - name)), *number);
}

// The number of blades of each rotor that a wrapper turns.
std::map<std::string, int> blades_in(const Node& root) {
  std::map<std::string, int> blades;
  for (const Node node : root.children("animation"))
    if (const auto blade = blade_of(text_of(node, "property")))
      blades[blade->first] = std::max(blades[blade->first], blade->second + 1);
  return blades;
}

// The place of a blade, in degrees, as the flight models set it: the blades of a rotor stand evenly
// about it.
std::optional<double> place_of_blade(const std::string& property,
                                     const std::map<std::string, int>& blades) {
  const auto blade = blade_of(property);
  const auto all = blade ? blades.find(blade->first) : blades.end();
  if (all == blades.end()) return std::nullopt;
  return 360.0 * blade->second / all->second;
}

double interpolated(const Table& table, double x) {
  if (x <= table.front().first) return table.front().second;
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (x > table[i].first) continue;
    const double span = table[i].first - table[i - 1].first;
    const double t = span > 0 ? (x - table[i - 1].first) / span : 1;
    return table[i - 1].second + t * (table[i].second - table[i - 1].second);
  }
  return table.back().second;
}

// A number that follows a property: by a table, or factor * value + offset, within bounds.
struct Driven {
  std::string prefix;  // and suffix of its fields: "" and "-deg", "-m", or "x-" and ""
  std::string suffix;
  double offset = 0;
  Table table = {};

  double at(const Node& node, const Cruise& cruise) const {
    const auto field = [&](const char* name) {
      const auto plain = number(text_of(node, (prefix + name).c_str()));
      return plain ? plain : number(text_of(node, (prefix + name + suffix).c_str()));
    };
    const std::string property = text_of(node, "property");
    const double x =
        property.empty()
            ? 0
            : place_of_blade(property, cruise.blades).value_or(property_value(property, cruise));
    if (!table.empty()) return interpolated(table, x);
    const double factor = field("factor").value_or(prefix.empty() ? 1 : 0);
    double value = factor * x + field("offset").value_or(offset);
    if (const auto least = field("min")) value = std::max(value, *least);
    if (const auto most = field("max")) value = std::min(value, *most);
    return value;
  }
};

void read_axis(const Node& node, Animation& animation) {
  animation.centre = vector(node.child("center"), "-m");
  const Node axis = node.child("axis");
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

Table table_of(const Node& node) {
  Table table;
  for (const Node entry : node.children("entry"))
    table.emplace_back(number(entry, "ind", 0), number(entry, "dep", 0));
  std::stable_sort(
      table.begin(), table.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return table;
}

Animation animation_of(const Node& node, const Cruise& cruise, const ReadTable& read_table) {
  Animation animation;
  animation.type = text_of(node, "type");
  animation.name = text_of(node, "name");
  for (const Node name : node.children("object-name")) animation.objects.push_back(text_of(name));
  animation.condition = condition_of(node, cruise);
  const bool turns = animation.type == "rotate" || animation.type == "spin";
  const Node interpolation = node.child("interpolation");
  const std::string table_file = interpolation.attribute("include").value();
  Driven driven{"", turns ? "-deg" : "-m"};
  if (table_file.empty()) driven.table = table_of(interpolation);
  if (!table_file.empty() && read_table) driven.table = read_table(table_file);
  animation.value = driven.at(node, cruise);
  if (animation.type == "scale")
    for (int i = 0; i < 3; ++i)
      animation.scale[i] =
          Driven{std::string(1, static_cast<char>('x' + i)) + "-", "", 1}.at(node, cruise);
  animation.least_m = number(node, "min-m", animation.least_m);
  animation.most_m = number(node, "max-m", animation.most_m);
  animation.texture = text_of(node, "texture");
  read_axis(node, animation);
  return animation;
}

// Pitch about y, then roll about x, then heading about z, then the translation.
Eigen::Affine3d offsets_of(const Node& node) {
  using Eigen::AngleAxisd;
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  if (!node) return result;
  result.translate(vector(node, "-m"));
  result.rotate(AngleAxisd(radians(number(node, "heading-deg", 0)), Vector3::UnitZ()) *
                AngleAxisd(radians(number(node, "roll-deg", 0)), Vector3::UnitX()) *
                AngleAxisd(radians(number(node, "pitch-deg", 0)), Vector3::UnitY()));
  return result;
}

Node load(pugi::xml_document& document, std::string_view text, const fs::path& name) {
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(std::string("is not XML: ") + parsed.description(),
                {name.string(), line_of(text, parsed.offset)});
  const Node root = document.child("PropertyList");
  if (!root) throw Error("has no <PropertyList>; expected a model of FlightGear", {name.string()});
  return root;
}

}  // namespace

Wrapper parse_wrapper(std::string_view text,
                      const fs::path& name,
                      const Cruise& stated,
                      const ReadTable& read_table) {
  pugi::xml_document document;
  const Node root = load(document, text, name);
  Cruise cruise = stated;
  cruise.blades = blades_in(root);
  Wrapper result;
  result.include = root.attribute("include").value();
  result.path = text_of(root, "path");
  result.texture_path = text_of(root, "texture-path");
  if (root.child("offsets")) result.nested_from_model = offsets_of(root.child("offsets"));
  for (const Node node : root.children("animation"))
    result.animations.push_back(animation_of(node, cruise, read_table));
  for (const Node node : root.children("model")) {
    Wrapper& nested = result.nested.emplace_back();
    nested.path = text_of(node, "path");
    nested.name = text_of(node, "name");
    nested.parent_from_nested = offsets_of(node.child("offsets"));
    nested.condition = condition_of(node, cruise);
  }
  return result;
}

Table parse_table(std::string_view text, const fs::path& name) {
  pugi::xml_document document;
  return table_of(load(document, text, name));
}

namespace {

// Of files that include or nest each other; bounds the recursion over a hostile file.
constexpr int kMaxDepth = 12;

// The part of a path below the data root that lies below the folder of `files`; empty: none.
fs::path below_folder(const ModelFiles& files, const fs::path& in_data_root) {
  if (files.in_data_root().empty()) return in_data_root;
  const fs::path below = in_data_root.lexically_normal().lexically_relative(files.in_data_root());
  return below.empty() || *below.begin() == ".." ? fs::path() : below;
}

class WrapperReader {
 public:
  WrapperReader(ModelFiles& files, const Cruise& cruise, std::set<std::string>& missing)
      : files_(files), cruise_(cruise), missing_(missing) {}

  Wrapper read(const fs::path& file, int depth) {
    if (depth > kMaxDepth) throw Error("nests itself", {files_.shown(file).string()});
    Wrapper wrapper = read_text(file, 0);
    wrapper.file = file;
    const fs::path folder = file.parent_path();
    if (!wrapper.path.empty()) wrapper.model = find_named_file(files_, wrapper.path, folder);
    if (!wrapper.path.empty() && wrapper.model.empty())
      throw Error("names the model " + wrapper.path + ", which does not exist below the folder " +
                      files_.shown(".").lexically_normal().string(),
                  {files_.shown(file).string()});
    if (!wrapper.texture_path.empty())
      wrapper.texture_folder = find_named_file(files_, wrapper.texture_path, folder);
    for (const Wrapper& stated : std::exchange(wrapper.nested, {}))
      if (auto nested = nested_of(stated, folder, depth))
        wrapper.nested.push_back(*std::move(nested));
    return wrapper;
  }

 private:
  Wrapper read_text(const fs::path& file, int depth) {
    if (depth > kMaxDepth) throw Error("includes itself", {files_.shown(file).string()});
    const auto read_table = [&](const std::string& name) {
      const fs::path table = file.parent_path() / name;
      return parse_table(files_.read(table, kMaxWrapperBytes), files_.shown(table));
    };
    Wrapper own =
        parse_wrapper(files_.read(file, kMaxWrapperBytes), files_.shown(file), cruise_, read_table);
    if (own.include.empty()) return own;
    Wrapper base = read_text(file.parent_path() / own.include, depth + 1);
    if (!own.path.empty()) base.path = own.path;
    if (!own.texture_path.empty()) base.texture_path = own.texture_path;
    if (own.nested_from_model) base.nested_from_model = own.nested_from_model;
    base.animations.insert(base.animations.end(), own.animations.begin(), own.animations.end());
    base.nested.insert(base.nested.end(), own.nested.begin(), own.nested.end());
    return base;
  }

  std::optional<Wrapper> nested_of(const Wrapper& stated, const fs::path& folder, int depth) {
    if (stated.path.empty() || is_effect_path(stated.path)) return std::nullopt;
    const fs::path path = find_named_file(files_, stated.path, folder);
    if (path.empty()) {
      missing_.insert(stated.path);
      return std::nullopt;
    }
    Wrapper nested;
    if (path.extension() == ".xml")
      nested = read(path, depth + 1);
    else
      nested.file = nested.model = path;
    nested.name = stated.name;
    nested.parent_from_nested = stated.parent_from_nested;
    nested.condition = stated.condition;
    return nested;
  }

  ModelFiles& files_;
  const Cruise& cruise_;
  std::set<std::string>& missing_;
};

}  // namespace

fs::path find_named_file(ModelFiles& files, const std::string& path, const fs::path& folder) {
  const auto is_there = [&](const fs::path& at) {
    return files.kind(at) != ModelFiles::Kind::kNone;
  };
  std::string clean = path;
  std::replace(clean.begin(), clean.end(), '\\', '/');
  if (is_there(folder / clean)) return (folder / clean).lexically_normal();
  while (!clean.empty() && clean.front() == '/') clean.erase(0, 1);  // of the data root
  if (clean.empty()) return {};
  for (const fs::path& candidate : {fs::path(clean), "AI" / fs::path(clean)}) {
    const fs::path below = below_folder(files, candidate);
    if (!below.empty() && is_there(below)) return below.lexically_normal();
  }
  return {};
}

Wrapper read_wrapper(ModelFiles& files,
                     const fs::path& file,
                     const Cruise& cruise,
                     std::set<std::string>& missing) {
  return WrapperReader(files, cruise, missing).read(file, 0);
}

}  // namespace airtruth::wrapper
