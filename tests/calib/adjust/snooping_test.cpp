// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/snooping.h"

#include <gtest/gtest.h>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;

// A solved flight of three lines, control on two planes.
struct Solved {
  Solved(double facet, double control_error, const Eigen::Vector3d& datum, bool with_control) {
    World w = make_world({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}}, block_planes(4, 6, 8));
    w.returns = 10;
    Dice dice(21);
    for (const size_t k : {size_t{3}, size_t{17}, size_t{18}, size_t{20}}) survey(w.planes[k], 0.02, &dice);
    TieSet ties = ties_of(w, &dice);
    for (TiePlane& p : ties.planes)
      for (PlaneControl& c : p.control) c.point += datum;
    ties.planes[17].control[1].point += control_error * ties.planes[17].normal;
    for (size_t i = ties.groups[group].begin; i < ties.groups[group].end; ++i) ties.returns.range[i] -= facet;
    CorrectionOptions o;
    o.spacing = core::Seconds(10.0);
    bench = std::make_unique<TieBench>(w, ties, w.exact, o, std::vector<Parameter>{boresight_roll, boresight_pitch, range_offset});
    pass = linearise(bench->problem, bench->state, bench->noise, 1.0);
    system = std::make_unique<TieSystem>(bench->problem, pass.blocks, control_rows(bench->state.planes, 1.0), 0.003);
    use = {std::vector<char>(ties.groups.size(), 1), std::vector<char>(16, with_control)};
    solve_now();
  }
  void solve_now() {
    Normals n = system->sum(use, rests);
    add_prior(bench->prior(Eigen::Vector3d(1e4, 1e4, 1.0), Eigen::Vector3d::Zero()), n);
    solution = solve(*system, n, rests, Inverse::both);
  }
  static constexpr size_t group = 40;
  std::unique_ptr<TieBench> bench;
  TiePass pass;
  std::unique_ptr<TieSystem> system;
  TieSelection use;
  std::vector<PlaneRest> rests;
  TieSolution solution;
};

TEST(Snooping, TestsOfSoundObservationsAreNormal) {
  const Solved s(0.0, 0.0, Eigen::Vector3d::Zero(), true);
  const TieTests t = tests_of(*s.system, s.solution, s.rests, s.use);
  double squares = 0.0, redundancy = 0.0, largest = 0.0;
  for (const TieTest& g : t.group) {
    squares += g.w * g.w;
    largest = std::max(largest, std::abs(g.w));
    redundancy += g.redundancy;
    EXPECT_GE(g.redundancy, 0.0);
    EXPECT_LE(g.redundancy, 1.0);
  }
  // The surfaces here are exact and their stated sigma 3 mm beside 6 mm of the ranges' mean: w is a little below its sigma of 1.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(t.group.size())), 1.0, 0.25);
  EXPECT_LT(largest, 4.0);
  EXPECT_GT(redundancy, 0.1 * static_cast<double>(t.group.size()));
  EXPECT_LT(redundancy, static_cast<double>(t.group.size()));
}

TEST(Snooping, FindsOneDisplacedFacet) {
  Solved s(0.15, 0.0, Eigen::Vector3d::Zero(), true);
  const TieTests before = tests_of(*s.system, s.solution, s.rests, s.use);
  EXPECT_GT(std::abs(before.group[s.group].w), 5.0);
  EXPECT_NEAR(std::abs(before.group[s.group].displacement), 0.14, 0.05);  // 0.15 m along the beam, less along the normal
  bool full = false;
  EXPECT_EQ(reject_worst(*s.system, before, {}, s.use, full), 1);
  EXPECT_FALSE(full);
  EXPECT_EQ(s.use.group[s.group], 0);
  // Left out, it is compared with what the others predict.
  s.solve_now();
  const TieTests after = tests_of(*s.system, s.solution, s.rests, s.use);
  EXPECT_EQ(after.group[s.group].redundancy, 1.0);
  EXPECT_NEAR(after.group[s.group].displacement, before.group[s.group].displacement, 0.02);  // its tilt is left out with it
  EXPECT_NEAR(after.group[s.group].w, before.group[s.group].w, 0.05 * std::abs(before.group[s.group].w));
  EXPECT_EQ(reject_worst(*s.system, after, {}, s.use, full), 0);
}

TEST(Snooping, FindsTheWrongControlPoint) {
  Solved s(0.0, 0.5, Eigen::Vector3d::Zero(), true);
  bool full = false;
  EXPECT_GE(reject_worst(*s.system, tests_of(*s.system, s.solution, s.rests, s.use), {}, s.use, full), 1);
  EXPECT_EQ(s.use.control[5], 0);
  EXPECT_EQ(std::count(s.use.control.begin(), s.use.control.end(), 0), 1);
}

TEST(Snooping, NoMoreThanTheShare) {
  Solved s(0.15, 0.0, Eigen::Vector3d::Zero(), true);
  SnoopingOptions o;
  o.alpha = 0.1;
  o.share = 0.02;
  bool full = false;
  for (int i = 0; i < 20; ++i) {
    reject_worst(*s.system, tests_of(*s.system, s.solution, s.rests, s.use), o, s.use, full);
    s.solve_now();
  }
  EXPECT_TRUE(full);
  EXPECT_LE(std::count(s.use.group.begin(), s.use.group.end(), 0), 0.02 * static_cast<double>(s.use.group.size()) + 1.0);
}

TEST(Snooping, ControlInAnotherDatumIsSeen) {
  const Eigen::Vector3d datum(1.2, -0.8, 2.5);
  const Solved s(0.0, 0.0, datum, false);
  const ControlShift shift = control_shift(*s.system, s.bench->state.planes, s.solution, s.rests);
  EXPECT_TRUE(shift.shifted);
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(shift.known[k]);
    EXPECT_NEAR(shift.mean[k], datum[k], 0.15);  // the trajectory's own position is known to 3 cm, the roofs slope 30 deg
  }
}

TEST(Snooping, OneWrongPointIsNoDatum) {
  const Solved one(0.0, 2.0, Eigen::Vector3d::Zero(), false);
  EXPECT_FALSE(control_shift(*one.system, one.bench->state.planes, one.solution, one.rests).shifted);
  const Solved sound(0.0, 0.0, Eigen::Vector3d::Zero(), false);
  EXPECT_FALSE(control_shift(*sound.system, sound.bench->state.planes, sound.solution, sound.rests).shifted);
}

TEST(Snooping, LevelControlTellsHeightsAlone) {
  Solved s(0.0, 0.0, {0.0, 0.0, -1.0}, false);
  for (TiePlane& p : s.bench->state.planes)
    if (p.normal.z() < std::cos(5.0 * deg)) p.control.clear();
  s.system = std::make_unique<TieSystem>(s.bench->problem, s.pass.blocks, control_rows(s.bench->state.planes, 1.0), 0.003);
  s.use.control.assign(s.system->control().size(), 0);
  s.solve_now();
  ASSERT_GT(s.system->control().size(), 0u);
  const ControlShift shift = control_shift(*s.system, s.bench->state.planes, s.solution, s.rests);
  EXPECT_TRUE(shift.shifted);
  EXPECT_TRUE(shift.known[2]);
  EXPECT_FALSE(shift.known[0] && shift.known[1]);
  EXPECT_NEAR(shift.mean.z(), -1.0, 0.1);
}

}  // namespace
}  // namespace swath::calib
