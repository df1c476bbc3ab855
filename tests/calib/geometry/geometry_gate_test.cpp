// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_gate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;
constexpr double deg = core::degree;

const GateFlight& flight() {
  static const GateFlight f;
  return f;
}

void scale(std::vector<double>& v, double by) {
  for (double& x : v) x *= by;
}
void shift(std::vector<double>& v, double by) {
  for (double& x : v) x += by;
}

/// A mistake put into a right flight.
struct Case {
  const char* name;
  std::function<void(GateFlight&)> make;
  double convergence = 0.0;
};

std::vector<Case> cases() {
  const auto angles = [](double by) {
    return [by](GateFlight& f) {
      for (core::Shots& s : f.shots) scale(s.angle, by);
    };
  };
  const auto ranges = [](double by) {
    return [by](GateFlight& f) {
      for (core::Shots& s : f.shots) scale(s.range, by);
    };
  };
  const auto calibration = [](auto change) { return [change](GateFlight& f) { change(f.chain.calibration); }; };
  return {
      {"scan_angle_sign", angles(-1)},
      {"scan_angle_degrees_as_radians", angles(1 / 57.29578)},
      {"scan_angle_gon", angles(1 / 0.9)},
      {"scan_scale", angles(0.5)},
      {"range_feet", ranges(1 / 0.3048)},
      {"range_two_way", ranges(2)},
      {"scanner_model", [](GateFlight& f) { f.chain.scanner.model = core::ScannerModel::conical; }},
      {"trajectory_height_feet", [](GateFlight& f) { scale(f.data.height, 1 / 0.3048); }},
      {"roll_sign", [](GateFlight& f) { scale(f.data.roll, -1); }},
      {"pitch_sign", [](GateFlight& f) { scale(f.data.pitch, -1); }},
      {"heading_sign", [](GateFlight& f) { scale(f.data.heading, -1); }},
      {"heading_grid_north", [](GateFlight& f) { shift(f.data.heading, -2 * deg); }, 2 * deg},
      {"axes_swapped", [](GateFlight& f) { std::swap(f.data.roll, f.data.pitch); }},
      {"axes_swapped", [](GateFlight& f) { shift(f.data.heading, 90 * deg); }},
      {"boresight_roll_sign", calibration([](core::Calibration& c) { c.roll.value *= -1; })},
      {"boresight_pitch_sign", calibration([](core::Calibration& c) { c.pitch.value *= -1; })},
      {"boresight_heading_sign", calibration([](core::Calibration& c) { c.heading.value *= -1; })},
      {"lever_arm_sign", calibration([](core::Calibration& c) { c.lever_arm_scanner[0].value *= -1; })},
      {"lever_arm_millimetres", calibration([](core::Calibration& c) {
         for (core::Metres& m : c.lever_arm_scanner) m.value *= 1000;
       })},
      {"time_offset", calibration([](core::Calibration& c) { c.latency.value += 0.15; })},
      {"mount_rolled", calibration([](core::Calibration& c) { c.roll.value += 180 * deg; })},
  };
}

std::string text_of(const GeometryFigures& g) {
  std::string out;
  for (const std::string& w : g.warnings) out += w + "\n";
  for (const TriedMistake& t : g.tried)
    out += t.name + " cells " + std::to_string(t.fit.cells) + " cost " + std::to_string(t.fit.cost) + " " + t.what + "\n";
  return out;
}

TEST(GeometryGate, ARightFlightIsConsistent) {
  const GeometryFigures g = flight().judged(2 * deg);
  EXPECT_EQ(g.verdict, Verdict::consistent) << text_of(g);
  EXPECT_TRUE(g.named.empty());
  EXPECT_TRUE(g.warnings.empty());
  ASSERT_GE(g.lines.pairs.size(), 3u);
  EXPECT_LT(g.lines.fit.cost, 2 * g.lines.predicted);
}

TEST(GeometryGate, EachUsualMistakeIsNamed) {
  for (const Case& c : cases()) {
    GateFlight f = flight();
    c.make(f);
    const GeometryFigures g = f.judged(c.convergence);
    EXPECT_EQ(g.verdict, Verdict::inconsistent) << c.name;
    ASSERT_FALSE(g.named.empty()) << c.name << "\n" << text_of(g);
    EXPECT_EQ(g.named.front().name, c.name) << text_of(g);
    EXPECT_GE(g.warnings.size(), 2u) << c.name;
  }
}

TEST(GeometryGate, OneLineIsNotJudgedAndNotBlamed) {
  const GeometryFigures g = GateFlight(false, 1).judged(2 * deg);
  EXPECT_EQ(g.verdict, Verdict::not_judged) << text_of(g);
  EXPECT_TRUE(g.warnings.empty());
}

TEST(GeometryGate, AFlatSceneIsNotBlamed) {
  const GeometryFigures g = GateFlight(true).judged(2 * deg);
  EXPECT_EQ(g.verdict, Verdict::consistent) << text_of(g);
  EXPECT_TRUE(g.warnings.empty());
}

TEST(GeometryGate, TimesOfAnotherWeekAreNamed) {
  GateFlight f = flight();
  shift(f.data.time, 604800.0);
  const GeometryFigures g = f.judged();
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "gps_week");
}

TEST(GeometryGate, TimesOfAnotherZoneAreNamed) {
  GateFlight f = flight();
  shift(f.data.time, -5.5 * 3600);
  const GeometryFigures g = f.judged();
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "time_offset");
  EXPECT_NE(g.warnings.back().find("19800 s earlier"), std::string::npos) << g.warnings.back();
}

TEST(GeometryGate, LeapSecondsAreThoseOfTheDate) {
  GateFlight f = flight();
  constexpr double in_2011 = 1e9;  // GPS less UTC was 15 s
  shift(f.data.time, in_2011 + 15);
  for (RecordedLine& l : f.lines) l.first += in_2011, l.last += in_2011;
  for (core::Shots& s : f.shots) shift(s.time, in_2011);
  const GeometryFigures g = f.judged();
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "leap_seconds");
  EXPECT_NE(g.warnings.back().find("15 s later"), std::string::npos) << g.warnings.back();
}

TEST(GeometryGate, LeapSecondsThatNothingShowsAreNotNamed) {
  GateFlight f(true, 3, 0.0);
  constexpr double in_1981 = 5e7;  // GPS less UTC was 1 s
  shift(f.data.time, in_1981);
  for (RecordedLine& l : f.lines) l.first += in_1981, l.last += in_1981;
  for (core::Shots& s : f.shots) shift(s.time, in_1981);
  // A trajectory without the last second of each line would cover all of it with times 1 s earlier.
  core::TrajectoryData cut;
  for (size_t i = 0; i < f.data.size(); ++i) {
    using D = core::TrajectoryData;
    const bool in = std::any_of(f.lines.begin(), f.lines.end(),
                                [t = f.data.time[i]](const RecordedLine& l) { return t > l.first - 2 && t < l.last - 0.9; });
    if (!in) continue;
    for (const auto c : {&D::time, &D::latitude, &D::longitude, &D::height, &D::roll, &D::pitch, &D::heading})
      (cut.*c).push_back((f.data.*c)[i]);
  }
  f.data = std::move(cut);
  const GeometryFigures g = f.judged();
  EXPECT_LT(g.covered, 0.95);
  EXPECT_TRUE(g.named.empty()) << text_of(g);
}

TEST(GeometryGate, AFittedValueIsLeftToAnAdjustment) {
  GateFlight f = flight();
  f.chain.calibration.roll.value += 0.1 * deg, f.chain.calibration.pitch.value -= 0.08 * deg;  // about 0.15 m
  const GeometryFigures g = f.judged();
  ASSERT_FALSE(g.named.empty()) << text_of(g);
  EXPECT_EQ(g.named.front().name, "boresight") << text_of(g);
  EXPECT_FALSE(g.named.front().usual);
  EXPECT_EQ(g.doubt, "");
}

TEST(GeometryGate, AUsualMistakeStopsAnAdjustment) {
  GateFlight f = flight();
  scale(f.data.roll, -1);
  EXPECT_NE(f.judged().doubt.find("sign of roll"), std::string::npos);
}

TEST(GeometryGate, ASlowTrajectoryWithLongStepsIsJudged) {
  GateFlight f = flight();
  core::TrajectoryData slow;
  for (size_t i = 0; i < f.data.size(); ++i) {
    if (i % 150 != 0 && (i + 1 == f.data.size() || f.data.time[i + 1] - f.data.time[i] < 1)) continue;
    using D = core::TrajectoryData;
    for (const auto c : {&D::time, &D::latitude, &D::longitude, &D::height, &D::roll, &D::pitch, &D::heading})
      (slow.*c).push_back((f.data.*c)[i]);
  }
  scale(slow.roll, -1);
  trajectory::TrajectoryOptions how;
  how.max_gap = core::Seconds(2);
  const trajectory::Trajectory t(std::move(slow), how);
  GeometryFigures g;
  ASSERT_NO_THROW(g = judge_geometry(f.input(t), {}));
  EXPECT_EQ(std::count_if(g.tried.begin(), g.tried.end(), [](const TriedMistake& m) { return m.name == "roll_sign"; }), 1) << text_of(g);
}

TEST(GeometryGate, WhatTheReaderOfTheTrajectoryWarnsOfIsNotSaidAgain) {
  GateFlight f = flight();
  for (size_t i = 0; i < f.data.size(); ++i) {
    const size_t a = i > 0 && f.data.time[i] - f.data.time[i - 1] < 1 ? i - 1 : i, b = a + 1;
    f.data.v_down.push_back(-(f.data.height[b] - f.data.height[a]) / (f.data.time[b] - f.data.time[a]));
    f.data.v_north.push_back(0), f.data.v_east.push_back(0);
  }
  scale(f.data.height, 1 / 0.3048);
  const GeometryFigures g = f.judged();
  const auto climb = std::find_if(g.checks.begin(), g.checks.end(), [](const GeometryCheck& c) { return c.name == "climb"; });
  ASSERT_NE(climb, g.checks.end());
  EXPECT_FALSE(climb->held);
  EXPECT_TRUE(climb->said);
  ASSERT_FALSE(g.named.empty());
  EXPECT_EQ(g.named.front().name, "trajectory_height_feet");
  for (const std::string& w : g.warnings) EXPECT_EQ(w.find("vertical velocities"), std::string::npos) << w;
}

TEST(GeometryGate, ReturnsInOtherBatchesGiveTheSameFigures) {
  const trajectory::Trajectory t(flight().data);
  GeometryInput in = flight().input(t);
  const GeometryFigures once = judge_geometry(in, {});
  in.shots = [&](const std::function<void(int, const core::Shots&)>& work) {
    for (size_t k = 0; k < flight().shots.size(); ++k) {
      const core::Shots& all = flight().shots[k];
      for (size_t first = 0; first < all.size(); first += 1000) {
        core::Shots part;
        const auto cut = [&](const auto& from, auto& to) {
          if (!from.empty())
            to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
                      from.begin() + static_cast<std::ptrdiff_t>(std::min(first + 1000, all.size())));
        };
        core::for_each_column(all, part, cut);
        work(flight().lines[k].line, part);
      }
    }
  };
  const GeometryFigures cut = judge_geometry(in, {});
  EXPECT_EQ(once.lines.fit.cells, cut.lines.fit.cells);
  EXPECT_EQ(once.lines.fit.cost, cut.lines.fit.cost);
}

}  // namespace
}  // namespace swath::calib
