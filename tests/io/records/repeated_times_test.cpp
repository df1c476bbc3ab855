// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/repeated_times.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::io {
namespace {

using Pairs = std::vector<std::pair<size_t, size_t>>;

TEST(RepeatedTimes, EachWithTheFirstOfItsTime) {
  EXPECT_EQ(repeated_times({}), Pairs{});
  EXPECT_EQ(repeated_times({1.0, 2.0, 3.0}), Pairs{});
  EXPECT_EQ(repeated_times({1.0, 1.0, 2.0, 2.0, 2.0}), (Pairs{{0, 1}, {2, 3}, {2, 4}}));
  // Not in the order of time, and apart from each other.
  EXPECT_EQ(repeated_times({5.0, 1.0, 5.0, 3.0, 1.0}), (Pairs{{0, 2}, {1, 4}}));
}

TEST(RepeatedTimes, TimesThatAreNotFiniteAreEqualToNone) {
  EXPECT_EQ(repeated_times({NAN, NAN, INFINITY, INFINITY, 1.0, 1.0}), (Pairs{{4, 5}}));
}

}  // namespace
}  // namespace swath::io
