// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjust_rounds.h"

#include <gtest/gtest.h>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;

const std::vector<Parameter> angles = {boresight_roll, boresight_pitch, boresight_heading};

std::unique_ptr<TieBench> bench_of(World w, TieSet ties, CorrectionForm form) {
  CorrectionOptions o;
  o.position = o.attitude = form;
  o.spacing = core::Seconds(10.0);
  return std::make_unique<TieBench>(w, std::move(ties), w.exact, o, angles);
}

World four_lines() {
  World w = make_world({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}}, block_planes(4, 8, 8));
  w.returns = 12;
  return w;
}

const Eigen::Vector3d free_angles = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
const Eigen::Vector3d useful = Eigen::Vector3d::Constant(1e-4);

TEST(AdjustRounds, BeforeIsTheMisfitOfTheStart) {
  const World w = four_lines();
  const auto b = bench_of(w, ties_of(w, nullptr), CorrectionForm::none);
  core::Calibration start = w.truth;
  start.roll.value += 1e-3;  // 0.7 m at 700 m
  AdjustRounds r(b->problem, start, w.noise, free_angles, useful, {});
  r.run();
  double before = 0.0, after = 0.0;
  for (size_t g = 0; g < b->ties.groups.size(); ++g) {
    before = std::max(before, std::abs(r.before[g]));
    after = std::max(after, std::abs(r.pass.blocks[g].b[3]) / r.pass.blocks[g].weight());
  }
  EXPECT_GT(before, 0.2);
  EXPECT_LT(before, 1.0);
  EXPECT_LT(after, 1e-6);
  EXPECT_TRUE(r.converged);
  EXPECT_NEAR(r.state.calibration.roll.value, w.truth.roll.value, 1e-9);
}

TEST(AdjustRounds, RoughPlanesWeighLess) {
  World w = four_lines();
  Dice dice(3);
  TieSet ties = ties_of(w, &dice);
  for (TiePlane& p : ties.planes) p.roughness = 0.02;
  ties.planes[5].roughness = 0.10;
  const auto b = bench_of(w, ties, CorrectionForm::none);
  AdjustRounds r(b->problem, w.truth, w.noise, free_angles, useful, {});
  r.run();
  EXPECT_NEAR(r.state.roughness[5], 0.098, 0.005);
  for (size_t k = 0; k < r.state.roughness.size(); ++k)
    if (k != 5) {
      EXPECT_LT(r.state.roughness[k], 0.02) << k;
    }
}

TEST(AdjustRounds, ControlOfAnotherDatumTakesNoPart) {
  World w = four_lines();
  Dice dice(4);
  for (const size_t k : {size_t{2}, size_t{17}, size_t{19}, size_t{21}}) survey(w.planes[k], 0.02, &dice);
  TieSet ties = ties_of(w, &dice);
  for (TiePlane& p : ties.planes)
    for (PlaneControl& c : p.control) c.point.z() += 47.0;  // a geoid left out
  const auto b = bench_of(w, ties, CorrectionForm::spline);
  AdjustRounds r(b->problem, w.truth, w.noise, free_angles, useful, {});
  r.run();
  EXPECT_TRUE(r.shift.shifted);
  EXPECT_NEAR(r.shift.mean.z(), 47.0, 0.2);
  for (const char c : r.use.control) EXPECT_EQ(c, 0);
  EXPECT_LT(std::abs(r.state.calibration.roll.value - w.truth.roll.value), 0.005 * deg);
}

TEST(AdjustRounds, WithoutAnythingToDo) {
  World w = four_lines();
  TieSet empty;
  empty.frame = w.frame;
  const auto b = bench_of(w, empty, CorrectionForm::spline);
  AdjustRounds r(b->problem, w.truth, w.noise, free_angles, useful, {});
  r.run();
  EXPECT_TRUE(r.solution.solved);
  EXPECT_EQ(r.state.calibration.roll.value, w.truth.roll.value);
}

}  // namespace
}  // namespace swath::calib
