// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/proj_grids.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/geo/proj_handles.h"
#include "tests/world/support.h"

namespace swath::core {
namespace {

/// A GTX file of one geoid height over the globe, 90 degrees a cell.
void write_geoid(const std::filesystem::path& file, float height) {
  std::string bytes;
  const auto big_endian = [&](const void* value, size_t n) {
    for (size_t i = 0; i < n; ++i) bytes += static_cast<const char*>(value)[n - 1 - i];
  };
  for (const double v : {-90.0, -180.0, 90.0, 90.0}) big_endian(&v, sizeof v);
  for (const std::int32_t n : {3, 5}) big_endian(&n, sizeof n);
  for (int i = 0; i < 15; ++i) big_endian(&height, sizeof height);
  test::write_bytes(file, bytes);
}

TEST(ProjGrids, TheFolderOfTheDatabaseMayBeAnother) {
  const test::TemporaryFolder folder;
  use_proj_folders({folder.path()});
  EXPECT_THROW(Crs("EPSG:32632"), Error);
  use_proj_folders({});
  EXPECT_EQ(Crs("EPSG:32632").epsg(), 32632);
}

TEST(ProjGrids, SeveralFoldersAreSearchedTogether) {
  const std::string database = proj_text(proj_context_get_database_path(nullptr));
  ASSERT_FALSE(database.empty());
  const test::TemporaryFolder folder;
  write_geoid(folder / "own.gtx", 40.0f);
  use_proj_folders({{}, folder.path(), std::filesystem::path(database).parent_path()});
  const auto files = grid_files_between(wgs84_geodetic(), Crs("+proj=utm +zone=32 +datum=WGS84 +geoidgrids=own.gtx +type=crs"));
  use_proj_folders({});
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0], folder / "own.gtx");
}

TEST(ProjGrids, AGeoidOfTheUsersOwnIsFound) {
  const test::TemporaryFolder folder;
  write_geoid(folder / "geoid.gtx", 40.0f);
  const Crs with("+proj=utm +zone=32 +datum=WGS84 +geoidgrids=" + (folder / "geoid.gtx").string() + " +type=crs");
  const auto files = grid_files_between(wgs84_geodetic(), with);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0], folder / "geoid.gtx");
}

TEST(ProjGrids, NoneWhereNoneIsTaken) {
  EXPECT_TRUE(grid_files_between(wgs84_geodetic(), Crs("EPSG:32632")).empty());
  EXPECT_TRUE(grid_files_between(Crs(), Crs("EPSG:32632")).empty());
}

}  // namespace
}  // namespace swath::core
