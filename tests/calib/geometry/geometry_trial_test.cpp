// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;

/// How often the shots are read while a flight with a mistake is judged.
int reads_of(const std::function<void(GateFlight&)>& change) {
  GateFlight f;
  change(f);
  const trajectory::Trajectory t(f.data);
  GeometryInput in = f.input(t);
  int reads = 0;
  in.shots = [&reads, all = in.shots](const auto& work) { ++reads, all(work); };
  judge_geometry(in, {});
  return reads;
}

/// Lines side by side, without returns.
struct ManyLines {
  core::TrajectoryData data;
  std::vector<RecordedLine> lines;
  explicit ManyLines(int count) {
    constexpr double speed = 50, taken = 100, spacing = 150;
    const core::Geodetic at = core::geodetic_of(GateFlight::local().to_ecef({0, 0, 300}));
    for (int k = 0; k < count; ++k) {
      const double start = 1000 + 200.0 * k;
      for (int i = -1; i <= static_cast<int>(taken) + 1; ++i) {
        data.time.push_back(start + i);
        data.latitude.push_back(at.latitude + (k % 2 ? taken - i : i) * speed / 6.37e6);
        data.longitude.push_back(at.longitude + k * spacing / (6.38e6 * std::cos(at.latitude)));
        data.height.push_back(at.height);
        for (const auto c : {&core::TrajectoryData::roll, &core::TrajectoryData::pitch, &core::TrajectoryData::heading})
          (data.*c).push_back(0);
      }
      lines.push_back({k + 1, start, start + taken, 1000000});
    }
  }
  GeometryInput input(const trajectory::Trajectory& t) const {
    GeometryInput in;
    in.shots = [](const auto&) {};
    in.lines = lines;
    in.trajectory = &t;
    in.range = 300;
    return in;
  }
};

TEST(GeometryTrial, SamplesForManyMistakesAreNoMoreThanTwoOfTheFlight) {
  const ManyLines f(60);
  trajectory::TrajectoryOptions how;
  how.max_gap = core::Seconds(1.5);
  const trajectory::Trajectory t(f.data, how);
  const GeometryInput in = f.input(t);
  const auto surfaces = [](const std::vector<SampledFlight>& all) {
    size_t n = 0;
    for (const SampledFlight& one : all)
      for (const Stretch& s : one.plan.stretches) n += !s.profile;
    return n;
  };
  const size_t own = surfaces(sampled(in, {}, GateFlight::local(), {{0.0, in.range}}));
  EXPECT_GE(own, 64u);
  const size_t nine = surfaces(sampled(in, {}, GateFlight::local(), std::vector<SampleFor>(9, {0.0, in.range})));
  EXPECT_LE(nine, 9 * own / 4);  // a pair of lines is not parted
}

TEST(GeometryTrial, ManySurveyedPlacesCostLittle) {
  const ManyLines f(60);
  trajectory::TrajectoryOptions how;
  how.max_gap = core::Seconds(1.5);
  const trajectory::Trajectory t(f.data, how);
  GeometryInput in = f.input(t);
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) in.control.push_back({GateFlight::local().to_ecef({i * 300.0 - 20e3, j * 150.0, 0}), 0.02, 0.02});
  const SampledFlight one = std::move(sampled(in, {}, GateFlight::local(), {{0.0, in.range}}).front());
  EXPECT_EQ(one.plan.spots, 40000u);
  EXPECT_GT(one.plan.near_spots, 500u);
  EXPECT_LT(one.plan.near_spots, 5000u);
  EXPECT_LE(one.control.size(), 500u);
  EXPECT_GT(one.control.size(), 50u);
}

TEST(GeometryTrial, ARightFlightIsReadOnce) {
  EXPECT_EQ(reads_of([](GateFlight&) {}), 1);
}

TEST(GeometryTrial, TheShotsAreReadFourTimesAtMostHoweverManyMistakesAreTried) {
  EXPECT_LE(reads_of([](GateFlight& f) {
              for (core::Shots& s : f.shots)
                for (double& r : s.range) r *= 2;
            }),
            4);
  EXPECT_LE(reads_of([](GateFlight& f) { f.chain.calibration.latency.value += 0.6; }), 4);
}

}  // namespace
}  // namespace swath::calib
