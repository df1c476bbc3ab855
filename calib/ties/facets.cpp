// SPDX-License-Identifier: GPL-3.0-or-later
// Region growing over cells in place of points (Vosselman et al., "Recognising structure in laser scanner point clouds", 2004): a cell's
// plane stands for its returns, so that 20 million returns grow in seconds. Planarity is judged within single lines, whose returns do not
// miss one another; the mismatch between lines does not hurt it.
#include "calib/ties/facets.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/statistics.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double least_width = 0.1;    // of a cell's side: narrower returns lie on one scan line
constexpr double least_wall = 0.3;     // the same of the neighbourhood of a wall's cell, three cells wide
constexpr double least_freedom = 6.0;  // of returns by which a cell is judged
constexpr double angle_slack = 0.05;   // rad between neighbouring cells beyond what their noise makes
constexpr double stands_out = 1.5;     // m above its surroundings: a roof
constexpr double surroundings = 8.0;   // m around a facet that are looked at for that
constexpr double square_pieces = 6.0;  // squares of the spread, in pieces
constexpr double level_share = 0.35;   // of the facets that level ground has if there are others enough
constexpr double wall_share = 0.25;

// A cell whose looks are each plane.
struct PlaneCell {
  CellIndex3 cell;
  std::uint32_t begin = 0, end = 0;  // looks
  std::uint32_t lines = 0;
  Vector3d centre, normal;
  double rms = 0.0, tilt_sigma = 0.0;
  bool used = false;
};

double slope_of(const Vector3d& normal) { return std::acos(std::min(std::abs(normal.z()), 1.0)); }

// A look of the growing facet: moments about the seed.
struct Growing {
  FacetLook look;
  Moments<double> moments;
};

Moments<double> moved(const Moments<float>& m, const Vector3d& by) {
  Moments<double> out;
  const Vector3d s = m.sum.cast<double>();
  const double n = m.n;
  out.n = m.n;
  out.sum = s + n * by;
  const auto product = [&](float ss, int a, int b) { return static_cast<double>(ss) + by[a] * s[b] + by[b] * s[a] + n * by[a] * by[b]; };
  out.xx = product(m.xx, 0, 0), out.xy = product(m.xy, 0, 1), out.xz = product(m.xz, 0, 2);
  out.yy = product(m.yy, 1, 1), out.yz = product(m.yz, 1, 2), out.zz = product(m.zz, 2, 2);
  return out;
}
void add(Moments<double>& to, const Moments<double>& m) {
  to.n += m.n, to.sum += m.sum;
  to.xx += m.xx, to.xy += m.xy, to.xz += m.xz, to.yy += m.yy, to.yz += m.yz, to.zz += m.zz;
}

class Grower {
 public:
  Grower(const PlaneCells& cells, const FacetOptions& o, core::Tally& tally) : cells_(cells), o_(o) {
    judge_cells(tally);
    for (std::uint32_t c = 0; c < plane_.size(); ++c) number_.emplace(key_of(plane_[c].cell), c);
  }

  std::vector<Facet> grow_all(core::Tally& tally) {
    std::vector<std::uint32_t> steep, level;
    for (std::uint32_t c = 0; c < plane_.size(); ++c) (slope_of(plane_[c].normal) < level_slope ? level : steep).push_back(c);
    std::sort(steep.begin(), steep.end(), [&](auto a, auto b) { return std::tuple(plane_[a].rms, a) < std::tuple(plane_[b].rms, b); });
    std::vector<Facet> out;
    std::uint64_t refused = 0;
    const auto grow = [&](std::uint32_t seed) {
      if (plane_[seed].used) return;
      if (auto f = grow_from(seed))
        out.push_back(std::move(*f));
      else
        ++refused;
    };
    for (const std::uint32_t c : steep) grow(c);
    for (const std::uint32_t c : level_seeds(level)) grow(c);
    tally.count("facets", out.size());
    if (refused) tally.count("facets refused: too small, rough, or of one line", refused);
    return out;
  }

 private:
  void judge_cells(core::Tally& tally) {
    std::uint64_t all = 0, lonely = 0, rough = 0;
    std::vector<PlaneCell> thin;
    for (std::uint32_t begin = 0, end = 0; begin < cells_.looks.size(); begin = end) {
      for (end = begin; end < cells_.looks.size() && cells_.looks[end].cell == cells_.looks[begin].cell;) ++end;
      ++all;
      PlaneCell c;
      c.cell = cells_.looks[begin].cell, c.begin = begin, c.end = end;
      Matrix3d scatter = Matrix3d::Zero();
      Vector3d sum = Vector3d::Zero();
      double n = 0.0, freedom = 0.0;
      for (std::uint32_t l = begin; l < end; ++l) {
        const Moments<float>& m = cells_.looks[l].moments;
        scatter += m.scatter();
        sum += m.sum.cast<double>();
        n += m.n, freedom += m.n - 1.0;
        c.lines += l == begin || cells_.looks[l].line != cells_.looks[l - 1].line;
      }
      c.centre = centre_of(c.cell, cells_.side) + sum / n;
      if (freedom < least_freedom) {
        thin.push_back(c);
        continue;
      }
      // Looks of one line tie it to itself (ahead and behind); cells of one look are kept for walls alone, where lines differ in height.
      const PlaneShape s = shape_of(scatter, freedom);
      if (end - begin < 2 && slope_of(s.normal) < wall_slope) {
        ++lonely;
        continue;
      }
      if (s.rms > o_.roughness || s.narrow < least_width * cells_.side) {
        ++rough;
        continue;
      }
      set_shape(c, s, freedom);
      plane_.push_back(c);
    }
    rough += o_.thin_walls ? judge_thin(thin) : thin.size();
    tally.count("cells", all);
    tally.count("cells refused: one line", lonely);
    tally.count("cells refused: not plane", rough);
  }

  static void set_shape(PlaneCell& c, const PlaneShape& s, double freedom) {
    c.normal = s.normal, c.rms = s.rms;
    c.tilt_sigma = std::max(s.rms, 0.02) / (std::sqrt(freedom) * s.narrow);
  }
  // A wall leaves few returns in a cell, all of them its own: such cells are judged with their neighbours of the same sort, and taken where
  // these lie on a wall. Returns the number of those that do not.
  std::uint64_t judge_thin(const std::vector<PlaneCell>& thin) {
    std::unordered_map<std::uint64_t, std::uint32_t> number;
    for (std::uint32_t k = 0; k < thin.size(); ++k) number.emplace(key_of(thin[k].cell), k);
    std::uint64_t others = 0;
    std::vector<Growing> near;
    for (PlaneCell c : thin) {
      near.clear();
      for (int d = 0; d < 27; ++d) {
        const auto at = number.find(key_of({c.cell.i + d % 3 - 1, c.cell.j + d / 3 % 3 - 1, c.cell.k + d / 9 - 1}));
        if (at != number.end()) take(near, thin[at->second], c.centre);
      }
      double freedom = 0.0;
      for (const Growing& g : near) freedom += g.moments.n - 1.0;
      const PlaneShape s = pooled(near);
      if (freedom < least_freedom || slope_of(s.normal) < wall_slope || s.rms > o_.roughness || s.narrow < least_wall * cells_.side) {
        ++others;
        continue;
      }
      set_shape(c, s, freedom);
      plane_.push_back(c);
    }
    return others;
  }

  // One level cell of each square: that of most lines, then the flattest.
  std::vector<std::uint32_t> level_seeds(const std::vector<std::uint32_t>& level) const {
    const double area = static_cast<double>(level.size()) * cells_.side * cells_.side;
    const double square = std::max(o_.piece, std::sqrt(area / (1.2 * static_cast<double>(o_.most))));
    std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> best;
    const auto better = [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(-static_cast<int>(plane_[a].lines), plane_[a].rms, a) <
             std::tuple(-static_cast<int>(plane_[b].lines), plane_[b].rms, b);
    };
    for (const std::uint32_t c : level) {
      const auto [at, fresh] = best.try_emplace({static_cast<std::int64_t>(std::floor(plane_[c].centre.x() / square)),
                                                 static_cast<std::int64_t>(std::floor(plane_[c].centre.y() / square))},
                                                c);
      if (!fresh && better(c, at->second)) at->second = c;
    }
    std::vector<std::uint32_t> out;
    for (const auto& [place, c] : best) out.push_back(c);
    return out;
  }

  // The look of `growing` that a cell's look continues, or none.
  static Growing* continued(std::vector<Growing>& growing, const CellLook& l) {
    for (Growing& g : growing)
      if (g.look.line == l.line && l.first < g.look.last + new_look && l.last > g.look.first - new_look) return &g;
    return nullptr;
  }
  void take(std::vector<Growing>& growing, const PlaneCell& c, const Vector3d& seed) const {
    for (std::uint32_t k = c.begin; k < c.end; ++k) {
      const CellLook& l = cells_.looks[k];
      Growing* g = continued(growing, l);
      if (!g) g = &growing.emplace_back(Growing{{l.line, l.first, l.last, 0}, {}});
      g->look.first = std::min(g->look.first, l.first), g->look.last = std::max(g->look.last, l.last);
      add(g->moments, moved(l.moments, centre_of(l.cell, cells_.side) - seed));
    }
  }
  static PlaneShape pooled(const std::vector<Growing>& growing) {
    Matrix3d scatter = Matrix3d::Zero();
    double freedom = 0.0;
    for (const Growing& g : growing) scatter += g.moments.scatter(), freedom += g.moments.n - 1.0;
    return shape_of(scatter, freedom);
  }
  // Does the cell continue the facet, line by line?
  bool continues(std::vector<Growing>& growing, const PlaneShape& shape, const PlaneCell& c, const Vector3d& seed) const {
    const double cosine = std::abs(shape.normal.dot(c.normal));
    if (std::acos(std::min(cosine, 1.0)) > 3.0 * c.tilt_sigma + angle_slack) return false;
    const double tolerance = 1.5 * o_.roughness;
    bool shared = false;
    for (std::uint32_t k = c.begin; k < c.end; ++k) {
      const CellLook& l = cells_.looks[k];
      const Growing* g = continued(growing, l);
      if (!g) continue;
      shared = true;
      const Vector3d at = centre_of(l.cell, cells_.side) + l.moments.mean() - seed;
      if (std::abs(shape.normal.dot(at - g->moments.mean())) > tolerance) return false;
    }
    return shared || std::abs(shape.normal.dot(c.centre - seed)) < tolerance + 2.0 * o_.mismatch;
  }

  std::optional<Facet> grow_from(std::uint32_t first) {
    const Vector3d seed = plane_[first].centre;
    std::vector<Growing> growing;
    std::vector<std::uint32_t> members;
    std::deque<std::uint32_t> waiting{first};
    PlaneShape shape;
    shape.normal = plane_[first].normal;
    const double reach = 0.5 * o_.piece;
    while (!waiting.empty()) {
      const std::uint32_t c = waiting.front();
      waiting.pop_front();
      if (plane_[c].used || (c != first && !continues(growing, shape, plane_[c], seed))) continue;
      plane_[c].used = true;
      members.push_back(c);
      take(growing, plane_[c], seed);
      shape = pooled(growing);
      const CellIndex3& at = plane_[c].cell;
      for (int d = 0; d < 27; ++d) {
        const auto next = number_.find(key_of({at.i + d % 3 - 1, at.j + d / 3 % 3 - 1, at.k + d / 9 - 1}));
        if (next == number_.end() || plane_[next->second].used) continue;
        Vector3d away = plane_[next->second].centre - seed;
        away -= shape.normal.dot(away) * shape.normal;
        if (away.norm() <= reach) waiting.push_back(next->second);
      }
    }
    return finished(growing, members, shape, seed);
  }

  std::optional<Facet> finished(std::vector<Growing>& growing, const std::vector<std::uint32_t>& members, const PlaneShape& shape,
                                const Vector3d& seed) const {
    const double tolerance = o_.roughness;
    const bool wall = slope_of(shape.normal) > wall_slope;
    std::vector<const Growing*> good;
    for (const Growing& g : growing) {
      if (g.moments.n < o_.returns) continue;
      const Vector3d& n = shape.normal;
      if (std::sqrt(std::max(n.dot(g.moments.scatter() * n), 0.0) / g.moments.n) <= tolerance) good.push_back(&g);
    }
    if (good.size() < (wall ? 1u : 2u)) return std::nullopt;
    Facet f;
    f.normal = shape.normal;
    f.slope = slope_of(shape.normal);
    // Extent from all its returns, as of an even spread.
    Matrix3d spread_of = Matrix3d::Zero();
    Vector3d sum = Vector3d::Zero();
    double n = 0.0;
    for (const Growing* g : good) spread_of += g->moments.scatter(), sum += g->moments.sum, n += g->moments.n;
    f.centre = seed + sum / n;
    const auto axes = plane_axes(f.normal);
    for (int k = 0; k < 2; ++k)
      f.half[k] = std::sqrt(3.0 * std::max(axes[static_cast<size_t>(k)].dot(spread_of * axes[static_cast<size_t>(k)]), 0.0) / n);
    if (f.half.minCoeff() < o_.extent) return std::nullopt;
    for (const Growing* g : good) {
      f.looks.push_back(g->look);
      f.looks.back().n = g->moments.n;
    }
    std::sort(f.looks.begin(), f.looks.end(),
              [](const FacetLook& a, const FacetLook& b) { return std::tie(a.line, a.first) < std::tie(b.line, b.first); });
    for (const std::uint32_t c : members) f.cells.push_back(plane_[c].cell);
    std::sort(f.cells.begin(), f.cells.end());
    return f;
  }

  const PlaneCells& cells_;
  const FacetOptions& o_;
  std::vector<PlaneCell> plane_;
  std::unordered_map<std::uint64_t, std::uint32_t> number_;
};

// Sloping facets that stand out of their surroundings are roofs.
void name_kinds(std::vector<Facet>& facets, const PlaneCells& cells) {
  std::unordered_map<std::uint64_t, float> lowest;
  for (const CellLook& l : cells.looks) {
    const auto z = static_cast<float>(centre_of(l.cell, cells.side).z() + l.moments.mean().z());
    const auto [at, fresh] = lowest.try_emplace(key_of({l.cell.i, l.cell.j, 0}), z);
    if (!fresh) at->second = std::min(at->second, z);
  }
  const int ring = static_cast<int>(std::ceil(surroundings / cells.side));
  for (Facet& f : facets) {
    f.kind = f.slope > wall_slope ? TieKind::wall : TieKind::ground;
    if (f.slope > wall_slope || f.slope < level_slope) continue;
    std::int32_t i0 = f.cells[0].i, i1 = i0, j0 = f.cells[0].j, j1 = j0;
    for (const CellIndex3& c : f.cells) i0 = std::min(i0, c.i), i1 = std::max(i1, c.i), j0 = std::min(j0, c.j), j1 = std::max(j1, c.j);
    std::vector<double> above;  // of the facet's plane over the ground around
    for (std::int32_t j = j0 - ring; j <= j1 + ring; ++j)
      for (std::int32_t i = i0 - ring; i <= i1 + ring; ++i) {
        if (i > i0 - 2 && i < i1 + 2 && j > j0 - 2 && j < j1 + 2) continue;
        const auto at = lowest.find(key_of({i, j, 0}));
        if (at == lowest.end()) continue;
        const Vector2d away = centre_of({i, j, 0}, cells.side).head<2>() - f.centre.head<2>();
        above.push_back(f.centre.z() - f.normal.head<2>().dot(away) / f.normal.z() - static_cast<double>(at->second));
      }
    if (core::median(std::move(above), 0.0) > stands_out) f.kind = TieKind::roof;
  }
}

}  // namespace

std::vector<Facet> spread(std::vector<Facet> facets, size_t most, double square) {
  if (facets.size() <= most) return facets;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<size_t>> squares;
  for (size_t k = 0; k < facets.size(); ++k)
    squares[{static_cast<std::int64_t>(std::floor(facets[k].centre.x() / square)),
             static_cast<std::int64_t>(std::floor(facets[k].centre.y() / square))}]
        .push_back(k);
  std::vector<std::tuple<size_t, std::uint64_t, size_t>> order;  // rank in its square, square's place in the draw, facet
  for (auto& [place, list] : squares) {
    std::sort(list.begin(), list.end(), [&](size_t a, size_t b) {
      return std::tuple(-static_cast<int>(facets[a].looks.size()), -facets[a].half.prod(), a) <
             std::tuple(-static_cast<int>(facets[b].looks.size()), -facets[b].half.prod(), b);
    });
    const std::uint64_t draw =
        mixed(static_cast<std::uint64_t>(place.first) * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(place.second));
    for (size_t rank = 0; rank < list.size(); ++rank) order.emplace_back(rank, draw, list[rank]);
  }
  std::sort(order.begin(), order.end());
  order.resize(most);
  std::vector<size_t> kept;
  for (const auto& [rank, draw, k] : order) kept.push_back(k);
  std::sort(kept.begin(), kept.end());
  std::vector<Facet> out;
  for (const size_t k : kept) out.push_back(std::move(facets[k]));
  return out;
}

std::vector<Facet> find_facets(const PlaneCells& cells, const FacetOptions& o, core::Tally& tally) {
  std::vector<Facet> all = Grower(cells, o, tally).grow_all(tally);
  name_kinds(all, cells);
  if (all.size() <= o.most) return all;
  std::vector<Facet> walls, slopes, level;
  for (Facet& f : all) (f.slope > wall_slope ? walls : f.slope < level_slope ? level : slopes).push_back(std::move(f));
  // Each has its share; what one does not need goes to the others, slopes first.
  const auto share = [&](double s) { return static_cast<size_t>(s * static_cast<double>(o.most)); };
  size_t n_level = std::min(level.size(), share(level_share)), n_wall = std::min(walls.size(), share(wall_share));
  const size_t n_slope = std::min(slopes.size(), o.most - n_level - n_wall);
  n_wall = std::min(walls.size(), o.most - n_level - n_slope);
  n_level = std::min(level.size(), o.most - n_wall - n_slope);
  const double square = square_pieces * o.piece;
  std::vector<Facet> out = spread(std::move(slopes), n_slope, square);
  for (auto* list : {&walls, &level})
    for (Facet& f : spread(std::move(*list), list == &walls ? n_wall : n_level, square)) out.push_back(std::move(f));
  tally.count("facets beyond the most planes", all.size() - out.size());
  return out;
}

}  // namespace swath::calib
