// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/describe.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

TEST(Describe, HelpShowsOptionsAndNamesTheNearest) {
  EXPECT_NE(stage_list().find("filters.smrf"), std::string::npos);
  EXPECT_NE(stage_help("filters.smrf").find("slope"), std::string::npos);
  try {
    stage_help("filters.smfr");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.hint().find("filters.smrf"), std::string::npos);
  }
}

TEST(Describe, PagesAreWrittenOnceAndKeepTheirProse) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(write_docs(folder.path(), true).empty());
  EXPECT_EQ(test::entries(folder.path()), 0u) << "a check writes nothing";
  EXPECT_FALSE(write_docs(folder.path(), false).empty());
  EXPECT_TRUE(write_docs(folder.path(), true).empty());
  const auto page = folder / "stages/filters.smrf.md";
  const std::string text = test::read_bytes(page);
  test::write_bytes(page, "prose before\n" + text + "prose behind\n");
  EXPECT_TRUE(write_docs(folder.path(), true).empty());
  std::string changed = test::read_bytes(page);
  changed.replace(changed.find("`slope`"), 7, "`pitch`");
  test::write_bytes(page, changed);
  ASSERT_EQ(write_docs(folder.path(), false).size(), 1u);
  EXPECT_EQ(test::read_bytes(page), "prose before\n" + text + "prose behind\n");
}

TEST(Describe, TheCommittedPagesAreUpToDate) {
  for (const auto& page : write_docs(test::source_folder() / "docs", true))
    ADD_FAILURE() << page << " is out of date; run: swath docs docs";
}

}  // namespace
}  // namespace swath::pipeline
