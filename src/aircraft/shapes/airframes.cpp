// SPDX-License-Identifier: Apache-2.0
#include "aircraft/shapes/airframes.h"

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/error.h"

// Lengths, diameters, spans and heights are those that makers publish (handbooks, brochures, type
// certificates), and each table says of which type; the lines between are drawn by eye after its
// side and front views.
namespace airtruth::shapes {
namespace {

using enum Paint;

// Linear RGB of paints, by eye.
constexpr std::array<Livery, 7> kLiveries = {
    {{"white", {0.72f, 0.72f, 0.70f}, {0.02f, 0.05f, 0.22f}},
     {"red", {0.42f, 0.012f, 0.014f}, {0.72f, 0.72f, 0.70f}},
     {"rescue", {0.72f, 0.72f, 0.70f}, {0.30f, 0.006f, 0.028f}},
     {"yellow", {0.68f, 0.42f, 0.012f}, {0.36f, 0.012f, 0.012f}},
     {"blue", {0.010f, 0.022f, 0.085f}, {0.62f, 0.62f, 0.60f}},
     {"olive", {0.040f, 0.044f, 0.024f}, {0.014f, 0.014f, 0.013f}},
     {"orange", {0.60f, 0.13f, 0.008f}, {0.72f, 0.72f, 0.70f}}}};
constexpr const char* kSportLiveries = "blue orange red white yellow";

// Robinson R44: rotor 10.06 m, fuselage 9.07 m, with rotors turning 11.66 m, height 3.28 m, tail
// rotor 1.47 m, cabin 1.28 m and skids 2.18 m wide, blade 0.254 m deep; tips at 215 and 187 m/s.
Airframe light_single() {
  Airframe a{.name = "helicopter-light",
             .size = "as a Robinson R44: rotor 10.06 m, fuselage 9.07 m, height 3.28 m",
             .origin = {0, 0, 1.3},
             .published = {9.07, 0, 3.28}};
  a.hulls = {{.stations = {{2.44, 0.03, 0.93, 1.03},
                           {2.36, 0.22, 0.76, 1.20},
                           {2.10, 0.42, 0.56, 1.45},
                           {1.65, 0.57, 0.45, 1.74},
                           {1.00, 0.64, 0.42, 1.96},
                           {0.20, 0.64, 0.42, 2.02},
                           {-0.60, 0.60, 0.46, 2.00},
                           {-1.20, 0.46, 0.72, 1.94},
                           {-1.70, 0.28, 1.10, 1.85},
                           {-2.15, 0.17, 1.37, 1.74},
                           {-4.00, 0.13, 1.44, 1.70},
                           {-5.75, 0.085, 1.53, 1.69},
                           {-5.95, 0.05, 1.56, 1.66}},
              .panels = {{kTrim, {{1.0, 0.66}, {-6.2, 1.40}, {-6.2, 1.58}, {1.0, 0.92}}},
                         {kTrim, {{2.6, 0.3}, {2.6, 0.72}, {-1.3, 0.60}, {-1.3, 0.3}}},
                         {kGlass, {{2.6, 0.92}, {1.40, 0.98}, {1.02, 2.1}, {2.6, 2.1}}, 0.02},
                         {kGlass, {{1.30, 1.04}, {0.52, 1.04}, {0.52, 1.84}, {1.02, 1.80}}},
                         {kGlass, {{0.42, 1.04}, {-0.30, 1.06}, {-0.42, 1.78}, {0.42, 1.84}}}},
              .squareness = 2.4},
             // The fairing of the mast.
             {.stations = {{0.42, 0.04, 1.9, 2.1},
                           {0.25, 0.16, 1.9, 2.9},
                           {0, 0.2, 1.9, 3.02},
                           {-0.35, 0.16, 1.9, 2.7},
                           {-0.9, 0.04, 1.8, 2.0}}}};
  a.sheets = {{kBase, {{{-5.60, 0, 1.65}, 0.62, 0.06}, {{-6.0, 0, 2.55}, 0.45, 0.04}}},
              {kBase, {{{-5.62, 0, 1.58}, 0.55, 0.06}, {{-5.98, 0, 0.95}, 0.42, 0.04}}},
              {kTrim, {{{-5.25, 0.05, 1.62}, 0.40, 0.04}, {{-5.28, 0.76, 1.62}, 0.38, 0.03}}}};
  a.bars = {{kDark, 0.05, {0, 0, 2.9}, {0, 0, 3.26}},
            {kDark, 0.035, {1.85, 1.06, 0.14}, {1.65, 1.06, 0.04}},
            {kDark, 0.04, {1.65, 1.05, 0.04}, {-1.25, 1.05, 0.04}},
            {kDark, 0.035, {0.85, 0, 0.44}, {0.85, 1.05, 0.06}},
            {kDark, 0.035, {-0.65, 0, 0.47}, {-0.65, 1.05, 0.06}},
            {kMetal, 0.04, {-1.0, 0.16, 0.75}, {-1.35, 0.16, 0.55}},
            {kDark, 0.02, {-6.1, 0, 1.0}, {-6.63, 0, 1.05}},
            {kRed, 0.04, {-5.2, 0, 1.68}, {-5.2, 0, 1.78}}};
  a.rotors = {{"main rotor", {0, 0, 3.25}, {0.04, 0, 1}, 10.06, 2, 0.254, 215, 2.5},
              {"tail rotor", {-5.90, -0.26, 1.62}, {0, -1, 0}, 1.47, 2, 0.13, -187}};
  return a;
}

// Eurocopter AS350 B2 (H125): rotor 10.69 m, fuselage 10.93 m, with rotors turning 12.94 m, height
// 3.14 m, tail rotor 1.86 m, stabiliser 2.53 m, cabin 1.87 m and skids 2.28 m wide, blade 0.30 m
// deep. The rotor turns clockwise.
Airframe turbine_single() {
  Airframe a{.name = "helicopter-turbine",
             .size = "as an AS350 (H125): rotor 10.69 m, fuselage 10.93 m, height 3.14 m",
             .origin = {0, 0, 1.35},
             .published = {10.93, 0, 3.14}};
  a.hulls = {{.stations = {{3.335, 0.05, 1.00, 1.14},
                           {3.22, 0.36, 0.78, 1.34},
                           {2.85, 0.64, 0.60, 1.68},
                           {2.25, 0.84, 0.50, 2.02},
                           {1.40, 0.92, 0.47, 2.20},
                           {0.30, 0.935, 0.47, 2.26},
                           {-0.60, 0.88, 0.52, 2.24},
                           {-1.40, 0.62, 0.80, 2.16},
                           {-2.20, 0.38, 1.25, 2.06},
                           {-2.90, 0.26, 1.52, 1.99},
                           {-5.00, 0.19, 1.66, 1.96},
                           {-6.80, 0.13, 1.74, 1.96},
                           {-7.00, 0.04, 1.80, 1.90}},
              .panels = {{kTrim, {{3.5, 0.3}, {3.5, 0.86}, {-1.6, 0.86}, {-1.6, 0.3}}},
                         {kTrim, {{0.4, 0.80}, {-2.2, 1.55}, {-2.2, 2.3}, {-0.7, 2.3}}},
                         {kTrim, {{-4.2, 1.5}, {-4.6, 2.1}, {-5.4, 2.1}, {-5.0, 1.5}}},
                         {kGlass, {{3.5, 1.16}, {2.36, 1.20}, {1.66, 2.14}, {3.5, 2.14}}, 0.03},
                         {kGlass, {{3.10, 0.72}, {2.50, 0.66}, {2.40, 1.06}, {3.16, 1.06}}, 0.25},
                         {kGlass, {{2.26, 1.22}, {1.10, 1.22}, {1.10, 1.98}, {1.74, 1.98}}},
                         {kGlass, {{0.98, 1.22}, {-0.10, 1.22}, {-0.20, 1.98}, {0.98, 1.98}}}},
              .squareness = 2.6},
             {.stations = {{1.15, 0.06, 2.05, 2.2},
                           {0.75, 0.36, 2.0, 2.55},
                           {0, 0.45, 2.0, 2.76},
                           {-1.0, 0.43, 1.95, 2.70},
                           {-2.0, 0.32, 1.85, 2.52},
                           {-2.5, 0.12, 1.95, 2.35}},
              .panels = {{kDark, {{0.45, 2.25}, {0.05, 2.25}, {0.05, 2.6}, {0.45, 2.55}}}},
              .squareness = 2.6}};
  a.sheets = {{kTrim, {{{-6.15, 0, 1.90}, 0.80, 0.09}, {{-7.00, 0, 3.02}, 0.48, 0.06}}},
              {kTrim, {{{-6.45, 0, 1.80}, 0.62, 0.08}, {{-6.95, 0, 0.80}, 0.42, 0.06}}},
              {kBase, {{{-5.05, 0.12, 1.82}, 0.53, 0.06}, {{-5.05, 1.265, 1.82}, 0.53, 0.05}}}};
  a.bars = {{kDark, 0.10, {0, 0, 2.7}, {0.1, 0, 3.08}},
            {kMetal, 0.15, {-2.1, 0, 2.42}, {-2.85, 0, 2.62}},
            {kDark, 0.035, {2.55, 1.10, 0.28}, {2.2, 1.10, 0.04}},
            {kDark, 0.045, {2.2, 1.09, 0.045}, {-1.35, 1.09, 0.045}},
            {kDark, 0.04, {1.35, 0.4, 0.50}, {1.35, 1.09, 0.07}},
            {kDark, 0.04, {-0.75, 0.4, 0.54}, {-0.75, 1.09, 0.07}},
            {kDark, 0.025, {-7.0, 0, 0.85}, {-7.595, 0, 0.98}},
            {kRed, 0.05, {-7.2, 0, 3.0}, {-7.2, 0, 3.10}}};
  a.rotors = {{"main rotor", {0.1, 0, 3.07}, {0.06, 0, 1}, 10.69, 3, 0.30, -218, 3},
              {"tail rotor", {-6.665, 0.30, 1.88}, {0, 1, 0}, 1.86, 2, 0.185, 203}};
  return a;
}

// Leonardo AW139: rotor 13.80 m, fuselage 13.77 m, with rotors turning 16.66 m, height 4.98 m with
// and 3.72 m without its tail rotor's blades, which reach 2.70 m; stabiliser 4.22 m, wheels 3.04 m
// apart. Its canted tail rotor stands upright here.
Airframe medium_twin() {
  Airframe a{.name = "helicopter-twin",
             .size = "as an AW139: rotor 13.80 m, fuselage 13.77 m, height 4.98 m",
             .origin = {0, 0, 1.7},
             .published = {13.77, 0, 4.98}};
  a.hulls = {{.stations = {{4.65, 0.05, 1.10, 1.26},
                           {4.45, 0.40, 0.90, 1.50},
                           {3.90, 0.72, 0.70, 1.76},
                           {3.20, 0.96, 0.58, 2.18},
                           {2.40, 1.10, 0.54, 2.50},
                           {1.00, 1.13, 0.54, 2.58},
                           {-1.00, 1.13, 0.54, 2.60},
                           {-2.20, 1.02, 0.66, 2.58},
                           {-3.40, 0.68, 1.10, 2.46},
                           {-4.60, 0.44, 1.48, 2.34},
                           {-6.50, 0.30, 1.74, 2.26},
                           {-8.10, 0.21, 1.92, 2.24},
                           {-8.60, 0.06, 2.02, 2.16}},
              .panels = {{kTrim, {{2.1, 0.4}, {1.2, 0.4}, {0.4, 2.7}, {1.3, 2.7}}},
                         {kTrim, {{0.4, 0.4}, {-1.7, 0.4}, {-2.5, 2.7}, {-0.4, 2.7}}},
                         {kTrim, {{-7.2, 1.5}, {-7.2, 2.4}, {-8.8, 2.4}, {-8.8, 1.5}}},
                         {kGlass, {{4.1, 1.62}, {3.12, 1.62}, {2.52, 2.42}, {3.3, 2.42}}, 0.05},
                         {kGlass, {{3.02, 1.52}, {2.12, 1.42}, {2.12, 2.22}, {2.56, 2.28}}},
                         {kGlass, {{3.9, 0.82}, {3.3, 0.76}, {3.3, 1.14}, {3.9, 1.12}}, 0.3},
                         {kGlass, {{1.80, 1.44}, {0.85, 1.44}, {0.85, 2.16}, {1.80, 2.16}}},
                         {kGlass, {{0.60, 1.44}, {-0.35, 1.44}, {-0.35, 2.16}, {0.60, 2.16}}},
                         {kGlass, {{-0.6, 1.44}, {-1.50, 1.44}, {-1.50, 2.16}, {-0.6, 2.16}}}},
              .squareness = 2.8},
             // The engines' cowling.
             {.stations = {{2.3, 0.10, 2.35, 2.55},
                           {1.7, 0.55, 2.3, 2.95},
                           {0.6, 0.78, 2.3, 3.22},
                           {-1.4, 0.80, 2.3, 3.22},
                           {-2.8, 0.62, 2.2, 2.98},
                           {-4.0, 0.30, 2.15, 2.62},
                           {-4.6, 0.05, 2.2, 2.4}},
              .panels = {{kTrim, {{0.9, 2.2}, {-2.2, 2.2}, {-2.6, 3.4}, {0.5, 3.4}}},
                         {kDark, {{1.35, 2.62}, {0.85, 2.62}, {0.85, 2.95}, {1.35, 2.85}}, 0.3}},
              .squareness = 2.8},
             // What holds the wheels.
             {.stations = {{-0.4, 0.03, 0.85, 0.95},
                           {-0.9, 0.28, 0.62, 1.15},
                           {-2.2, 0.28, 0.62, 1.15},
                           {-2.8, 0.03, 0.9, 1.0}},
              .right = 1.12},
             {.paint = kMetal,
              .stations = {{-2.2, 0.16, 2.52, 2.86}, {-3.2, 0.17, 2.55, 2.89}},
              .right = 0.55}};
  a.sheets = {{kTrim, {{{-7.15, 0, 2.1}, 1.50, 0.16}, {{-8.22, 0, 4.05}, 0.90, 0.09}}},
              {kTrim, {{{-7.9, 0, 2.0}, 0.70, 0.08}, {{-8.3, 0, 1.55}, 0.45, 0.05}}},
              {kTrim, {{{-6.55, 0.2, 2.0}, 0.85, 0.10}, {{-6.75, 2.11, 2.1}, 0.60, 0.06}}}};
  a.bars = {{kDark, 0.13, {0, 0, 3.1}, {0.05, 0, 3.62}},
            {kMetal, 0.06, {3.05, 0, 0.62}, {3.05, 0, 0.22}},
            {kDark, 0.20, {3.05, 0.08, 0.20}, {3.05, 0.20, 0.20}},
            {kMetal, 0.07, {-1.55, 1.25, 0.75}, {-1.55, 1.42, 0.25}},
            {kDark, 0.25, {-1.55, 1.42, 0.25}, {-1.55, 1.62, 0.25}},
            {kDark, 0.02, {-3.9, 0, 2.55}, {-4.0, 0, 2.95}},
            {kRed, 0.06, {-8.9, 0, 4.0}, {-8.9, 0, 4.05}}};
  a.rotors = {{"main rotor", {0.05, 0, 3.62}, {0.07, 0, 1}, 13.80, 5, 0.40, 214, 3.5},
              {"tail rotor", {-8.41, 0.36, 3.63}, {0, 1, 0}, 2.70, 4, 0.22, 203}};
  return a;
}

// Boeing CH-47D: two rotors of 18.29 m, fuselage 15.54 m long and 3.78 m wide with its tanks, with
// rotors turning 30.14 m, height 5.77 m, blade 0.81 m deep. Where a blade of one rotor reaches
// over the other, those of the other stand a sixth of a turn aside.
Airframe heavy_tandem() {
  Airframe a{.name = "helicopter-tandem",
             .size = "as a CH-47D: two rotors 18.29 m, fuselage 15.54 m, height 5.77 m",
             .origin = {0, 0, 2.3},
             .published = {15.54, 0, 5.77}};
  a.hulls = {{.stations = {{7.95, 0.10, 1.10, 1.40},
                           {7.80, 0.55, 0.85, 1.85},
                           {7.35, 0.95, 0.66, 2.40},
                           {6.50, 1.22, 0.56, 2.95},
                           {5.30, 1.26, 0.54, 3.12},
                           {0.00, 1.26, 0.54, 3.12},
                           {-3.80, 1.26, 0.54, 3.12},
                           {-5.20, 1.26, 0.78, 3.12},
                           {-6.60, 1.20, 1.60, 3.12},
                           {-7.30, 1.05, 2.10, 3.10},
                           {-7.59, 0.60, 2.40, 2.90}},
              .panels = {{kTrim, {{8.1, 0.3}, {8.1, 1.15}, {-8, 1.15}, {-8, 0.3}}},
                         {kTrim, {{-5.4, 0.5}, {-5.4, 3.2}, {-7.7, 3.2}, {-7.7, 0.5}}},
                         {kGlass, {{8.0, 1.62}, {7.0, 1.70}, {6.85, 2.56}, {8.0, 2.56}}, 0.05},
                         {kGlass, {{7.95, 1.02}, {7.4, 0.92}, {7.4, 1.48}, {7.95, 1.44}}, 0.25},
                         {kGlass, {{6.85, 1.75}, {6.10, 1.75}, {6.10, 2.50}, {6.72, 2.56}}},
                         {kGlass, {{3.9, 1.85}, {3.5, 1.85}, {3.5, 2.25}, {3.9, 2.25}}},
                         {kGlass, {{1.9, 1.85}, {1.5, 1.85}, {1.5, 2.25}, {1.9, 2.25}}},
                         {kGlass, {{-0.1, 1.85}, {-0.5, 1.85}, {-0.5, 2.25}, {-0.1, 2.25}}},
                         {kGlass, {{-2.1, 1.85}, {-2.5, 1.85}, {-2.5, 2.25}, {-2.1, 2.25}}}},
              .squareness = 3.6},
             // The tanks along the sides.
             {.stations = {{4.9, 0.08, 0.75, 1.00},
                           {4.4, 0.44, 0.50, 1.32},
                           {-4.2, 0.44, 0.50, 1.32},
                           {-4.9, 0.08, 0.80, 1.10}},
              .squareness = 3,
              .right = 1.45},
             // The pylon of the forward rotor, the shaft's tunnel, and the pylon of the aft rotor.
             {.stations = {{7.1, 0.10, 2.4, 2.75},
                           {6.6, 0.50, 2.4, 3.45},
                           {5.95, 0.62, 2.4, 3.95},
                           {5.2, 0.50, 2.4, 3.80},
                           {4.2, 0.30, 2.4, 3.36},
                           {1.5, 0.30, 2.4, 3.36},
                           {-3.6, 0.30, 2.4, 3.36}},
              .squareness = 2.6},
             {.stations = {{-3.0, 0.06, 2.9, 3.3},
                           {-3.8, 0.36, 2.8, 4.10},
                           {-4.6, 0.52, 2.8, 4.95},
                           {-5.9, 0.56, 2.8, 5.30},
                           {-7.0, 0.42, 2.8, 5.20},
                           {-7.5, 0.08, 2.9, 4.90}},
              .panels = {{kTrim, {{-3, 4.2}, {-8, 4.2}, {-8, 5.5}, {-3, 5.5}}}},
              .squareness = 3},
             // Engines and their exhausts.
             {.stations = {{-4.3, 0.20, 3.1, 3.5},
                           {-4.7, 0.40, 2.9, 3.7},
                           {-6.2, 0.42, 2.9, 3.74},
                           {-6.9, 0.32, 3.0, 3.64}},
              .right = 1.35},
             {.paint = kMetal,
              .stations = {{-6.8, 0.28, 3.04, 3.60}, {-7.35, 0.30, 3.02, 3.62}},
              .right = 1.35}};
  a.bars = {{kDark, 0.20, {5.95, 0, 3.8}, {6.0, 0, 4.40}},
            {kDark, 0.22, {-5.9, 0, 5.2}, {-5.87, 0, 5.77}},
            {kMetal, 0.08, {3.2, 1.55, 0.8}, {3.2, 1.60, 0.3}},
            {kDark, 0.30, {3.2, 1.50, 0.30}, {3.2, 1.85, 0.30}},
            {kMetal, 0.08, {-3.9, 1.60, 0.8}, {-3.9, 1.65, 0.3}},
            {kDark, 0.30, {-3.9, 1.60, 0.30}, {-3.9, 1.88, 0.30}},
            {kRed, 0.07, {-0.5, 0, 0.44}, {-0.5, 0, 0.56}}};
  a.rotors = {{"forward rotor", {6.0, 0, 4.38}, {0.12, 0, 1}, 18.29, 3, 0.81, 215, 3},
              {"aft rotor", {-5.87, 0, 5.66}, {0.07, 0, 1}, 18.29, 3, 0.81, -215, 3}};
  return a;
}

// Schleicher ASK 21: span 17.00 m, length 8.35 m, height 1.55 m, wings of 17.95 m2.
Airframe glider() {
  Airframe a{.name = "glider",
             .size = "as an ASK 21: span 17.00 m, length 8.35 m, height 1.55 m",
             .liveries = "blue orange red white",
             .origin = {0, 0, 0.75},
             .published = {8.35, 17.00, 1.55}};
  a.hulls = {{.paint = kWhite,
              .stations = {{2.75, 0.02, 0.50, 0.55},
                           {2.60, 0.14, 0.38, 0.66},
                           {2.00, 0.28, 0.20, 0.90},
                           {1.00, 0.35, 0.10, 1.06},
                           {0.00, 0.35, 0.10, 1.10},
                           {-0.80, 0.28, 0.22, 1.04},
                           {-1.80, 0.17, 0.42, 0.92},
                           {-4.90, 0.10, 0.56, 0.80},
                           {-5.45, 0.05, 0.50, 0.76}},
              .panels = {{kBase, {{2.8, 0}, {2.8, 0.8}, {2.35, 0.8}, {2.35, 0}}},
                         {kGlass, {{2.15, 0.74}, {0.02, 0.80}, {-0.1, 1.2}, {1.9, 1.2}}}}}};
  a.sheets = {{kWhite,
               {{{0.55, 0.1, 0.82}, 1.45, 0.22},
                {{0.50, 4.8, 1.12}, 1.12, 0.15},
                {{0.34, 7.6, 1.33}, 0.75, 0.09}}},
              {kBase, {{{0.34, 7.6, 1.33}, 0.75, 0.09}, {{0.22, 8.5, 1.40}, 0.46, 0.05}}},
              {kWhite, {{{-4.35, 0, 0.66}, 1.12, 0.12}, {{-4.72, 0, 1.50}, 0.75, 0.09}}},
              {kBase, {{{-5.10, 0, 0.50}, 0.50, 0.07}, {{-5.15, 0, 1.52}, 0.45, 0.05}}},
              {kWhite, {{{-4.72, 0, 1.51}, 0.72, 0.08}, {{-4.85, 1.55, 1.51}, 0.42, 0.04}}}};
  a.bars = {{kDark, 0.17, {0.3, 0, 0.17}, {0.3, 0.06, 0.17}}};
  return a;
}

// A paraglider of class EN B, such as an Advance Alpha: canopy of 26 m2, 11.6 m flat and 9.1 m
// projected; the pilot hangs 7 m below it.
Airframe paraglider() {
  Airframe a{.name = "paraglider",
             .size = "span 9.10 m projected, 8.3 m from the pilot to the canopy's top",
             .liveries = kSportLiveries,
             .origin = {0, 0, 4.0},
             .published = {3.1, 9.10, 8.3}};
  a.hulls = {
      {.paint = kDark,
       .stations = {{1.25, 0.08, 0.35, 0.50},
                    {0.60, 0.20, 0.10, 0.55},
                    {0.00, 0.28, 0.00, 0.85},
                    {-0.35, 0.20, 0.15, 0.90}}},
      {.paint = kWhite,
       .stations = {{0.20, 0.03, 0.95, 1.05}, {0.05, 0.13, 0.85, 1.16}, {-0.1, 0.03, 0.9, 1}}}};
  a.sheets = {{kBase,
               {{{0.90, 0, 8.12}, 2.75, 0.36},
                {{0.88, 1.2, 8.00}, 2.70, 0.36},
                {{0.80, 2.3, 7.62}, 2.50, 0.33}}},
              {kTrim,
               {{{0.80, 2.3, 7.62}, 2.50, 0.33},
                {{0.64, 3.3, 7.00}, 2.15, 0.28},
                {{0.35, 4.1, 6.20}, 1.60, 0.22},
                {{-0.15, 4.55, 5.35}, 0.80, 0.08}}}};
  for (const double aft : {0.4, -0.6})
    for (const auto& [right, up] : {std::pair{1.2, 7.85}, std::pair{2.3, 7.5}, std::pair{3.7, 6.6}})
      a.bars.push_back({kDark, 0.006, {0, 0.22, 0.8}, {aft, right, up}});
  return a;
}

// A weight-shift trike such as a P&M Quik: wing of 8.60 m with a double surface, length 3.90 m,
// height 3.70 m.
Airframe trike() {
  Airframe a{.name = "trike",
             .size = "as a P&M Quik: span 8.60 m, length 3.90 m, height 3.70 m",
             .liveries = kSportLiveries,
             .origin = {0, 0, 1.8},
             .published = {3.90, 8.60, 3.70}};
  a.hulls = {{.stations = {{1.75, 0.04, 0.42, 0.54},
                           {1.50, 0.22, 0.32, 0.84},
                           {0.90, 0.36, 0.26, 1.10},
                           {0.10, 0.37, 0.26, 0.95},
                           {-0.70, 0.20, 0.34, 0.92}},
              .panels = {{kGlass, {{1.3, 0.86}, {0.95, 0.92}, {0.85, 1.2}, {1.2, 1.2}}}}},
             {.paint = kDark, .stations = {{-0.45, 0.26, 0.65, 1.15}, {-1.05, 0.26, 0.65, 1.15}}},
             // The pilot.
             {.paint = kDark,
              .stations = {{0.75, 0.2, 0.8, 1.3}, {0.3, 0.27, 0.8, 1.45}, {-0.3, 0.2, 0.8, 1.35}}},
             {.paint = kWhite,
              .stations = {{0.6, 0.03, 1.5, 1.6}, {0.45, 0.15, 1.4, 1.74}, {0.3, 0.03, 1.5, 1.6}}}};
  a.sheets = {{kBase,
               {{{1.35, 0, 3.45}, 2.50, 0.22},
                {{0.75, 1.2, 3.50}, 1.75, 0.17},
                {{0.10, 2.5, 3.55}, 1.32, 0.12}}},
              {kTrim,
               {{{0.10, 2.5, 3.55}, 1.32, 0.12},
                {{-0.50, 3.7, 3.60}, 0.95, 0.08},
                {{-0.90, 4.3, 3.68}, 0.35, 0.02}}}};
  a.bars = {{kMetal, 0.04, {-0.4, 0, 0.5}, {0.15, 0, 3.45}},
            {kMetal, 0.03, {1.35, 0, 3.45}, {-2.15, 0, 3.35}},
            {kMetal, 0.025, {0.3, 0, 3.4}, {1.0, 0.72, 1.75}},
            {kMetal, 0.025, {1.0, 0, 1.75}, {1.0, 0.72, 1.75}},
            {kMetal, 0.03, {-0.2, 0.2, 0.5}, {-0.55, 0.85, 0.25}},
            {kDark, 0.19, {1.15, 0, 0.19}, {1.15, 0.06, 0.19}},
            {kDark, 0.22, {-0.55, 0.82, 0.22}, {-0.55, 0.98, 0.22}}};
  a.rotors = {{"propeller", {-1.20, 0, 1.05}, {1, 0, 0}, 1.72, 3, 0.14, 190, 0, 35}};
  return a;
}

// Zeppelin NT LZ N07-100: length 75.1 m, hull 14.16 m across, height 17.4 m, over its engines
// 19.5 m; gondola 10.7 m long. The mark from which it is told is the hull's middle.
Airframe airship() {
  Airframe a{.name = "airship",
             .size = "as a Zeppelin NT: length 75.1 m, height 17.4 m",
             .liveries = kSportLiveries,
             .origin = {0, 0, 10.3},
             .published = {75.1, 19.5, 17.4}};
  a.hulls = {
      {.paint = kWhite,
       .stations = {{37.55, 0.05, 10.27, 10.37},
                    {37.0, 1.60, 8.72, 11.92},
                    {35.0, 3.40, 6.92, 13.72},
                    {30.0, 5.40, 4.92, 15.72},
                    {22.0, 6.70, 3.62, 17.02},
                    {12.0, 7.08, 3.24, 17.40},
                    {0.0, 6.95, 3.37, 17.27},
                    {-12.0, 6.20, 4.12, 16.52},
                    {-22.0, 4.85, 5.47, 15.17},
                    {-30.0, 3.05, 7.27, 13.37},
                    {-36.0, 1.10, 9.22, 11.42},
                    {-37.55, 0.10, 10.22, 10.42}},
       .panels = {{kBase, {{32, 9.0}, {-26, 9.0}, {-26, 11.2}, {32, 11.2}}},
                  {kTrim, {{-30, 0}, {-30, 20}, {-38, 20}, {-38, 0}}}}},
      {.stations = {{13.0, 0.2, 1.0, 1.4},
                    {12.0, 0.95, 0.3, 2.6},
                    {9.0, 1.12, 0.1, 3.6},
                    {3.8, 1.12, 0.1, 3.6},
                    {2.3, 0.3, 1.6, 3.4}},
       .panels = {{kGlass, {{13, 1.3}, {3.4, 1.3}, {3.4, 2.3}, {13, 2.3}}}},
       .squareness = 3},
      {.paint = kDark, .stations = {{9.2, 0.05, 0, 0.3}, {8.6, 0.2, 0, 0.7}, {8.0, 0.05, 0, 0.3}}},
      {.stations = {{9.6, 0.3, 7.2, 7.9}, {8.8, 0.55, 6.9, 8.2}, {7.0, 0.35, 7.1, 8.0}},
       .right = 8.4}};
  a.sheets = {{kBase, {{{-24.0, 0, 13.6}, 10.0, 0.5}, {{-29.0, 0, 17.4}, 6.5, 0.3}}},
              {kBase, {{{-24.0, 3.2, 8.3}, 10.0, 0.5}, {{-29.0, 7.6, 5.8}, 6.5, 0.3}}}};
  a.bars = {{kWhite, 0.25, {8.5, 6.6, 7.8}, {8.5, 8.2, 7.6}}};
  a.rotors = {{"right propeller", {9.9, 8.4, 7.55}, {1, 0, 0}, 2.70, 3, 0.25, 170, 0, 30},
              {"left propeller", {9.9, -8.4, 7.55}, {1, 0, 0}, 2.70, 3, 0.25, -170, 0, 30}};
  return a;
}

struct Made {
  const Airframe* airframe;
  const Livery* livery;
};

const std::map<std::string, Made>& made() {
  static const std::map<std::string, Made> all = [] {
    std::map<std::string, Made> named;
    for (const Airframe& airframe : airframes())
      for (const Livery& livery : kLiveries)
        if (airframe.liveries.find(livery.name) != std::string_view::npos)
          named[fmt::format("{}/{}", airframe.name, livery.name)] = {&airframe, &livery};
    return named;
  }();
  return all;
}

}  // namespace

std::span<const Airframe> airframes() {
  static const std::vector<Airframe> all = {airship(),
                                            glider(),
                                            light_single(),
                                            heavy_tandem(),
                                            turbine_single(),
                                            medium_twin(),
                                            paraglider(),
                                            trike()};
  return all;
}

std::vector<std::string> made_names() {
  std::vector<std::string> names;
  for (const auto& [name, one] : made()) names.push_back(name);
  return names;
}

const Airframe* made_airframe(const std::string& name) {
  const auto found = made().find(name);
  return found != made().end() ? found->second.airframe : nullptr;
}

model::Mesh made_mesh(const std::string& name) {
  const auto found = made().find(name);
  check(found != made().end(), "a name of made_names()");
  return airframe_mesh(*found->second.airframe, *found->second.livery);
}

}  // namespace airtruth::shapes
