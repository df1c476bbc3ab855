// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/report_docs.h"

#include <gtest/gtest.h>

#include "core/config/option_visitors.h"
#include "pipeline/limits.h"
#include "stages/registry.h"

namespace swath::pipeline {
namespace {

TEST(ReportDocs, ThePageNamesCountsWithTheirFateAndFindings) {
  const std::string page = report_page();
  for (const char* part : {"## `filters.smrf`", "| `ground` | integer |  | changed | Returns classified as ground. |",
                           "| `kept the class they had (keep_classes)` | integer |  | kept |", "| `void_share` | number | share |"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST(ReportDocs, EveryResultSaysWhatItIs) {
  for (const auto& e : stages::registry()) {
    const auto s = e.make();
    for (const auto& results : {core::document_results([&](core::ResultVisitor& v) { s->visit_counts(v); }),
                                core::document_results([&](core::ResultVisitor& v) { s->visit_findings(v); })})
      for (const core::ResultDoc& d : results) {
        EXPECT_TRUE(d.doc.ends_with('.')) << e.name << " " << d.path << ": " << d.doc;
        EXPECT_LE(d.doc.size(), 120u) << e.name << " " << d.path;
      }
  }
}

TEST(ReportDocs, EachLimitOfAFindingIsOneOfTheRun) {
  Limits limits;
  std::vector<std::string> names;
  for (const core::OptionDoc& o : core::document_options(core::described(limits))) names.push_back(o.path);
  EXPECT_FALSE(limited_findings().empty());
  for (const LimitedFinding& f : limited_findings())
    EXPECT_NE(std::find(names.begin(), names.end(), f.limit), names.end()) << f.stage << " " << f.path << " " << f.limit;
}

TEST(ReportDocs, TheSchemaHoldsTheCountsOfAStage) {
  const core::Value schema = report_schema();
  bool found = false;
  for (const core::Value& one : schema.find("properties")->find("stages")->find("items")->find("anyOf")->items())
    if (one.find("properties")->find("type")->find("const")->as_text() == "filters.smrf") {
      const core::Value* ground = one.find("properties")->find("tally")->find("properties")->find("ground");
      ASSERT_NE(ground, nullptr);
      found = ground->find("properties")->find("count")->find("type")->as_text() == "integer";
    }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace swath::pipeline
