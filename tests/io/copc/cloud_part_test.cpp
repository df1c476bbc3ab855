// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/cloud_part.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "core/error.h"
#include "io/copc/ept.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr std::size_t points = 250000;

struct OneCloud {
  test::TemporaryFolder folder;
  LasHeader header = test::sample_header(6, 4, true);
  LasPoints all;
  Survey survey;
  core::Crs crs{"EPSG:25832"};
  core::Area area{};
  CloudMap map{crs, 1.0, 1.0, {0, 0, 0}, area};

  OneCloud() {
    header.offset = {500000.0, 5400000.0, 300.0};
    all = test::copc_points(header, points);
    test::write_copc_sample(folder / "a.copc.laz", header, all);
    survey.folder = folder.path();
    survey.points.resize(1);
    survey.points[0].file = "a.copc.laz";
    survey.points[0].crs = "EPSG:25832";
  }
  CloudPart part(std::optional<double> resolution = {}) const { return part_of_cloud(survey, survey.points[0], map, resolution); }
};

TEST(CloudPart, NodesWithinTheAreaHoldAllOfItsPoints) {
  OneCloud c;
  EXPECT_FALSE(c.part().chunks) << "all points: as any file";
  EXPECT_EQ(c.part().points, points);
  c.area.box = {500300.0, 5400300.0, 500350.0, 5400350.0};
  const CloudPart part = c.part();
  ASSERT_TRUE(part.chunks);
  EXPECT_LT(part.points, points / 2);
  EXPECT_EQ(part.points + part.unread, points);
  LasReader reader(c.folder / "a.copc.laz", 1, {part.chunks});
  EXPECT_EQ(reader.count(), part.points);
  std::set<double> times;
  LasPoints p;
  while (reader.read(p, 10000) > 0) times.insert(p.gps_time.begin(), p.gps_time.end());
  EXPECT_EQ(reader.position(), part.points);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points; ++i) {
    if (!c.area.box.holds(c.all.x[i], c.all.y[i])) continue;
    ++inside;
    EXPECT_TRUE(times.contains(c.all.gps_time[i]));
  }
  EXPECT_GT(inside, 20u);
  c.area.box = {0.0, 0.0, 1.0, 1.0};
  EXPECT_EQ(c.part().points, 0u);
  EXPECT_EQ(c.part().unread, points);
}

TEST(CloudPart, AnAreaInAnotherProjectionFindsTheSameNodes) {
  OneCloud c;
  c.area.box = {500300.0, 5400300.0, 500350.0, 5400350.0};
  const CloudPart same = c.part();
  const core::Crs other("EPSG:3857");
  const core::Transform to(c.crs, other);
  const Eigen::Vector3d low = to({500300.0, 5400300.0, 300.0}), high = to({500350.0, 5400350.0, 300.0});
  const core::Area area{{low.x(), low.y(), high.x(), high.y()}};
  const CloudPart there = part_of_cloud(c.survey, c.survey.points[0], {other, 1.0, 1.0, {0, 0, 0}, area}, {});
  EXPECT_GE(there.points, same.points);
  EXPECT_LT(there.points, points);
}

TEST(CloudPart, AResolutionTakesTheLevelsThatItNeeds) {
  OneCloud c;
  LasReader reader(c.folder / "a.copc.laz");
  const double spacing = copc_info(reader.header(), "a")->spacing;
  const CloudPart coarse = c.part(spacing);
  ASSERT_TRUE(coarse.chunks);
  EXPECT_EQ(coarse.chunks->size(), 1u) << "the root";
  EXPECT_FALSE(c.part(0.001).chunks) << "all levels";
  const LasHeader plain = test::sample_header(6);
  test::write_sample(c.folder / "plain.laz", plain, test::sample_points(plain, 10));
  c.survey.points[0].file = "plain.laz";
  EXPECT_EQ(c.part().points, 10u);
  EXPECT_THROW(c.part(1.0), core::Error) << "a file without levels";
}

TEST(CloudPart, ABrokenHierarchyIsRefused) {
  OneCloud c;
  LasReader reader(c.folder / "a.copc.laz");
  const std::uint64_t page = copc_info(reader.header(), "a")->page;
  std::fstream f(c.folder / "a.copc.laz", std::ios::in | std::ios::out | std::ios::binary);
  f.seekp(static_cast<std::streamoff>(page + 28));
  f.write("\x01\0\0\0", 4);
  f.close();
  EXPECT_THROW(c.part(), core::Error);
}

TEST(CloudPart, NodesOfAnEptIndexAreChosenAsThoseOfCopc) {
  OneCloud c;
  test::write_ept(c.folder / "ept", c.folder / "a.copc.laz");
  const auto of_ept = [&](std::optional<double> resolution) {
    Survey s = c.survey;
    s.points[0].file = "ept/ept.json";
    s.points[0].crs.clear();
    expand_clouds(s);
    CloudPart sum;
    for (const PointFile& f : s.points) {
      const CloudPart part = part_of_cloud(s, f, c.map, resolution);
      sum.points += part.points, sum.unread += part.unread;
    }
    return sum;
  };
  for (const core::Box& box : {core::Area{}.box, core::Box{500300.0, 5400300.0, 500350.0, 5400350.0}})
    for (const std::optional<double> resolution : {std::optional<double>(), std::optional(3.0), std::optional(100.0)}) {
      c.area.box = box;
      EXPECT_EQ(of_ept(resolution).points, c.part(resolution).points);
      EXPECT_EQ(of_ept(resolution).unread, c.part(resolution).unread);
    }
}

}  // namespace
}  // namespace swath::io
