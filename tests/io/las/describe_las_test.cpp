// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/describe_las.h"

#include <cstring>
#include <fstream>
#include <random>

#include "core/error.h"
#include "io/las/las_writer.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

bool warns(const core::Value& told, const std::string& words) {
  for (const core::Value& w : told.find("warnings")->items())
    if (w.as_text().find(words) != std::string::npos) return true;
  return false;
}

TEST(DescribeLas, TruncatedFilesAreErrors) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.las", "LASF");
  EXPECT_THROW(describe_las(folder / "a.las"), core::Error);
}

TEST(DescribeLas, PointsThatAreThereTwiceAreNamed) {
  const test::TemporaryFolder folder;
  core::Block block;
  core::resize(block, 100);
  for (size_t i = 0; i < block.size(); ++i) block.x[i] = 500000.0 + static_cast<double>(i), block.y[i] = 5300000.0;
  const auto written = [&](const char* name, int times) {
    LasWriteOptions o;
    o.threads = 1;
    LasWriter writer(folder / name, o);
    for (int k = 0; k < times; ++k) {
      block.intensity.assign(block.size(), static_cast<std::uint16_t>(k / 2));
      writer.write(block);
    }
    writer.finish();
    return describe_las(folder / name);
  };
  EXPECT_FALSE(warns(written("once.las", 1), "points twice"));
  EXPECT_TRUE(warns(written("twice.las", 2), "100 of the first 200 points have the place, intensity and return number of another"));
  EXPECT_TRUE(warns(written("more.las", 3), "100 of the first 300 points have")) << "returns of another intensity at one place are returns";
  block.time.resize(block.size());
  for (size_t i = 0; i < block.size(); ++i) block.time[i] = 1000.0 + static_cast<double>(i);
  EXPECT_FALSE(warns(written("timed_once.las", 1), "points twice"));
  EXPECT_TRUE(warns(written("timed.las", 2), "100 of the first 200 points have the place, time and return number of another"));
}

TEST(DescribeLas, DensityOfSparsePointsCountsNoEmptyCellsAsUncovered) {
  const test::TemporaryFolder folder;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0.0, 300.0);
  const double area = 300.0 * 300.0;
  for (const double density : {4.0, 1.0, 0.186, 0.02}) {  // of 1 square unit; 0.186 is 2 points per m2 in feet
    core::Block block;
    core::resize(block, static_cast<size_t>(density * area));
    for (size_t i = 0; i < block.size(); ++i) block.x[i] = place(random) - 150.0, block.y[i] = 5300000.0 + place(random);
    LasWriteOptions o;
    o.threads = 1;
    LasWriter writer(folder / "a.las", o);
    writer.write(block);
    writer.finish();
    const double stated = describe_las(folder / "a.las").find("points_per_square_unit")->as_number();
    EXPECT_NEAR(stated / density, 1.0, 0.1) << density;
  }
}

TEST(DescribeLas, CopcIsNamedAndItsHierarchyIsChecked) {
  const test::TemporaryFolder folder;
  const LasHeader header = test::sample_header(6);
  test::write_copc_sample(folder / "a.copc.laz", header, test::copc_points(header, 200000));
  const core::Value whole = describe_las(folder / "a.copc.laz");
  EXPECT_EQ(whole.find("format")->as_text(), "COPC (LAZ)");
  EXPECT_GT(whole.find("copc")->find("nodes")->as_int(), 1);
  EXPECT_GT(whole.find("copc")->find("levels")->as_int(), 1);
  EXPECT_FALSE(warns(whole, "COPC"));

  std::vector<std::string> warnings;
  const LasHeader written = read_las_header(folder / "a.copc.laz", warnings);
  const CopcInfo info = *copc_info(written, folder / "a.copc.laz");
  std::fstream(folder / "a.copc.laz", std::ios::in | std::ios::out | std::ios::binary)
      .seekp(static_cast<std::streamoff>(info.page + 28))
      .write("\1\0\0\0", 4);  // points of the root
  const core::Value broken = describe_las(folder / "a.copc.laz");
  EXPECT_EQ(broken.find("format")->as_text(), "LAZ");
  EXPECT_EQ(broken.find("copc"), nullptr);
  EXPECT_TRUE(warns(broken, "it is a COPC file, but the COPC hierarchy is broken: its nodes hold"));
  EXPECT_EQ(broken.find("points")->as_int(), 200000);
}

TEST(DescribeLas, APointAloneCoversOneCell) {
  const test::TemporaryFolder folder;
  core::Block block;
  core::resize(block, 1);
  LasWriteOptions o;
  o.threads = 1;
  LasWriter writer(folder / "a.las", o);
  writer.write(block);
  writer.finish();
  EXPECT_EQ(describe_las(folder / "a.las").find("covered_area")->as_number(), 4.0);
}

TEST(DescribeLasReference, OneStripInFeet) {
  SWATH_SHARED_OR_SKIP(data, "data/autzen");
  const core::Value las = describe_las(data / "autzen_trim.las");
  EXPECT_EQ(las.find("points")->as_int(), 110000);
  ASSERT_EQ(las.find("lines")->items().size(), 1u);
  EXPECT_EQ(las.find("lines")->items()[0].find("number")->as_int(), 7326);
  EXPECT_EQ(las.find("lines")->items()[0].find("count")->as_int(), 110000);
  EXPECT_NE(las.find("crs"), nullptr);
  const core::Value laz = describe_las(data / "autzen_trim.laz");
  EXPECT_EQ(laz.find("points")->as_int(), 110000);
  EXPECT_EQ(laz.find("x")->items()[0].as_number(), las.find("x")->items()[0].as_number());
}

TEST(DescribeLasReference, WrongBoundsAndWeeklessTimesAreToldOf) {
  SWATH_SHARED_OR_SKIP(data, "data/als_leeward/points.las");
  const core::Value told = describe_las(data);
  EXPECT_EQ(told.find("points")->as_int(), 1325);
  EXPECT_TRUE(warns(told, "seconds of the week"));
  const test::TemporaryFolder folder;
  std::string bytes = test::read_bytes(data);
  const double wrong = 12345678.0;
  std::memcpy(bytes.data() + 179, &wrong, sizeof wrong);  // max x of the header
  test::write_bytes(folder / "a.las", bytes);
  EXPECT_TRUE(warns(describe_las(folder / "a.las"), "the header states x"));
}

}  // namespace
}  // namespace swath::io
