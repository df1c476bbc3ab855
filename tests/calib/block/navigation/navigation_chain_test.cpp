// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/navigation_chain.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int images = 6;
using Numbers = std::unordered_map<std::string, std::uint32_t>;

/// A covariance of all images, positions in metres and rotations of 1e-4 rad.
MatrixXd any_covariance() {
  std::srand(7);
  const MatrixXd A = MatrixXd::Random(6 * images, 6 * images);
  MatrixXd C = A * A.transpose() + MatrixXd::Identity(6 * images, 6 * images);
  for (Index k = 0; k < C.rows(); ++k)
    if (k % 6 > 2) C.row(k) *= 1e-4, C.col(k) *= 1e-4;
  return C;
}

/// Errors of the first order in time: all covariances follow from those of neighbours.
MatrixXd markov_covariance() {
  PoseCovariance T = 0.3 * PoseCovariance::Random();
  T.diagonal().setConstant(0.8);
  MatrixXd C = MatrixXd::Zero(6 * images, 6 * images);
  C.topLeftCorner<6, 6>().setIdentity();
  for (Index i = 1; i < images; ++i) {
    C.block(6 * i, 0, 6, 6 * i) = T * C.block(6 * i - 6, 0, 6, 6 * i);
    C.block(0, 6 * i, 6 * i, 6) = C.block(6 * i, 0, 6, 6 * i).transpose();
    C.block<6, 6>(6 * i, 6 * i) = T * C.block<6, 6>(6 * i - 6, 6 * i - 6) * T.transpose() + PoseCovariance::Identity();
  }
  return C;
}

OrientationCorrelation pairs_of(const MatrixXd& C, std::uint32_t paired) {
  OrientationCorrelation out;
  for (std::uint32_t i = 0; i < images; ++i) {
    out.images.push_back("i" + std::to_string(i));
    for (std::uint32_t j = i - std::min(i, paired); j <= i; ++j) out.pairs.push_back({i, j, C.block<6, 6>(6 * i, 6 * j)});
  }
  return out;
}

Numbers all_images() {
  Numbers out;
  for (std::uint32_t i = 0; i < images; ++i) out["i" + std::to_string(i)] = i;
  return out;
}

/// (I - B)^-1 R R' (I - B)^-T.
MatrixXd covariance_of(const std::vector<NavigationStep>& chain, Index n) {
  const Index d = chain.front().root.rows();
  MatrixXd M = MatrixXd::Identity(d * n, d * n), R = MatrixXd::Zero(d * n, d * n);
  for (const NavigationStep& s : chain) {
    for (size_t k = 0; k < s.before.size(); ++k)
      M.block(d * s.image, d * s.before[k], d, d) = -s.by_before.middleCols(d * static_cast<Index>(k), d);
    R.block(d * s.image, d * s.image, d, d) = s.root;
  }
  const MatrixXd root = M.inverse() * R;
  return root * root.transpose();
}

void expect_equal(const MatrixXd& a, const MatrixXd& b) {
  ASSERT_EQ(a.rows(), b.rows());
  constexpr double rounding = 1e-9;
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < a.cols(); ++j) EXPECT_NEAR(a(i, j), b(i, j), rounding * std::sqrt(b(i, i) * b(j, j))) << i << " " << j;
}

/// Of two images, by the size of one's own.
void expect_block(const MatrixXd& a, const MatrixXd& b, const MatrixXd& own) { EXPECT_LT((a - b).norm(), 1e-9 * own.norm()); }

const std::vector<PoseCovariance> unturned(images, PoseCovariance::Identity());

TEST(NavigationChain, HasTheCovarianceOfItsPairs) {
  const MatrixXd C = any_covariance();
  expect_equal(covariance_of(navigation_chain(pairs_of(C, images), all_images(), unturned, {}, "c.csv"), images), C);
  // Of few pairs those are kept, whatever the others.
  const MatrixXd few = covariance_of(navigation_chain(pairs_of(C, 2), all_images(), unturned, {}, "c.csv"), images);
  for (Index i = 0; i < images; ++i)
    for (Index j = std::max<Index>(0, i - 2); j <= i; ++j)
      expect_block(few.block(6 * i, 6 * j, 6, 6), C.block(6 * i, 6 * j, 6, 6), C.block(6 * i, 6 * i, 6, 6));
  EXPECT_GT((few - C).norm(), 1e-3 * C.norm());
}

TEST(NavigationChain, PairsOfNeighboursAreEnoughForErrorsOfFirstOrder) {
  const MatrixXd C = markov_covariance();
  expect_equal(covariance_of(navigation_chain(pairs_of(C, 1), all_images(), unturned, {}, "c.csv"), images), C);
}

TEST(NavigationChain, StationsOrAttitudesAlone) {
  const MatrixXd C = any_covariance();
  for (const int first : {0, 3}) {
    const MatrixXd found = covariance_of(navigation_chain(pairs_of(C, images), all_images(), unturned, {first, 3}, "c.csv"), images);
    for (Index i = 0; i < images; ++i)
      for (Index j = 0; j < images; ++j)
        expect_block(found.block(3 * i, 3 * j, 3, 3), C.block(6 * i + first, 6 * j + first, 3, 3),
                     C.block(6 * i + first, 6 * i + first, 3, 3));
  }
}

TEST(NavigationChain, AxesAreTurned) {
  const MatrixXd C = any_covariance();
  std::vector<PoseCovariance> turn;
  MatrixXd all = MatrixXd::Zero(6 * images, 6 * images);
  for (Index i = 0; i < images; ++i) {
    turn.push_back(PoseCovariance::Zero());
    turn.back().topLeftCorner<3, 3>().setRandom();
    turn.back().bottomRightCorner<3, 3>().setRandom();
    all.block<6, 6>(6 * i, 6 * i) = turn.back();
  }
  expect_equal(covariance_of(navigation_chain(pairs_of(C, images), all_images(), turn, {}, "c.csv"), images), all * C * all.transpose());
}

TEST(NavigationChain, ImagesThatTheBlockDoesNotHaveAreLeftOut) {
  const MatrixXd C = any_covariance();
  const Numbers some{{"i0", 0}, {"i2", 1}, {"i5", 2}};
  const MatrixXd found = covariance_of(
      navigation_chain(pairs_of(C, images), some, std::vector<PoseCovariance>(3, PoseCovariance::Identity()), {}, "c.csv"), 3);
  const std::array<Index, 3> kept{0, 2, 5};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      expect_block(found.block(6 * static_cast<Index>(i), 6 * static_cast<Index>(j), 6, 6), C.block(6 * kept[i], 6 * kept[j], 6, 6),
                   C.block(6 * kept[i], 6 * kept[i], 6, 6));
}

template <class F>
std::string fault_of(F f) {
  try {
    f();
  } catch (const core::Error& e) {
    return e.what();
  }
  return "";
}

TEST(NavigationChain, WhatIsMissingIsNamed) {
  const MatrixXd C = any_covariance();
  OrientationCorrelation pairs = pairs_of(C, images);
  Numbers more = all_images();
  more["i6"] = 6;
  const std::vector<PoseCovariance> seven(7, PoseCovariance::Identity());
  EXPECT_EQ(fault_of([&] { navigation_chain(pairs, more, seven, {}, "c.csv"); }), "image i6 is not in the file of correlations");
  std::erase_if(pairs.pairs, [](const CovariancePair& p) { return p.image == 2 && p.other == 1; });
  EXPECT_EQ(fault_of([&] { navigation_chain(pairs, all_images(), unturned, {}, "c.csv"); }),
            "image i3 is paired with two images that are not paired with each other");
  pairs = pairs_of(C, images);
  pairs.pairs[1].value *= 1e3;  // a correlation above 1
  EXPECT_NE(fault_of([&] { navigation_chain(pairs, all_images(), unturned, {}, "c.csv"); }).find("image i1"), std::string::npos);
}

}  // namespace
}  // namespace swath::calib
