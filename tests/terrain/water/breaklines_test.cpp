// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/breaklines.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "terrain/dtm.h"
#include "terrain/tin/tin_surface.h"
#include "tests/terrain/made.h"
#include "tests/terrain/tin/heights_at.h"

namespace swath::terrain {
namespace {

using core::BreaklineKind;
using core::Void;
using Eigen::Vector3d;

constexpr double millimetre = 1e-3;

/// Hills with a wall of 2 m along a slanting line.
double step(double x, double y) { return 40.0 + 3.0 * std::sin(x / 15.0) * std::cos(y / 12.0) + (y > 0.5 * x + 20.0 ? 2.0 : 0.0); }

SettledLine settled(BreaklineKind kind, std::vector<Vector3d> v, const std::string& place) {
  return {{kind, place, {std::move(v)}, true, 0.02}, false};
}

/// A breakline on the upper edge of the wall, one that crosses it at a common height, a lake and a river.
std::vector<SettledLine> world() {
  std::vector<SettledLine> out;
  std::vector<Vector3d> wall;
  for (double x = 2.0; x <= 78.0; x += 7.3) wall.emplace_back(x, 0.5 * x + 20.0, step(x, 0.5 * x + 20.001));
  const Vector3d on = wall[4];
  out.push_back(settled(BreaklineKind::breakline, wall, "wall"));
  out.push_back(settled(BreaklineKind::breakline, {{on.x() - 5.0, on.y() + 9.0, 43.3}, on, {on.x() + 6.0, on.y() - 11.0, 39.0}}, "stair"));
  out.push_back(settled(BreaklineKind::lake, {{50, 5, 37}, {70, 6, 37}, {66, 18, 37}, {52, 15, 37}}, "lake"));
  out.push_back(settled(BreaklineKind::river, {{5, 62, 39}, {40, 66, 38}, {75, 64, 37}, {75, 69, 37}, {40, 71, 38}, {5, 67, 39}}, "river"));
  core::Tally tally;
  for (auto& [line, derived] : out)
    if (line.is_water()) line = with_heights(line, {}, {}, tally);
  return out;
}

TEST(Breaklines, VerticesLieOnTheSurface) {
  const core::Block b = test::random_points(6000, 80.0, step, 11);
  const Breaklines lines(world(), {}, b.origin);
  DtmOptions o;
  const core::Lattice window{1.0, 500000, 4600000, 80, 80};
  const Constraints near = lines.near(window, halo(o));
  const Tin tin = triangulate(b, lines.kept(b, terrain_rows(b, o), near), near, 0.5 * o.max_edge.value);
  std::vector<double> x, y, z;
  for (const auto& [line, derived] : world())
    for (const auto& part : line.parts)
      for (const Vector3d& v : part) x.push_back(v.x()), y.push_back(v.y()), z.push_back(v.z());
  // Between the vertices of a line its straight height.
  const auto wall = world()[0].line.parts[0];
  for (size_t k = 1; k < wall.size(); ++k)
    for (const double t : {0.1, 0.37, 0.5, 0.81}) {
      const Vector3d p = wall[k - 1] + t * (wall[k] - wall[k - 1]);
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  const auto got = heights_at(tin, x, y);
  for (size_t k = 0; k < z.size(); ++k) EXPECT_NEAR(got[k], z[k], millimetre) << x[k] << ' ' << y[k];
  EXPECT_GE(tin.constrained.size(), near.edges.size());
}

TEST(Breaklines, LakeIsFlatAndRiverFalls) {
  const core::Block b = test::random_points(6000, 80.0, step, 11);
  const Breaklines lines(world(), {}, b.origin);
  const core::Lattice window{0.5, 1000000, 9200000, 160, 160};
  DtmOptions o;
  o.cell = core::Metres(0.5);
  const core::Grid g = dtm(b, window, o, &lines);
  int lake = 0, river = 0;
  double before = 100.0;
  for (int i = 0; i < window.nx; ++i) {
    const double x = window.centre_x(i) - b.origin.x();
    double here = 0;
    for (int j = 0; j < window.ny; ++j) {
      const double y = window.centre_y(j) - b.origin.y();
      const size_t at = window.at(i, j);
      if (x > 53 && x < 65 && y > 7 && y < 14) {
        ++lake;
        EXPECT_EQ(g.height[at], 37.0f);
        EXPECT_EQ(g.reason[at], Void::none);
        EXPECT_NEAR(static_cast<double>(g.sigma[at]), 0.02, 1e-6);
      }
      if (x > 8 && x < 72 && std::abs(y - (x < 40 ? 64.5 + 4.0 * (x - 5.0) / 35.0 : 68.5 - 2.0 * (x - 40.0) / 35.0)) < 0.3)
        here = static_cast<double>(g.height[at]);
    }
    if (here == 0) continue;
    ++river;
    EXPECT_LE(here, before);
    EXPECT_NEAR(here, 39.0 - 2.0 * (x - 5.0) / 70.0, 0.1);
    before = here;
  }
  EXPECT_GT(lake, 300);
  EXPECT_GT(river, 100);
}

TEST(Breaklines, SameBitsForEveryTiling) {
  DtmOptions o;
  o.max_edge = core::Metres(8.0);
  for (const core::Block& b :
       {test::random_points(9000, 80.0, step, 3), test::lattice_points(80, step), test::random_points(700, 80.0, step, 6)}) {
    auto features = world();
    features.push_back(settled(BreaklineKind::boundary, {{1, 1, 0}, {79, 3, 0}, {77, 78, 0}, {2, 70, 0}}, "edge"));
    const Breaklines lines(features, {}, b.origin);
    const core::Lattice window{1.0, 499996, 4599996, 88, 88};
    const core::Grid whole = dtm(b, window, o, &lines);
    EXPECT_EQ(whole.reason[window.at(4, 80)], Void::no_data);  // outside the boundary
    for (const int cells : {11, 29, 64}) {
      const core::Grid t =
          test::tiled(b, window, cells, halo(o), [&](const core::Block& p, const core::Lattice& w) { return dtm(p, w, o, &lines); });
      EXPECT_TRUE(test::same_bits(t.height, whole.height)) << cells;
      EXPECT_TRUE(test::same_bits(t.sigma, whole.sigma)) << cells;
      EXPECT_EQ(t.count, whole.count) << cells;
      EXPECT_EQ(t.reason, whole.reason) << cells;
    }
  }
}

TEST(Breaklines, TheWallIsSharpWithItsLines) {
  // Upper and lower edge, 2 cm apart in plan: the model follows both, where points alone smear the wall over their spacing.
  const core::Block b = test::random_points(6000, 80.0, step, 12);
  std::vector<Vector3d> upper, lower;
  for (double x = 0.0; x <= 80.0; x += 1.0) {
    upper.emplace_back(x, 0.5 * x + 20.01, step(x, 0.5 * x + 20.01));
    lower.emplace_back(x, 0.5 * x + 19.99, step(x, 0.5 * x + 19.99));
  }
  const Breaklines lines({settled(BreaklineKind::breakline, upper, "u"), settled(BreaklineKind::breakline, lower, "l")}, {}, b.origin);
  const core::Lattice window{1.0, 500005, 4600005, 70, 70};
  const auto rms = [&](const core::Grid& g) {
    double square = 0;
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const double e =
            static_cast<double>(g.height[window.at(i, j)]) - step(window.centre_x(i) - b.origin.x(), window.centre_y(j) - b.origin.y());
        square += e * e;
      }
    return std::sqrt(square / static_cast<double>(window.size()));
  };
  const double with = rms(dtm(b, window, {}, &lines)), without = rms(dtm(b, window, {}));
  EXPECT_GT(without, 0.1);
  EXPECT_LT(with, 0.03);
}

TEST(Breaklines, WaterOfUnknownHeightIsVoid) {
  const core::Block b = test::random_points(3000, 80.0, step, 13);
  core::Breakline lake{BreaklineKind::lake, "lake", {{{20, 20, 0}, {40, 20, 0}, {40, 40, 0}, {20, 40, 0}}}, false, 0.0};
  const Breaklines lines({{lake, true}}, {}, b.origin);
  const core::Lattice window{1.0, 500000, 4600000, 80, 80};
  const core::Grid g = dtm(b, window, {}, &lines);
  EXPECT_EQ(g.reason[window.at(30, 30)], Void::water);
  EXPECT_TRUE(std::isnan(g.height[window.at(30, 30)]));
  EXPECT_EQ(g.reason[window.at(50, 30)], Void::none);
}

TEST(Breaklines, WaterIsKnownAsWaterWithAndWithoutItsHeight) {
  const Eigen::Vector3d origin(500000, 4600000, 0);
  for (const bool known : {true, false}) {
    const core::Breakline lake{BreaklineKind::lake, "lake", {{{20, 20, 3}, {40, 20, 3}, {40, 40, 3}, {20, 40, 3}}}, known, 0.0};
    const Breaklines lines({{lake, true}}, {}, origin);
    EXPECT_TRUE(lines.is_water(500030, 4600030));
    EXPECT_FALSE(lines.is_water(500050, 4600030));
    EXPECT_TRUE(lines.any_water(500035, 4600035, 500090, 4600090));
    EXPECT_FALSE(lines.any_water(500045, 4600035, 500090, 4600090));
  }
}

TEST(Breaklines, PackedAndUnpackedTheyAreTheSame) {
  const auto before = world();
  const auto after = unpack(pack(before));
  ASSERT_EQ(after.size(), before.size());
  for (size_t k = 0; k < after.size(); ++k) {
    EXPECT_EQ(after[k].line.kind, before[k].line.kind);
    EXPECT_EQ(after[k].line.place, before[k].line.place);
    EXPECT_EQ(after[k].line.parts, before[k].line.parts);
    EXPECT_EQ(after[k].line.sigma, before[k].line.sigma);
    EXPECT_EQ(after[k].derived, before[k].derived);
  }
}

TEST(Breaklines, DamagedBytesAreToldWithTheirFile) {
  const std::string bytes = pack(world());
  const auto fault = [](const std::string& given) {
    try {
      unpack(given, "work/breaklines.settled");
    } catch (const core::Error& e) {
      return e.text();
    }
    return std::string("none");
  };
  for (const size_t n : {size_t{4}, size_t{100}, bytes.size() - 1}) {
    EXPECT_NE(fault(bytes.substr(0, n)).find("work/breaklines.settled"), std::string::npos) << n;
    EXPECT_NE(fault(bytes.substr(0, n)).find(".swath"), std::string::npos) << n;
  }
  std::string many = bytes;  // a number of lines that no memory holds
  many[6] = 0x7f;
  EXPECT_NE(fault(many).find("damaged"), std::string::npos);
}

TEST(Breaklines, CellsOutsideTheBoundaryStaySoWhateverIsSaidOfThemLater) {
  const core::Block b = test::random_points(3000, 80.0, step, 13);
  const core::Breakline boundary{BreaklineKind::boundary, "edge", {{{0, 0, 0}, {40, 0, 0}, {40, 80, 0}, {0, 80, 0}}}, false, 0.0};
  const Breaklines lines({{boundary, false}}, {}, b.origin);
  core::Grid g(core::Lattice{1.0, 500000, 4600000, 80, 80});
  std::fill(g.reason.begin(), g.reason.end(), Void::never_seen);
  lines.cut(g);
  EXPECT_EQ(g.reason[g.lattice.at(60, 40)], Void::no_data);
  EXPECT_EQ(g.reason[g.lattice.at(20, 40)], Void::never_seen);
}

}  // namespace
}  // namespace swath::terrain
