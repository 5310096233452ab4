// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "aircraft/catalogue.h"
#include "aircraft/osg_adapter.h"
#include "aircraft/wrapper.h"
#include "base/error.h"

namespace airtruth::aircraft {
namespace {

// FlightGear: x back, y right, z up. Body: x forward, y right, z down.
const Eigen::Affine3d kBodyFromFlightGear(Eigen::Matrix3d(Eigen::Vector3d(-1, 1, -1).asDiagonal()));

// AC3D files have y up; FlightGear stands them up by a quarter turn about x.
Eigen::Affine3d flightgear_from_ac() {
  Eigen::Matrix3d m;
  m << 1, 0, 0,  //
      0, 0, -1,  //
      0, 1, 0;
  return Eigen::Affine3d(m);
}

Vector3 axis_vector(const std::string& text, const char* what) {
  const bool negative = !text.empty() && text[0] == '-';
  const std::string letter =
      !text.empty() && (text[0] == '-' || text[0] == '+') ? text.substr(1) : text;
  if (letter != "x" && letter != "y" && letter != "z")
    throw Error(std::string(what) + " is '" + text +
                "'; expected x, y or z, or one of them with a minus");
  return (negative ? -1.0 : 1.0) * Vector3::Unit(letter[0] - 'x');
}

Eigen::Affine3d body_from_axes(const ModelAxes& axes) {
  const Vector3 forward = axis_vector(axes.forward, "model_forward");
  const Vector3 up = axis_vector(axes.up, "model_up");
  if (std::abs(forward.dot(up)) > 0.5)
    throw Error("model_forward and model_up are the same axis; expected two different ones");
  if (!std::isfinite(axes.scale) || axes.scale <= 0)
    throw Error("model_scale is not positive; expected metres per unit");
  Eigen::Matrix3d m;
  m.row(0) = forward;
  m.row(1) = forward.cross(up);  // right
  m.row(2) = -up;
  return Eigen::Affine3d(axes.scale * m);
}

bool named(const std::vector<std::string>& names, const Animation& animation) {
  if (animation.objects.empty()) return true;
  return std::any_of(
      animation.objects.begin(), animation.objects.end(), [&](const std::string& object) {
        return std::find(names.begin(), names.end(), object) != names.end();
      });
}

bool ends_with_on(const std::string& name) {
  return name.size() > 2 && name.ends_with("On") && name.find("ight") != std::string::npos;
}

// Lamps, their glow, shadows on the ground, smoke: drawn for the game, and no part of an aircraft's
// body.
bool is_effect(const std::vector<std::string>& names) {
  static const std::array<const char*, 9> kWords = {
      "halo", "Halo", "glow", "Glow", "shadow", "contrail", "smoke", "lightbeam", "Beam"};
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return ends_with_on(name) || std::any_of(kWords.begin(), kWords.end(), [&](const char* word) {
             return name.find(word) != std::string::npos;
           });
  });
}

Eigen::Affine3d about(const Vector3& centre, const Eigen::Affine3d& map) {
  return Eigen::Translation3d(centre) * map * Eigen::Translation3d(-centre);
}

Eigen::Affine3d motion_of(const Animation& animation, const Cruise& cruise) {
  const double value = animated_value(animation, cruise);
  const double length = animation.axis.norm();
  if (animation.type == "rotate" && length > 1e-9)
    return about(animation.centre,
                 Eigen::Affine3d(Eigen::AngleAxisd(radians(value), animation.axis / length)));
  if (animation.type == "translate" && length > 1e-9)
    return Eigen::Affine3d(Eigen::Translation3d(value * animation.axis / length));
  if (animation.type == "scale")
    return about(animation.centre, Eigen::Affine3d(Eigen::Matrix3d(animation.scale.asDiagonal())));
  return Eigen::Affine3d::Identity();
}

class Loader {
 public:
  Loader(const LoadOptions& options, Aircraft& aircraft)
      : cruise_{options.airspeed_kt, options.altitude_agl_ft}, aircraft_(aircraft) {
    aircraft_.mesh.parts.push_back({.name = "airframe"});
  }

  void add(const Wrapper& wrapper,
           const Eigen::Affine3d& body_from_parent,
           std::vector<fs::path> folders) {
    const Eigen::Affine3d body_from_model = body_from_parent * wrapper.parent_from_model;
    folders.insert(folders.begin(), wrapper.texture_folders.begin(), wrapper.texture_folders.end());
    note_unknown(wrapper);
    for (const Animation& animation : wrapper.animations)
      if (animation.type == "select" && animation.objects.empty() && animation.condition &&
          !holds(*animation.condition, cruise_))
        return;
    if (!wrapper.model.empty()) {
      const bool ac = wrapper.model.extension() == ".ac";
      const Eigen::Affine3d model_from_file =
          ac ? flightgear_from_ac() : Eigen::Affine3d::Identity();
      append_model(
          aircraft_.mesh,
          wrapper.model,
          folders,
          [&](const std::vector<std::string>& names) {
            return choose(wrapper, names, body_from_model, model_from_file);
          },
          aircraft_.sources);
    }
    for (const Wrapper& nested : wrapper.nested) add(nested, body_from_model, folders);
  }

  const std::set<std::string>& unknown() const { return unknown_; }

 private:
  PartChoice choose(const Wrapper& wrapper,
                    const std::vector<std::string>& names,
                    const Eigen::Affine3d& body_from_model,
                    const Eigen::Affine3d& model_from_file) {
    PartChoice choice;
    choice.hidden = is_effect(names);
    Eigen::Affine3d model_from_rest = Eigen::Affine3d::Identity();
    const Animation* spin = nullptr;
    for (const Animation& animation : wrapper.animations) {
      if (!named(names, animation)) continue;
      const bool applies = !animation.condition || holds(*animation.condition, cruise_);
      if (animation.type == "select") {
        choice.hidden = choice.hidden || !applies;
      } else if (animation.type == "billboard" || animation.type == "flash") {
        choice.hidden = choice.hidden || !animation.objects.empty();  // lamps
      } else if (animation.type == "spin" && applies && animation.axis.norm() > 1e-9) {
        spin = &animation;
      } else if (applies) {
        model_from_rest = model_from_rest * motion_of(animation, cruise_);
      }
    }
    choice.body_from_file = body_from_model * model_from_rest * model_from_file;
    if (spin != nullptr) choice.part = part_of(*spin, body_from_model * model_from_rest);
    return choice;
  }

  int part_of(const Animation& spin, const Eigen::Affine3d& body_from_model) {
    const Eigen::Vector3f centre = (body_from_model * spin.centre).cast<float>();
    const Eigen::Vector3f axis = (body_from_model.linear() * spin.axis).normalized().cast<float>();
    const double rate = animated_value(spin, cruise_) / 60;
    auto& parts = aircraft_.mesh.parts;
    for (std::size_t i = 1; i < parts.size(); ++i)
      if (parts[i].centre_in_body == centre && parts[i].axis_in_body == axis)
        return static_cast<int>(i);
    const std::string name = spin.objects.empty() ? "spinning" : spin.objects.front();
    parts.push_back({name, {}, true, axis, centre, rate});
    return static_cast<int>(parts.size() - 1);
  }

  void note_unknown(const Wrapper& wrapper) {
    // Known, or of no meaning for how an aircraft in flight looks by day.
    static const std::set<std::string> kKnown = {
        "select",   "rotate", "spin",       "translate", "scale",      "billboard", "flash",
        "noshadow", "shader", "dist-scale", "range",     "alpha-test", "blend",     "pick",
        "timed",    "point",  "trail",      "light",     "none",       "",          "shadow"};
    for (const Animation& animation : wrapper.animations)
      if (!kKnown.contains(animation.type)) unknown_.insert(animation.type);
  }

  Cruise cruise_;
  Aircraft& aircraft_;
  std::set<std::string> unknown_;
};

// Faces drawn twice (from both sides) would shine through one another; slivers without area have no
// normal.
void drop_doubles(Mesh& mesh) {
  for (Part& part : mesh.parts) {
    std::set<std::array<std::array<float, 3>, 3>> seen;
    std::erase_if(part.triangles, [&](const Triangle& triangle) {
      std::array<std::array<float, 3>, 3> key;
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3f& p = mesh.positions[triangle.vertex[i]];
        key[i] = {p.x(), p.y(), p.z()};
      }
      const Eigen::Vector3f a =
          mesh.positions[triangle.vertex[1]] - mesh.positions[triangle.vertex[0]];
      const Eigen::Vector3f b =
          mesh.positions[triangle.vertex[2]] - mesh.positions[triangle.vertex[0]];
      if (!(a.cross(b).norm() > 1e-10f)) return true;
      std::sort(key.begin(), key.end());
      return !seen.insert(key).second;
    });
  }
}

bool is_model_file(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  return extension == ".ac" || extension == ".obj" || extension == ".3ds" || extension == ".osgt" ||
         extension == ".xml";
}

void load_catalogued(const std::string& name,
                     const fs::path& file,
                     const LoadOptions& options,
                     const Warn& warn_to,
                     Aircraft& aircraft) {
  if (options.axes)
    throw Error("model_forward, model_up and model_scale are for a model file; '" + name +
                "' has its own axes and metres");
  // AI/Aircraft/<folder>/<file>.xml: the data root is four up.
  const fs::path root = fs::absolute(file).parent_path().parent_path().parent_path().parent_path();
  std::set<std::string> missing;
  const Wrapper wrapper = read_wrapper(file, root, aircraft.sources, missing);
  Loader loader(options, aircraft);
  loader.add(wrapper, kBodyFromFlightGear, {file.parent_path()});
  std::string words;
  for (const std::string& type : loader.unknown()) words += (words.empty() ? "" : ", ") + type;
  if (!words.empty())
    warn(warn_to, name + ": animations that are not known and are left out: " + words);
}

void load_bare(const std::string& name, const LoadOptions& options, Aircraft& aircraft) {
  const fs::path file = name;
  if (!fs::is_regular_file(file)) throw Error("does not exist; expected a 3D model", {name});
  const Eigen::Affine3d body_from_file = body_from_axes(options.axes.value_or(ModelAxes{}));
  aircraft.mesh.parts.push_back({.name = "airframe"});
  append_model(
      aircraft.mesh,
      file,
      {},
      [&](const std::vector<std::string>& names) {
        return PartChoice{is_effect(names), body_from_file, 0};
      },
      aircraft.sources);
}

}  // namespace

Aircraft load_aircraft(const std::string& name, const LoadOptions& options, const Warn& warn_to) {
  Aircraft aircraft;
  aircraft.name = name;
  if (is_model_file(name) && fs::path(name).extension() != ".xml") {
    aircraft.file = name;
    load_bare(name, options, aircraft);
  } else {
    aircraft.file = is_model_file(name) ? fs::path(name) : find_aircraft(name).file;
    load_catalogued(name, aircraft.file, options, warn_to, aircraft);
  }
  drop_doubles(aircraft.mesh);
  if (aircraft.mesh.triangle_count() == 0)
    throw Error("holds no triangles; expected a 3D model", {aircraft.file.string()});
  std::sort(aircraft.sources.begin(), aircraft.sources.end());
  aircraft.sources.erase(std::unique(aircraft.sources.begin(), aircraft.sources.end()),
                         aircraft.sources.end());
  return aircraft;
}

}  // namespace airtruth::aircraft
