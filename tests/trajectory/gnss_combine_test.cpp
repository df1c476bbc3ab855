// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/gnss_combine.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace swath::trajectory {
namespace {

using core::FixQuality;

constexpr double rounding = 1e-8;  // m, of ECEF coordinates in doubles

struct Row {
  double time;
  Eigen::Vector3d offset;
  double sigma;
  FixQuality quality = FixQuality::fixed;
};

const Eigen::Vector3d place(-3976219.0, 3382371.0, 3652511.0);

core::GnssData solution(const std::vector<Row>& rows) {
  core::GnssData g;
  for (const Row& r : rows) {
    g.time.push_back(1e9 + r.time);
    g.position.push_back(place + r.offset);
    g.covariance.push_back(Eigen::Matrix3d::Identity() * r.sigma * r.sigma);
    g.quality.push_back(r.quality);
    g.satellites.push_back(8);
  }
  return g;
}

Eigen::Vector3d east(double metres) { return {metres, 0, 0}; }

TEST(GnssCombine, BestQualityFirstAndEveryEpochOfAny) {
  const auto near = solution({{0, east(0), 0.01}, {1, east(0.1), 0.3, FixQuality::float_ambiguity}, {3, east(0), 1, FixQuality::single}});
  const auto far = solution({{1, east(0.5), 0.02}, {2, east(0.6), 0.2, FixQuality::float_ambiguity}, {3, east(5), 1, FixQuality::single}});
  const CombinedGnss c = combine_gnss({near, far}, 5.0);
  ASSERT_EQ(c.data.size(), 4u);
  EXPECT_EQ(c.data.position[0], place + east(0));
  EXPECT_EQ(c.data.position[1], place + east(0.5)) << "a fixed solution of the far base before a float one of the near base";
  EXPECT_EQ(c.data.position[2], place + east(0.6));
  EXPECT_EQ(c.data.position[3], place + east(0)) << "of equals the nearest base's";
  EXPECT_EQ(c.data.quality[1], FixQuality::fixed);
  EXPECT_EQ(c.taken, (std::vector<std::uint64_t>{2, 2}));
  EXPECT_EQ(c.averaged, 0u);
  EXPECT_EQ(c.disagreeing, 0u);
}

TEST(GnssCombine, FixedSolutionsThatAgreeAreAveragedByCovariance) {
  const CombinedGnss c = combine_gnss({solution({{0, east(0), 0.01}}), solution({{0, east(0.03), 0.02}})}, 5.0);
  ASSERT_EQ(c.data.size(), 1u);
  EXPECT_EQ(c.averaged, 1u);
  EXPECT_NEAR(c.data.position[0].x() - place.x(), 0.03 * 0.2, rounding) << "weights 4 to 1";
  // Covariance intersection: two together are never better than the better one alone.
  EXPECT_NEAR(c.data.covariance[0](0, 0), 2.0 / (1e4 + 2500.0), 1e-12);
  EXPECT_GE(c.data.covariance[0](0, 0), 1e-4);
}

TEST(GnssCombine, FullCovariancesWeightByDirection) {
  auto a = solution({{0, Eigen::Vector3d(0, 0, 0), 0.01}}), b = solution({{0, Eigen::Vector3d(0.02, 0.02, 0), 0.01}});
  a.covariance[0] << 4e-4, 1e-4, 0, 1e-4, 1e-4, 0, 0, 0, 1e-4;
  b.covariance[0] << 1e-4, 0, 0, 0, 9e-4, -1e-4, 0, -1e-4, 4e-4;
  const CombinedGnss c = combine_gnss({a, b}, 5.0);
  const Eigen::Matrix3d wa = a.covariance[0].inverse(), wb = b.covariance[0].inverse();
  const Eigen::Vector3d mean = (wa + wb).inverse() * (wb * Eigen::Vector3d(0.02, 0.02, 0));
  EXPECT_LT((c.data.position[0] - place - mean).norm(), rounding);
  EXPECT_LT((c.data.covariance[0] - 2 * (wa + wb).inverse()).norm(), 1e-15);
}

TEST(GnssCombine, DisagreementIsCountedAndTheNearestTaken) {
  const CombinedGnss c = combine_gnss({solution({{0, east(0), 0.01}, {1, east(0), 0.01}}), solution({{0, east(0.2), 0.01}})}, 5.0);
  EXPECT_EQ(c.disagreeing, 1u);
  EXPECT_EQ(c.averaged, 0u);
  EXPECT_NEAR(c.worst_disagreement, 0.2, rounding);
  EXPECT_EQ(c.worst_at, 1e9);
  EXPECT_EQ(c.data.position[0], place);
  // Either may be wrong: its variance holds half of the squared difference.
  EXPECT_NEAR(c.data.covariance[0](0, 0), 1e-4 + 0.5 * 0.04, 1e-9);
  EXPECT_NEAR(c.data.covariance[0](1, 1), 1e-4, 1e-12);
  EXPECT_NEAR(c.data.covariance[1](0, 0), 1e-4, 1e-12);
}

TEST(GnssCombine, TheMajorityOutvotesTheNearest) {
  const CombinedGnss c =
      combine_gnss({solution({{0, east(0.2), 0.01}}), solution({{0, east(0), 0.01}}), solution({{0, east(0.01), 0.01}})}, 5.0);
  EXPECT_EQ(c.disagreeing, 1u);
  EXPECT_EQ(c.averaged, 1u);
  EXPECT_NEAR(c.data.position[0].x() - place.x(), 0.005, rounding);
  EXPECT_NEAR(c.data.covariance[0](0, 0), 1e-4, 1e-12) << "no rival: nothing is added";
  EXPECT_EQ(c.taken, (std::vector<std::uint64_t>{0, 1, 0}));
}

TEST(GnssCombine, EpochsOfSetClocksAreOneButNotAveraged) {
  // The second lies 0.4 ms later: at 100 m/s 4 cm further.
  const CombinedGnss c = combine_gnss({solution({{0, east(0), 0.01}}), solution({{0.0004, east(0.01), 0.01}})}, 5.0);
  ASSERT_EQ(c.data.size(), 1u);
  EXPECT_EQ(c.averaged, 0u);
  EXPECT_EQ(c.data.position[0], place);
}

TEST(GnssCombine, AccountOfFixes) {
  const auto g = solution({{0, east(0), 0.01},
                           {1, east(0), 0.01},
                           {2, east(0), 0.1, FixQuality::float_ambiguity},
                           {7, east(0), 1.0, FixQuality::single},
                           {8, east(0), 0.01},
                           {10, east(0), 0.01}});
  const GnssAccount a = account_of(g, 1.0);
  EXPECT_EQ(a.fixes, 6u);
  EXPECT_EQ(a.by_quality[static_cast<size_t>(FixQuality::fixed)], 4u);
  EXPECT_NEAR(a.share(FixQuality::float_ambiguity), 1.0 / 6, 1e-12);
  EXPECT_EQ(a.gaps, 2u);
  EXPECT_EQ(a.longest_gap, 5.0);
  EXPECT_EQ(a.longest_gap_at, 1e9 + 2);
  EXPECT_EQ(a.last, 1e9 + 10);
  EXPECT_EQ(account_of({}, 1.0).fixes, 0u);
  EXPECT_EQ(account_of({}, 1.0).share(FixQuality::fixed), 0.0);
}

}  // namespace
}  // namespace swath::trajectory
