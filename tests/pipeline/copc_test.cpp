// SPDX-License-Identifier: GPL-3.0-or-later
// COPC, EPT and virtual point clouds through whole runs.
#include <algorithm>
#include <fstream>
#include <tuple>

#include "core/error.h"
#include "io/text/value_file.h"
#include "io/vector/line_layer.h"
#include "pipeline/run.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t points = 130000;

/// A run of the stages over one cloud file; the products' folder.
fs::path run_on(const fs::path& folder, const std::string& cloud, const std::string& stages, const std::string& name,
                const std::string& tile = "400 m", int threads = 2) {
  test::write_bytes(folder / "survey.toml", "crs = \"EPSG:25832\"\n[[points]]\nfile = \"" + cloud + "\"\ncrs = \"EPSG:25832\"\n");
  test::write_bytes(folder / "p.toml", stages);
  Request r;
  r.config = folder / "p.toml";
  r.survey = folder / "survey.toml";
  r.output = folder / name;
  r.sets = {"run.tile=\"" + tile + "\""};
  r.threads = threads;
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  pipeline::run(plan, progress, "test");
  return r.output;
}

std::string stages_of(const std::string& reading, const std::string& writer, const std::string& writing = {}) {
  return "[[stage]]\ntype = \"readers.las\"\n" + reading + "[[stage]]\ntype = \"" + writer + "\"\n" + writing;
}

/// Records of all files of points below a folder, or of one file, in an order of their own.
std::vector<std::string> records_in(const fs::path& where) {
  std::vector<fs::path> files;
  if (fs::is_directory(where))
    for (const auto& e : fs::directory_iterator(where))
      if (e.path().extension() == ".laz") files.push_back(e.path());
  if (!fs::is_directory(where)) files.push_back(where);
  std::vector<std::string> out;
  for (const fs::path& file : files) {
    io::LasReader reader(file, 1);
    io::LasHeader h = reader.header();
    io::LasPoints p;
    while (reader.read(p, 1u << 20) > 0) {
      const std::vector<std::uint8_t> all = test::records_of(p, h);
      for (std::size_t at = 0; at < all.size(); at += h.record_length)
        out.emplace_back(reinterpret_cast<const char*>(&all[at]), static_cast<std::size_t>(h.record_length));
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string bytes_in(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct CopcRun : testing::Test {
  test::TemporaryFolder folder;
  io::LasHeader header = test::sample_header(7, 4, true);
  io::LasPoints all;

  CopcRun() {
    header.offset = {500000.0, 5400000.0, 300.0};
    all = test::copc_points(header, points);
    test::write_sample(folder / "a.laz", header, all, 1);
    test::write_copc_sample(folder / "a.copc.laz", header, all);
  }
};

TEST_F(CopcRun, TheFileHasEveryFieldOfTheCloudWhateverTheTilesAndThreads) {
  const std::string stages = stages_of("", "writers.copc");
  const fs::path out = run_on(folder.path(), "a.laz", stages, "out");
  EXPECT_EQ(records_in(out / "points.copc.laz"), records_in(folder / "a.laz"));
  EXPECT_TRUE(bytes_in(out / "points.copc.laz") ==
              bytes_in(run_on(folder.path(), "a.laz", stages, "out1", "400 m", 1) / "points.copc.laz"));
  EXPECT_TRUE(bytes_in(out / "points.copc.laz") == bytes_in(run_on(folder.path(), "a.laz", stages, "out2", "2 km") / "points.copc.laz"));
  const core::Value report = io::read_value_file(out / "report.json");
  EXPECT_NE(io::to_json(report).find("\"points.copc.laz\""), std::string::npos);
}

TEST_F(CopcRun, BlocksHaveAFileEachAndTogetherAllPoints) {
  const fs::path out = run_on(folder.path(), "a.laz", stages_of("", "writers.copc", "block = \"500 m\""), "out");
  std::size_t files = 0;
  for (const auto& e : fs::directory_iterator(out / "copc")) files += e.path().extension() == ".laz";
  EXPECT_GE(files, 4u);
  EXPECT_TRUE(fs::exists(out / "copc" / "500000_5400000.copc.laz"));
  EXPECT_EQ(records_in(out / "copc"), records_in(folder / "a.laz"));
  EXPECT_FALSE(fs::exists(out / "points.copc.laz"));
}

TEST_F(CopcRun, ScaledExtraBytesBecomeFloats) {
  const fs::path out = run_on(folder.path(), "a.laz", stages_of("", "writers.copc", "extra_bytes = \"float\""), "out");
  io::LasReader reader(out / "points.copc.laz");
  EXPECT_EQ(reader.header().extras.at(3).type, 9);
  EXPECT_FALSE(reader.header().extras.at(3).scale);
  EXPECT_EQ(reader.header().point_count, points);
}

TEST_F(CopcRun, OlderPointFormatsGetTheOneWithTheirFields) {
  io::LasHeader old = test::sample_header(3);
  old.offset = header.offset;
  const io::LasPoints p = test::copc_points(old, 5000);
  test::write_sample(folder / "old.las", old, p, 1);
  const fs::path out = run_on(folder.path(), "old.las", stages_of("", "writers.copc"), "out");
  io::LasReader reader(out / "points.copc.laz");
  EXPECT_EQ(reader.header().point_format, 7);
  EXPECT_TRUE(reader.header().global_encoding & io::las_encoding::wkt);
  io::LasPoints back;
  reader.read(back, 5000);
  std::vector<double> x = p.x;
  std::sort(x.begin(), x.end());
  std::sort(back.x.begin(), back.x.end());
  EXPECT_EQ(back.x, x);
  EXPECT_THROW(run_on(folder.path(), "a.laz", stages_of("", "writers.copc", "point_format = 3"), "out3"), core::Error);
  EXPECT_THROW(run_on(folder.path(), "a.laz", stages_of("", "writers.copc", "file = \"a.laz\""), "out4"), core::Error);
}

TEST_F(CopcRun, CopcEptAndVirtualCloudsInEqualLasIn) {
  const std::string stages = stages_of("", "writers.las");
  const std::vector<std::string> of_las = records_in(run_on(folder.path(), "a.laz", stages, "las") / "points");
  ASSERT_EQ(of_las.size(), points);
  EXPECT_EQ(records_in(run_on(folder.path(), "a.copc.laz", stages, "copc") / "points"), of_las);
  test::write_ept(folder / "ept", folder / "a.copc.laz");
  EXPECT_EQ(records_in(run_on(folder.path(), "ept/ept.json", stages, "of_ept") / "points"), of_las);
  test::write_bytes(folder / "a.vpc", R"({"features": [{"assets": {"data": {"href": "a.copc.laz"}}}]})");
  EXPECT_EQ(records_in(run_on(folder.path(), "a.vpc", stages, "of_vpc") / "points"), of_las);
}

TEST_F(CopcRun, TilesAreListedForViewersAndMapsAndNamedByKilometresOrAreas) {
  const std::string by_kilometre = stages_of("", "writers.las", "names = \"kilometre\"\nprefix = \"als_\"\n");
  const fs::path out = run_on(folder.path(), "a.laz", by_kilometre, "out", "1 km");
  EXPECT_TRUE(fs::exists(out / "points" / "als_500_5400.laz"));
  EXPECT_TRUE(fs::exists(out / "points" / "als_499_5399.laz"));
  EXPECT_TRUE(fs::exists(out / "points" / "index.gpkg"));
  const std::vector<std::string> records = records_in(folder / "a.laz");
  EXPECT_EQ(records_in(run_on(folder.path(), "out/points/index.vpc", stages_of("", "writers.las"), "again") / "points"), records);
  EXPECT_THROW(run_on(folder.path(), "a.laz", by_kilometre, "out400", "400 m"), core::Error);

  io::LineLayer sheets{"sheets", "", {}, {}, {}, true};
  for (const auto& [name, x, y] :
       {std::tuple("north-east", 5e5, 54e5), {"north-west", 499e3, 54e5}, {"south-east", 5e5, 5399e3}, {"south-west", 499e3, 5399e3}})
    sheets.lines.push_back({name, {x, x + 1e3, x + 1e3, x, x}, {y, y, y + 1e3, y + 1e3, y}, {}});
  io::write_line_layer(folder / "sheets.gpkg", sheets, "EPSG:25832");
  const auto by_areas = [&](const std::string& more) {
    return stages_of("", "writers.las", "names = \"areas\"\nareas = \"sheets.gpkg\"\n" + more);
  };
  EXPECT_TRUE(fs::exists(run_on(folder.path(), "a.laz", by_areas(""), "named", "1 km") / "points" / "south-west.laz"));
  EXPECT_THROW(run_on(folder.path(), "a.laz", by_areas(""), "named400", "400 m"), core::Error) << "several tiles in one area";
  EXPECT_THROW(run_on(folder.path(), "a.laz", by_areas("areas_field = \"sheet\"\n"), "field", "1 km"), core::Error);
  EXPECT_THROW(run_on(folder.path(), "a.laz", stages_of("", "writers.las", "names = \"areas\"\n"), "none"), core::Error);
  const fs::path bare = run_on(folder.path(), "a.laz", stages_of("", "writers.las", "index = false\n"), "bare");
  EXPECT_FALSE(fs::exists(bare / "points" / "index.vpc") || fs::exists(bare / "points" / "index.gpkg"));
}

TEST_F(CopcRun, BoundsGiveThePointsWithinThemFromEveryKindOfFile) {
  const std::string stages = stages_of("bounds = [500100, 5400050, 500300, 5400400]\n", "writers.las");
  const fs::path of_las = run_on(folder.path(), "a.laz", stages, "las");
  const std::vector<std::string> records = records_in(of_las / "points");
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points; ++i) inside += all.x[i] >= 500100 && all.x[i] < 500300 && all.y[i] >= 5400050 && all.y[i] < 5400400;
  EXPECT_EQ(records.size(), inside);
  const fs::path of_copc = run_on(folder.path(), "a.copc.laz", stages, "copc");
  EXPECT_EQ(records_in(of_copc / "points"), records);
  EXPECT_NE(io::to_json(io::read_value_file(of_copc / "report.json")).find("not read"), std::string::npos);
  const std::string nowhere = stages_of("bounds = [0, 0, 1, 1]\n", "writers.las");
  EXPECT_THROW(run_on(folder.path(), "a.copc.laz", nowhere, "none"), core::Error);
  EXPECT_THROW(run_on(folder.path(), "a.laz", stages_of("bounds = [2, 0, 1, 1]\n", "writers.las"), "wrong"), core::Error);
}

TEST_F(CopcRun, AResolutionThinsACloudEvenly) {
  const fs::path out = run_on(folder.path(), "a.copc.laz", stages_of("resolution = \"100 m\"\n", "writers.las"), "out");
  const std::size_t n = records_in(out / "points").size();
  EXPECT_GT(n, 1000u);
  EXPECT_LT(n, points);
  EXPECT_THROW(run_on(folder.path(), "a.laz", stages_of("resolution = \"100 m\"\n", "writers.las"), "las"), core::Error);
}

TEST_F(CopcRun, ABrokenHierarchyIsOneErrorThatNamesFileAndByte) {
  io::LasReader reader(folder / "a.copc.laz");
  const std::uint64_t page = io::copc_info(reader.header(), "a")->page;
  std::fstream f(folder / "a.copc.laz", std::ios::in | std::ios::out | std::ios::binary);
  f.seekp(static_cast<std::streamoff>(page + 16));
  f.write("\xff\xff\xff\xff\xff\xff\xff\x7f", 8);
  f.close();
  try {
    run_on(folder.path(), "a.copc.laz", stages_of("", "writers.las"), "out");
    ADD_FAILURE() << "not refused";
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("the COPC hierarchy is broken: the node 0-0-0-0"), std::string::npos) << e.text();
    EXPECT_NE(e.text().find("a.copc.laz: byte " + std::to_string(page)), std::string::npos) << e.text();
  }
  EXPECT_FALSE(fs::exists(folder / "out" / "points"));
}

}  // namespace
}  // namespace swath::pipeline
