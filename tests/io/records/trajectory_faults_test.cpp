// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/trajectory_faults.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::io {
namespace {

/// Due east at 60 m/s on the equator, across longitude 180, with 0.1 rad/s of turns.
core::TrajectoryData flight(size_t n = 400) {
  core::TrajectoryData t;
  for (size_t i = 0; i < n; ++i) {
    const double s = 0.01 * static_cast<double>(i), lon = core::pi - 1.2 / 6378137.0 * 60 + 60.0 * s / 6378137.0;
    t.time.push_back(1e9 + s);
    t.latitude.push_back(0.0);
    t.longitude.push_back(lon > core::pi ? lon - 2 * core::pi : lon);
    t.height.push_back(1000.0);
    t.roll.push_back(0.3 * std::sin(s));
    t.pitch.push_back(0.05);
    t.heading.push_back(i % 2 ? 0.01 : 2 * core::pi - 0.01);
  }
  return t;
}

TEST(TrajectoryFaults, ARightFlightAcross180HasNone) {
  core::TrajectoryData t = flight();
  core::Tally tally;
  EXPECT_TRUE(leave_out_faults(t, "a", tally).empty());
  EXPECT_TRUE(tally.empty());
}

TEST(TrajectoryFaults, OneWildValueOfEachKindIsLeftOutAndCounted) {
  struct Case {
    std::vector<double> core::TrajectoryData::*column;
    double value;
    PoseFault fault;
  };
  using T = core::TrajectoryData;
  for (const Case& c : {Case{&T::latitude, std::nan(""), PoseFault::not_finite},
                        {&T::latitude, 1.6, PoseFault::impossible},
                        {&T::latitude, 0.01, PoseFault::place},
                        {&T::longitude, 0.0, PoseFault::place},
                        {&T::longitude, 1e300, PoseFault::impossible},
                        {&T::height, 1e9, PoseFault::impossible},
                        {&T::height, 5000.0, PoseFault::place},
                        {&T::roll, 3.0, PoseFault::attitude},
                        {&T::roll, 1e300, PoseFault::impossible},
                        {&T::heading, 3.0, PoseFault::attitude},
                        {&T::time, 2e9, PoseFault::time},
                        {&T::time, -5.0, PoseFault::time}})
    for (const size_t at : {size_t{0}, size_t{200}, size_t{399}}) {
      T t = flight();
      (t.*c.column)[at] = c.value;
      EXPECT_EQ(pose_faults(t)[at], c.fault) << at << ' ' << c.value;
      core::Tally tally;
      leave_out_faults(t, "a", tally);
      EXPECT_EQ(t.size(), 399u) << at << ' ' << c.value;
      EXPECT_EQ(tally.left_out(), 1u);
      EXPECT_NE(tally.value().members()[0].second.find("examples")->items()[0].as_text().find("record " + std::to_string(at)),
                std::string::npos);
    }
}

TEST(TrajectoryFaults, ManyAreNotASlip) {
  core::TrajectoryData t = flight();
  for (size_t i = 0; i < t.size(); i += 20) t.height[i] = std::nan("");
  core::Tally tally;
  EXPECT_THROW(leave_out_faults(t, "a", tally), core::Error);
  t = flight();
  for (size_t i = 0; i < t.size(); i += 20) t.height[i] = 5000.0;  // which of them are right?
  EXPECT_TRUE(leave_out_faults(t, "a", tally).size() == t.size() && t.size() == 400);
}

}  // namespace
}  // namespace swath::io
