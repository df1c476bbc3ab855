// SPDX-License-Identifier: GPL-3.0-or-later
// LAS, LAZ and COPC: header, records, CRS, points as columns and as blocks, and as raw records in the scanner's frame.
#include <limits>

#include "io/las/cloud_extent.h"
#include "io/las/las_reader.h"
#include "tests/fuzz/target.h"

using namespace swath;

namespace {

/// Coordinates are 32 bits times a scale, which the header may state as it likes: only what is no number is a finding.
constexpr double farthest = std::numeric_limits<double>::max();
constexpr std::size_t batch = 4096;

void read_points(const std::filesystem::path& file) {
  io::LasReader reader(file, 1);
  io::LasPoints points;
  while (reader.position() < fuzz::most_values && reader.read(points, batch) > 0)
    for (std::size_t i = 0; i < points.size(); ++i) {
      fuzz::expect(points.x[i], farthest, "an x");
      fuzz::expect(points.y[i], farthest, "a y");
      fuzz::expect(points.z[i], farthest, "a z");
    }
  for (const io::LasExtra& e : reader.header().extras) io::las_extra_values(points, reader.header(), e.name);
}

void read_blocks(const std::filesystem::path& file) {
  io::LasReader reader(file, 1);
  reader.crs();
  core::Block block;
  block.origin = reader.header().offset;
  io::LasTime time;
  time.week = 2317;
  while (reader.position() < fuzz::most_values && reader.read(block, batch, time, 1) > 0)
    for (std::size_t i = 0; i < block.size(); ++i) {
      fuzz::expect(block.x[i], farthest, "an x of a block");
      fuzz::expect(block.y[i], farthest, "a y of a block");
      fuzz::expect(block.z[i], farthest, "a z of a block");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("cloud.laz", data, size);
  fuzz::reading([&] { read_points(file); });
  fuzz::reading([&] { read_blocks(file); });
  fuzz::reading([&] { io::extent_of_cloud(file, 1000, -1000, 9000, 1); });
  static const io::Survey survey =
      fuzz::survey_of("[[laser]]\nfile = \"cloud.laz\"\nformat = \"las\"\ntime = { scale = \"gps_adjusted\" }\n");
  fuzz::reading([&] { fuzz::read_shots(survey); });
  return 0;
}
