// SPDX-License-Identifier: GPL-3.0-or-later
// filters.ground with its defaults against the classes of other people's clouds; all of them: bench/real/real.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "filters/ground/ground.h"
#include "io/las/las_reader.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

/// The limits that the project has set itself for clouds of this kind.
struct Cloud {
  const char* name;
  const char* file;
  double total, at_rim, gap;  ///< %; type II within 12 m of the rim, %; largest distance between stated and true share of a decile
};

class RealCloud : public testing::TestWithParam<Cloud> {};

struct Labelled {
  core::Block block;
  std::vector<bool> is_ground, counts;
};

/// The maker's ground; classes 65 and 67 are artefacts in these clouds.
Labelled read(const std::filesystem::path& file) {
  io::LasReader reader(file);
  Labelled cloud;
  const auto& low = reader.header().min;
  cloud.block.origin = {low[0], low[1], 0.0};
  reader.read(cloud.block, reader.header().point_count, {.keep_unknown = true});
  for (std::uint8_t& c : cloud.block.classification) {
    cloud.is_ground.push_back(c == core::point_class::ground);
    cloud.counts.push_back(c != 65 && c != 67);
    c = core::point_class::unassigned;
  }
  return cloud;
}

/// m from the box around the cloud, whose crops are rectangles.
double from_rim(const core::Block& b, size_t p, double east, double north) {
  return std::min({b.x[p], b.y[p], east - b.x[p], north - b.y[p]});
}

double percent(size_t part, size_t of) { return of == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of); }

TEST_P(RealCloud, GroundAgreesWithItsMakerUpToTheRim) {
  SWATH_SHARED_OR_SKIP(folder, "data");
  Labelled cloud = read(folder / GetParam().file);
  core::Block& b = cloud.block;
  filters::classify_ground(b, b.size(), {});
  const double east = *std::max_element(b.x.begin(), b.x.end()), north = *std::max_element(b.y.begin(), b.y.end());
  size_t judged = 0, wrong = 0, objects_at_rim = 0, taken_at_rim = 0;
  std::array<size_t, 10> count{}, ground{};
  std::array<double, 10> stated{};
  for (size_t p = 0; p < b.size(); ++p) {
    if (!cloud.counts[p]) continue;
    const bool said = b.classification[p] == core::point_class::ground;
    ++judged, wrong += said != cloud.is_ground[p];
    if (!cloud.is_ground[p] && from_rim(b, p, east, north) < 12.0) ++objects_at_rim, taken_at_rim += said;
    const double chance = b.ground_probability[p];
    if (!(chance >= 0.0)) continue;
    const auto decile = std::min<size_t>(9, static_cast<size_t>(10.0 * chance));
    ++count[decile], ground[decile] += cloud.is_ground[p], stated[decile] += chance;
  }
  ASSERT_GT(judged, 10000u);
  ASSERT_GT(objects_at_rim, 1000u);
  const double total = percent(wrong, judged), at_rim = percent(taken_at_rim, objects_at_rim);
  double gap = 0.0;
  for (size_t k = 0; k < count.size(); ++k)
    if (count[k] >= 200) gap = std::max(gap, std::abs(stated[k] - static_cast<double>(ground[k])) / static_cast<double>(count[k]));
  std::printf("%s: total %.2f %%, type II at the rim %.2f %%, probability within %.2f\n", GetParam().name, total, at_rim, gap);
  EXPECT_LE(total, GetParam().total);
  EXPECT_LE(at_rim, GetParam().at_rim);
  EXPECT_LE(gap, GetParam().gap);
}

INSTANTIATE_TEST_SUITE_P(Crops, RealCloud,
                         testing::Values(Cloud{"houses", "ign_lidarhd/test_data_77055_627755_LA93_IGN69.laz", 1.6, 1.5, 0.10},
                                         Cloud{"garden", "ign_lidarhd/test_data_77050_627760_LA93_IGN69.laz", 1.6, 1.5, 0.25},
                                         Cloud{"town", "ahn3_delft/ahn3_cropped_1.laz", 2.4, 2.0, 0.25}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace swath::stages
