// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_pulses.h"

#include <gtest/gtest.h>

#include "tests/calib/box_flight.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;
using namespace test;

struct World {
  BoxRecords records;
  RoofTarget target;
  core::Scanner scanner;
  ShotGeometry geometry{scanner, {}};
  trajectory::Trajectory trajectory;

  explicit World(const BoxFlight& f) : records(fly(f)), trajectory(records.delivered) {
    std::vector<Vector3d> corners;
    for (const io::ControlPoint& p : records.control) corners.push_back(p.ecef);
    target = roof_target("hall", corners, 0.02, 0.02);
  }
};

BoxFlight wide_beams() {
  BoxFlight f;
  f.lines = {{3, 0.5, 0.0, 700.0}, {7, 0.5, 500.0, 700.0}};
  f.footprint = Footprint::disc;
  return f;
}

TEST(TargetPulses, CollectsThoseAroundTheTarget) {
  World w(wide_beams());
  const auto shots = w.records.stream();
  const CollectedPulses p = collect_pulses(shots, w.geometry, w.trajectory, w.target, 0.01);
  ASSERT_EQ(p.lines.size(), 2u);
  EXPECT_EQ(p.lines[0].line, 3);
  EXPECT_EQ(p.lines[1].line, 7);
  EXPECT_EQ(p.lines[1].pulses.size(), 0u);
  EXPECT_EQ(p.returns, w.records.shots[0].second.size() + w.records.shots[1].second.size());
  EXPECT_EQ(p.outside, 0u);
  EXPECT_TRUE(p.several_returns);
  EXPECT_NEAR(p.widest, std::tan(0.35), 0.02);
  const TargetPulses& mine = p.lines[0].pulses;
  size_t two = 0;
  for (size_t i = 0; i < mine.size(); ++i) {
    EXPECT_LE(mine.first[i], mine.last[i]);
    if (mine.returns[i] > 1) {
      ++two;
      EXPECT_GT(mine.last[i] - mine.first[i], 1.0);
    }
    const auto pose = w.trajectory.pose_at(mine.time[i]);
    const Vector3d at =
        w.target.frame.local_R_ecef * (w.geometry.ecef_point(*pose, {mine.angle[i], 0.0, mine.first[i]}) - w.target.frame.origin);
    EXPECT_LT(at.head<2>().norm(), 34.0 + 5.0 + 7.6);
  }
  EXPECT_GT(two, 50u);
}

TEST(TargetPulses, KeepsWithinItsBounds) {
  World w(wide_beams());
  const auto shots = w.records.stream();
  const CollectedPulses all = collect_pulses(shots, w.geometry, w.trajectory, w.target, 0.01);
  const size_t n = all.lines[0].pulses.size();
  const CollectedPulses some = collect_pulses(shots, w.geometry, w.trajectory, w.target, 0.01, n / 3);
  EXPECT_EQ(some.lines[0].kept_one_in, 4u);
  EXPECT_LE(some.lines[0].pulses.size(), n / 3);
  EXPECT_GT(some.lines[0].pulses.size(), n / 5);
  // Every fourth of the same pulses, evenly.
  for (size_t i = 0; i < some.lines[0].pulses.size(); ++i) EXPECT_EQ(some.lines[0].pulses.time[i], all.lines[0].pulses.time[4 * i]);
}

TEST(TargetPulses, BatchesMakeNoDifference) {
  World w(wide_beams());
  const auto whole = w.records.stream();
  const ShotStream split = [&](const std::function<void(int, const core::Shots&)>& f) {
    for (const auto& [line, s] : w.records.shots)
      for (size_t from = 0; from < s.size(); from += 777) {
        core::Shots batch;
        for (size_t i = from; i < std::min(from + 777, s.size()); ++i) {
          batch.time.push_back(s.time[i]), batch.angle.push_back(s.angle[i]), batch.range.push_back(s.range[i]);
          batch.return_number.push_back(s.return_number[i]), batch.return_count.push_back(s.return_count[i]);
        }
        f(line, batch);
      }
  };
  const CollectedPulses a = collect_pulses(whole, w.geometry, w.trajectory, w.target, 0.01);
  const CollectedPulses b = collect_pulses(split, w.geometry, w.trajectory, w.target, 0.01);
  EXPECT_EQ(a.lines[0].pulses.time, b.lines[0].pulses.time);
  EXPECT_EQ(a.lines[0].pulses.last, b.lines[0].pulses.last);
}

TEST(TargetPulses, CountsWhatIsOutsideTheTrajectoryAndSkipsWhatIsNoRange) {
  World w(wide_beams());
  for (auto& [line, s] : w.records.shots) {
    s.time[0] = 1.0;
    s.range[1] = std::nan("");
    s.range[2] = -5.0;
    s.angle[3] = std::nan("");
  }
  const auto shots = w.records.stream();
  EXPECT_EQ(collect_pulses(shots, w.geometry, w.trajectory, w.target, 0.01).outside, 2u);
}

}  // namespace
}  // namespace swath::calib
