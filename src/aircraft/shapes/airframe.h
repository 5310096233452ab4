// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "aircraft/model/mesh.h"

// An aircraft as a table of hulls, sheets, bars and rotors, and the one builder of its mesh.
//
// Tables state metres forward of the main rotor's mast (or of another mark of the type), to the
// right, and up from the ground on which the aircraft stands. What lies to the right of the middle
// stands for itself and its mirror image, but for rotors.
//
// Example: the mesh of "helicopter-light" (airframes.h) has a part "airframe" from 2.44 m ahead of
// the mast to 6.63 m behind it, and the parts "main rotor" and "tail rotor", which spin.
namespace airtruth::shapes {

struct Place {
  double forward = 0, right = 0, up = 0;  // m
};

// What a surface is painted with: the two colours of a livery, or a colour that every livery has.
enum class Paint : std::uint8_t {
  kBase,
  kTrim,
  kWhite,
  kGlass,
  kDark,   // tyres, skids, cloth
  kMetal,  // exhausts, hubs
  kBlade,
  kTip,  // of blades
  kRed,  // beacons
};

struct Livery {
  std::string_view name;
  std::array<float, 3> base, trim;  // linear RGB
};

struct Station {
  double forward, half_width, bottom, top;  // m
};

// A convex part of the side view of a hull in a paint of its own, such as a window.
struct Panel {
  Paint paint = Paint::kGlass;
  std::vector<std::array<double, 2>> corners = {};  // forward, up; m
  // What is nearer to the plane of symmetry keeps its paint: a post between two panes.
  double inner_m = 0;
};

// A closed skin, smooth along its stations; its sections are superellipses.
struct Hull {
  Paint paint = Paint::kBase;
  std::vector<Station> stations = {};
  std::vector<Panel> panels = {};
  double squareness = 2;
  double right = 0;  // of its middle, m
};

struct SheetRib {
  Place leading = {};
  double chord = 0;  // m
  double thickness = 0;
};

// A wing, a fin or a sail over two or more ribs.
struct Sheet {
  Paint paint = Paint::kBase;
  std::vector<SheetRib> ribs = {};
};

struct Bar {
  Paint paint = Paint::kDark;
  double radius = 0.03;  // m
  Place from = {}, to = {};
};

struct Rotor {
  std::string_view name;
  Place hub = {};
  Place axis = {};      // a direction, as long as wanted
  double diameter = 0;  // m
  int blades = 2;
  double chord = 0.2;  // m
  // Speed of the blades' tips; positive: counter-clockwise seen against the axis.
  double tip_mps = 0;
  double cone_deg = 0;
  double pitch_deg = 8;  // at the root; two fifths of it at the tip
  double phase_deg = 0;  // of the first blade at the time 0, from forward or up
};

struct Size {
  double length_m = 0, span_m = 0, height_m = 0;
};

struct Airframe {
  std::string_view name;  // "helicopter-light"
  std::string_view size;  // what it is like, with the published sizes that it has
  // The names of its liveries, with blanks between.
  std::string_view liveries = "blue olive red rescue white yellow";
  // The origin of the body: the middle of the airframe.
  Place origin = {};
  // Published length, span and height of all but the blades of main rotors; 0 where none is.
  Size published = {};
  std::vector<Hull> hulls = {};
  std::vector<Sheet> sheets = {};
  std::vector<Bar> bars = {};
  std::vector<Rotor> rotors = {};
};

// Part 0 is the airframe; each rotor is a part that spins.
model::Mesh airframe_mesh(const Airframe& airframe, const Livery& livery);

}  // namespace airtruth::shapes
