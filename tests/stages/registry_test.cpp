// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/config/option_visitors.h"

namespace swath::stages {
namespace {

TEST(Registry, NamesAreThoseOfTheStagesAndUnique) {
  std::set<std::string_view> names;
  for (const Entry& e : registry()) {
    EXPECT_EQ(e.make()->info().name, e.name);
    EXPECT_TRUE(names.insert(e.name).second) << e.name;
  }
  EXPECT_EQ(make_stage("filters.none"), nullptr);
}

TEST(Registry, EveryStageSaysWhatItDoesAndEveryOptionToo) {
  for (const Entry& e : registry()) {
    const auto stage = e.make();
    EXPECT_TRUE(stage->info().summary.ends_with('.')) << e.name;
    EXPECT_FALSE(stage->info().grains.empty()) << e.name;
    for (const auto& o : core::document_options([&](core::Visitor& v) { stage->visit(v); }))
      EXPECT_TRUE(o.doc.ends_with('.')) << e.name << " " << o.path;
  }
}

TEST(Registry, DefaultsAreValid) {
  for (const Entry& e : registry()) {
    const auto stage = e.make();
    std::vector<core::Fault> faults;
    const core::Describe d = [&](core::Visitor& v) { stage->visit(v); };
    core::read_options(d, core::effective_values(d), "", faults);
    // Limits of power lines depend on country and contract, the part of a cloud on the user: they have no default.
    const bool contract = e.name == "terrain.powerlines" || e.name == "filters.crop";
    EXPECT_EQ(faults.empty(), !contract) << e.name;
    for (const auto& f : faults)
      if (!contract || f.text().find("must be given") == std::string::npos) ADD_FAILURE() << e.name << ": " << f.text();
  }
}

/// Otherwise a run that is continued would take what the file held before, and a product could take its place.
TEST(Registry, FilesThatOptionsNameAreInputsBesideTheSurvey) {
  io::Survey survey;
  survey.folder = "flight";
  int files = 0;
  for (const Entry& e : registry()) {
    const auto stage = e.make();
    const core::Describe d = [&](core::Visitor& v) { stage->visit(v); };
    core::Value given = core::Value::object();
    std::set<std::filesystem::path> wanted;
    for (const auto& o : core::document_options(d)) {
      if (o.is_table || o.shape != "file" || o.path == "program") continue;  // a program is no data
      given[o.path] = core::Value(o.path + ".gpkg");
      wanted.insert(std::filesystem::path("flight") / (o.path + ".gpkg"));
    }
    std::vector<core::Fault> faults;
    core::read_options(d, given, "", faults);
    if (wanted.empty()) continue;
    const std::vector<std::filesystem::path> inputs = stage->inputs(survey);
    for (const auto& file : wanted) EXPECT_EQ(std::count(inputs.begin(), inputs.end(), file), 1) << e.name << " " << file;
    files += static_cast<int>(wanted.size());
  }
  EXPECT_GE(files, 5);
}

}  // namespace
}  // namespace swath::stages
