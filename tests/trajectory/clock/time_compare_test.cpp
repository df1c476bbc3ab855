// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/time_compare.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>

#include "core/geo/geodesy.h"
#include "tests/world/support.h"
#include "trajectory/clock/clock_model.h"

namespace swath::trajectory {
namespace {

core::EventTags tags(std::vector<double> time, std::vector<std::string> id = {}) {
  core::EventTags e;
  e.epoch = 1.4e9;
  e.time = std::move(time);
  for (size_t i = 0; i < e.size(); ++i) e.id.push_back(id.empty() ? std::to_string(i + 1) : id[i]);
  e.sigma.assign(e.size(), 0);
  e.strip.assign(e.size(), 1);
  e.doubtful.assign(e.size(), 0);
  return e;
}

/// Level flight at a speed, turning at a rate (rad/s), climbing.
Trajectory flight(double speed, double turn, double climb) {
  core::TrajectoryData d;
  const double r = 6.4e6;
  double north = 0, east = 0;
  for (int i = 0; i <= 6000; ++i) {
    const double s = i / 100.0, heading = 0.5 + turn * s;
    d.time.push_back(1.4e9 + s);
    d.latitude.push_back(0.8 + north / r);
    d.longitude.push_back(0.2 + east / (r * std::cos(0.8)));
    d.height.push_back(1000 + climb * s);
    d.roll.push_back(0);
    d.pitch.push_back(0);
    d.heading.push_back(heading);
    north += speed * std::cos(heading + turn / 200) / 100;
    east += speed * std::sin(heading + turn / 200) / 100;
  }
  return Trajectory(std::move(d));
}

TEST(TimeCompare, ByNameAndByTime) {
  const core::EventTags a = tags({10.001, 20.002, 30.003, 50}, {"1", "2", "3", "x"});
  core::EventTags b = tags({30, 20, 10, 40}, {"3", "2", "1", "4"});
  for (const EventMatch match : {EventMatch::id, EventMatch::time}) {
    const TimeComparison c = compare(a, b, match, 0.5);
    ASSERT_EQ(c.pairs.size(), 3u);
    EXPECT_EQ(c.pairs[0].second, 2u);
    EXPECT_NEAR(c.pairs[2].difference, 0.003, 1e-12);
    EXPECT_EQ(c.only_first, 1u);
    EXPECT_EQ(c.only_second, 1u);
    EXPECT_NEAR(c.all.bias, 0.002, 1e-12);
    EXPECT_NEAR(c.all.standard, 0.001, 1e-12);
    EXPECT_NEAR(c.all.rms, std::sqrt(14.0 / 3) * 1e-3, 1e-12);
    EXPECT_NEAR(c.all.largest, 0.003, 1e-12);
  }
  // Another epoch and a latency change nothing but the sum.
  b.epoch -= 100;
  for (double& t : b.time) t += 100;
  b.latency = 0.0005;
  EXPECT_NEAR(compare(a, b, EventMatch::id, 0.5).all.bias, 0.0015, 1e-12);
  EXPECT_EQ(compare(a, b, EventMatch::time, 0.001).pairs.size(), 1u) << "farther apart than the tolerance";
}

TEST(TimeCompare, DoubtfulEventsAndSigmas) {
  core::EventTags a = tags({1.1, 2.001, 3.003}), b = tags({1, 2, 3});
  a.doubtful[0] = 1;
  a.sigma = {0.001, 0.0003, 0.0012};
  b.sigma = {0, 0.0004, 0.0009};
  const TimeComparison c = compare(a, b, EventMatch::id, 1);
  EXPECT_EQ(c.trusted.n, 2u);
  EXPECT_NEAR(c.trusted.bias, 0.002, 1e-12);
  EXPECT_NEAR(c.pairs[1].sigma, 0.0005, 1e-12);
  EXPECT_NEAR(c.trusted.error_ratio, 2.0, 1e-9);
  EXPECT_EQ(compare(tags({1}), tags({1}), EventMatch::id, 1).all.error_ratio, 0) << "not known";
}

TEST(TimeCompare, ShiftAndDrift) {
  std::vector<double> stamps, marks;
  for (int i = 0; i < 20; ++i) {
    stamps.push_back(100 + 4.0 * i);
    marks.push_back(stamps.back() - (0.003 + 2e-6 * 4.0 * i + (i % 2 ? 1e-5 : -1e-5)));
  }
  const core::EventTags a = tags(stamps), b = tags(marks);
  const ShiftDrift f = shift_and_drift(compare(a, b, EventMatch::id, 1).pairs, a);
  EXPECT_NEAR(f.shift, 0.003, 1e-5);
  EXPECT_NEAR(f.drift, 2e-6, 3e-7);
  EXPECT_NEAR(f.rms_after, 1e-5, 1e-6);
}

// 40 us at 220 km/h is 2.4 mm; 1 to 10 ms at 60 m/s are 6 to 60 cm.
TEST(TimeCompare, SecondsAreMetresOfFlight) {
  TimePair pair;
  pair.difference = 40e-6;
  EXPECT_NEAR(compare_places({pair}, 220 / 3.6).axes[0].bias, 0.0024, 0.00005);
  // The same along a trajectory, which differs from the plane it is made of by 1e-3 of the way.
  const struct { double speed, difference, expected; } cases[] = {{220 / 3.6, 40e-6, 0.00244}, {60, 1e-3, 0.06}, {60, 10e-3, 0.60}};
  for (const auto& c : cases) {
    const Trajectory t = flight(c.speed, 0, 0);
    const core::EventTags second = tags({10, 20, 30}), first = tags({10 + c.difference, 20 + c.difference, 30 + c.difference});
    const PlaceComparison p = compare_places(compare(first, second, EventMatch::id, 1).pairs, second, t);
    EXPECT_NEAR(p.axes[0].bias, c.expected, 0.01 * c.expected);
    EXPECT_LT(p.axes[1].largest, 1e-3 * c.expected);
    EXPECT_LT(p.axes[2].largest, 1e-3 * c.expected);
    EXPECT_EQ(p.outside, 0u);
  }
}

TEST(TimeCompare, AxesAgreeWithTheTrajectoryItself) {
  const Trajectory t = flight(60, 0.1, 3);
  const core::EventTags second = tags({10, 90}), first = tags({10.05, 90.05});
  const PlaceComparison p = compare_places(compare(first, second, EventMatch::id, 1).pairs, second, t);
  EXPECT_EQ(p.outside, 1u);
  const Pose a = *t.pose_at(1.4e9 + 10.05), b = *t.pose_at(1.4e9 + 10);
  EXPECT_NEAR(p.length.bias, (a.position - b.position).norm(), 1e-4);
  EXPECT_NEAR(p.axes[2].bias, 0.15, 1e-3);
  // Turning right: the later place lies to the right, v dt^2 rate / 2.
  EXPECT_NEAR(p.axes[1].bias, 60 * 0.05 * 0.05 * 0.1 / 2, 1e-3);
  EXPECT_NEAR(p.axes[0].bias, 3.0, 0.02);
}

constexpr double reference_time = 1e-7;   // s, stated by the reference
constexpr double reference_place = 1e-6;  // m, its printed digits

TEST(TimeCompareReference, StripsOfTheReferenceFlight) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p003_sync.json");
  rapidjson::Document d;
  d.Parse(test::read_bytes(file).c_str());
  core::EventTags stamps, corrected, marks;
  for (core::EventTags* t : {&stamps, &corrected, &marks}) {
    t->epoch = d["gps_week"].GetInt() * 604800.0;
    for (const auto& e : d["events"].GetArray()) {
      t->id.push_back(std::to_string(t->size() + 1));
      t->strip.push_back(e["strip"].GetInt());
      t->sigma.push_back(0);
      t->doubtful.push_back(e["strip"].GetInt() == 1);
      t->time.push_back(t == &stamps ? e["pc_utc_sec_of_day"].GetDouble() - 39600 + d["sow_at_epoch"].GetDouble()
                                     : e[t == &marks ? "mark_gps_sow" : "corrected_gps_sow"].GetDouble());
    }
  }
  const TimeComparison raw = compare(stamps, marks, EventMatch::id, 1), after = compare(corrected, marks, EventMatch::id, 1);
  ASSERT_EQ(raw.pairs.size(), 60u);
  const auto strip_of = [](const TimeComparison& c, int strip) {
    std::vector<TimePair> out;
    for (const TimePair& p : c.pairs)
      if (p.strip == strip) out.push_back(p);
    return out;
  };
  const auto largest = [](const std::vector<TimePair>& pairs) {
    double m = 0;
    for (const TimePair& p : pairs) m = std::max(m, std::abs(p.difference));
    return m;
  };
  const auto& fit = d["shift_drift"];
  const auto check = [&](const ShiftDrift& mine, const rapidjson::Value& theirs) {
    EXPECT_NEAR(mine.shift, theirs["shift_s"].GetDouble(), reference_time);
    EXPECT_NEAR(mine.drift, theirs["drift"].GetDouble(), 1e-9);
    EXPECT_NEAR(mine.rms_after, theirs["rms_after_s"].GetDouble(), reference_time);
  };
  check(shift_and_drift(raw.pairs, stamps), fit["whole"]);
  for (int s = 1; s <= 4; ++s) {
    const auto k = static_cast<rapidjson::SizeType>(s - 1);
    EXPECT_NEAR(largest(strip_of(raw, s)), d["stats"]["raw_max_us"][k].GetDouble() * 1e-6, reference_time);
    EXPECT_NEAR(largest(strip_of(after, s)), d["stats"]["corrected_max_us"][k].GetDouble() * 1e-6, reference_time);
    check(shift_and_drift(strip_of(raw, s), stamps), fit["strips"][k]);
  }
  EXPECT_NEAR(after.trusted.largest, d["stats"]["corrected_max_after_convergence_us"].GetDouble() * 1e-6, reference_time);
  EXPECT_LT(after.trusted.largest, 40e-6);
  EXPECT_NEAR(after.trusted.largest * d["speed_m_s"].GetDouble(), d["stats"]["position_error_mm_max"].GetDouble() * 1e-3, 1e-5);
}

}  // namespace
}  // namespace swath::trajectory
