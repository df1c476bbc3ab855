// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry_trial.h"

#include <gtest/gtest.h>

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
