// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "aircraft/shapes/airframe.h"

// The aircraft that are made in code, and their names: a type and a livery.
//
// Example: made_mesh("helicopter-light/red") is a piston helicopter of two blades in red and white.
namespace airtruth::shapes {

std::span<const Airframe> airframes();

// All names, sorted.
std::vector<std::string> made_names();
// The airframe of a name; nullptr where it is no name of made_names().
const Airframe* made_airframe(const std::string& name);
// The mesh of one of made_names().
model::Mesh made_mesh(const std::string& name);

}  // namespace airtruth::shapes
