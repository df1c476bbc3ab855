// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/area.h"

#include <gtest/gtest.h>

namespace swath::stages {
namespace {

TEST(Area, PlacesAreGrownAndStatedSidesReplaceThem) {
  io::Survey survey;
  survey.area.west = 499000.0;
  survey.area.highest = core::Metres(900.0);
  Context context{survey};
  set_area(context, {500000, 5400000, 501000, 5401000}, 2000.0);
  EXPECT_EQ(context.area.box.x0, 499000.0);
  EXPECT_EQ(context.area.box.y0, 5398000.0);
  EXPECT_EQ(context.area.box.x1, 503000.0);
  EXPECT_EQ(context.area.highest, 900.0);
}

}  // namespace
}  // namespace swath::stages
