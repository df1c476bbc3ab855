// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

namespace swath::core {
namespace {

TEST(InParallel, EveryTurnRunsOnceInPartsOfTheGrain) {
  for (const std::size_t n : {0u, 1u, 7u, 8u, 9u, 1000u}) {
    std::vector<int> times(n, 0);
    std::mutex guard;
    std::set<std::size_t> starts;
    in_parallel(n, 8, [&](std::size_t first, std::size_t last) {
      ASSERT_LT(first, last);
      ASSERT_LE(last - first, 8u);
      for (std::size_t k = first; k < last; ++k) ++times[k];
      const std::scoped_lock lock(guard);
      starts.insert(first);
    });
    EXPECT_EQ(times, std::vector<int>(n, 1)) << n;
    EXPECT_EQ(starts.size(), (n + 7) / 8);
    for (const std::size_t s : starts) EXPECT_EQ(s % 8, 0u);
  }
}

TEST(InParallel, AnErrorOfAPartIsThrownAgain) {
  EXPECT_THROW(in_parallel(100, 1,
                           [](std::size_t first, std::size_t) {
                             if (first == 50) throw std::runtime_error("bad");
                           }),
               std::runtime_error);
}

TEST(InParallel, LoopsMayLieWithinLoops) {
  std::atomic<int> turns{0};
  in_parallel(20, 1, [&](std::size_t, std::size_t) {
    in_parallel(30, 4, [&](std::size_t a, std::size_t b) { turns += static_cast<int>(b - a); });
  });
  EXPECT_EQ(turns, 600);
}

}  // namespace
}  // namespace swath::core
