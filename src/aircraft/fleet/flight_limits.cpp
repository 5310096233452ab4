// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/flight_limits.h"

#include <algorithm>
#include <array>
#include <utility>

namespace airtruth::aircraft {
namespace {

// The order of kClasses.
enum class Class {
  kAirliner,
  kBusinessJet,
  kTurboprop,
  kSlowPiston,
  kLightPiston,
  kFastPiston,
  kPistonFighter,
  kJetFighter,
  kHelicopter,
  kGlider
};

// Sources of each number: docs/flight-limits.md.
// name, slowest, fastest, bank, climb, descent, usual low, usual high, usual bank, hours
const std::vector<FlightLimits> kClasses = {
    {"airliner", 52, 265, 45, 25, 35, 70, 230, 25, 6, 20},
    {"business jet", 42, 265, 45, 25, 35, 60, 220, 30, 6, 20},
    {"turboprop", 30, 190, 45, 13, 25, 50, 130, 30, 6, 20},
    {"slow piston", 12, 72, 60, 6, 10, 22, 36, 30, 7, 19},
    {"light piston", 22, 92, 60, 7, 12, 35, 62, 30, 7, 19},
    {"fast piston", 25, 140, 60, 10, 18, 45, 90, 30, 7, 19},
    {"piston fighter", 28, 215, 80, 22, 120, 75, 130, 60, 8, 18},
    {"jet fighter", 50, 740, 84, 330, 330, 110, 260, 60, 7, 19},
    {"helicopter", 0, 100, 60, 12, 15, 25, 70, 20, 7, 19},
    {"glider", 16, 80, 60, 8, 12, 20, 45, 40, 10, 18},
};

using TypeClass = std::pair<std::string_view, Class>;

// Folders of Debian's flightgear-data-ai. SR-71, SpaceShuttle, balloon, bluebird and Ferry fit no
// class.
constexpr std::array<TypeClass, 108> kTypes = {{
    {"220", Class::kAirliner},
    {"339", Class::kAirliner},
    {"717", Class::kAirliner},
    {"727", Class::kAirliner},
    {"733", Class::kAirliner},
    {"734", Class::kAirliner},
    {"735", Class::kAirliner},
    {"736", Class::kAirliner},
    {"738", Class::kAirliner},
    {"739", Class::kAirliner},
    {"747", Class::kAirliner},
    {"757", Class::kAirliner},
    {"767", Class::kAirliner},
    {"777", Class::kAirliner},
    {"787", Class::kAirliner},
    {"A300", Class::kAirliner},
    {"A310", Class::kAirliner},
    {"A319", Class::kAirliner},
    {"A320", Class::kAirliner},
    {"A321", Class::kAirliner},
    {"A330-MRTT", Class::kAirliner},
    {"A332", Class::kAirliner},
    {"A333", Class::kAirliner},
    {"A342", Class::kAirliner},
    {"A343", Class::kAirliner},
    {"A345", Class::kAirliner},
    {"A346", Class::kAirliner},
    {"A350", Class::kAirliner},
    {"A380", Class::kAirliner},
    {"BAE146-300", Class::kAirliner},
    {"Bae146-200", Class::kAirliner},
    {"CR2", Class::kAirliner},
    {"CR7", Class::kAirliner},
    {"CR9", Class::kAirliner},
    {"E70", Class::kAirliner},
    {"E90", Class::kAirliner},
    {"E95", Class::kAirliner},
    {"ERJ145", Class::kAirliner},
    {"Fokker-100", Class::kAirliner},
    {"Fokker-70", Class::kAirliner},
    {"M11", Class::kAirliner},
    {"MD80", Class::kAirliner},
    {"MD90", Class::kAirliner},
    {"tu154b", Class::kAirliner},
    {"vulcanb2", Class::kAirliner},
    {"BAe-125", Class::kBusinessJet},
    {"Bombardier-Challenger", Class::kBusinessJet},
    {"CCX", Class::kBusinessJet},
    {"Citation-Bravo", Class::kBusinessJet},
    {"Embraer-Legacy", Class::kBusinessJet},
    {"AT4", Class::kTurboprop},
    {"AT7", Class::kTurboprop},
    {"Cessna208Caravan", Class::kTurboprop},
    {"DH3", Class::kTurboprop},
    {"DH4", Class::kTurboprop},
    {"DH7", Class::kTurboprop},
    {"DHT", Class::kTurboprop},
    {"E-2C", Class::kTurboprop},
    {"Fokker-50", Class::kTurboprop},
    {"JS41", Class::kTurboprop},
    {"SF3", Class::kTurboprop},
    {"Saab-2000", Class::kTurboprop},
    {"b1900d", Class::kTurboprop},
    {"beech-200", Class::kTurboprop},
    {"beech99", Class::kTurboprop},
    {"Arup-S2", Class::kSlowPiston},
    {"Cub", Class::kSlowPiston},
    {"DH82", Class::kSlowPiston},
    {"Dragonfly", Class::kSlowPiston},
    {"FK9MK2", Class::kSlowPiston},
    {"cri-cri", Class::kSlowPiston},
    {"ercoupe", Class::kSlowPiston},
    {"flash2a", Class::kSlowPiston},
    {"DR400", Class::kLightPiston},
    {"Dromader", Class::kLightPiston},
    {"Fokker-S-11", Class::kLightPiston},
    {"G-164", Class::kLightPiston},
    {"c172", Class::kLightPiston},
    {"c177", Class::kLightPiston},
    {"c182", Class::kLightPiston},
    {"c182rg", Class::kLightPiston},
    {"pa-28", Class::kLightPiston},
    {"BNI", Class::kFastPiston},
    {"Beechcraft-Staggerwing", Class::kFastPiston},
    {"Cessna-421-Golden-Eagle", Class::kFastPiston},
    {"Cessna337", Class::kFastPiston},
    {"Diamond-Da42", Class::kFastPiston},
    {"c310", Class::kFastPiston},
    {"c310u3a", Class::kFastPiston},
    {"A6M2", Class::kPistonFighter},
    {"Polikarpov-I16", Class::kPistonFighter},
    {"Spitfire", Class::kPistonFighter},
    {"bf109", Class::kPistonFighter},
    {"Buccaneer", Class::kJetFighter},
    {"F-15", Class::kJetFighter},
    {"F-18", Class::kJetFighter},
    {"F-4", Class::kJetFighter},
    {"JA37", Class::kJetFighter},
    {"Jaguar-GR1", Class::kJetFighter},
    {"Lightning", Class::kJetFighter},
    {"MiG-21bis", Class::kJetFighter},
    {"Mirage2000", Class::kJetFighter},
    {"T-38", Class::kJetFighter},
    {"eurofighter", Class::kJetFighter},
    {"f-14b", Class::kJetFighter},
    {"f16", Class::kJetFighter},
    {"seahawk", Class::kJetFighter},
    {"centrair-101", Class::kGlider},
}};

}  // namespace

const std::vector<FlightLimits>& flight_classes() { return kClasses; }

const FlightLimits* flight_limits(const std::string& aircraft) {
  if (aircraft.find('.') != std::string::npos) return nullptr;
  const std::string_view type = std::string_view(aircraft).substr(0, aircraft.find('/'));
  const auto is_it = [type](const TypeClass& entry) { return entry.first == type; };
  const auto found = std::find_if(kTypes.begin(), kTypes.end(), is_it);
  if (found != kTypes.end()) return &kClasses[static_cast<std::size_t>(found->second)];
  return nullptr;
}

}  // namespace airtruth::aircraft
