// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contour_lines.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "tests/terrain/made.h"
#include "tests/world/support.h"

namespace swath::terrain {
namespace {

using Vertices = std::vector<Eigen::Vector2d>;

double signed_area(const Vertices& v) {
  double sum = 0.0;
  for (size_t k = 1; k < v.size(); ++k) {
    const Eigen::Vector2d a = v[k - 1] - v[0], b = v[k] - v[0];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

bool same(const std::vector<ContourLine>& a, const std::vector<ContourLine>& b) {
  if (a.size() != b.size()) return false;
  for (size_t k = 0; k < a.size(); ++k)
    if (a[k].level != b[k].level || a[k].closed != b[k].closed || a[k].vertices != b[k].vertices) return false;
  return true;
}

TEST(ContourLines, ConeGivesOneCircleCounterClockwise) {
  const core::Grid g = test::sampled({1.0, 0, 0, 60, 60}, [](double x, double y) { return 20.0 - std::hypot(x - 30.2, y - 29.7); });
  ContourOptions o;
  o.tolerance = core::Metres(0.0);
  const auto lines = contour_lines(trace(g, g.lattice, o), o);
  std::map<std::int64_t, const ContourLine*> closed;
  for (const ContourLine& l : lines)
    if (l.closed) {
      EXPECT_TRUE(closed.emplace(l.level, &l).second);
      EXPECT_EQ(l.vertices.front(), l.vertices.back());
      EXPECT_EQ(l.is_index, l.level % 5 == 0);
    }
  for (int level = 0; level <= 17; ++level) {
    ASSERT_TRUE(closed.count(level)) << level;
    const double r = 20.0 - level;
    // A chord of at most sqrt(2) m cuts (chord^2 / 8r) off the circle; interpolation along edges adds the same again.
    const double sagitta = 2.0 * 2.0 / (8.0 * r);
    EXPECT_NEAR(length(closed[level]->vertices), 2.0 * core::pi * r, 2.0 * core::pi * sagitta);
    EXPECT_GT(signed_area(closed[level]->vertices), 0.0);
  }
}

TEST(ContourLines, PitIsClockwiseAndOpenLinesEndAtTheEdgeOrAVoid) {
  core::Grid g = test::sampled({1.0, 0, 0, 40, 40}, [](double x, double y) { return std::hypot(x - 20.3, y - 20.1); });
  ContourOptions o;
  o.interval = core::Metres(7.3);
  const auto pit = join(trace(g, g.lattice, o), o);
  ASSERT_FALSE(pit.empty());
  ASSERT_TRUE(pit[0].closed);
  EXPECT_LT(signed_area(pit[0].vertices), 0.0);

  g.height[g.lattice.at(20, 12)] = std::nanf("");  // on the first ring
  const auto cut = join(trace(g, g.lattice, o), o);
  ASSERT_FALSE(cut.empty());
  EXPECT_EQ(cut[0].level, 1);
  EXPECT_FALSE(cut[0].closed);
  for (const Eigen::Vector2d& end : {cut[0].vertices.front(), cut[0].vertices.back()})
    EXPECT_LT((end - Eigen::Vector2d(20.5, 12.5)).norm(), 1.5);
}

TEST(ContourLines, TouchedSummitsLeaveNoSpecks) {
  core::Grid g = test::sampled({1.0, 0, 0, 9, 9}, [](double, double) { return 0.5; });
  g.height[g.lattice.at(4, 4)] = 1.0f;  // exactly on the level: a ring of no length
  const ContourOptions o;
  EXPECT_EQ(trace(g, g.lattice, o).size(), 4u);
  EXPECT_TRUE(join(trace(g, g.lattice, o), o).empty());
}

TEST(ContourLines, TilesOrderAndDoublesDoNotMatter) {
  const auto hills = [](double x, double y) { return 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0) + 0.4 * std::sin(x * y); };
  const core::Grid g = test::sampled({1.0, 100, 200, 90, 70}, hills);
  ContourOptions o;
  o.min_length = core::Metres(3.0);
  o.tolerance = core::Metres(0.2);
  const std::vector<Segment> all = trace(g, g.lattice, o);
  const auto expected = contour_lines(all, o);
  EXPECT_GT(expected.size(), 20u);
  for (const ContourLine& l : expected) EXPECT_GT(l.vertices.size(), 1u);
  std::vector<Segment> mixed;
  for (int tj = 0; tj < 70; tj += 13)
    for (int ti = 0; ti < 90; ti += 17) {
      const auto part = trace(g, {1.0, 100 + ti, 200 + tj, 17, 13}, o);
      mixed.insert(mixed.end(), part.begin(), part.end());
    }
  EXPECT_EQ(mixed.size(), all.size());
  mixed.insert(mixed.end(), all.begin(), all.begin() + 50);
  std::shuffle(mixed.begin(), mixed.end(), std::mt19937(3));
  EXPECT_TRUE(same(contour_lines(mixed, o), expected));

  std::vector<ContourLine> by_level;
  for (size_t k = 0; k < all.size();) {
    std::vector<Segment> one;
    for (const std::int64_t level = all[k].level; k < all.size() && all[k].level == level; ++k) one.push_back(all[k]);
    for (ContourLine& l : contour_lines(one, o)) by_level.push_back(std::move(l));
  }
  EXPECT_TRUE(same(by_level, expected));
}

TEST(ContourLines, SimplificationStaysWithinToleranceAndKeepsEnds) {
  Vertices v;
  for (int k = 0; k <= 400; ++k) v.emplace_back(0.25 * k, 5.0 * std::sin(0.05 * k) + 0.02 * std::sin(3.0 * k));
  for (const double tolerance : {0.05, 0.5}) {
    const Vertices s = simplify(v, false, tolerance);
    EXPECT_EQ(s.front(), v.front());
    EXPECT_EQ(s.back(), v.back());
    EXPECT_LT(s.size(), v.size() / 2);
    for (const Eigen::Vector2d& p : v) {
      double nearest = 1e9;
      for (size_t k = 1; k < s.size(); ++k) {
        const Eigen::Vector2d d = s[k] - s[k - 1];
        const double t = std::clamp((p - s[k - 1]).dot(d) / d.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (p - s[k - 1] - t * d).norm());
      }
      EXPECT_LE(nearest, tolerance);
    }
  }
  EXPECT_EQ(simplify(v, false, 0.0).size(), v.size());
  EXPECT_EQ(simplify(v, false, 100.0).size(), 2u);
}

TEST(ContourLines, ASimplifiedRingStaysARing) {
  Vertices ring;
  for (int k = 0; k <= 60; ++k) ring.emplace_back(std::cos(2 * core::pi * (k % 60) / 60), std::sin(2 * core::pi * (k % 60) / 60));
  for (const double tolerance : {0.01, 0.5, 10.0}) {
    const Vertices s = simplify(ring, true, tolerance);
    EXPECT_GE(s.size(), 4u);
    EXPECT_EQ(s.front(), s.back());
    EXPECT_GT(signed_area(s), 0.5);
  }
}

// --- against gdal_contour ---------------------------------------------------------------------------------------------------------

core::Grid read_ascii_grid(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string key;
  int nx = 0, ny = 0;
  double west = 0, south = 0, cell = 0, no_data = 0;
  in >> key >> nx >> key >> ny >> key >> west >> key >> south >> key >> cell >> key >> no_data;
  core::Grid g(core::Lattice{cell, core::cell_index(west, cell), core::cell_index(south, cell), nx, ny});
  for (int j = ny - 1; j >= 0; --j)
    for (int i = 0; i < nx; ++i) in >> g.height[g.lattice.at(i, j)];
  return g;
}

// The lines of gdal_contour's GeoJSON: "elev":L ... "coordinates":[[x,y],...].
std::vector<std::pair<double, Vertices>> read_gdal_lines(const std::string& text) {
  std::vector<std::pair<double, Vertices>> out;
  for (size_t at = text.find("\"elev\":"); at != std::string::npos; at = text.find("\"elev\":", at + 1)) {
    Vertices v;
    const size_t begin = text.find("\"coordinates\":[", at) + 15, end = text.find("]]", begin);
    std::string numbers = text.substr(begin, end - begin);
    for (char& c : numbers)
      if (c == '[' || c == ']' || c == ',') c = ' ';
    std::istringstream in(numbers);
    for (double x = 0, y = 0; in >> x >> y;) v.emplace_back(x, y);
    out.emplace_back(std::strtod(text.c_str() + at + 7, nullptr), v);
  }
  return out;
}

// Length of a line inside the rectangle of cell centres: gdal_contour prolongs lines by the last half cell with the border's heights.
double length_within(const Vertices& v, const core::Lattice& l) {
  constexpr double touch = 1e-6;
  double sum = 0.0;
  const auto inside = [&](const Eigen::Vector2d& p) {
    return p.x() > l.centre_x(0) - touch && p.x() < l.centre_x(l.nx - 1) + touch && p.y() > l.centre_y(0) - touch &&
           p.y() < l.centre_y(l.ny - 1) + touch;
  };
  for (size_t k = 1; k < v.size(); ++k)
    if (inside(v[k - 1]) && inside(v[k])) sum += (v[k] - v[k - 1]).norm();
  return sum;
}

double bilinear(const core::Grid& g, const Eigen::Vector2d& p) {
  const core::Lattice& l = g.lattice;
  const double u = p.x() / l.cell - static_cast<double>(l.i0) - 0.5, v = p.y() / l.cell - static_cast<double>(l.j0) - 0.5;
  const int i = std::clamp(static_cast<int>(std::floor(u)), 0, l.nx - 2), j = std::clamp(static_cast<int>(std::floor(v)), 0, l.ny - 2);
  const auto h = [&](int a, int b) { return static_cast<double>(g.height[l.at(i + a, j + b)]); };
  const double s = u - i, t = v - j;
  return (1 - s) * (1 - t) * h(0, 0) + s * (1 - t) * h(1, 0) + (1 - s) * t * h(0, 1) + s * t * h(1, 1);
}

TEST(ContourLines, AgreesWithGdal) {
  SWATH_SHARED_OR_SKIP(folder, "data/contour_gdal");
  const core::Grid g = read_ascii_grid(folder / "input-dem.asc");
  const auto theirs = read_gdal_lines(test::read_bytes(folder / "contour-gdal.geojson"));
  ContourOptions o;
  o.interval = core::Metres(0.5);
  o.tolerance = core::Metres(0.0);
  const auto ours = contour_lines(trace(g, g.lattice, o), o);

  // Where the level halves an edge exactly, gdal_contour's vertex stands 1e-6 m of height beside it; over the DEM's gentler slope, 0.017,
  // that is 5.9e-5 m (24 of its 1122 vertices). All others agree to 1e-7 m.
  constexpr double vertex_shift = 6e-5, height_error = 1e-9;
  std::map<double, std::vector<const Vertices*>> by_level;
  for (const auto& [level, v] : theirs) by_level[level].push_back(&v);
  EXPECT_EQ(ours.size(), theirs.size());
  double our_total = 0.0, their_total = 0.0, worst_height = 0.0, worst_shift = 0.0;
  for (const ContourLine& l : ours) {
    ASSERT_EQ(by_level[l.height].size(), 1u) << l.height;
    const Vertices& v = *by_level[l.height][0];
    EXPECT_EQ(l.closed, v.front() == v.back());
    const double a = length(l.vertices), b = length_within(v, g.lattice);
    EXPECT_NEAR(a, b, vertex_shift * static_cast<double>(l.vertices.size())) << l.height;
    our_total += a;
    their_total += b;
    for (const Eigen::Vector2d& p : l.vertices) {
      worst_height = std::max(worst_height, std::abs(bilinear(g, p) - l.height));
      double nearest = 1e9;
      for (const Eigen::Vector2d& q : v) nearest = std::min(nearest, (p - q).norm());
      worst_shift = std::max(worst_shift, nearest);
    }
  }
  EXPECT_LE(worst_height, height_error);
  EXPECT_LE(worst_shift, vertex_shift);
  EXPECT_NEAR(our_total, their_total, 1e-3);
  std::ostringstream figures;
  figures << ours.size() << " lines, length " << our_total << " m (gdal_contour " << their_total
          << " m within the cell centres), vertex heights within " << worst_height << " m, vertices within " << worst_shift << " m";
  RecordProperty("figures", figures.str());
  std::cout << "  " << figures.str() << "\n";
}

}  // namespace
}  // namespace swath::terrain
