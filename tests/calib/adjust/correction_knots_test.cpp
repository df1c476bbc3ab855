// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/correction_knots.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <map>
#include <memory>
#include <set>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

const std::vector<TieLine> two_lines = {{1, 100.0, 110.0}, {2, 200.0, 207.0}};

CorrectionOptions form(CorrectionForm position, CorrectionForm attitude) {
  CorrectionOptions o;
  o.position = position;
  o.attitude = attitude;
  o.spacing = core::Seconds(2.5);
  return o;
}

TEST(CorrectionKnots, CountsAndPlaces) {
  const CorrectionKnots none(two_lines, 0.0, form(CorrectionForm::none, CorrectionForm::none), test::tactical_errors);
  EXPECT_EQ(none.size(), 0);
  EXPECT_EQ(none.at(0, 105.0, Eigen::VectorXd(0)).norm(), 0.0);
  const CorrectionKnots k(two_lines, 0.0, form(CorrectionForm::spline, CorrectionForm::drift), test::tactical_errors);
  // Knots at most 2.5 s apart: five on ten seconds, four on seven; two for each drift.
  EXPECT_EQ(k.size(), 3 * (5 + 2 + 4 + 2));
  EXPECT_EQ(k.times(0).size(), 5u);
  EXPECT_DOUBLE_EQ(k.times(1).back(), 207.0);
  int positions = 0;
  for (int i = 0; i < k.size(); ++i) positions += k.is_position(i);
  EXPECT_EQ(positions, 27);
}

TEST(CorrectionKnots, LinearBetweenKnotsAndHeldBeyond) {
  const CorrectionKnots k(two_lines, 0.5, form(CorrectionForm::spline, CorrectionForm::drift), test::tactical_errors);
  Eigen::VectorXd x(k.size());
  for (int i = 0; i < x.size(); ++i) x[i] = i;
  // The latency moves the knots: the first line's are at 100.5, 103, 105.5 ...
  EXPECT_NEAR(k.at(0, 100.5, x)[0], 0.0, 1e-12);
  EXPECT_NEAR(k.at(0, 101.75, x)[0], 1.5, 1e-12);
  EXPECT_NEAR(k.at(0, 110.5, x)[2], 14.0, 1e-12);
  EXPECT_NEAR(k.at(0, 120.0, x)[2], 14.0, 1e-12);
  EXPECT_NEAR(k.at(0, 105.5, x)[3], 16.5, 1e-12);  // the drift's knots begin at number 15
  std::vector<int> numbers;
  const Eigen::MatrixXd D = k.derivatives(1, 203.0, numbers);
  Eigen::VectorXd some(static_cast<Eigen::Index>(numbers.size()));
  for (size_t i = 0; i < numbers.size(); ++i) some[i] = x[numbers[i]];
  EXPECT_LT((D * some - k.at(1, 203.0, x)).norm(), 1e-12);
}

TEST(CorrectionKnots, PriorOfASplineIsTheTrajectorys) {
  const CorrectionKnots k(two_lines, 0.0, form(CorrectionForm::spline, CorrectionForm::spline), test::tactical_errors);
  const Eigen::MatrixXd C = test::tactical_errors({100.0, 200.0});
  const int second = 3 * 5 * 2;  // unknowns of the first line
  EXPECT_NEAR(k.covariance()(0, 0), C(0, 0), 1e-10);
  EXPECT_NEAR(k.covariance()(0, second), C(0, 6), 1e-10);  // between the lines
  EXPECT_NEAR(k.covariance()(15 + 2, 15 + 2), C(5, 5), 1e-15);
  // Scaled: variances by the squares of the factors.
  const Eigen::MatrixXd I = k.information({2.0, 2.0, 2.0}, {3.0, 3.0, 3.0}) * k.information().inverse();
  EXPECT_NEAR(I(0, 0), 0.25, 1e-3);
  EXPECT_NEAR(I(15, 15), 1.0 / 9.0, 1e-3);
  const Eigen::MatrixXd one = k.information() * k.covariance();
  EXPECT_LT((one - Eigen::MatrixXd::Identity(k.size(), k.size())).diagonal().cwiseAbs().maxCoeff(), 1e-3);
}

TEST(CorrectionKnots, PriorOfAShiftIsThatOfTheMean) {
  const CorrectionKnots k(two_lines, 0.0, form(CorrectionForm::shift, CorrectionForm::none), test::tactical_errors);
  ASSERT_EQ(k.size(), 6);
  const Eigen::MatrixXd C = test::tactical_errors({100.0, 102.5, 105.0, 107.5, 110.0});
  double mean = 0.0;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) mean += C(6 * i, 6 * j) / 25.0;
  EXPECT_NEAR(k.covariance()(0, 0), mean, 1e-9);
  EXPECT_EQ(k.common_shift().col(1).sum(), 2.0);
}

TEST(CorrectionKnots, ADriftKeepsLinesAndItsPriorIsThatOfTheFit) {
  // Errors that are a line in time: slope of sigma 1 mm/s through zero at 100 s, nothing else.
  const ErrorCovariance slope = [](const std::vector<double>& t) {
    const auto n = static_cast<Eigen::Index>(t.size());
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) C(6 * i, 6 * j) = 1e-6 * (t[i] - 100.0) * (t[j] - 100.0);
    return C;
  };
  const CorrectionKnots k({{1, 100.0, 110.0}}, 0.0, form(CorrectionForm::drift, CorrectionForm::none), slope);
  ASSERT_EQ(k.size(), 6);
  EXPECT_NEAR(k.covariance()(0, 0), 0.0, 2e-12);
  EXPECT_NEAR(k.covariance()(3, 3), 1e-4, 1e-9);
}

TEST(CorrectionKnots, ExactAndFullyCorrelatedTrajectoriesCanBeInverted) {
  const ErrorCovariance zero = [](const std::vector<double>& t) { return Eigen::MatrixXd::Zero(6 * t.size(), 6 * t.size()).eval(); };
  const ErrorCovariance one = [](const std::vector<double>& t) {
    return Eigen::MatrixXd(Eigen::VectorXd::Ones(6 * t.size()) * Eigen::RowVectorXd::Ones(6 * t.size()));
  };
  for (const ErrorCovariance& c : {zero, one}) {
    const CorrectionKnots k(two_lines, 0.0, form(CorrectionForm::spline, CorrectionForm::spline), c);
    EXPECT_TRUE(k.information().allFinite());
    EXPECT_GT(k.information().diagonal().minCoeff(), 0.0);
  }
}

TEST(CorrectionKnots, EachScaleHasItsOwnFactor) {
  const CorrectionKnots k(two_lines, 0.0, form(CorrectionForm::spline, CorrectionForm::drift), test::tactical_errors, true);
  const ScaleFactors p{2.0, 3.0, 0.5}, a{4.0, 5.0, 1.0};
  const Eigen::MatrixXd C = k.covariance(p, a);
  for (const bool position : {true, false})
    for (const CorrectionScale scale : {line_mean, line_drift}) {
      const Eigen::MatrixXd& m = k.modes(position, scale);
      ASSERT_EQ(m.cols(), 6);  // two lines, three components
      EXPECT_LT((m.transpose() * m - Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-12);
      const double factor = (position ? p : a)[scale];
      const Eigen::MatrixXd bare = m.transpose() * k.covariance() * m;
      EXPECT_LT((m.transpose() * C * m - factor * factor * bare).norm(), 1e-9 * bare.norm());
    }
  // A correction of the position within the first line alone: north, up and down about its mean and drift.
  Eigen::VectorXd wave = Eigen::VectorXd::Zero(k.size());
  const double values[] = {1.0, -2.0, 2.0, -2.0, 1.0};
  for (int i = 0; i < 5; ++i) wave[3 * i] = values[i];
  for (const CorrectionScale scale : {line_mean, line_drift}) wave -= k.modes(true, scale) * (k.modes(true, scale).transpose() * wave);
  EXPECT_GT(wave.norm(), 1.0);
  EXPECT_NEAR(wave.dot(C * wave), 0.25 * wave.dot(k.covariance() * wave), 1e-9 * wave.dot(C * wave));
  // The information is the inverse of the covariance, as far as the unscaled one is.
  const Eigen::MatrixXd one = k.information(p, a) * C, bare = k.information() * k.covariance();
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(k.size(), k.size());
  EXPECT_LT((one - I).diagonal().cwiseAbs().maxCoeff(), 20.0 * std::max(1e-6, (bare - I).cwiseAbs().maxCoeff()));
}

// Twelve lines of 100 s with knots every second: 7272 corrections, where 1500 may all be correlated with all.
struct ManyLines {
  explicit ManyLines(CorrectionForm position = CorrectionForm::spline, CorrectionForm attitude = CorrectionForm::spline,
                     int most = 100000) {
    for (int l = 0; l < 12; ++l) lines.push_back({l + 1, 200.0 * l, 200.0 * l + 100.0});
    CorrectionOptions o;
    o.position = position;
    o.attitude = attitude;
    o.most = most;
    o.spacing = core::Seconds(1.0);
    knots = std::make_unique<CorrectionKnots>(lines, 0.0, o, test::tactical_errors, true);
  }
  std::vector<TieLine> lines;
  std::unique_ptr<CorrectionKnots> knots;
};

TEST(CorrectionKnots, ManyAreChained) {
  const ManyLines m;
  const CorrectionKnots& k = *m.knots;
  EXPECT_TRUE(k.is_chained());
  EXPECT_EQ(k.spacing(), 1.0);
  EXPECT_EQ(k.size(), 12 * (101 * 6 + 12));
  // All six of a knot are one node, a line's trend is one, and so are the values that are common to all.
  const std::vector<int> nodes = k.nodes(2);
  EXPECT_EQ(nodes[0], 0);
  EXPECT_EQ(nodes[1], 0);
  std::vector<int> numbers;
  const Eigen::MatrixXd D = k.derivatives(3, 640.0, numbers);
  EXPECT_EQ(D.rows(), 6);
  std::set<int> here;
  for (const int n : numbers) here.insert(nodes[static_cast<size_t>(2 + n)]);
  EXPECT_EQ(here.size(), 2u);
  std::map<int, int> sizes;
  for (const int n : nodes) ++sizes[n];
  EXPECT_EQ(sizes.size(), 1u + 12u * 101u + 12u);
  EXPECT_EQ(sizes[1], 6);
  EXPECT_EQ(sizes.rbegin()->second, 12);
}

TEST(CorrectionKnots, ChainedPriorIsAsGiven) {
  const ManyLines m;
  const ScaleFactors one{1, 1, 1}, half{0.5, 0.5, 0.5};
  const auto prior = m.knots->prior(one, half);
  std::vector<int> numbers;
  const Eigen::MatrixXd D = m.knots->derivatives(3, 640.0, numbers);
  const Eigen::MatrixXd C = D * prior(numbers) * D.transpose(), given = test::tactical_errors({640.0});
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(std::sqrt(C(i, i)), (i < 3 ? 1.0 : 0.5) * std::sqrt(given(i, i)), 0.15 * std::sqrt(given(i, i))) << i;
  EXPECT_NEAR(std::sqrt(m.knots->mean_square(true, {})), std::sqrt((2 * 0.02 * 0.02 + 0.03 * 0.03) / 3), 0.001);
  EXPECT_GT(m.knots->mean_square(false, line_mean), m.knots->mean_square(false, line_drift));
}

TEST(CorrectionKnots, ACommonShiftIsOneOfTheTrends) {
  const ManyLines m;
  const Eigen::MatrixXd B = m.knots->common_shift();
  TieMatrix N(std::make_shared<UnknownNodes>(m.knots->nodes(0)));
  m.knots->add_information({1, 1, 1}, {1, 1, 1}, 0, N);
  // Of all lines alike, the trends' information alone holds it: twelve means with correlations of 1/e and less in 60 s.
  for (Eigen::Index c = 0; c < 3; ++c) {
    const double sigma = 1.0 / std::sqrt(B.col(c).dot(N.times(B.col(c))));
    const double one_line = c < 2 ? 0.02 : 0.03;
    EXPECT_GT(sigma, one_line / std::sqrt(12.0) / 1.5);
    EXPECT_LT(sigma, one_line);
  }
}

TEST(CorrectionKnots, FewOrOfAnotherFormAreNotChained) {
  EXPECT_FALSE(ManyLines(CorrectionForm::spline, CorrectionForm::drift).knots->is_chained());
  EXPECT_TRUE(ManyLines(CorrectionForm::none, CorrectionForm::spline).knots->is_chained());
  EXPECT_EQ(ManyLines(CorrectionForm::none, CorrectionForm::spline).knots->size(), 12 * (101 * 3 + 6));
  const ManyLines few(CorrectionForm::spline, CorrectionForm::spline, 1000);
  EXPECT_FALSE(few.knots->is_chained());
  EXPECT_LE(few.knots->size(), 1000);
  // A bound that leaves knots nearly as wide is not worth it.
  EXPECT_FALSE(ManyLines(CorrectionForm::spline, CorrectionForm::spline, 1600).knots->is_chained());
  CorrectionOptions o;
  o.spacing = core::Seconds(1.0);
  EXPECT_FALSE(CorrectionKnots({{1, 0.0, 100.0}, {2, 200.0, 300.0}}, 0.0, o, test::tactical_errors).is_chained());
  o.spacing = core::Seconds(0.5);
  EXPECT_TRUE(CorrectionKnots({{1, 0.0, 100.0}, {2, 200.0, 300.0}}, 0.0, o, test::tactical_errors).is_chained());
}

TEST(CorrectionKnots, StatedSigmas) {
  CorrectionOptions o;
  o.stated_correlation = core::Seconds(10.0);
  const Eigen::MatrixXd C = stated_covariance(o)({0.0, 10.0});
  EXPECT_NEAR(C(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(C(0, 6), 0.01 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(std::sqrt(C(5, 5)), o.stated_heading.value, 1e-12);
  EXPECT_EQ(C(0, 1), 0.0);
}

TEST(CorrectionKnots, ALineOfAnInstantHasOneConstant) {
  const CorrectionKnots k({{1, 100.0, 100.01}}, 0.0, form(CorrectionForm::spline, CorrectionForm::drift), test::tactical_errors);
  EXPECT_EQ(k.size(), 6);
}

}  // namespace
}  // namespace swath::calib
