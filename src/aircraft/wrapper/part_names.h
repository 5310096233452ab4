// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

// What FlightGear's models tell by names alone: lamps and other effects of the game, propellers
// that turn too fast to be seen, and wheels. Letter case matters only where it is said. In other
// files than .ac and the .xml that name them, a name says nothing of the kind.
namespace airtruth::wrapper {

// Whether the path of a nested model is, by whole words below the aircraft's own folder, that of a
// lamp, smoke, rain or a sound.
bool is_effect_path(const std::string& path);

// The same of a file or folder of the catalogue, where the letters count wherever they stand, those
// of UkraineIntl among them. A seed draws among the names that are listed by it.
bool is_effect_name(const std::string& file);

// Whether an object is a lamp, its glow, a shadow on the ground, smoke or, by whole words, a
// wheel's chock. These are effects of the game or stand on the ground, and are no part of the
// aircraft's body. A lamp that is lit has a name that ends in "On".
bool is_effect(const std::string& object);

// Whether the names, outermost first, are those of a propeller or rotor that turns fast, and not of
// a jet engine's fan ("Prop_Blur_L", "no1propdisk", "Propeller.Fast", "disqueHelice").
bool is_propeller_disc(const std::vector<std::string>& names);

bool is_wheel(const std::string& object);

}  // namespace airtruth::wrapper
