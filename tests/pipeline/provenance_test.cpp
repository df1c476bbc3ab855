// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/provenance.h"

#include "core/error.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

Plan two_stages() {
  Plan plan;
  plan.stages.push_back({stages::make_stage("filters.noise"), {}, ""});
  plan.stages.push_back({stages::make_stage("filters.smrf"), {}, ""});
  return plan;
}

void set(Plan& plan, size_t stage, const char* key, core::Value value) {
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table[key] = std::move(value);
  core::read_options(plan.stages[stage].describe(), table, "", faults);
  ASSERT_TRUE(faults.empty());
}

/// An empty Shapefile of lines.
void write_shapefile(const std::filesystem::path& stem) {
  std::string head(100, '\0');
  head[2] = 0x27, head[3] = 0x0a;                    // 9994
  head[27] = 50;                                     // 16-bit words
  head[28] = static_cast<char>(0xe8), head[29] = 3;  // version 1000
  head[32] = 3;                                      // lines
  test::write_bytes(stem.string() + ".shp", head);
  test::write_bytes(stem.string() + ".shx", head);
  std::string table(65, '\0');  // one field
  table[0] = 3, table[1] = 26, table[2] = 1, table[3] = 1, table[8] = 65, table[10] = 11;
  table[32] = 'a', table[43] = 'C', table[48] = 10, table[64] = '\r';
  test::write_bytes(stem.string() + ".dbf", table);
}

TEST(Provenance, FilesBesideAnInputAndTheCalibrationFileAreInputsToo) {
  const test::TemporaryFolder folder;
  write_shapefile(folder / "lines");
  test::write_bytes(folder / "calibration.json", "{}");
  Plan plan;
  plan.stages.push_back({stages::make_stage("terrain.breaklines"), {}, ""});
  plan.survey.folder = folder.path();
  plan.survey.breaklines.emplace_back();
  plan.survey.breaklines[0].file = "lines.shp";
  plan.survey.calibration_file = "calibration.json";
  std::vector<Input> inputs = inputs_of(plan);
  std::vector<std::string> names;
  for (const Input& i : inputs) names.push_back(i.file.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"lines.shp", "lines.dbf", "lines.shx", "calibration.json"}));
  const auto before = fingerprints(plan, inputs);
  test::write_bytes(folder / "lines.prj", "LOCAL_CS[\"x\"]");
  const auto with_crs = fingerprints(plan, inputs_of(plan));
  EXPECT_NE(with_crs, before);
  std::string table = test::read_bytes(folder / "lines.dbf");
  table[1] = 25;
  test::write_bytes(folder / "lines.dbf", table);
  EXPECT_NE(fingerprints(plan, inputs_of(plan)), with_crs);
}

TEST(Provenance, TheProjectFollowsFromTheFingerprint) {
  const auto id = project_id("a");
  EXPECT_EQ(id, project_id("a"));
  EXPECT_NE(id, project_id("b"));
  EXPECT_EQ(id[7] >> 4, 8);  // version: the high bits of the third field, little-endian
  EXPECT_EQ(id[8] >> 6, 2);  // variant
}

TEST(Provenance, TheDayIsTodayUnlessStated) {
  EXPECT_GE(creation_day().year, 2026);
  ::setenv("SOURCE_DATE_EPOCH", "1709164800", 1);  // 2024-02-29
  const Day day = creation_day();
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(day.year, 2024);
  EXPECT_EQ(day.of_year, 60);
}

TEST(Provenance, AStageKeepsItsFingerprintUntilItOrOneBeforeItChanges) {
  Plan plan = two_stages();
  const auto before = fingerprints(plan, {});
  set(plan, 1, "slope", 0.31);
  const auto later = fingerprints(plan, {});
  EXPECT_EQ(later[0], before[0]);
  EXPECT_NE(later[1], before[1]);
  const auto other_input = fingerprints(plan, {{"x", 1, "hash"}});
  EXPECT_NE(other_input[0], later[0]);
  plan.run.tile = core::Metres(250);
  EXPECT_NE(fingerprints(plan, {})[0], later[0]);
  plan.run.tile = core::Metres(500);
  plan.run.threads = 7;
  EXPECT_EQ(fingerprints(plan, {}), later) << "threads change no result";
}

}  // namespace
}  // namespace swath::pipeline
