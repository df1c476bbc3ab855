// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/known_lines.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::quality {
namespace {

TEST(KnownLines, SigmasOfAPoint) {
  const double unknown = std::nan("");
  // Nothing compared: what neighbours share is taken to be as large as their scatter.
  const KnownLines alone{{}, 0.03, unknown, unknown, unknown};
  EXPECT_NEAR(alone.sigma(), std::sqrt(2.0) * 0.03, 1e-9);
  EXPECT_NEAR(alone.horizontal_sigma(), std::sqrt(2.0) * 0.03, 1e-9);
  // Three steep places, and as a fourth that the place is as good as the height.
  const KnownLines compared{{}, 0.03, 0.02, unknown, 0.05, 3};
  EXPECT_NEAR(compared.shared(), 0.02, 1e-9);
  EXPECT_NEAR(compared.horizontal_sigma(), std::sqrt(2.0 * (3 * 0.05 * 0.05 + 0.02 * 0.02) / 4), 1e-9);
  const KnownLines level{{}, 0.03, 0.02, unknown, unknown, 3};  // no steep ground: as the heights
  EXPECT_NEAR(level.horizontal_sigma(), std::sqrt(2.0) * 0.02, 1e-9);
}

TEST(KnownLines, OffsetsAreTakenFromTheHeights) {
  core::Block b;
  b.z = {1.0, 2.0, 3.0};
  b.x = b.y = b.z;
  b.strip = {3, 7, 9};
  take_offsets(b, KnownLines{{{3, 0.05}, {7, -0.05}}});
  EXPECT_EQ(b.z, (std::vector<double>{0.95, 2.05, 3.0}));
}

TEST(KnownLines, OnlyPointsWithoutASigmaGetOne) {
  core::Block b;
  b.x = b.y = b.z = {1.0, 2.0};
  EXPECT_EQ(give_sigmas(b, 0.03, 0.04), 2u);
  EXPECT_EQ(b.sigma_v, (std::vector<float>{0.03F, 0.03F}));
  EXPECT_EQ(b.sigma_h, (std::vector<float>{0.04F, 0.04F}));
  b.sigma_v = {0.0F, 0.1F};
  b.sigma_h = {0.0F, 0.2F};
  EXPECT_EQ(give_sigmas(b, 0.05, 0.06), 1u);
  EXPECT_EQ(b.sigma_v, (std::vector<float>{0.05F, 0.1F}));
  EXPECT_EQ(b.sigma_h, (std::vector<float>{0.06F, 0.2F}));
}

}  // namespace
}  // namespace swath::quality
