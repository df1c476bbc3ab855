// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/direct_comparison.h"

#include <gtest/gtest.h>

#include <random>

#include "calib/block/block_findings.h"
#include "calib/block/block_page.h"
#include "core/error.h"
#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

constexpr double boresight_sigma = 1e-4;  // rad, as large as that of attitudes

struct Compared {
  BlockConfig config;
  ReadBlock stated, read;
  BlockSolution solution;
  std::vector<DirectCompared> found;
};

/// A made block whose stations and attitudes have a file of covariances, and whose boresight is observed, or free.
Compared compare(unsigned seed, const std::string& boresight) {
  test::Making making = test::small_making();
  making.seed = seed;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 3; ++k) making.boresight[k] = boresight_sigma * normal(random);
  test::MadeFiles m;
  m.block = test::make_block(making).given;
  m.write_angles = true, m.angle_use = "observed";
  const test::TemporaryFolder folder;
  const std::string file = test::write_made(m, folder.path());
  CorrelationFile to(folder / "correlation.csv", "local");
  for (size_t i = 0; i < m.block.images.size(); ++i) {
    PoseCovariance C = PoseCovariance::Zero();
    C.topLeftCorner<3, 3>() = m.block.stations.at(i).covariance, C.bottomRightCorner<3, 3>() = m.block.attitudes.at(i).covariance;
    to.add(m.block.images[i].name, m.block.images[i].name, C);
  }
  to.commit();
  Compared out;
  out.config = test::read_made(file);
  out.config.images.correlation = folder / "correlation.csv";
  out.config.cameras[0].sigma.boresight = boresight;
  out.config.adjust.robust = out.config.adjust.components = false;
  out.stated = out.read = read_block(out.config, file);
  out.solution = adjust_block(out.read.block, out.config.adjust);
  out.found = compare_direct(out.stated, out.read, out.solution);
  return out;
}

TEST(DirectComparison, DifferencesHaveTheirOwnSigmasOverSeeds) {
  constexpr int seeds = 20;
  constexpr double three_sigma = 0.25;  // half of the rotations' variance is the boresight's, one error per seed
  std::array<double, 6> squares{};
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Compared c = compare(seed, "0.0057295779513 deg");
    ASSERT_EQ(c.found.size(), 6u);
    for (size_t k = 0; k < 6; ++k) {
      EXPECT_TRUE(c.found[k].is_tested);
      EXPECT_LE(c.found[k].integrated, c.found[k].direct) << "the adjustment has the same observations, and more";
      squares[k] += c.found[k].over_sigma * c.found[k].over_sigma / seeds;
    }
  }
  for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(std::sqrt(squares[k]), 1.0, three_sigma) << k;
}

TEST(DirectComparison, AFreeBoresightLeavesDirectAttitudesWithoutSigma) {
  const Compared c = compare(1, "free");
  for (size_t k = 0; k < 6; ++k) EXPECT_EQ(c.found[k].is_known, k < 3) << k;
  EXPECT_EQ(c.found[0].component + " " + c.found[0].unit + " " + c.found[5].component + " " + c.found[5].unit, "east m turn deg");
  BlockFound found = findings_of(c.read, c.config, c.solution);
  EXPECT_EQ(block_page(c.read, c.config, c.solution, found).find("Direct and integrated"), std::string::npos);
  found.direct = c.found;
  EXPECT_NE(block_page(c.read, c.config, c.solution, found).find("not known"), std::string::npos);
}

TEST(DirectComparison, WithoutCovariancesThereIsNone) {
  Compared c = compare(1, "free");
  c.stated.covariance.clear();
  EXPECT_TRUE(compare_direct(c.stated, c.read, c.solution).empty());
}

}  // namespace
}  // namespace swath::calib
