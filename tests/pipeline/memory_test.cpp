// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/memory.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/error.h"

namespace swath::pipeline {
namespace {

TEST(MemoryBudget, WhatIsFreeIsTheBudgetLessWhatTheProcessHolds) {
  if (resident_bytes() == 0) GTEST_SKIP() << "this system does not say what a process holds";
  const MemoryBudget budget(2e9);
  const double free = budget.free();
  EXPECT_LT(free, 2e9 - budget.reserve());
  EXPECT_GT(free, 1e9);
  EXPECT_EQ(MemoryBudget(1e6).free(), 0.0);
}

TEST(MemoryBudget, FreedMemoryThatIsKeptStaysWithinTheBudget) {
  if (resident_bytes() == 0) GTEST_SKIP() << "this system does not say what a process holds";
  constexpr double bytes = 2e9;
  {
    // Pieces that no page of its own holds, each second one kept, so that the heap cannot shrink by itself.
    std::vector<std::unique_ptr<std::vector<char>>> pieces, kept;
    for (int k = 0; k < 40000; ++k) (k % 100 == 0 ? kept : pieces).push_back(std::make_unique<std::vector<char>>(10000, 'x'));
    pieces.clear();
    const double left = MemoryBudget(bytes).left();
    EXPECT_LE(static_cast<double>(resident_bytes()) + left, bytes) << "what may be taken fits beside what is resident";
  }
}

TEST(MemoryBudget, ARefusalNamesTheBudgetThatWorks) {
  const MemoryBudget budget(200e6);
  EXPECT_NO_THROW(budget.require(50e6, 50e6, "a tile"));
  try {
    budget.require(145e6, 50e6, "filters.ground on the tile 1_2");
    FAIL();
  } catch (const core::SystemError& e) {  // work done so far stays
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    EXPECT_EQ(e.where(), "run.memory");
    EXPECT_NE(std::string(e.what()).find("filters.ground on the tile 1_2 needs 145 MB and 50 MB are free"), std::string::npos) << e.what();
    EXPECT_NE(e.hint().find("300 MB"), std::string::npos) << e.hint();  // 200 + 95 / 0.95
  }
}

TEST(MemoryBudget, WhatTheProcessHoldsBeyondTheBudgetCounts) {
  if (resident_bytes() == 0) GTEST_SKIP() << "this system does not say what a process holds";
  const MemoryBudget budget(1e6);
  EXPECT_EQ(budget.free(), 0.0);
  EXPECT_LT(budget.left(), 0.0);
  try {
    budget.require(95e6, 95e6 - 190e6, "a tile");  // twice as much is missing as with 0 bytes left
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.hint().find("201 MB"), std::string::npos) << e.hint();  // 1 + 190 / 0.95
    EXPECT_NE(std::string(e.what()).find("0 MB are free"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace swath::pipeline
