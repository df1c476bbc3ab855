// SPDX-License-Identifier: GPL-3.0-or-later
// What `swath simulate` refuses, before it writes.
#include <gtest/gtest.h>

#include "core/error.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

TEST(Simulate, RefusesOutagesThatLeaveNothing) {
  const test::TemporaryFolder folder;
  Options o = preset(Scene::flat);
  o.output.laser = false;
  o.gnss.outages = {{core::Seconds(0), core::Seconds(1e5)}};
  EXPECT_THROW(run(o, folder / "a"), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

TEST(Simulate, RefusesWhatDoesNotGoTogetherBeforeItWrites) {
  const test::TemporaryFolder folder;
  Options o = preset(Scene::flat);
  o.world.relief = core::Metres(500);
  EXPECT_THROW(run(o, folder / "a"), core::Error);  // the ground reaches the aircraft
  o = preset(Scene::flat);
  o.crs = "EPSG:4326";
  EXPECT_THROW(run(o, folder / "a"), core::Error);
  o = preset(Scene::flat);
  o.scanner.max_returns = 9;
  EXPECT_THROW(run(o, folder / "a"), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

}  // namespace
}  // namespace swath::simulate
