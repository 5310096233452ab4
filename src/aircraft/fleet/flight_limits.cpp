// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/flight_limits.h"

#include "foundation/base/text.h"

namespace airtruth::fleet {
namespace {

// Folders of flightgear-data-ai and types that are made in code, by class. SR-71, SpaceShuttle,
// balloon, bluebird and Ferry fit none.
constexpr std::string_view kAirliners =
    "220 339 717 727 733 734 735 736 738 739 747 757 767 777 787 A300 A310 A319 A320 "
    "A321 A330-MRTT A332 A333 A342 A343 A345 A346 A350 A380 BAE146-300 Bae146-200 CR2 "
    "CR7 CR9 E70 E90 E95 ERJ145 Fokker-100 Fokker-70 M11 MD80 MD90 tu154b vulcanb2";
constexpr std::string_view kBusinessJets =
    "BAe-125 Bombardier-Challenger CCX Citation-Bravo Embraer-Legacy";
constexpr std::string_view kTurboprops =
    "AT4 AT7 Cessna208Caravan DH3 DH4 DH7 DHT E-2C Fokker-50 JS41 SF3 Saab-2000 b1900d "
    "beech-200 beech99";
constexpr std::string_view kSlowPistons =
    "Arup-S2 Cub DH82 Dragonfly FK9MK2 cri-cri ercoupe flash2a trike";
constexpr std::string_view kLightPistons =
    "DR400 Dromader Fokker-S-11 G-164 c172 c177 c182 c182rg pa-28";
constexpr std::string_view kFastPistons =
    "BNI Beechcraft-Staggerwing Cessna-421-Golden-Eagle Cessna337 Diamond-Da42 c310 "
    "c310u3a";
constexpr std::string_view kPistonFighters = "A6M2 Polikarpov-I16 Spitfire bf109";
constexpr std::string_view kJetFighters =
    "Buccaneer F-15 F-18 F-4 JA37 Jaguar-GR1 Lightning MiG-21bis Mirage2000 T-38 "
    "eurofighter f-14b f16 seahawk";
constexpr std::string_view kHelicopters =
    "helicopter-light helicopter-tandem helicopter-turbine helicopter-twin";
constexpr std::string_view kGliders = "centrair-101 glider";

// Sources of each number: docs/flight-limits.md.
// name, slowest, fastest, bank, climb, descent, usual low, usual high, usual bank, hours, types
const std::vector<FlightLimits> kClasses = {
    {"airliner", 52, 265, 45, 25, 35, 70, 230, 25, 6, 20, kAirliners},
    {"business jet", 42, 265, 45, 25, 35, 60, 220, 30, 6, 20, kBusinessJets},
    {"turboprop", 30, 190, 45, 13, 25, 50, 130, 30, 6, 20, kTurboprops},
    {"slow piston", 12, 72, 60, 6, 10, 22, 36, 30, 7, 19, kSlowPistons},
    {"light piston", 22, 92, 60, 7, 12, 35, 62, 30, 7, 19, kLightPistons},
    {"fast piston", 25, 140, 60, 10, 18, 45, 90, 30, 7, 19, kFastPistons},
    {"piston fighter", 28, 215, 80, 22, 120, 75, 130, 60, 8, 18, kPistonFighters},
    {"jet fighter", 50, 740, 84, 330, 330, 110, 260, 60, 7, 19, kJetFighters},
    {"helicopter", 0, 100, 60, 12, 15, 25, 70, 20, 7, 19, kHelicopters},
    {"glider", 16, 80, 60, 8, 12, 20, 45, 40, 10, 18, kGliders},
    {"paraglider", 5, 22, 60, 8, 20, 9, 13, 25, 9, 19, "paraglider"},
    {"airship", 0, 36, 15, 8, 8, 8, 25, 6, 7, 20, "airship"},
};

}  // namespace

const std::vector<FlightLimits>& flight_classes() { return kClasses; }

const FlightLimits* flight_limits(const std::string& aircraft) {
  if (aircraft.find('.') != std::string::npos) return nullptr;
  const std::string wanted = aircraft.substr(0, aircraft.find('/'));
  for (const FlightLimits& limits : kClasses)
    for (const std::string& type : words_in(limits.types))
      if (type == wanted) return &limits;
  return nullptr;
}

}  // namespace airtruth::fleet
