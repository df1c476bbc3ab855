// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/held_values.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "calib/block/block_adjust.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

test::Making distorted(unsigned seed) {
  test::Making m;
  m.seed = seed;
  m.which = {"", DriftSets::none, ControlLayout::chains, 2};
  m.camera[1] = 0.05, m.camera[2] = -0.08;  // mm
  m.camera[3] = 8e-7;                       // k1: 1.2 mm in the corners; the two points differ by 25 um there
  return m;
}

/// Findings once the block is adjusted with this camera.
std::string finding(const ImageBlock& given, const std::function<void(BlockCamera&)>& change) {
  ImageBlock b = given;
  change(b.cameras[0]);
  BlockOptions plain;
  plain.robust = plain.components = false;
  const BlockSolution s = adjust_block(b, plain);
  const std::vector<std::string> found = held_value_findings(b, s.weights);
  return found.empty() ? "" : found.front();
}

TEST(HeldValues, ARightCameraIsNotNamed) {
  for (unsigned seed = 1; seed <= 5; ++seed) EXPECT_EQ(finding(test::make_block(distorted(seed)).given, [](BlockCamera&) {}), "") << seed;
}

TEST(HeldValues, DistortionOfTheOtherPoint) {
  const std::string found = finding(test::make_block(distorted(1)).given, [](BlockCamera& c) { c.distortion = DistortionAt::measured; });
  EXPECT_NE(found.find("fit better with distortion = \"ideal\""), std::string::npos) << found;
}

TEST(HeldValues, SignsOfThePrincipalPoint) {
  const ImageBlock given = test::make_block(distorted(2)).given;
  const std::string x = finding(given, [](BlockCamera&c) { c.value[1] = -c.value[1]; }),
                    y = finding(given, [](BlockCamera&c) { c.value[2] = -c.value[2]; }),
                    both = finding(given, [](BlockCamera&c) { c.value.segment<2>(1) *= -1.0; });
  EXPECT_NE(x.find("the opposite sign of x0:"), std::string::npos) << x;
  EXPECT_NE(y.find("the opposite sign of y0:"), std::string::npos) << y;
  EXPECT_NE(both.find("the opposite sign of x0 and y0:"), std::string::npos) << both;
}

TEST(HeldValues, FreeValuesAreNotJudged) {
  const std::string found = finding(test::make_block(distorted(3)).given, [](BlockCamera& c) {
    c.distortion = DistortionAt::measured;
    c.sigma.segment<3>(1).setConstant(free_value);
  });
  EXPECT_EQ(found, "");
}

TEST(HeldValues, SquaresAreThoseOfTheDenseSolution) {
  ImageBlock block = test::block_with_all_unknowns();
  const LinearBlock l = BlockSystem(block, {}).linearise();
  const auto rows = static_cast<Eigen::Index>(l.residual.size());
  const Eigen::MatrixXd A = test::dense_rows(l);
  Eigen::MatrixXd r(rows, 2);
  for (Eigen::Index k = 0; k < rows; ++k) r.row(k) << std::sin(0.7 * static_cast<double>(k)), l.residual[static_cast<size_t>(k)];
  const Eigen::MatrixXd scaled = A * A.colwise().norm().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd left = r - scaled * Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(scaled).solve(r);
  const Eigen::VectorXd found = adjusted_squares(l, r);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(found[k], left.col(k).squaredNorm(), 1e-6 * r.col(k).squaredNorm()) << k;
}

}  // namespace
}  // namespace swath::calib
