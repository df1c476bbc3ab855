// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/jackknife.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;

struct Solved {
  Solved() {
    World w = make_world({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}}, block_planes(4, 6, 8));
    w.returns = 10;
    Dice dice(6);
    TieSet ties = ties_of(w, &dice);
    CorrectionOptions o;
    o.spacing = core::Seconds(10.0);
    bench = std::make_unique<TieBench>(w, ties, w.exact, o, std::vector<Parameter>{boresight_roll, boresight_pitch, range_offset});
    pass = linearise(bench->problem, bench->state, bench->noise, 1.0);
    system = std::make_unique<TieSystem>(bench->problem, pass.blocks, std::vector<ControlRow>{}, 0.003);
    use = {std::vector<char>(ties.groups.size(), 1), {}};
    solution = solve_with(use, full);
  }
  TieSolution solve_with(const TieSelection& with, Normals& n) const {
    std::vector<PlaneRest> rests;
    n = system->sum(with, rests);
    add_prior(bench->prior(Eigen::Vector3d(1e2, 1e2, 1.0), Eigen::Vector3d::Zero()), n);
    return solve(*system, n, rests, Inverse::both);
  }
  std::unique_ptr<TieBench> bench;
  TiePass pass;
  std::unique_ptr<TieSystem> system;
  TieSelection use;
  Normals full{0};
  TieSolution solution;
};

TEST(Jackknife, IsTheSpreadOfAdjustmentsWithoutEachLine) {
  const Solved s;
  const auto lines = groups_by_line(s.bench->ties, s.use);
  ASSERT_EQ(lines.size(), 4u);
  const Jackknife j = jackknife(s.bench->problem, *s.system, s.use, s.full, s.solution, lines);
  EXPECT_EQ(j.replicates, 4);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero(), expected = squares;
  for (const auto& gone : lines) {
    TieSelection without = s.use;
    for (const size_t g : gone) without.group[g] = 0;
    Normals n(0);
    const TieSolution other = s.solve_with(without, n);
    const Eigen::Vector3d d = (other.x - s.solution.x).head<3>();
    squares += d.cwiseAbs2();
    expected += (other.of_globals(3) - s.solution.of_globals(3)).diagonal();
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(j.sigma[i], std::sqrt(0.75 * squares[i]), 1e-6 * j.sigma[i]);
    EXPECT_NEAR(j.ratio[i], std::sqrt(squares[i] / expected[i]), 1e-4 * j.ratio[i]);
    EXPECT_GE(j.freedom[i], 1.0);
    EXPECT_LE(j.freedom[i], 3.0);
  }
}

TEST(Jackknife, RegionsPartThePlanes) {
  const Solved s;
  const auto regions = groups_by_region(s.bench->ties, s.use, 8);
  EXPECT_EQ(regions.size(), 8u);
  std::set<size_t> seen;
  std::vector<std::set<std::uint32_t>> planes(regions.size());
  for (size_t r = 0; r < regions.size(); ++r)
    for (const size_t g : regions[r]) {
      EXPECT_TRUE(seen.insert(g).second);
      planes[r].insert(s.bench->ties.groups[g].plane);
    }
  EXPECT_EQ(seen.size(), s.bench->ties.groups.size());
  for (const auto& p : planes) EXPECT_NEAR(static_cast<double>(p.size()), 28.0 / 8.0, 1.0);
  // No more regions than planes.
  EXPECT_EQ(groups_by_region(s.bench->ties, s.use, 200).size(), 28u);
}

TEST(Jackknife, OneLineTellsNothing) {
  const Solved s;
  EXPECT_EQ(jackknife(s.bench->problem, *s.system, s.use, s.full, s.solution, {{0, 1, 2}}).replicates, 0);
}

TEST(Jackknife, EnlargedOnlyBeyondChance) {
  EXPECT_EQ(enlargement(1.5, 7.0, 0.01), 1.0);  // chance makes 1.62 of seven degrees of freedom
  EXPECT_NEAR(enlargement(3.24, 7.0, 0.01), 2.0, 0.02);
  EXPECT_EQ(enlargement(0.2, 7.0, 0.01), 1.0);
  EXPECT_EQ(enlargement(5.0, 0.0, 0.01), 1.0);
}

}  // namespace
}  // namespace swath::calib
