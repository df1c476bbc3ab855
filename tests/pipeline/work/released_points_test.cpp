// SPDX-License-Identifier: GPL-3.0-or-later
// A run whose last stage fails has written its points and released them: what the same command goes on from.
#include "pipeline/work/released_points.h"

#include <map>

#include "io/las/las_writer.h"
#include "pipeline/run.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class ReleasedPoints : public ::testing::Test {
 protected:
  ReleasedPoints() {
    io::LasWriteOptions o;
    o.threads = 1;
    io::LasWriter writer(folder_ / "a.laz", o);
    core::Block b;
    b.origin = {500000.0, 5300000.0, 0.0};
    for (int i = 0; i < 10000; ++i) {
      b.x.push_back(0.5 * (i % 100));
      b.y.push_back(0.5 * (i / 100));
      b.z.push_back(0.01 * (i % 100) + (i % 97 == 0 ? 5.0 : 0.0));
      b.classification.push_back(i % 97 == 0 ? 1 : 2);
      b.intensity.push_back(static_cast<std::uint16_t>(i));
      b.time.push_back(1e9 + 3e8 + 1e-5 * i);
    }
    writer.write(b);
    writer.finish();
    test::write_bytes(folder_ / "survey.toml", "crs = \"EPSG:32632\"\n[[points]]\nfile = \"a.laz\"\ncrs = \"EPSG:32632\"\n");
  }
  /// Throws where a stage behind the writer fails.
  core::Value run(const std::string& output, bool fails, const std::string& more = {}) const {
    Request r;
    r.config = folder_ / "p.toml";
    test::write_bytes(r.config,
                      "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.noise\"\n[[stage]]\ntype = "
                      "\"terrain.dtm\"\n[[stage]]\ntype = \"filters.hag_dem\"\n[[stage]]\ntype = \"writers.las\"\n"
                      "[[stage]]\ntype = \"writers.gdal\"\n[[stage]]\ntype = \"writers.picture\"\n" +
                          std::string(fails ? "contours = \"dtm.vrt\"\n" : ""));
    r.survey = folder_ / "survey.toml";
    r.output = folder_ / output;
    r.sets = {"run.tile=\"25 m\""};
    if (!more.empty()) r.sets.push_back(more);
    r.threads = 2;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    return pipeline::run(plan, progress, "test").report;
  }
  static std::int64_t number(const core::Value& report, const char* key) { return report.find(key)->as_int(); }
  /// Every file of the points, by name.
  std::map<std::string, std::string> points(const std::string& output) const {
    std::map<std::string, std::string> out;
    for (const auto& e : fs::directory_iterator(folder_ / output / "points"))
      if (e.path().extension() == ".laz") out[e.path().filename().string()] = test::read_bytes(e.path());
    return out;
  }
  /// The files in the work folder whose names end so.
  std::vector<fs::path> work(const std::string& output, const std::string& ending) const {
    std::vector<fs::path> out;
    for (const auto& e : fs::recursive_directory_iterator(folder_ / output / ".swath"))
      if (e.path().string().ends_with(ending)) out.push_back(e.path());
    std::sort(out.begin(), out.end());
    return out;
  }
  test::TemporaryFolder folder_;
};

TEST_F(ReleasedPoints, AreNotInTheWorkFolderAndTheRunGoesOnWithoutThem) {
  run("whole", false);
  EXPECT_GE(points("whole").size(), 4u);
  EXPECT_THROW(run("out", true), core::Error);
  EXPECT_TRUE(work("out", ".pts").empty());
  const core::Value report = run("out", false);
  EXPECT_EQ(number(report, "pieces_damaged"), 0);
  EXPECT_GT(number(report, "pieces_resumed"), 0);
  EXPECT_EQ(points("out"), points("whole"));
}

TEST_F(ReleasedPoints, AreReadAgainWhereAPieceMadeOfThemIsGone) {
  run("whole", false);
  // A written tile; the record of one; a column, a grid, a record of an earlier stage; the note of what is needed.
  for (const std::string damaged : {".laz", "writers.las", ".cols", ".grid", "terrain.dtm", "released.done"}) {
    EXPECT_THROW(run("out", true), core::Error);
    std::vector<fs::path> files;
    for (const fs::path& f : work("out", damaged.front() == '.' || damaged.front() == 'r' ? damaged : ".done"))
      if (damaged.front() == '.' || damaged.front() == 'r' || f.parent_path().filename().string().find(damaged) != std::string::npos)
        files.push_back(f);
    ASSERT_FALSE(files.empty()) << damaged;
    fs::remove(files.front());
    const core::Value report = run("out", false);
    const core::Value* again = report.find("strips_read_again");
    EXPECT_TRUE(number(report, "pieces_damaged") > 0 || (again && again->as_int() > 0)) << damaged;
    EXPECT_EQ(points("out"), points("whole")) << damaged;
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(ReleasedPoints, AreReadAgainForAWriterOfOtherOptions) {
  run("whole", false, "writers.las.scale=0.01");
  EXPECT_THROW(run("out", true), core::Error);
  const core::Value report = run("out", false, "writers.las.scale=0.01");
  EXPECT_EQ(number(report, "pieces_damaged"), 0);
  EXPECT_EQ(number(report, "strips_read_again"), 1);
  EXPECT_EQ(points("out"), points("whole"));
}

TEST_F(ReleasedPoints, StayWhereTheWorkIsKept) {
  run("out", false, "run.keep_work=true");
  const size_t kept = work("out", ".pts").size();
  EXPECT_GE(kept, 4u);
  // Of a run that was stopped without keep_work the points are gone, and are read again.
  EXPECT_THROW(run("killed", true), core::Error);
  run("killed", false, "run.keep_work=true");
  EXPECT_EQ(work("killed", ".pts").size(), kept);
}

}  // namespace
}  // namespace swath::pipeline
