// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/inpaint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
constexpr float float_rounding = 1e-4F;  // m, heights of some tens of metres in single precision

float plane(int i, int j) { return 3.0F + 0.25F * static_cast<float>(i) - 0.5F * static_cast<float>(j); }

Raster plane_with_hole(int from, int to) {
  Raster r(40, 40, 0.0F);
  for (int j = 0; j < r.ny; ++j)
    for (int i = 0; i < r.nx; ++i) r.value[r.at(i, j)] = i >= from && i < to && j >= from && j < to ? nothing : plane(i, j);
  return r;
}

TEST(Inpaint, PlanesComeBackExactly) {
  const Raster out = inpaint(plane_with_hole(15, 23), {.reach = 10, .relax = 4, .extrapolate = false});
  for (int j = 0; j < out.ny; ++j)
    for (int i = 0; i < out.nx; ++i) ASSERT_NEAR(out.value[out.at(i, j)], plane(i, j), float_rounding) << i << " " << j;
}

TEST(Inpaint, KeepsValuesAndStopsAtItsReach) {
  Raster r(61, 3, nothing);
  r.value[r.at(30, 1)] = 7.0F;
  const Raster out = inpaint(r, {.reach = 10, .relax = 3, .extrapolate = true});
  EXPECT_EQ(out.value[out.at(30, 1)], 7.0F);
  EXPECT_EQ(out.value[out.at(40, 1)], 7.0F);
  EXPECT_TRUE(std::isnan(out.value[out.at(41, 1)]));
  EXPECT_TRUE(std::isnan(out.value[out.at(19, 1)]));
  EXPECT_TRUE(std::isnan(inpaint(r, {.reach = 10, .relax = 3, .extrapolate = false}).value[r.at(31, 1)]));
}

TEST(Inpaint, AChangeBeyondItsSupportChangesNothing) {
  const Inpainting how{.reach = 6, .relax = 2, .extrapolate = true};
  Raster a = plane_with_hole(12, 30);
  Raster b = a;
  b.value[b.at(5, 20)] += 100.0F;
  const Raster fa = inpaint(a, how);
  const Raster fb = inpaint(b, how);
  bool changed = false;
  for (int j = 0; j < a.ny; ++j)
    for (int i = 0; i < a.nx; ++i) {
      const bool same =
          fa.value[a.at(i, j)] == fb.value[a.at(i, j)] || (std::isnan(fa.value[a.at(i, j)]) && std::isnan(fb.value[a.at(i, j)]));
      if (std::max(std::abs(i - 5), std::abs(j - 20)) > how.support()) {
        ASSERT_TRUE(same) << i << " " << j;
      }
      changed |= !same && !(i == 5 && j == 20);
    }
  EXPECT_FALSE(changed);  // the nearest value on every line hides the one behind it
  b = a;
  b.value[b.at(11, 20)] += 100.0F;
  EXPECT_NE(inpaint(b, how).value[b.at(13, 20)], fa.value[a.at(13, 20)]);
}

}  // namespace
}  // namespace swath::filters
