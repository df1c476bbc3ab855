// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds that enter after georeferencing: what is kept of each point.
#include <algorithm>
#include <numeric>

#include "tests/pipeline/cloud_case.h"

namespace swath::pipeline {
namespace {

/// The only file of points of a run.
fs::path only_tile(const fs::path& out) {
  std::vector<fs::path> tiles;
  for (const auto& e : fs::directory_iterator(out / "points"))
    if (e.path().extension() != ".vrt" && e.path().extension() != ".txt") tiles.push_back(e.path());
  std::erase_if(tiles, [](const fs::path& f) { return f.extension() != ".las" && f.extension() != ".laz"; });
  EXPECT_EQ(tiles.size(), 1u);
  return tiles.at(0);
}

/// Tallies of a run's stages as text.
std::string tallies_of(const fs::path& out) {
  std::string text;
  const core::Value report = io::read_value_file(out / "report.json");
  for (const core::Value& stage : report.find("stages")->items())
    if (const core::Value* tally = stage.find("tally")) text += io::to_json(*tally);
  return text;
}

/// A header whose points lie in one tile.
io::LasHeader header_of(int format, bool extras = false) {
  io::LasHeader h = test::sample_header(format, -1, extras);
  h.offset = {easting + 50000.0, northing + 50000.0, -100.0};
  return h;
}

/// Made points without the heights beyond any place of the Earth that readers leave out.
io::LasPoints points_for(const io::LasHeader& h, size_t n) {
  io::LasPoints p = test::sample_points(h, n);
  for (size_t i = 0; i < n; ++i) {
    p.raw_z[i] %= 500;
    p.z[i] = p.raw_z[i] * h.scale.z() + h.offset.z();
  }
  return p;
}

TEST(Cloud, EveryFieldOfEveryFormatIsKept) {
  for (int format = 0; format <= 10; ++format) {
    CloudCase c;
    io::LasHeader h = header_of(format, true);
    h.scale = {0.0001, 0.0001, 0.0025};
    h.guid.fill(0x5C);
    h.creation_day = 200, h.creation_year = 2015;
    io::LasPoints p = points_for(h, 3000);
    p.return_number[0] = p.return_count[0] = 0;
    p.return_number[1] = 5, p.return_count[1] = 2;
    c.add(h, p, "a.las");
    const fs::path tile = only_tile(c.run(copy_stages, "100 km"));
    EXPECT_EQ(test::read_all(tile, 1), p) << format;
    const io::LasReader r(tile, 1);
    EXPECT_EQ(r.header().point_format, format);
    EXPECT_EQ(r.header().scale, h.scale);
    EXPECT_EQ(r.header().offset, h.offset);
    EXPECT_EQ(r.header().guid, h.guid);
    EXPECT_EQ(r.header().creation_year, 2015);
    EXPECT_EQ(r.header().file_source_id, 7);
  }
}

TEST(Cloud, TimesAgainstTheBitAreKeptAndNamed) {
  CloudCase c;
  io::LasHeader h = header_of(8);
  h.global_encoding = io::las_encoding::wkt;  // seconds of week, says the bit
  const io::LasPoints p = points_for(h, 1000);
  c.add(h, p, "a.las");
  const fs::path out = c.run(copy_stages, "100 km");
  EXPECT_EQ(test::read_all(only_tile(out), 1).gps_time, p.gps_time);
  EXPECT_FALSE(io::LasReader(only_tile(out), 1).header().gps_time_is_adjusted());
  EXPECT_NE(tallies_of(out).find("contradict"), std::string::npos);
  EXPECT_NE(tallies_of(out).find("time_scale"), std::string::npos);
}

TEST(Cloud, AStatedScaleSetsTheBitAndNoTime) {
  CloudCase c;
  io::LasHeader h = header_of(8);
  h.global_encoding = io::las_encoding::wkt;
  const io::LasPoints p = points_for(h, 1000);
  c.add(h, p, "a.las", "time_scale = \"gps_adjusted\"\n");
  const fs::path out = c.run(copy_stages, "100 km");
  EXPECT_EQ(test::read_all(only_tile(out), 1).gps_time, p.gps_time);
  EXPECT_TRUE(io::LasReader(only_tile(out), 1).header().gps_time_is_adjusted());
  EXPECT_EQ(tallies_of(out).find("contradict"), std::string::npos);
}

TEST(Cloud, SecondsOfAWeekStayAsRecordedUnlessAsked) {
  io::LasHeader h = header_of(1);
  h.global_encoding = 0;
  io::LasPoints p = points_for(h, 1000);
  for (size_t i = 0; i < p.size(); ++i) p.gps_time[i] = 604700.1 + 0.01 * static_cast<double>(i);
  CloudCase kept, dated;
  kept.add(h, p, "a.las", "week = 2000\n");
  EXPECT_EQ(test::read_all(only_tile(kept.run(copy_stages, "100 km")), 1).gps_time, p.gps_time);
  dated.add(h, p, "a.las", "week = 2000\n");
  const fs::path tile = only_tile(dated.run(copy_stages + "times = \"adjusted\"\n", "100 km"));
  EXPECT_TRUE(io::LasReader(tile, 1).header().gps_time_is_adjusted());
  EXPECT_NEAR(test::read_all(tile, 1).gps_time[5], 2000 * 604800.0 + p.gps_time[5] - 1e9, 1e-6);
}

TEST(Cloud, ReturnNumbersOfACloudStayUnlessAsked) {
  io::LasHeader h = header_of(6);
  io::LasPoints p = points_for(h, 1000);
  std::fill(p.return_number.begin(), p.return_number.end(), std::uint8_t{0});
  for (size_t i = 0; i < p.size(); ++i) p.gps_time[i] = 3e8 + 1e-4 * static_cast<double>(i / 2);
  const std::string stages = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.returns\"\n",
                    write = "[[stage]]\ntype = \"writers.las\"\n";
  CloudCase kept, repaired;
  kept.add(h, p, "a.las");
  EXPECT_EQ(test::read_all(only_tile(kept.run(stages + write, "100 km")), 1), p);
  repaired.add(h, p, "a.las");
  const io::LasPoints q = test::read_all(only_tile(repaired.run(stages + "repair_clouds = true\n" + write, "100 km")), 1);
  EXPECT_EQ(q.return_number[0] + q.return_number[1], 3);
  EXPECT_EQ(q.return_count[0], 2);
}

TEST(Cloud, KeptClassesAreRespected) {
  CloudCase c;
  Block b = square(4000, easting, northing, 100, 10);
  b.classification.assign(b.size(), core::point_class::unassigned);
  for (size_t i = 0; i < b.size(); i += 4) b.classification[i] = core::point_class::building;
  for (size_t i = 1; i < b.size(); i += 40) b.classification[i] = core::point_class::ground;
  c.add(b, "a.las", "EPSG:32632");
  const auto classes_with = [&](const std::string& keep) {
    std::map<int, size_t> n;
    const fs::path out = c.run("[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.ground\"\nkeep_classes = \"" + keep +
                                   "\"\n[[stage]]\ntype = \"writers.las\"\ncompress = false\n",
                               "1000 m");
    for (const std::uint8_t k : points_of(out).classification) ++n[k];
    fs::remove_all(out);
    return n;
  };
  const size_t nearly_all = 90;  // % of what the filter may call ground: the rim of the square is its own affair
  std::map<int, size_t> anew = classes_with("none"), rest = classes_with("all");
  EXPECT_EQ(anew[6], 0u);
  EXPECT_GT(anew[2], 4000 * nearly_all / 100);
  EXPECT_EQ(classes_with("ground"), (std::map<int, size_t>{{1, 2900}, {2, 100}, {6, 1000}}));
  EXPECT_EQ(rest[6], 1000u);
  EXPECT_GT(rest[2], 3000 * nearly_all / 100);
}

TEST(Cloud, HeightsOfAGeographicFileAreMetres) {
  CloudCase c;
  c.add(square(100, 9.0, 47.85, 0.001, 123.4), "degrees.las", "EPSG:4326", 1e-7);
  const Block out = points_of(c.run(copy_stages, "500 m"));
  ASSERT_EQ(out.size(), 100u);
  for (const double z : out.z) EXPECT_NEAR(z, 123.4, 0.001);  // one step of the files
}

TEST(Cloud, AFileStatesTheUnitOfItsHeights) {
  CloudCase c;
  c.add(square(100, easting, northing, 100, 10), "feet.las", "EPSG:32632", 0.001, "height_unit = \"1 ft\"\n");
  for (const double z : points_of(c.run(copy_stages, "500 m")).z) EXPECT_NEAR(z, 3.048, 0.001);
}

TEST(Cloud, HeightsInMetresOverFeetAreStatedInTheProduct) {
  CloudCase c;
  c.survey = "crs = \"EPSG:2263\"\nheight_unit = \"1 m\"\n";
  c.add(square(100, 983000, 210000, 100, 10), "a.las", "EPSG:2263");
  const fs::path tile = only_tile(c.run(copy_stages, "500 m"));
  io::LasReader reader(tile, 1);
  const core::Crs stated(reader.crs().definition);
  EXPECT_TRUE(stated.has_height_unit());
  EXPECT_NEAR(stated.vertical_metres_per_unit(), 1.0, 1e-12);
  for (const double z : test::read_all(tile, 1).z) EXPECT_NEAR(z, 10.0, 0.001);
}

TEST(Cloud, ColoursOfOneFileAreNotLostAmongOthers) {
  CloudCase c;
  for (const std::string name : {"a.las", "b.las", "c.las"}) {
    Block b = square(100, easting, northing, 100, 10);
    b.strip.assign(b.size(), static_cast<std::uint16_t>(name[0]));
    if (name == "b.las")
      for (auto* column : {&b.red, &b.green, &b.blue}) column->assign(b.size(), 700);
    c.add(b, name, "EPSG:32632");
  }
  const Block out = points_of(c.run(copy_stages, "500 m"));
  ASSERT_EQ(out.size(), 300u);
  ASSERT_EQ(out.red.size(), 300u);
  for (size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out.red[i], out.strip[i] == 'b' ? 700 : 0) << i;
}

}  // namespace
}  // namespace swath::pipeline
