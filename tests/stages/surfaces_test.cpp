// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/surfaces.h"

#include <gtest/gtest.h>

#include <set>

#include "stages/registry.h"

namespace swath::stages {
namespace {

TEST(Surfaces, EachStandsOnceAndSomeStageGivesIt) {
  std::set<Product> seen;
  for (const Surface& s : surfaces()) {
    EXPECT_TRUE(seen.insert(s.product).second) << name_of(s.product);
    bool given = false;
    for (const Entry& e : registry()) {
      const auto stage = e.make();
      for (const Product p : stage->info().gives_products) given = given || p == s.product;
    }
    EXPECT_TRUE(given) << name_of(s.product);
  }
}

}  // namespace
}  // namespace swath::stages
