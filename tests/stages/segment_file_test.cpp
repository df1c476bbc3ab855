// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/segment_file.h"

#include <limits>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

std::vector<terrain::Segment> some() {
  std::vector<terrain::Segment> out;
  for (const std::int64_t level : {-7, 0, 12})
    for (int i = 0; i < 500; ++i)
      out.push_back({level, {i, -i, i % 6}, {i + 1, -i, 0}, 612000.0 + i / 3.0, 5.3e6 - i, i % 9 ? 0.1 * i : -0.0, 1e-300});
  out.back().to_y = std::numeric_limits<double>::infinity();
  return out;
}

std::vector<terrain::Segment> read_all(const std::filesystem::path& folder, TileKey key) {
  std::map<std::int64_t, std::vector<LevelSegments>> levels;
  add_levels(folder, key, levels);
  std::vector<terrain::Segment> out;
  for (const auto& [level, stretches] : levels)
    for (const LevelSegments& s : stretches) read_segments(s, out);
  return out;
}

TEST(SegmentFile, SegmentsComeBackByLevel) {
  const test::TemporaryFolder folder;
  write_segments(folder.path(), {1, -2}, some());
  write_segments(folder.path(), {1, -1}, {});
  EXPECT_EQ(read_all(folder.path(), {1, -2}), some());
  EXPECT_TRUE(read_all(folder.path(), {1, -1}).empty());
}

TEST(SegmentFile, AFileCutOrGoneIsAnError) {
  const test::TemporaryFolder folder;
  write_segments(folder.path(), {0, 0}, some());
  const std::filesystem::path file = folder / "0_0.segments";
  const std::string bytes = test::read_bytes(file);
  for (size_t n = 1; n < bytes.size(); n += 97) {
    test::write_bytes(file, bytes.substr(0, n));
    EXPECT_THROW(read_all(folder.path(), {0, 0}), core::SystemError) << n;
  }
  std::filesystem::remove(file);
  EXPECT_THROW(read_all(folder.path(), {0, 0}), core::SystemError);
}

}  // namespace
}  // namespace swath::stages
