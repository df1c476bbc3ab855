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

TEST(Provenance, HashesContent) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a", "one");
  test::write_bytes(folder / "b", "one");
  test::write_bytes(folder / "c", "two");
  EXPECT_EQ(hash_file(folder / "a"), hash_file(folder / "b"));
  EXPECT_NE(hash_file(folder / "a"), hash_file(folder / "c"));
  EXPECT_THROW(hash_file(folder / "none"), core::Error);
  test::write_bytes(folder / "empty", "");
  EXPECT_EQ(hash_file(folder / "empty"), "2d06800538d394c2");  // XXH3 of nothing, as its specification prints it
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
