// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/handed_on.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

trajectory::Trajectory flight() {
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
  return trajectory::Trajectory(std::move(d));
}

const io::Survey survey;

stages::Context everything() {
  stages::Context c{survey};
  core::GnssData gnss;
  gnss.time = {1.0, 2.0};
  gnss.position = {{1, 2, 3}, {4, 5, 6}};
  gnss.covariance.assign(2, Eigen::Matrix3d::Identity() * 0.5);
  gnss.quality = {core::FixQuality::fixed, core::FixQuality::single};
  gnss.satellites = {9, 10};
  core::EventData events;
  events.time = {1.5};
  events.sigma = {0.0};
  events.id = {"photo 7"};
  events.strip = {0};
  events.technique = {""};
  events.doubtful = {1};
  c.records.put(std::move(gnss));
  c.records.put(std::move(events));
  c.records.put(flight());
  c.origin = {652000, 5310000, 0};
  c.area.box = {612000, 5270000, 692000, 5350000};
  c.area.highest = 900;
  return c;
}

TEST(HandedOn, ComesBackAsItWas) {
  const test::TemporaryFolder folder;
  const stages::Context given = everything();
  ASSERT_TRUE(write_handed_on(folder / "a", {}, given));
  stages::Context back{survey};
  read_handed_on(folder / "a", back);
  const auto &gnss = back.records.get<core::GnssData>(), &of_gnss = given.records.get<core::GnssData>();
  const auto &events = back.records.get<core::EventData>(), &of_events = given.records.get<core::EventData>();
  const auto &flown = back.records.get<trajectory::Trajectory>(), &of_flown = given.records.get<trajectory::Trajectory>();
  EXPECT_EQ(gnss.position[1], of_gnss.position[1]);
  EXPECT_EQ(gnss.covariance[1], of_gnss.covariance[1]);
  EXPECT_EQ(gnss.quality, of_gnss.quality);
  EXPECT_TRUE(gnss.velocity.empty());
  EXPECT_EQ(events.id, of_events.id);
  EXPECT_EQ(events.doubtful, of_events.doubtful);
  EXPECT_EQ(back.origin, given.origin);
  EXPECT_EQ(back.area.box.x0, given.area.box.x0);
  EXPECT_EQ(back.area.box.y1, given.area.box.y1);
  EXPECT_EQ(back.area.lowest, given.area.lowest);
  EXPECT_EQ(back.area.highest, given.area.highest);
  const core::TrajectoryData &a = of_flown.data(), &b = flown.data();
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.latitude, b.latitude);
  EXPECT_EQ(a.sigma_heading, b.sigma_heading);
  EXPECT_EQ(a.covariance.upper, b.covariance.upper);
  EXPECT_EQ(a.errors.states, b.errors.states);
  EXPECT_EQ(a.errors.links, b.errors.links);
  EXPECT_EQ(a.response.per_unit[0], b.response.per_unit[0]);
  ASSERT_EQ(flown.spans().size(), 2u);
  EXPECT_EQ(flown.spans(), of_flown.spans());
  EXPECT_EQ(flown.pose_at(100.5123)->position, of_flown.pose_at(100.5123)->position);
}

TEST(HandedOn, WhatTheStageDidNotChangeIsLeftAndWhatItTookIsGone) {
  const test::TemporaryFolder folder;
  stages::Context context = everything();
  const stages::Records::Marks before = context.records.marks();
  context.records.put(flight());
  context.records.drop<core::EventData>();
  ASSERT_TRUE(write_handed_on(folder / "a", before, context));
  stages::Context back = everything();
  const core::GnssData* gnss = back.records.find<core::GnssData>();
  const trajectory::Trajectory* flown = back.records.find<trajectory::Trajectory>();
  const stages::Records::Marks were = back.records.marks();
  read_handed_on(folder / "a", back);
  EXPECT_EQ(back.records.find<core::GnssData>(), gnss);
  EXPECT_FALSE(back.records.has<core::EventData>());
  EXPECT_NE(back.records.find<trajectory::Trajectory>(), flown);
  EXPECT_NE(back.records.mark_of<trajectory::Trajectory>(back.records.marks()), back.records.mark_of<trajectory::Trajectory>(were));
}

TEST(HandedOn, AFileThatIsNotWholeIsAnError) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_handed_on(folder / "a", {}, everything()));
  const std::string bytes = test::read_bytes(folder / "a");
  for (size_t n = 0; n < bytes.size(); n += 97) {
    test::write_bytes(folder / "a", bytes.substr(0, n));
    stages::Context back{survey};
    EXPECT_THROW(read_handed_on(folder / "a", back), core::Error) << n;
  }
  test::write_bytes(folder / "a", bytes + "x");
  stages::Context back{survey};
  EXPECT_THROW(read_handed_on(folder / "a", back), core::SystemError);
}

}  // namespace
}  // namespace swath::pipeline
