// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/event_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

/// Two techniques with the same names; the second's positions are off by 1, -2 and 3 cm, and their recorder's places scatter by 2 cm.
struct Placed {
  core::EventData events;
  std::vector<EventPosition> solved;
  Eigen::Vector3d centre = core::ecef_of({0.8, 0.2, 500.0});
  LocalFrame frame = local_frame(centre);

  void add(const std::string& technique, const std::string& id, const Eigen::Vector3d& enu, const Eigen::Vector3d& recorded) {
    events.time.push_back(static_cast<double>(events.time.size()));
    events.sigma.push_back(0.0);
    events.id.push_back(id);
    events.strip.push_back(0);
    events.technique.push_back(technique);
    events.doubtful.push_back(0);
    events.place.push_back(recorded.allFinite() ? frame.to_ecef(recorded) : recorded);
    events.place_sigma.push_back({0.02, 0.02, 0.02});
    EventPosition p;
    p.reach = Reach::full;
    p.position = frame.to_ecef(enu);
    p.sigma.setConstant(0.02);
    p.velocity.setZero(), p.velocity_sigma.setZero(), p.covariance.setZero();
    solved.push_back(p);
  }
};

const Eigen::Vector3d none = Eigen::Vector3d::Constant(std::nan(""));

TEST(EventComparison, TechniquesByName) {
  Placed p;
  const Eigen::Vector3d off(0.01, -0.02, 0.03);
  for (int k = 0; k < 5; ++k) p.add("marks", "P" + std::to_string(k), Eigen::Vector3d(10.0 * k, 0, 0), none);
  for (int k = 4; k >= 1; --k) p.add("pc", "P" + std::to_string(k), Eigen::Vector3d(10.0 * k, 0, 0) + off, none);
  p.add("pc", "X", {0, 0, 0}, none);
  const auto found = compare_event_places(p.events, p.solved);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].techniques, "pc - marks");
  EXPECT_EQ(found[0].pairs, 4u);
  EXPECT_EQ(found[0].only_first, 1u);
  EXPECT_EQ(found[0].only_second, 1u);
  EXPECT_LT((found[0].bias - off).norm(), 1e-6);
  EXPECT_LT((found[0].rms - off.cwiseAbs()).norm(), 1e-6);
  EXPECT_LT(found[0].standard.norm(), 1e-5);
  EXPECT_FALSE(found[0].ratio);
}

TEST(EventComparison, PlacesOfTheRecorderHaveARatio) {
  Placed p;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.02);
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d truth(5.0 * k, 3.0, 1.0);
    const Eigen::Vector3d ours(normal(random), normal(random), normal(random)), theirs(normal(random), normal(random), normal(random));
    p.add("photos", std::to_string(k), truth + ours, truth + theirs);
  }
  p.add("photos", "blind", {0, 0, 0}, none);
  const auto found = compare_event_places(p.events, p.solved);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pairs, 400u);
  EXPECT_EQ(found[0].only_first, 1u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(found[0].rms[axis], 0.02 * std::sqrt(2.0), 0.004) << axis;
    EXPECT_NEAR((*found[0].ratio)[axis], 1.0, 0.12) << axis;
  }
}

TEST(EventComparison, DoubtfulAndUnreachedEventsAreNotCompared) {
  Placed p;
  p.add("a", "1", {0, 0, 0}, none);
  p.add("a", "2", {0, 0, 0}, none);
  p.add("b", "1", {9, 9, 9}, none);
  p.add("b", "2", {9, 9, 9}, none);
  p.events.doubtful[2] = 1;
  p.solved[1].reach = Reach::gap;
  const auto found = compare_event_places(p.events, p.solved);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pairs, 0u);
  EXPECT_TRUE(compare_event_places({}, {}).empty());
}

}  // namespace
}  // namespace swath::trajectory
