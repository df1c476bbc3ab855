// SPDX-License-Identifier: GPL-3.0-or-later
// Which columns of a cloud's points a run reads.
#include "pipeline/engine/strips.h"

#include "io/text/value_file.h"
#include "pipeline/run.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Column;

class CloudColumns : public ::testing::Test {
 protected:
  CloudColumns() {
    io::LasHeader h = test::sample_header(7, 4);
    h.offset = {550000.0, 5350000.0, 0.0};
    h.extras.push_back(test::extra_field("sigma_v", 9));
    io::LasPoints p = test::sample_points(h, 60000);
    for (size_t i = 0; i < p.size(); ++i) {
      p.raw_x[i] = static_cast<std::int32_t>(i % 300) * 40;
      p.raw_y[i] = static_cast<std::int32_t>(i / 300) * 400;
      p.raw_z[i] %= 200;
      p.flags[i] = 0;
      p.return_count[i] = p.return_number[i] = 1;
    }
    test::write_sample(folder_ / "a.laz", h, p, 1);
    test::write_bytes(folder_ / "survey.toml", "crs = \"EPSG:32632\"\n[[points]]\nfile = \"a.laz\"\ncrs = \"EPSG:32632\"\n");
  }
  Plan plan(const std::vector<std::string>& stages, const std::string& output, const std::string& set = {}) const {
    std::string text = "[[stage]]\ntype = \"readers.las\"\n";
    for (const std::string& s : stages) text += "[[stage]]\ntype = \"" + s + "\"\n";
    Request r;
    r.config = folder_ / "p.toml";
    test::write_bytes(r.config, text);
    r.survey = folder_ / "survey.toml";
    r.output = folder_ / output;
    if (!set.empty()) r.sets.push_back(set);
    r.threads = 2;
    return make_plan(r);
  }
  core::ColumnSet unread(const std::vector<std::string>& stages, const std::string& set = {}) const {
    Plan p = plan(stages, "unused", set);
    Progress progress(Voice::quiet);
    RunState run(p, progress);
    run.fingerprints = run.folders = std::vector<std::string>(p.stages.size());
    for (size_t i = 0; i < p.stages.size(); ++i)
      if (run.works_on(i, stages::Grain::strip)) run.last_strip_stage = i;
    choose_strips(run);
    return run.context.unread;
  }
  /// Tallies and findings of the stages, and the terrain model's bytes.
  std::string terrain(const std::string& output, const std::string& set = {}) const {
    Plan p = plan({"filters.returns", "filters.noise", "filters.ground", "terrain.dtm"}, output, set);
    Progress progress(Voice::quiet);
    run(p, progress, "test");
    std::string text;
    const core::Value report = io::read_value_file(folder_ / output / "report.json");
    for (const core::Value& stage : report.find("stages")->items())
      for (const char* key : {"tally", "findings"})
        if (const core::Value* found = stage.find(key)) text += io::to_json(*found);
    for (const auto& e : fs::recursive_directory_iterator(folder_ / output))
      if (e.path().extension() == ".tif") text += test::read_bytes(e.path());
    return text;
  }
  test::TemporaryFolder folder_;
};

TEST_F(CloudColumns, WhatNoStageReadsIsNotRead) {
  const core::ColumnSet terrain = unread({"filters.noise", "filters.ground", "terrain.dtm"});
  EXPECT_TRUE(terrain.contains({Column::intensity, Column::user_data, Column::red, Column::green, Column::blue, Column::source}));
  EXPECT_FALSE(terrain.has(Column::x));
  EXPECT_FALSE(terrain.has(Column::classification));
  EXPECT_FALSE(terrain.has(Column::time)) << "the reader judges the times, whatever the stages read";
}

TEST_F(CloudColumns, AWriterOfPointsReadsWholeRecords) {
  EXPECT_FALSE(unread({"filters.noise", "writers.las"}).has(Column::source));
  EXPECT_EQ(unread({"filters.noise", "terrain.dtm"}, "run.keep_work=true"), core::ColumnSet{}) << "for other stages of later runs";
}

TEST_F(CloudColumns, StripStagesReadTheirs) {
  EXPECT_TRUE(unread({"terrain.density"}).has(Column::return_count));
  EXPECT_FALSE(unread({"filters.returns", "terrain.density"}).has(Column::return_count));
}

TEST_F(CloudColumns, ProductsAndCountsAreThoseOfWholeRecords) {
  const std::string part = terrain("part"), whole = terrain("whole", "run.keep_work=true");
  EXPECT_GT(part.size(), 1000u);
  EXPECT_TRUE(part == whole);
}

}  // namespace
}  // namespace swath::pipeline
