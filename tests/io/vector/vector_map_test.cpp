// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/vector_map.h"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <functional>

#include "core/error.h"
#include "io/vector/gdal_door.h"
#include "io/vector/height_statement.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// A contour with its label and a spot height, as this program writes them.
void write_map(const std::filesystem::path& file) {
  ContourWriter writer(file, "EPSG:2225+6360");  // feet; NAVD88 in US survey feet
  writer.add(core::ContourLine{{6000000, 6000100}, {2000000, 2000000}, 420.0, true, false, false});
  writer.add(core::ContourLabel{6000050, 2000000, "420", 0.0, 5.0, 420.0});
  writer.add(core::SpotHeight{6000010, 2000020, 423.4, "423.4", true, 5.0});
  writer.close();
}

TEST(VectorMap, HoldsWhatTheFileHoldsForEachReader) {
  const test::TemporaryFolder folder;
  for (const char* name : {"map.gpkg", "map.dxf", "map.geojson"}) {
    const auto file = folder / name;
    write_map(file);
    const VectorMap map = read_map(file);
    const VectorLines lines = read_lines(file);
    const GdalMessages messages;
    const Dataset set = required_vector(file, messages);
    const SpotFile spots = spots_in(*set, "");
    EXPECT_EQ(map.height_unit, height_unit_in(*set, file)) << name;
    EXPECT_NEAR(map.height_unit.value_or(0.0), 1200.0 / 3937.0, 1e-12) << name;
    ASSERT_EQ(map.lines.lines.size(), 1u) << name;
    EXPECT_EQ(map.lines.lines[0].x, lines.lines[0].x);
    EXPECT_EQ(map.lines.lines[0].height, 420.0);
    EXPECT_TRUE(map.lines.lines[0].index);
    EXPECT_EQ(map.lines.crs_wkt, lines.crs_wkt);
    EXPECT_EQ(map.spots.x, spots.x);
    EXPECT_EQ(map.spots.z, spots.z);
    EXPECT_EQ(map.spots.crs_wkt, spots.crs_wkt);
  }
  EXPECT_THROW(read_map(folder / "none.gpkg"), core::Error);
}

/// How often the file is opened meanwhile.
int openings(const std::filesystem::path& file, const std::function<void()>& meanwhile) {
  const int watch = inotify_init1(IN_NONBLOCK);
  EXPECT_GE(inotify_add_watch(watch, file.c_str(), IN_OPEN | IN_CLOSE), 0);  // equal events in a row would be one
  meanwhile();
  int count = 0;
  alignas(inotify_event) std::array<char, 4096> events;
  for (ssize_t n = 0; (n = read(watch, events.data(), events.size())) > 0;)
    for (ssize_t at = 0; at < n;) {
      const auto* e = reinterpret_cast<const inotify_event*>(events.data() + at);
      count += (e->mask & IN_OPEN) != 0;
      at += static_cast<ssize_t>(sizeof(inotify_event) + e->len);
    }
  close(watch);
  return count;
}

TEST(VectorMap, TheFileIsOpenedOnce) {
  const test::TemporaryFolder folder;
  const auto file = folder / "map.gpkg";
  write_map(file);
  const int lines_alone = openings(file, [&] { read_lines(file); });
  EXPECT_GT(lines_alone, 0);
  EXPECT_EQ(openings(file, [&] { read_map(file); }), lines_alone);
}

}  // namespace
}  // namespace swath::io
