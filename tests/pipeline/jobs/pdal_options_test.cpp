// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/pdal_options.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/config/option_visitors.h"
#include "stages/registry.h"

namespace swath::pipeline {
namespace {

TEST(PdalOptions, EveryFilterAndOptionIsOneOfOurs) {
  for (const PdalFilter& f : pdal_filters()) {
    const auto stage = stages::make_stage(f.ours);
    ASSERT_TRUE(stage) << f.ours;
    std::vector<std::string> known;
    for (const core::OptionDoc& o : core::document_options([&](core::Visitor& v) { stage->visit(v); })) known.push_back(o.path);
    const auto is_known = [&](const char* name) { return std::find(known.begin(), known.end(), name) != known.end(); };
    for (const PdalOption& o : f.options) EXPECT_TRUE(is_known(o.ours)) << f.type << " " << o.ours;
    for (const auto& [name, value] : f.fixed) EXPECT_TRUE(is_known(name)) << f.type << " " << name;
  }
}

TEST(PdalOptions, WhatIsTheCaseAnywayMayBeWritten) {
  EXPECT_TRUE(is_the_case("filters.smrf", "returns", "last, only"));
  EXPECT_FALSE(is_the_case("filters.smrf", "returns", "first"));
  EXPECT_TRUE(is_the_case("filters.elm", "class", 7));
  EXPECT_TRUE(is_the_case("filters.elm", "class", "7"));
  EXPECT_FALSE(is_the_case("filters.elm", "class", 18));
  EXPECT_TRUE(is_the_case("writers.las", "compression", "laszip"));
  EXPECT_FALSE(is_the_case("writers.gdal", "compression", "laszip"));
  EXPECT_TRUE(is_the_case("filters.smrf", "ignore", "Classification[7:7]")) << "ground filters look at no noise";
  EXPECT_FALSE(is_the_case("filters.smrf", "ignore", "Classification[6:6]"));
  EXPECT_FALSE(is_the_case("filters.smrf", "ignore", "Classification[18:18]")) << "low noise would be looked at";
}

TEST(PdalOptions, RangesOfClassesAreAlternatives) {
  std::string why;
  const auto classes = [&](const std::string& limits) { return why.clear(), classes_of_limits(limits, why); };
  EXPECT_EQ(classes("Classification[2:2]"), std::vector<int>{2});
  EXPECT_EQ(classes("Classification[9:9], Classification[2:3],Classification[3:3]"), (std::vector<int>{2, 3, 9}));
  EXPECT_EQ(why, "");
  const auto refused = [&](const std::string& limits, const std::string& reason) {
    EXPECT_TRUE(classes(limits).empty()) << limits;
    EXPECT_NE(why.find(reason), std::string::npos) << limits << ": " << why;
  };
  refused("Classification[2:2],Z[0:100]", "'Z[0:100]' is no range of Classification");
  refused("Classification![7:7]", "state those to keep");
  refused("Classification[2:256]", "classes from 0 to 255");
  refused("Classification[3:2]", "classes from 0 to 255");
  refused("Classification[2:2]x", "is not Classification[a:b]");
  refused("", "no limit");
}

}  // namespace
}  // namespace swath::pipeline
