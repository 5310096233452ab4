// SPDX-License-Identifier: Apache-2.0
// DAIDALUS, NASA's reference implementation of DO-365, as an outside answer. Its example flight H1
// is compared with the alerting table that NASA publishes for it, found through AIRTRUTH_SHARED.
// AIRTRUTH_DAIDALUS names a build of its program DaidalusAlerting, which is then asked about ten
// thousand random pairs.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "encounter/separation/violation.h"
#include "foundation/base/files.h"
#include "foundation/geometry/units.h"
#include "support/random_encounter.h"
#include "support/shared_folder.h"

namespace airtruth::separation {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else if (c != ' ' && c != '\r')
      cells.back() += c;
  }
  return cells;
}

std::vector<std::vector<std::string>> rows_of(const fs::path& file, int skipped) {
  std::ifstream in(file);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  for (int i = 0; std::getline(in, line); ++i)
    if (i >= skipped && !line.empty()) rows.push_back(cells_of(line));
  return rows;
}

// One row of the alerting table, in SI units. Empty: not defined.
struct Answer {
  std::vector<std::optional<double>> to_volume_s;
  double horizontal_m = 0, above_m = 0, hmd_m = 0, vmd_m = 0, dcpa_m = 0, tcpa_s = 0;
  double relative_speed_mps = 0;
  std::optional<double> tcoa_s, tau_mod_s;
};

std::optional<double> defined(const std::string& cell) {
  if (cell.empty() || cell == "infty" || cell == "nan" || cell == "NaN") return std::nullopt;
  return std::stod(cell);
}

Answer answer_of(const std::vector<std::string>& row, std::size_t levels) {
  Answer answer;
  std::size_t i = 5;
  for (std::size_t level = 0; level < levels; ++level)
    answer.to_volume_s.push_back(defined(row.at(i++)));
  answer.horizontal_m = *defined(row.at(i++)) * kMetresOfNauticalMile;
  answer.above_m = *defined(row.at(i++)) * kMetresOfFoot;
  answer.relative_speed_mps = *defined(row.at(i++)) * kMpsOfKnot;
  ++i;  // the vertical closure rate
  answer.hmd_m = *defined(row.at(i++)) * kMetresOfNauticalMile;
  answer.vmd_m = *defined(row.at(i++)) * kMetresOfFoot;
  answer.tcpa_s = defined(row.at(i++)).value_or(0);
  answer.dcpa_m = *defined(row.at(i++)) * kMetresOfNauticalMile;
  answer.tcoa_s = defined(row.at(i++));
  answer.tau_mod_s = i < row.size() ? defined(row.at(i)) : std::nullopt;
  return answer;
}

// Within 1e-6 of the value, and `printed` more: the last digit that the table prints.
void expect_near(double ours, double theirs, double printed, const char* what) {
  EXPECT_NEAR(ours, theirs, 1e-6 * std::abs(theirs) + printed) << what;
}

// `digit`: a unit of the last printed decimal.
void expect_same(const test_support::Pair& pair, const Answer& answer, double digit) {
  const Measures m = measures(pair.own, pair.intruder);
  const Vector3 v = pair.intruder.velocity_ned_mps - pair.own.velocity_ned_mps;
  const double nmi = digit * kMetresOfNauticalMile;
  const double foot = digit * kMetresOfFoot;
  expect_near(m.horizontal_m, answer.horizontal_m, nmi, "horizontal separation");
  expect_near(std::abs(m.above_m), answer.above_m, foot, "vertical separation");
  expect_near(v.head<2>().norm(), answer.relative_speed_mps, digit, "relative speed");
  expect_near(m.hmd_m, answer.hmd_m, nmi, "hmd");
  expect_near(m.vmd_m, answer.vmd_m, foot, "vmd");
  // Of equal velocities DAIDALUS keeps a rounding of its units, which gives it a closest approach
  // thousands of kilometres away. Where the aircraft diverge it gives a time of 0 and the
  // separation of now.
  if (v.head<2>().norm() > kStillMps) {
    expect_near(m.tcpa_s.value_or(0), answer.tcpa_s, digit, "tcpa");
    expect_near(m.dcpa_m.value_or(m.horizontal_m), answer.dcpa_m, nmi, "dcpa");
  }
  ASSERT_EQ(m.tau_mod_s.has_value(), answer.tau_mod_s.has_value());
  if (m.tau_mod_s) expect_near(*m.tau_mod_s, *answer.tau_mod_s, digit, "tau_mod");
  // At the same height DAIDALUS gives a time of 0.
  if (m.above_m == 0) return;
  ASSERT_EQ(m.tcoa_s.has_value(), answer.tcoa_s.has_value());
  if (m.tcoa_s) expect_near(*m.tcoa_s, *answer.tcoa_s, digit, "tcoa");
}

void expect_same_violation(const test_support::Pair& pair,
                           const Volume& volume,
                           double lookahead_s,
                           const std::optional<double>& to_volume_s,
                           double digit) {
  const auto ours = violation(volume, pair.own, pair.intruder, lookahead_s);
  ASSERT_EQ(ours.has_value(), to_volume_s.has_value());
  if (ours) expect_near(ours->begin_s, *to_volume_s, digit, "time to the volume");
}

// ------------------------------------------------------------------------------------------ H1

// A place on DAIDALUS's sphere, on which a minute of arc is a nautical mile.
constexpr double kEarthRadiusM = kMetresOfNauticalMile * 60 * 180 / kPi;

Vector3 on_sphere(double latitude, double longitude) {
  return {std::cos(latitude) * std::cos(longitude),
          std::cos(latitude) * std::sin(longitude),
          std::sin(latitude)};
}

// H1 states latitudes and longitudes. DAIDALUS projects both aircraft orthographically onto the
// plane that touches the sphere at the own aircraft, and takes a velocity from the places now and
// 10 s later on the great circle.
struct Plane {
  Vector3 north, east;
  Plane(double latitude, double longitude)
      : north(-std::sin(latitude) * std::cos(longitude),
              -std::sin(latitude) * std::sin(longitude),
              std::cos(latitude)),
        east(-std::sin(longitude), std::cos(longitude), 0) {}
  Vector3 ned(const Vector3& unit, double altitude_m) const {
    return {kEarthRadiusM * north.dot(unit), kEarthRadiusM * east.dot(unit), -altitude_m};
  }
};

struct Geodetic {
  double latitude, longitude, altitude_m, east_mps, north_mps, up_mps;
};

Geodetic geodetic_of(const std::vector<std::string>& row) {
  return {radians(std::stod(row.at(1))),
          radians(std::stod(row.at(2))),
          std::stod(row.at(3)) * kMetresOfFoot,
          std::stod(row.at(4)) * kMpsOfKnot,
          std::stod(row.at(5)) * kMpsOfKnot,
          std::stod(row.at(6)) * kMpsOfFootPerMinute};
}

Mover projected(const Plane& plane, const Geodetic& g) {
  constexpr double kStep_s = 10;
  const Vector3 here = on_sphere(g.latitude, g.longitude);
  const Plane local(g.latitude, g.longitude);
  const double speed_mps = std::hypot(g.east_mps, g.north_mps);
  const double arc = speed_mps * kStep_s / kEarthRadiusM;
  const Vector3 along = (g.north_mps * local.north + g.east_mps * local.east) / speed_mps;
  const Vector3 later = std::cos(arc) * here + std::sin(arc) * along;
  const Vector3 now = plane.ned(here, g.altitude_m);
  const Vector3 then = plane.ned(later, g.altitude_m + kStep_s * g.up_mps);
  return {now, (then - now) / kStep_s};
}

TEST(Daidalus, H1GivesThePublishedTable) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset: H1 is not here";
  const fs::path folder = fs::path(shared) / "encounters" / "daidalus";
  const auto flown = rows_of(folder / "H1.daa", 2);
  const auto published = rows_of(folder / "H1-alerting-no_sum.csv", 2);
  ASSERT_EQ(flown.size(), 2 * published.size());
  ASSERT_EQ(published.size(), 230u);
  // The table's alerts are preventive, corrective and warning of DO-365B phase I.
  const Volume& preventive = named_volume("do365-preventive")->volume;
  const Volume& well_clear = named_volume("do365-phase1")->volume;
  for (std::size_t k = 0; k < published.size(); ++k) {
    SCOPED_TRACE(fmt::format("at {} s", published[k][0]));
    const Geodetic own = geodetic_of(flown[2 * k]);
    const Plane plane(own.latitude, own.longitude);
    const test_support::Pair pair{projected(plane, own),
                                  projected(plane, geodetic_of(flown[2 * k + 1]))};
    const Answer answer = answer_of(published[k], 3);
    expect_same(pair, answer, 0.5e-6);
    expect_same_violation(pair, preventive, 180, answer.to_volume_s[0], 0.5e-6);
    expect_same_violation(pair, well_clear, 180, answer.to_volume_s[1], 0.5e-6);
    expect_same_violation(pair, well_clear, 180, answer.to_volume_s[2], 0.5e-6);
  }
}

// ---------------------------------------------------------------------------------- the oracle

// One alerter with a level for each named volume. The first is the corrective one, whose DTHR the
// table's tau_mod takes.
std::string configuration(double lookahead_s) {
  std::string text = fmt::format(
      "lookahead_time = {} [s]\nhysteresis_time = 0 [s]\n"
      "persistence_time = 0 [s]\nalerting_m = 0\nalerting_n = 0\n"
      "alerters = A\ncorrective_region = MID\n",
      lookahead_s);
  int level = 0;
  for (const NamedVolume& named : named_volumes()) {
    const std::string alert = fmt::format("A_alert_{}_", ++level);
    const std::string detector = fmt::format("A_det_{}_WCV_", level);
    text += fmt::format("{}region = {}\n", alert, level == 1 ? "MID" : "NONE");
    text += fmt::format("{0}alerting_time = 10 [s]\n{0}early_alerting_time = 10 [s]\n", alert);
    text += fmt::format("{0}spread_hdir = 0 [deg]\n{0}spread_hs = 0 [knot]\n", alert);
    text += fmt::format("{0}spread_vs = 0 [fpm]\n{0}spread_alt = 0 [ft]\n", alert);
    text += fmt::format("{}detector = det_{}\n", alert, level);
    text += fmt::format("{}DTHR = {} [m]\n", detector, named.volume.horizontal_m);
    text += fmt::format("{}ZTHR = {} [m]\n", detector, named.volume.vertical_m);
    text += fmt::format("{}TTHR = {} [s]\n", detector, named.volume.tau_s);
    text += fmt::format("{}TCOA = {} [s]\n", detector, named.volume.coaltitude_s);
    text +=
        fmt::format("A_load_core_detection_det_{} = gov.nasa.larcfm.ACCoRD.WCV_TAUMOD\n", level);
  }
  return text;
}

std::string row_of(const char* name, const Mover& mover, std::uint64_t time_s) {
  const Vector3& p = mover.position_ned_m;
  const Vector3& v = mover.velocity_ned_mps;
  return fmt::format("{}, {:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}, {}\n",
                     name,
                     p.y(),
                     p.x(),
                     -p.z(),
                     v.y(),
                     v.x(),
                     -v.z(),
                     time_s);
}

TEST(Daidalus, TenThousandRandomPairsGiveItsAnswers) {
  const char* program = std::getenv("AIRTRUTH_DAIDALUS");
  if (program == nullptr)
    GTEST_SKIP() << "AIRTRUTH_DAIDALUS is unset: no build of DaidalusAlerting is here";
  constexpr std::uint64_t kPairs = 10'000;
  constexpr double kLookahead_s = 180;
  const fs::path folder =
      fs::temp_directory_path() / fmt::format("airtruth-daidalus-{}", ::getpid());
  fs::create_directories(folder);
  std::string flights =
      "NAME, sx, sy, sz, vx, vy, vz, time\n"
      "[none], [m], [m], [m], [m/s], [m/s], [m/s], [s]\n";
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const test_support::Pair pair = test_support::random_pair(i);
    flights += row_of("own", pair.own, i) + row_of("intruder", pair.intruder, i);
  }
  std::ofstream(folder / "pairs.daa") << flights;
  std::ofstream(folder / "volumes.conf") << configuration(kLookahead_s);
  const std::string command = fmt::format(
      "'{0}' --conf '{1}/volumes.conf' --nohysteresis --precision 12 --out '{1}/answers.csv' "
      "'{1}/pairs.daa' 2> '{1}/log'",
      program,
      folder.string());
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const auto rows = rows_of(folder / "answers.csv", 2);
  ASSERT_EQ(rows.size(), kPairs);
  for (std::uint64_t i = 0; i < kPairs && !::testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(fmt::format("pair {}", i));
    const test_support::Pair pair = test_support::random_pair(i);
    const Answer answer = answer_of(rows[i], named_volumes().size());
    expect_same(pair, answer, 1e-9);
    std::size_t level = 0;
    for (const NamedVolume& named : named_volumes()) {
      SCOPED_TRACE(std::string(named.name));
      expect_same_violation(pair, named.volume, kLookahead_s, answer.to_volume_s[level++], 1e-9);
    }
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace airtruth::separation
