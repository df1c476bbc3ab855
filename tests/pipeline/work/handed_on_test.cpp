// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/handed_on.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

std::shared_ptr<const trajectory::Trajectory> flight() {
  core::TrajectoryData d;
  for (int i = 0; i < 400; ++i) {
    d.time.push_back(100.0 + 0.005 * i + (i >= 200 ? 3.0 : 0.0));  // two spans
    d.latitude.push_back(0.8 + 1e-7 * i), d.longitude.push_back(0.1), d.height.push_back(500.0 + 0.1 * i);
    d.roll.push_back(0.01), d.pitch.push_back(0.02), d.heading.push_back(3.0);
    for (auto* column : {&d.sigma_north, &d.sigma_east, &d.sigma_down, &d.sigma_roll, &d.sigma_pitch, &d.sigma_heading})
      column->push_back(0.01f);
  }
  d.covariance.time = {100.0, 101.0};
  d.covariance.upper.assign(2, {});
  d.covariance.upper[1][44] = 7.0;
  d.errors.resize(2, 3);
  d.errors.time = {100.0, 101.0};
  d.errors.links[17] = 0.5;
  d.response.time = {100.0};
  d.response.per_unit.assign(1, core::CalibrationResponse::Matrix::Constant(0.25));
  return std::make_shared<const trajectory::Trajectory>(std::move(d));
}

HandedOn everything() {
  HandedOn h;
  auto gnss = std::make_shared<core::GnssData>();
  gnss->time = {1.0, 2.0};
  gnss->position = {{1, 2, 3}, {4, 5, 6}};
  gnss->covariance.assign(2, Eigen::Matrix3d::Identity() * 0.5);
  gnss->quality = {core::FixQuality::fixed, core::FixQuality::single};
  gnss->satellites = {9, 10};
  auto events = std::make_shared<core::EventData>();
  events->time = {1.5};
  events->sigma = {0.0};
  events->id = {"photo 7"};
  events->strip = {0};
  events->technique = {""};
  events->doubtful = {1};
  h.gnss = std::move(gnss);
  h.events = std::move(events);
  h.trajectory = flight();
  h.origin = {652000, 5310000, 0};
  h.area.box = {612000, 5270000, 692000, 5350000};
  h.area.highest = 900;
  return h;
}

TEST(HandedOn, ComesBackAsItWas) {
  const test::TemporaryFolder folder;
  const HandedOn given = everything();
  ASSERT_TRUE(write_handed_on(folder / "a", {}, given));
  const HandedOn back = read_handed_on(folder / "a", {});
  EXPECT_EQ(back.gnss->position[1], given.gnss->position[1]);
  EXPECT_EQ(back.gnss->covariance[1], given.gnss->covariance[1]);
  EXPECT_EQ(back.gnss->quality, given.gnss->quality);
  EXPECT_TRUE(back.gnss->velocity.empty());
  EXPECT_EQ(back.events->id, given.events->id);
  EXPECT_EQ(back.events->doubtful, given.events->doubtful);
  EXPECT_EQ(back.origin, given.origin);
  EXPECT_EQ(back.area.box.x0, given.area.box.x0);
  EXPECT_EQ(back.area.box.y1, given.area.box.y1);
  EXPECT_EQ(back.area.lowest, given.area.lowest);
  EXPECT_EQ(back.area.highest, given.area.highest);
  const core::TrajectoryData &a = given.trajectory->data(), &b = back.trajectory->data();
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.latitude, b.latitude);
  EXPECT_EQ(a.sigma_heading, b.sigma_heading);
  EXPECT_EQ(a.covariance.upper, b.covariance.upper);
  EXPECT_EQ(a.errors.states, b.errors.states);
  EXPECT_EQ(a.errors.links, b.errors.links);
  EXPECT_EQ(a.response.per_unit[0], b.response.per_unit[0]);
  ASSERT_EQ(back.trajectory->spans().size(), 2u);
  EXPECT_EQ(back.trajectory->spans(), given.trajectory->spans());
  EXPECT_EQ(back.trajectory->pose_at(100.5123)->position, given.trajectory->pose_at(100.5123)->position);
}

TEST(HandedOn, WhatTheStageDidNotChangeComesFromBefore) {
  const test::TemporaryFolder folder;
  const HandedOn before = everything();
  HandedOn after = before;
  after.trajectory = flight();
  ASSERT_TRUE(write_handed_on(folder / "a", before, after));
  const HandedOn back = read_handed_on(folder / "a", before);
  EXPECT_EQ(back.gnss, before.gnss);
  EXPECT_NE(back.trajectory, before.trajectory);
  EXPECT_FALSE(write_handed_on(folder / "b", before, {})) << "a stage that takes something away is done again";
}

TEST(HandedOn, AFileThatIsNotWholeIsAnError) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_handed_on(folder / "a", {}, everything()));
  const std::string bytes = test::read_bytes(folder / "a");
  for (size_t n = 0; n < bytes.size(); n += 97) {
    test::write_bytes(folder / "a", bytes.substr(0, n));
    EXPECT_THROW(read_handed_on(folder / "a", {}), core::Error) << n;
  }
  test::write_bytes(folder / "a", bytes + "x");
  EXPECT_THROW(read_handed_on(folder / "a", {}), core::SystemError);
}

}  // namespace
}  // namespace swath::pipeline
