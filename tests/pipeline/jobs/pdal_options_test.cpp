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

}  // namespace
}  // namespace swath::pipeline
