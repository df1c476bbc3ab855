// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/set_options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    return e.text();
  }
  return "accepted";
}

core::Value pipeline_of(const std::string& types) {
  core::Value tree = core::Value::object();
  tree["stage"] = core::Value::array();
  for (size_t from = 0; from < types.size();) {
    const size_t end = std::min(types.find(' ', from), types.size());
    core::Value stage = core::Value::object();
    stage["type"] = types.substr(from, end - from);
    tree["stage"].push(std::move(stage));
    from = end + 1;
  }
  return tree;
}

TEST(SetOptions, AValueIsWhatItReadsAs) {
  core::Value table = core::Value::object();
  for (const char* set : {"a=true", "b=3", "c=0.5", "d=50 cm", "e=[1, 2]", "f.g.h=x=y"}) set_option(table, set);
  EXPECT_TRUE(table.find("a")->as_bool());
  EXPECT_EQ(table.find("b")->as_int(), 3);
  EXPECT_EQ(table.find("c")->as_number(), 0.5);
  EXPECT_EQ(table.find("d")->as_text(), "50 cm");
  EXPECT_EQ(table.find("e")->items().size(), 2u);
  EXPECT_EQ(table.find("f")->find("g")->find("h")->as_text(), "x=y");
  EXPECT_EQ(table.find("d")->where.file, "--set");
}

TEST(SetOptions, WhatIsNoOptionIsRefused) {
  core::Value table = core::Value::object();
  table["a"] = 1;
  EXPECT_NE(refusal([&] { set_option(table, "a"); }).find("'a' is not key=value"), std::string::npos);
  EXPECT_NE(refusal([&] { set_option(table, "=1"); }).find("is not key=value"), std::string::npos);
  EXPECT_NE(refusal([&] { set_option(table, "a.b=1"); }).find("what it changes is no table"), std::string::npos);
  std::string deep = "a";
  for (int k = 0; k < 30; ++k) deep += ".a";
  EXPECT_NE(refusal([&] { set_option(table, deep + "=1"); }).find("a key of more than 20 levels"), std::string::npos);
}

TEST(SetOptions, EveryStageThatTheLongestNameFitsIsChanged) {
  core::Value tree = pipeline_of("filters.smrf quality.swath report.quality filters.smrf");
  set_stage_option(tree, "run.tile=250 m");
  set_stage_option(tree, "smrf.cell=2 m");
  set_stage_option(tree, "quality.swath.anps=1 m");
  const auto& stages = tree.find("stage")->items();
  EXPECT_EQ(tree.find("run")->find("tile")->as_text(), "250 m");
  EXPECT_EQ(stages[0].find("cell")->as_text(), "2 m");
  EXPECT_EQ(stages[3].find("cell")->as_text(), "2 m");
  EXPECT_EQ(stages[1].find("anps")->as_text(), "1 m");
  EXPECT_EQ(stages[2].find("swath"), nullptr);
  EXPECT_NE(refusal([&] { set_stage_option(tree, "smfr.cell=2 m"); }).find("no stage 'smfr' in this pipeline"), std::string::npos);
  EXPECT_NE(refusal([&] { set_stage_option(tree, "cell=2 m"); }).find("is not stage.key=value"), std::string::npos);
}

}  // namespace
}  // namespace swath::pipeline
