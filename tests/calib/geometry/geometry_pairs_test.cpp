// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "tests/calib/gate_flight.h"

namespace swath::calib {
namespace {

using test::GateFlight;

struct Sampled {
  GateFlight flight;
  trajectory::Trajectory trajectory{flight.data};
  SamplePlan plan = plan_sample(flight.lines, trajectory, GateFlight::local(), 0.0, 300.0, {});
  GeometrySample sample = collect_samples({&plan}, flight.input(trajectory).shots).front();
  GroundOptions options{plan.cell, 0.15};
};

const Sampled& sampled() {
  static const Sampled s;
  return s;
}

TEST(GeometryPairs, CellsLieOnTheGround) {
  const Sampled& s = sampled();
  LocalPoints points(s.flight.chain.scanner, s.flight.chain.calibration, s.trajectory, GateFlight::local());
  size_t cells = 0, off = 0;
  for (const PassGround& g : ground_of(s.sample, points, s.options))
    for (const GroundCell& c : g.smooth) {
      ++cells;
      off += std::abs(c.mean.z() - GateFlight::ground(c.mean.x(), c.mean.y(), false)) > 0.3;
      EXPECT_LT(c.rms, 0.3);
    }
  EXPECT_GT(cells, 300u);
  EXPECT_LT(100 * off, cells);
}

TEST(GeometryPairs, AHeightOfOneLineShowsInItsPairs) {
  const Sampled& s = sampled();
  LocalPoints points(s.flight.chain.scanner, s.flight.chain.calibration, s.trajectory, GateFlight::local());
  std::vector<PassGround> ground = ground_of(s.sample, points, s.options);
  ASSERT_GE(ground.size(), 2u);
  for (GroundCell& c : ground[1].smooth) c.mean.z() += 1.0;
  const std::vector<SharedCell> shared = shared_cells(ground[0], ground[1], s.options.cell);
  ASSERT_GT(shared.size(), 30u);
  double sum = 0;
  for (const SharedCell& c : shared) sum += c.apart;
  EXPECT_NEAR(sum / static_cast<double>(shared.size()), -1.0, 0.1);
}

TEST(GeometryPairs, ThePredictedDifferenceFollowsTheSigmas) {
  const Sampled& s = sampled();
  LocalPoints points(s.flight.chain.scanner, s.flight.chain.calibration, s.trajectory, GateFlight::local());
  const std::vector<PassGround> ground = ground_of(s.sample, points, s.options);
  const std::vector<SharedCell> shared = shared_cells(ground[0], ground[1], s.options.cell);
  const auto predicted = [&](const core::SensorSigma& sigma) {
    return predicted_difference(shared, s.sample.surfaces[0].shots, s.sample.surfaces[1].shots, points.geometry(), sigma, s.trajectory,
                                GateFlight::local());
  };
  core::SensorSigma loose = s.flight.sensor;
  loose.roll = core::degrees(0.1);
  EXPECT_GT(predicted(s.flight.sensor), 0.02);
  EXPECT_LT(predicted(s.flight.sensor), 0.12);
  EXPECT_GT(predicted(loose), 3 * predicted(s.flight.sensor));
}

/// Sloped cells that agree, and level ones of one height that differ by `tide`, more so by `tilt` per cell.
std::vector<SharedCell> shore(std::vector<GroundCell>& cells, double tide, double tilt, double slope_apart) {
  cells.assign(60, {});
  std::vector<SharedCell> out;
  for (int i = 0; i < 60; ++i) {
    GroundCell& c = cells[static_cast<size_t>(i)];
    const bool land = i < 30;
    c.mean = {3.0 * i, 0.0, land ? 0.3 * i : -1.0};
    c.slope = {land ? 0.1 : 0.0, 0.0};
    out.push_back({&c, &c, (land ? slope_apart : tide + tilt * i) + 0.01 * std::sin(7.0 * i)});
  }
  return out;
}

TEST(GeometryPairs, WaterAtAnotherLevelIsTakenOut) {
  std::vector<GroundCell> cells;
  auto shared = shore(cells, 0.7, 0.0, 0.0);
  const auto tide = take_out_water(shared, 0.04);
  ASSERT_TRUE(tide);
  EXPECT_NEAR(*tide, 0.7, 0.02);
  EXPECT_EQ(shared.size(), 30u);
}

TEST(GeometryPairs, LandThatDiffersIsNotWater) {
  std::vector<GroundCell> cells;
  for (const auto& [tide, tilt, land] : {std::tuple{0.7, 0.0, 0.7}, std::tuple{0.3, 0.02, 0.0}, std::tuple{0.05, 0.0, 0.0}}) {
    auto shared = shore(cells, tide, tilt, land);
    EXPECT_FALSE(take_out_water(shared, 0.04)) << tide << " " << tilt;
    EXPECT_EQ(shared.size(), 60u);
  }
  auto shared = shore(cells, 0.7, 0.0, 0.0);
  for (int i = 30; i < 60; ++i) cells[static_cast<size_t>(i)].mean.z() = i;  // terraces
  EXPECT_FALSE(take_out_water(shared, 0.04));
}

}  // namespace
}  // namespace swath::calib
