// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/correction_chain.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numeric>

#include "tests/world/navigation.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index q = 2;  // a component of position and one of attitude

// Two components, correlated with one another, that fall to 1/e in 40 and 15 s.
MatrixXd errors_at(const std::vector<double>& times) {
  const auto n = static_cast<Index>(times.size());
  MatrixXd C(q * n, q * n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double dt = std::abs(times[static_cast<size_t>(i)] - times[static_cast<size_t>(j)]);
      const double slow = std::exp(-dt / 40.0), fast = std::exp(-dt / 15.0);
      C.block<q, q>(q * i, q * j) << 4.0 * slow, 0.5 * slow, 0.5 * slow, 0.0625 * slow + 0.25 * fast;
    }
  return C;
}
// Knots a second apart.
std::vector<double> seconds(Index knots) {
  std::vector<double> out(static_cast<size_t>(knots));
  std::iota(out.begin(), out.end(), 0.0);
  return out;
}
MatrixXd errors(Index knots) { return errors_at(seconds(knots)); }
LineChain chain(Index knots) { return chain_of(line_covariance(seconds(knots), q, errors_at)); }

// The covariance that a prior implies, trends left out.
struct Implied {
  Implied(std::vector<Index> knots, const MatrixXd& trends, const CorrectionChains::Factors& factors = {{{1, 1, 1}, {1, 1, 1}}}) {
    std::vector<LineChain> lines;
    std::vector<ChainPlaces> places;
    int next = 0;
    for (const Index n : knots) {
      lines.push_back(chain(n));
      ChainPlaces p;
      for (Index k = 0; k < n; ++k) {
        p.knot.push_back({next, next + 1});
        next += 2;
      }
      places.push_back(p);
    }
    corrections = next;
    for (size_t l = 0; l < lines.size(); ++l)
      for (size_t i = 0; !lines[l].place.empty() && i < 2 * q; ++i) places[l].trend.push_back(next++);
    size = next;
    chains = CorrectionChains(lines, places, trends, {true, false});
    TieMatrix N = TieMatrix::dense(size);
    chains.add_information(factors, 0, N);
    whole = N.whole().inverse();
  }
  MatrixXd of_corrections() const { return whole.topLeftCorner(corrections, corrections); }
  CorrectionChains chains;
  int corrections = 0, size = 0;
  MatrixXd whole;
};

// Mean, drift from the middle to the end, and what is left about them, mean square over the knots.
std::array<double, 3> variances(const MatrixXd& C, Index component, Index knots) {
  MatrixXd one(knots, knots), G(knots, 2);
  for (Index i = 0; i < knots; ++i) {
    G.row(i) << 1.0, 2.0 * static_cast<double>(i) / static_cast<double>(knots - 1) - 1.0;
    for (Index j = 0; j < knots; ++j) one(i, j) = C(q * i + component, q * j + component);
  }
  const MatrixXd fit = (G.transpose() * G).inverse() * G.transpose(), rest = MatrixXd::Identity(knots, knots) - G * fit;
  const MatrixXd trend = fit * one * fit.transpose();
  return {trend(0, 0), trend(1, 1), (rest * one * rest.transpose()).trace() / static_cast<double>(knots)};
}

TEST(CorrectionChain, CovarianceOfALineInParts) {
  constexpr Index knots = 300;  // three parts
  const MatrixXd C = errors(knots);
  const LineCovariance line = line_covariance(seconds(knots), q, errors_at);
  MatrixXd B = MatrixXd::Zero(q * knots, 2 * q);
  for (Index k = 0; k < knots; ++k)
    for (Index c = 0; c < q; ++c)
      B(q * k + c, c) = 1.0, B(q * k + c, q + c) = static_cast<double>(k) - 0.5 * static_cast<double>(knots - 1);
  for (Index c = 0; c < 2 * q; ++c) B.col(c).normalize();
  EXPECT_LT((line.by_trends - C * B).norm(), 1e-9 * (C * B).norm());
  for (const Index k : {0, 126, 127, 128, 255, 298}) {
    EXPECT_EQ(line.at[static_cast<size_t>(k)], (C.block<q, q>(q * k, q * k)));
    EXPECT_EQ(line.next[static_cast<size_t>(k)], (C.block<q, q>(q * (k + 1), q * k)));
  }
}

TEST(CorrectionChain, OneKnotHasNoTrend) {
  const Implied p({1}, MatrixXd(0, 0));
  EXPECT_EQ(p.size, 2);
  EXPECT_LT((p.of_corrections() - errors(1)).norm(), 1e-9 * errors(1).norm());
}

TEST(CorrectionChain, TwoKnotsKeepTheirCovariance) {
  const Implied p({2}, MatrixXd::Identity(2 * q, 2 * q));
  EXPECT_LT((p.of_corrections() - errors(2)).norm(), 0.05 * errors(2).norm());
}

TEST(CorrectionChain, MeanDriftAndTheRestHaveTheirVariances) {
  for (const Index knots : {3, 5, 30, 120}) {
    const Implied p({knots}, MatrixXd::Identity(2 * q, 2 * q));
    for (Index c = 0; c < q; ++c) {
      const auto is = variances(p.of_corrections(), c, knots), wanted = variances(errors(knots), c, knots);
      for (const size_t s : {size_t{0}, size_t{1}, size_t{2}})
        EXPECT_NEAR(is[s], wanted[s], 0.03 * wanted[s]) << knots << " " << c << " " << s;
    }
  }
}

// A little more: the chain has to make up for what it forgets.
TEST(CorrectionChain, NeighboursDifferAboutAsTheyDid) {
  const Index knots = 60;
  const MatrixXd is = Implied({knots}, MatrixXd::Identity(2 * q, 2 * q)).of_corrections(), wanted = errors(knots);
  for (const Index k : {Index{5}, Index{30}, Index{50}})
    for (Index c = 0; c < q; ++c) {
      const auto difference = [&](const MatrixXd& C) {
        const Index a = q * k + c, b = a + q;
        return C(a, a) + C(b, b) - 2.0 * C(a, b);
      };
      EXPECT_GT(difference(is), difference(wanted)) << k << " " << c;
      EXPECT_LT(difference(is), 1.7 * difference(wanted)) << k << " " << c;
    }
}

TEST(CorrectionChain, TrendsOfLinesAreCorrelated) {
  MatrixXd trends = MatrixXd::Identity(4 * q, 4 * q);
  trends.topRightCorner(2 * q, 2 * q).diagonal() << 0.8, 0.6, 0.0, 0.0;
  trends.bottomLeftCorner(2 * q, 2 * q) = trends.topRightCorner(2 * q, 2 * q).transpose();
  const Implied p({20, 20}, trends);
  const Index a = p.corrections, b = a + 2 * q;
  const auto correlation = [&](Index i, Index j) { return p.whole(i, j) / std::sqrt(p.whole(i, i) * p.whole(j, j)); };
  EXPECT_NEAR(correlation(a, b), 0.8, 0.02);
  EXPECT_NEAR(correlation(a + 2, b + 2), 0.0, 0.02);
  EXPECT_NEAR(correlation(a, b + 2), 0.0, 0.02);
}

TEST(CorrectionChain, FactorsOfEachPartAndScale) {
  const Index knots = 30;
  const Implied one({knots}, MatrixXd::Identity(2 * q, 2 * q)), more({knots}, MatrixXd::Identity(2 * q, 2 * q), {{{3, 1, 1}, {1, 1, 2}}});
  const auto a = variances(one.of_corrections(), 0, knots), b = variances(more.of_corrections(), 0, knots);
  EXPECT_GT(b[0], 4.0 * a[0]);  // the chain's own part of the mean stays
  EXPECT_LT(b[0], 9.0 * a[0]);
  EXPECT_NEAR(b[2], a[2], 0.01 * a[2]);
  const auto c = variances(one.of_corrections(), 1, knots), d = variances(more.of_corrections(), 1, knots);
  EXPECT_NEAR(d[2], 4.0 * c[2], 0.01 * d[2]);
  EXPECT_LT(d[0], 4.0 * c[0]);
}

TEST(CorrectionChain, CovarianceOfNeighbouringKnots) {
  const CorrectionChains::Factors factors = {{{3, 2, 1}, {1, 1.5, 2}}};
  const Implied p({30, 3}, MatrixXd::Identity(4 * q, 4 * q), factors);
  const double unit = p.whole.diagonal().head(60).maxCoeff();
  for (const size_t k : {size_t{0}, size_t{12}, size_t{28}})
    for (const size_t c : {size_t{0}, size_t{1}})
      for (const size_t d : {size_t{0}, size_t{1}}) {
        const auto a = static_cast<Index>(2 * k + c);
        EXPECT_NEAR(p.chains.covariance(factors, 0, {k, k}, {c, d}), p.whole(a, static_cast<Index>(2 * k + d)), 1e-3 * unit);
        EXPECT_NEAR(p.chains.covariance(factors, 0, {k, k + 1}, {c, d}), p.whole(a, static_cast<Index>(2 * k + 2 + d)), 1e-3 * unit);
        EXPECT_NEAR(p.chains.covariance(factors, 0, {k + 1, k}, {d, c}), p.whole(a, static_cast<Index>(2 * k + 2 + d)), 1e-3 * unit);
      }
  EXPECT_NEAR(p.chains.covariance(factors, 1, {0, 1}, {0, 0}), p.whole(60, 62), 1e-3 * unit);
}

// Drawn from the prior and known without error, each scale's squares are as many as its degrees of freedom, and a factor is its square.
TEST(CorrectionChain, SquaresOfEachScale) {
  constexpr int draws = 200;
  const CorrectionChains::Factors one = {{{1, 1, 1}, {1, 1, 1}}};
  const Implied p({30, 25, 1}, MatrixXd::Identity(4 * q, 4 * q));
  const MatrixXd root = p.whole.llt().matrixL();
  TieMatrix known = TieMatrix::dense(p.size);
  std::vector<int> all(static_cast<size_t>(p.size));
  std::iota(all.begin(), all.end(), 0);
  known.add(all, 1e12 * MatrixXd::Identity(p.size, p.size));
  TieInverse inverse(known);
  inverse.invert();
  swath::test::Dice dice(8);
  std::array<std::array<double, 3>, 2> squares{};
  std::array<std::array<ScaleSums, 3>, 2> sums;
  for (int i = 0; i < draws; ++i) {
    VectorXd z(p.size);
    for (double& v : z) v = dice.normal();
    sums = p.chains.sums(one, root * z, inverse, 0);
    for (const size_t part : {0, 1})
      for (const size_t s : {0, 1, 2}) squares[part][s] += sums[part][s].squares / draws;
    if (i > 0) continue;
    const auto twice = p.chains.sums({{{2, 2, 2}, {2, 2, 2}}}, root * z, inverse, 0);
    for (const size_t part : {0, 1})
      for (const size_t s : {0, 1, 2}) EXPECT_NEAR(twice[part][s].squares, 0.25 * sums[part][s].squares, 1e-6 * sums[part][s].squares);
  }
  for (const size_t part : {0, 1})
    for (const size_t s : {0, 1, 2}) {
      const double n = s == within_line ? 56.0 : 2.0;
      EXPECT_NEAR(sums[part][s].freedom, n, 0.02) << part << s;
      // Mean of `draws` sums of n squares.
      EXPECT_NEAR(squares[part][s], n, 4.0 * std::sqrt(2.0 * n / draws)) << part << s;
    }
}

// A priori, nothing is known of it but the prior: no degrees of freedom.
TEST(CorrectionChain, FreedomIsWhatTheDataLeave) {
  const CorrectionChains::Factors one = {{{1, 1, 1}, {1, 1, 1}}};
  const Implied p({30}, MatrixXd::Identity(2 * q, 2 * q));
  TieMatrix N = TieMatrix::dense(p.size);
  p.chains.add_information(one, 0, N);
  TieInverse inverse(N);
  inverse.invert();
  const auto sums = p.chains.sums(one, VectorXd::Ones(p.size), inverse, 0);
  for (const auto& part : sums)
    for (const ScaleSums& s : part) EXPECT_NEAR(s.freedom, 0.0, 1e-3);
}

TEST(CorrectionChain, StatedSquares) {
  const Implied p({30}, MatrixXd::Identity(2 * q, 2 * q));
  const auto wanted = variances(errors(30), 0, 30);
  EXPECT_NEAR(p.chains.squares(true, line_mean), 30 * wanted[0], 0.03 * 30 * wanted[0]);
  EXPECT_NEAR(p.chains.squares(true, within_line), 30 * wanted[2], 0.03 * 30 * wanted[2]);
  const double all = p.chains.squares(true, line_mean) + p.chains.squares(true, line_drift) + p.chains.squares(true, within_line);
  double expected = 0.0;
  for (Index k = 0; k < 30; ++k) expected += p.whole(2 * k, 2 * k);
  EXPECT_NEAR(all, expected, 1e-3 * expected);
}

}  // namespace
}  // namespace swath::calib
