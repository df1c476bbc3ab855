// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/saved_config.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

Request request_with(const std::filesystem::path& config) {
  Request r;
  r.config = config;
  r.sets = {"dtm.cell=50cm", "run.tile=\"250 m\""};
  r.output = "here";
  r.threads = 3;
  return r;
}

TEST(SavedConfig, IsThePlanAgain) {
  const test::TemporaryFolder folder;
  const Request request = request_with(test::source_folder() / "configs/dtm.toml");
  const Plan plan = make_plan(request);
  save_config(plan, folder / "mine.toml", "swath dtm \x1b[31m\n--cell 50cm");
  EXPECT_EQ(test::entries(folder.path()), 1u) << "a plan without a survey has none to write";
  Request again;
  again.config = folder / "mine.toml";
  Plan saved = make_plan(again);
  EXPECT_EQ(saved.run.output, "here");
  EXPECT_EQ(saved.run.threads, 3);
  EXPECT_EQ(saved.run.tile.value, 250.0);
  ASSERT_EQ(saved.stages.size(), plan.stages.size());
  for (size_t k = 0; k < plan.stages.size(); ++k) {
    EXPECT_EQ(saved.stages[k].stage->info().name, plan.stages[k].stage->info().name);
    EXPECT_EQ(core::fingerprint_of(saved.stages[k].describe()), core::fingerprint_of(plan.stages[k].describe()));
  }
  EXPECT_NE(core::fingerprint_of(plan.stages[4].describe()),
            core::fingerprint_of(make_plan({test::source_folder() / "configs/dtm.toml", {}, {}, {}}).stages[4].describe()))
      << "the cell that was set is part of it";
  const std::string text = test::read_bytes(folder / "mine.toml");
  EXPECT_EQ(text.find('\x1b'), std::string::npos) << "a comment holds no control character";
}

TEST(SavedConfig, ASurveyThatNoFileHoldsIsWrittenBesideIt) {
  const test::TemporaryFolder folder;
  core::Value survey = core::Value::object();
  survey["name"] = "made";
  core::Value file = core::Value::object();
  test::write_bytes(folder / "fix.pos", "% made\n");
  file["file"] = (folder / "fix.pos").string();
  survey["gnss"].push(file);
  Plan plan = make_plan({test::source_folder() / "configs/trajectory.toml", {}, {}, {}});
  plan.survey_tree = survey;
  save_config(plan, folder / "mine.toml", "swath");
  EXPECT_NE(test::read_bytes(folder / "mine.toml").find("survey = \"mine.survey.toml\""), std::string::npos);
  EXPECT_NE(test::read_bytes(folder / "mine.survey.toml").find("fix.pos"), std::string::npos);
}

TEST(SavedConfig, AnotherConfigIsNotOverwritten) {
  const test::TemporaryFolder folder;
  const Request request = request_with(test::source_folder() / "configs/dtm.toml");
  const Plan plan = make_plan(request);
  test::write_bytes(folder / "mine.toml", "[run]\n");
  try {
    save_config(plan, folder / "mine.toml", "swath");
    FAIL() << "it was overwritten";
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    EXPECT_NE(e.where().find("mine.toml"), std::string::npos);
  }
  EXPECT_EQ(test::read_bytes(folder / "mine.toml"), "[run]\n");
  save_config(plan, folder / "new.toml", "swath");
  EXPECT_NO_THROW(save_config(plan, folder / "new.toml", "swath")) << "the same command continues a run";
}

}  // namespace
}  // namespace swath::pipeline
