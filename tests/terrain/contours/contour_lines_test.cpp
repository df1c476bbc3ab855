// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/contour_lines.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "tests/terrain/lines.h"
#include "tests/terrain/made.h"
#include "tests/world/support.h"

namespace swath::terrain {
namespace {

using Vertices = std::vector<Eigen::Vector2d>;

std::vector<ContourLine> lines_on(const core::Grid& g, std::vector<Segment> segments, const ContourOptions& o) {
  Facets surface = test::facets_of(g);
  return contour_lines(std::move(segments), o, surface).lines;
}

bool same(const std::vector<ContourLine>& a, const std::vector<ContourLine>& b) {
  if (a.size() != b.size()) return false;
  for (size_t k = 0; k < a.size(); ++k)
    if (a[k].level != b[k].level || a[k].closed != b[k].closed || a[k].depression != b[k].depression || a[k].vertices != b[k].vertices)
      return false;
  return true;
}

TEST(ContourLines, ConeGivesOneCircleCounterClockwise) {
  const core::Grid g = test::sampled({1.0, 0, 0, 60, 60}, [](double x, double y) { return 20.0 - std::hypot(x - 30.2, y - 29.7); });
  ContourOptions o;
  o.tolerance = core::Metres(0.0);
  const auto lines = lines_on(g, trace(g, g.lattice, o), o);
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
  EXPECT_TRUE(pit[0].depression);

  g.height[g.lattice.at(20, 12)] = std::nanf("");  // on the first ring
  const auto cut = join(trace(g, g.lattice, o), o);
  ASSERT_FALSE(cut.empty());
  EXPECT_EQ(cut[0].level, 1);
  EXPECT_FALSE(cut[0].closed);
  for (const Eigen::Vector2d& end : {cut[0].vertices.front(), cut[0].vertices.back()})
    EXPECT_LT((end - Eigen::Vector2d(20.5, 12.5)).norm(), 1.5);
}

TEST(ContourLines, TouchedSummitsAreSpecksThatMinAreaLeavesOut) {
  core::Grid g = test::sampled({1.0, 0, 0, 9, 9}, [](double, double) { return 0.5; });
  g.height[g.lattice.at(4, 4)] = 1.0f;  // exactly on the level
  const ContourOptions o;
  const auto lines = join(trace(g, g.lattice, o), o);
  ASSERT_EQ(lines.size(), 1u);  // a ring round the very summit, a ten-thousandth of a cell wide
  EXPECT_LT(std::abs(signed_area(lines[0].vertices)), 1e-6);
  ContourOptions larger;
  larger.min_area = "1 m2";
  EXPECT_TRUE(lines_on(g, trace(g, g.lattice, larger), larger).empty());
}

TEST(ContourLines, TilesOrderAndDoublesDoNotMatter) {
  const auto hills = [](double x, double y) { return 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0) + 0.4 * std::sin(x * y); };
  const core::Grid g = test::sampled({1.0, 100, 200, 90, 70}, hills);
  ContourOptions o;
  o.min_length = core::Metres(3.0);
  o.min_area = "1.5 m2";
  o.tolerance = core::Metres(0.2);
  const std::vector<Segment> all = trace(g, g.lattice, o);
  const auto expected = lines_on(g, all, o);
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
  EXPECT_TRUE(same(lines_on(g, mixed, o), expected));

  std::vector<ContourLine> by_level;
  for (size_t k = 0; k < all.size();) {
    std::vector<Segment> one;
    for (const std::int64_t level = all[k].level; k < all.size() && all[k].level == level; ++k) one.push_back(all[k]);
    for (ContourLine& l : lines_on(g, one, o)) by_level.push_back(std::move(l));
  }
  EXPECT_TRUE(same(by_level, expected));
}

TEST(ContourLines, RingsBelowTheLeastAreaAreLeftOut) {
  // A cone and a pit: rings of radius 1 to 17 m round each.
  const core::Grid g = test::sampled({0.5, 0, 0, 180, 90}, [](double x, double y) {
    return x < 45.0 ? 17.7 - std::hypot(x - 22.3, y - 22.4) : std::hypot(x - 67.6, y - 22.1) - 17.7;
  });
  ContourOptions o;
  const auto smallest = [&](const std::string& area) {
    o.min_area = area;
    double least = 1e9;
    size_t depressions = 0;
    for (const ContourLine& l : lines_on(g, trace(g, g.lattice, o), o)) {
      if (l.closed) least = std::min(least, std::abs(signed_area(l.vertices)));
      EXPECT_EQ(l.depression, l.closed && l.vertices[0].x() > 45.0);
      depressions += l.depression;
    }
    EXPECT_GT(depressions, 10u);
    return least;
  };
  EXPECT_NEAR(smallest("0 m2"), core::pi * 0.7 * 0.7, 0.3);
  EXPECT_NEAR(smallest("10 m2"), core::pi * 2.7 * 2.7, 0.6);
  EXPECT_EQ(smallest("10 m2"), smallest("107.639 ft2"));
  EXPECT_EQ(smallest("10 m2"), smallest("0.001 ha"));
}

TEST(ContourLines, NoLineIsOpenInside) {
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0.0, 0.2);
  core::Grid g = test::sampled({1.0, 10, 20, 100, 80},
                               [&](double x, double y) { return 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0) + noise(random); });
  for (int n = 0; n < 40; ++n) g.height[static_cast<size_t>(random() % g.height.size())] = std::nanf("");
  ContourOptions o;
  o.interval = core::Metres(0.5);
  const auto lines = lines_on(g, trace(g, g.lattice, o), o);
  size_t open = 0;
  const auto is_known = [&](long i, long j) {
    return g.lattice.holds(static_cast<int>(i), static_cast<int>(j)) &&
           !std::isnan(g.height[g.lattice.at(static_cast<int>(i), static_cast<int>(j))]);
  };
  for (const ContourLine& l : lines) {
    if (l.closed) continue;
    ++open;
    for (const Eigen::Vector2d& end : {l.vertices.front(), l.vertices.back()}) {
      // A void, or nothing, at one of the centres around the end.
      const long i = std::lround(std::floor(end.x() - 10.5)), j = std::lround(std::floor(end.y() - 20.5));
      bool beside = false;
      for (long dj = -1; dj <= 2; ++dj)
        for (long di = -1; di <= 2; ++di) beside = beside || !is_known(i + di, j + dj);
      EXPECT_TRUE(beside) << end.transpose();
    }
  }
  EXPECT_GT(open, 20u);
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
  const auto ours = lines_on(g, trace(g, g.lattice, o), o);

  // Where the level halves an edge exactly, gdal_contour's vertex stands 1e-6 m of height beside it; over the DEM's gentler slope, 0.017,
  // that is 5.9e-5 m (24 of its 1122 vertices). Ours beside a centre are squeezed by up to 1e-4 of an edge. Between the edges that both
  // share, ours bend at the diagonals of the square: lengths agree to 1 %.
  const double vertex_shift = 6e-5 + 1e-4 * g.lattice.cell;
  constexpr double height_error = 1e-4, length_share = 0.01;
  std::map<double, std::vector<const Vertices*>> by_level;
  for (const auto& [level, v] : theirs) by_level[level].push_back(&v);
  EXPECT_EQ(ours.size(), theirs.size());
  double our_total = 0.0, their_total = 0.0, worst_height = 0.0, worst_shift = 0.0;
  for (const ContourLine& l : ours) {
    ASSERT_EQ(by_level[l.height].size(), 1u) << l.height;
    const Vertices& v = *by_level[l.height][0];
    EXPECT_EQ(l.closed, v.front() == v.back());
    const double a = length(l.vertices), b = length_within(v, g.lattice);
    EXPECT_NEAR(a, b, length_share * b) << l.height;
    our_total += a;
    their_total += b;
    for (const Eigen::Vector2d& p : l.vertices) {
      const double u = p.x() / g.lattice.cell - 0.5, w = p.y() / g.lattice.cell - 0.5;
      if (std::min(std::abs(u - std::round(u)), std::abs(w - std::round(w))) > 1e-7) continue;  // on a diagonal
      worst_height = std::max(worst_height, std::abs(bilinear(g, p) - l.height));
      double nearest = 1e9;
      for (const Eigen::Vector2d& q : v) nearest = std::min(nearest, (p - q).norm());
      worst_shift = std::max(worst_shift, nearest);
    }
  }
  EXPECT_LE(worst_height, height_error);
  EXPECT_LE(worst_shift, vertex_shift);
  EXPECT_NEAR(our_total, their_total, 0.002 * their_total);
  std::ostringstream figures;
  figures << ours.size() << " lines, length " << our_total << " m (gdal_contour " << their_total
          << " m within the cell centres), vertex heights within " << worst_height << " m, vertices within " << worst_shift << " m";
  RecordProperty("figures", figures.str());
  std::cout << "  " << figures.str() << "\n";
}

}  // namespace
}  // namespace swath::terrain
