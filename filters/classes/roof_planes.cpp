// SPDX-License-Identifier: GPL-3.0-or-later
// Planes by random sample consensus (Fischler & Bolles 1981), localised as in Schnabel, Wahl & Klein 2007 ("Efficient RANSAC for
// point-cloud shape detection"): around each cell of a lattice that is as fine as the returns allow, planes through one sampled return of
// the cell and two of the 3 x 3 cells around; the best of 24 is fitted by least squares and judged. Deviations: samples of at most four
// returns of a cell stand for all, so that the cost follows the area and not the returns (PCL's RANSAC over all returns of windows of 6 m
// took 28 % of the class filter's time at 14 returns/m2); the draws are those of a fixed sequence.
#include "filters/classes/roof_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/floor_div.h"
#include "core/parallel.h"
#include "core/wide.h"
#include "filters/bins.h"
#include "filters/classes/plane_samples.h"
#include "filters/classes/returns.h"

namespace swath::filters {
namespace {

constexpr int ring = 1;  // cells around a window's middle
constexpr size_t fullest = samples_of_cell * (2 * ring + 1) * (2 * ring + 1);
constexpr size_t fewest = 5;          // sampled returns of a plane
constexpr float least_share = 0.25f;  // of the window's candidates
constexpr float own_share = 0.5f;     // of all sampled returns over the hull of its ground plan that lie on it
constexpr float agreement = 0.3f;     // of the windows around a return that must have a plane through it
constexpr float most_turned = 0.2f;   // between the normals of planes of one surface, rad
constexpr int growth = 4;             // cells
constexpr double most_cells = 40.0;   // of 81 that a wide plane must cover
constexpr int fewest_cells = 3;       // of a wide plane
constexpr float last_share = 0.7f;    // of its returns that are last ones
constexpr float steepest2 = 3.0f;     // squared rise / run: 60 deg
constexpr int hypotheses = 24;
constexpr int planes_of_window = 3;
constexpr float rms_share = 0.6f;         // of the tolerance: points evenly spread within it have 0.58
constexpr float closeness = 0.65f;        // of the returns over a wide plane that lie within half the tolerance
constexpr float glass_rms = 1.0f / 3.0f;  // of the tolerance: leaves are rougher than glass
constexpr float glass_share = 0.8f;       // of the first returns over glass that lie on it
constexpr size_t glass_fewest = 9;        // sampled returns
constexpr double glass_area = 2.0;        // of the area that other planes need: clipped hedges and vans' windows are smaller
constexpr size_t rows_at_once = 4, points_at_once = 4096;  // of one thread
constexpr float least_triangle = 0.1f;                     // area in plan, of a cell's

/// z = level + east x + north y about the window's centre.
struct Plane {
  float level = 0, east = 0, north = 0;
  bool glass = false;  ///< beams pass it
  float close = 0;  ///< share of the returns over its ground plan within half the tolerance: of all, or of the first ones if that is more
  float above(float x, float y, float z) const { return z - (level + east * x + north * y); }
  float cosine() const { return 1.0f / std::sqrt(1.0f + east * east + north * north); }
};

SWATH_WIDE size_t count_within(const float* x, const float* y, const float* z, size_t n, const Plane& plane, float band) {
  std::int32_t count = 0;
  for (size_t k = 0; k < n; ++k) count += std::abs(plane.above(x[k], y[k], z[k])) <= band ? 1 : 0;
  return static_cast<size_t>(count);
}

struct Points {
  std::array<float, fullest> x, y, z;
  std::array<std::uint32_t, fullest> row;
  size_t n = 0;
  void add(float px, float py, float pz, std::uint32_t r) {
    x[n] = px, y[n] = py, z[n] = pz, row[n] = r;
    ++n;
  }
  size_t within(const Plane& plane, float band) const { return count_within(x.data(), y.data(), z.data(), n, plane, band); }
  Points on(const Plane& plane, float tolerance, bool is_on = true) const {
    Points out;
    const float band = tolerance / plane.cosine();
    for (size_t k = 0; k < n; ++k)
      if ((std::abs(plane.above(x[k], y[k], z[k])) <= band) == is_on) out.add(x[k], y[k], z[k], row[k]);
    return out;
  }
};

/// By least squares of heights.
Plane fit(const Points& p) {
  double x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  const double z0 = p.z[0], n = static_cast<double>(p.n);
  for (size_t k = 0; k < p.n; ++k) {
    const double px = p.x[k], py = p.y[k], pz = p.z[k] - z0;
    x += px, y += py, z += pz;
    xx += px * px, xy += px * py, yy += py * py, xz += px * pz, yz += py * pz;
  }
  x /= n, y /= n, z /= n;
  xx -= n * x * x, xy -= n * x * y, yy -= n * y * y, xz -= n * x * z, yz -= n * y * z;
  const double area = xx * yy - xy * xy;
  const double east = (xz * yy - yz * xy) / area, north = (yz * xx - xz * xy) / area;
  return {static_cast<float>(z - east * x - north * y + z0), static_cast<float>(east), static_cast<float>(north)};
}

float cross(float ax, float ay, float bx, float by) { return ax * by - ay * bx; }

/// Convex hull in plan, counter-clockwise (Andrew 1979).
class Hull {
 public:
  explicit Hull(const Points& p) {
    std::array<std::pair<float, float>, fullest> sorted;
    for (size_t k = 0; k < p.n; ++k) sorted[k] = {p.x[k], p.y[k]};
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(p.n));
    const auto chain = [&](auto&& at) {
      const size_t start = n_;
      for (size_t k = 0; k < p.n; ++k) {
        const auto [x, y] = at(k);
        while (n_ >= start + 2 && cross(x_[n_ - 1] - x_[n_ - 2], y_[n_ - 1] - y_[n_ - 2], x - x_[n_ - 2], y - y_[n_ - 2]) <= 0.0f) --n_;
        x_[n_] = x, y_[n_] = y;
        ++n_;
      }
      --n_;
    };
    chain([&](size_t k) { return sorted[k]; });
    chain([&](size_t k) { return sorted[p.n - 1 - k]; });
  }
  /// The border counts.
  bool holds(float x, float y) const {
    for (size_t k = 0, next = 1; k < n_; ++k, next = k + 1 < n_ ? k + 1 : 0)
      if (cross(x_[next] - x_[k], y_[next] - y_[k], x - x_[k], y - y_[k]) < 0.0f) return false;
    return true;
  }

 private:
  std::array<float, 2 * fullest> x_, y_;
  size_t n_ = 0;
};

/// The samples of a window: candidates of planes, and all.
class Window {
 public:
  Window(const core::Block& b, const Samples& samples, const std::vector<std::uint8_t>& candidate, int i, int j) : block_(b) {
    const auto side = static_cast<float>(samples.lattice().cell);
    least_area_ = least_triangle * side * side;
    const auto add = [&](int di, int dj) {
      for (const Samples::Sample& s : samples.in(i + di, j + dj)) {
        const float x = s.x + static_cast<float>(di) * side, y = s.y + static_cast<float>(dj) * side;
        all_.add(x, y, s.z, s.row);
        if (candidate[s.row]) left_.add(x, y, s.z, s.row);
      }
    };
    add(0, 0);
    own_ = left_.n;
    if (own_ == 0) return;
    for (int dj = -ring; dj <= ring; ++dj)
      for (int di = -ring; di <= ring; ++di)
        if (di != 0 || dj != 0) add(di, dj);
  }

  bool has_own() const { return own_ > 0; }

  /// The planes of the window that pass through its middle cell.
  void find(float tolerance, std::vector<Plane>& planes) {
    for (int k = 0; k < planes_of_window && own_ > 0 && left_.n >= fewest; ++k) {
      const size_t least = std::max(fewest, static_cast<size_t>(std::ceil(least_share * static_cast<float>(left_.n))));
      Plane plane;
      if (!consensus(tolerance, least, plane)) return;
      Points found = left_.on(plane, tolerance);
      plane = fit(found);
      found = left_.on(plane, tolerance);
      if (found.n < least) return;
      plane = fit(found);
      if (is_roof(found, plane, tolerance)) planes.push_back(plane);
      take_off(plane, tolerance);
    }
  }

 private:
  bool consensus(float tolerance, size_t least, Plane& best) {
    size_t most = least - 1;
    std::uint32_t state = 12345;
    const auto draw = [&state](size_t n) {
      state = state * 1664525u + 1013904223u;  // Knuth's; the upper half is used
      return static_cast<size_t>((std::uint64_t{state >> 8} * n) >> 24);
    };
    for (int h = 0; h < hypotheses; ++h) {
      const size_t a = static_cast<size_t>(h) % own_, b = draw(left_.n), c = draw(left_.n);
      const float bx = left_.x[b] - left_.x[a], by = left_.y[b] - left_.y[a], bz = left_.z[b] - left_.z[a];
      const float cx = left_.x[c] - left_.x[a], cy = left_.y[c] - left_.y[a], cz = left_.z[c] - left_.z[a];
      const float area = cross(bx, by, cx, cy);
      if (std::abs(area) < 2.0f * least_area_) continue;
      Plane p;
      p.east = cross(bz, by, cz, cy) / area, p.north = cross(bx, bz, cx, cz) / area;
      if (p.east * p.east + p.north * p.north > steepest2) continue;
      p.level = left_.z[a] - p.east * left_.x[a] - p.north * left_.y[a];
      const size_t n = left_.within(p, tolerance / p.cosine());
      if (n <= most) continue;
      most = n, best = p;
      if (n == left_.n) break;  // no other can have more
    }
    return most >= least;
  }

  /// Notes how closely the returns follow the plane.
  bool is_roof(const Points& found, Plane& plane, float tolerance) const {
    if (!(plane.east * plane.east + plane.north * plane.north <= steepest2)) return false;  // nor one through a line of returns
    float squares = 0;
    size_t last = 0;
    for (size_t k = 0; k < found.n; ++k) {
      const float off = plane.above(found.x[k], found.y[k], found.z[k]) * plane.cosine();
      squares += off * off;
      last += core::is_last_return(block_, found.row[k]);
    }
    const auto n = static_cast<float>(found.n);
    const float rms = std::sqrt(squares / n);
    if (rms > rms_share * tolerance) return false;
    plane.glass = static_cast<float>(last) < last_share * n;
    if (plane.glass && (found.n < glass_fewest || rms > glass_rms * tolerance)) return false;
    const auto [all, first] = over(found, plane, tolerance);
    plane.close = std::max(all.close, first.close);
    return plane.glass ? first.on >= glass_share : all.on >= own_share;
  }

  /// Shares of sampled returns.
  struct Over {
    float on = 0, close = 0;  ///< within the tolerance of the plane, within half of it
  };
  /// Of those over the hull of `found`: of all, and of the first ones.
  std::pair<Over, Over> over(const Points& found, const Plane& plane, float tolerance) const {
    const Hull hull(found);
    const float band = tolerance / plane.cosine();
    std::array<int, 2> n{}, on{}, close{};  // of later returns, of first ones
    for (size_t k = 0; k < all_.n; ++k) {
      if (!hull.holds(all_.x[k], all_.y[k])) continue;
      const float off = std::abs(plane.above(all_.x[k], all_.y[k], all_.z[k]));
      const size_t kind = is_first_return(block_, all_.row[k]) ? 1 : 0;
      ++n[kind], on[kind] += off <= band, close[kind] += off <= 0.5f * band;
    }
    const auto share = [](int part, int of) { return of == 0 ? 0.0f : static_cast<float>(part) / static_cast<float>(of); };
    return {{share(on[0] + on[1], n[0] + n[1]), share(close[0] + close[1], n[0] + n[1])}, {share(on[1], n[1]), share(close[1], n[1])}};
  }

  void take_off(const Plane& plane, float tolerance) {
    const float band = tolerance / plane.cosine();
    Points rest;
    size_t own = 0;
    for (size_t k = 0; k < left_.n; ++k) {
      if (std::abs(plane.above(left_.x[k], left_.y[k], left_.z[k])) <= band) continue;
      rest.add(left_.x[k], left_.y[k], left_.z[k], left_.row[k]);
      own += k < own_;
    }
    if (rest.n == left_.n) own = 0;  // nothing lies on it: the next round would find the same
    left_ = rest, own_ = own;
  }

  const core::Block& block_;
  Points all_, left_;
  size_t own_ = 0;  ///< the first of left_: those of the middle cell
  float least_area_ = 0;
};

/// The planes of the cells of one side, in the districts that have it.
class Planes {
 public:
  Planes(const core::Block& b, const std::vector<std::uint8_t>& candidate, const Districts& where, size_t level, float tolerance,
         double area)
      : samples_(b, lattice_around(b, candidate, sample_sides[level], sample_border)),
        side_(static_cast<float>(lattice().cell)),
        start_(lattice().size() + 1, 0) {
    looked_.assign(lattice().size(), 0);
    find(b, candidate, where, level, tolerance);
    wide_.assign(planes_.size(), 0);
    const int cells = std::max(fewest_cells, static_cast<int>(std::ceil(std::min(area / (lattice().cell * lattice().cell), most_cells))));
    core::in_parallel(static_cast<size_t>(lattice().ny), rows_at_once, [&](size_t from, size_t to) {
      for (int j = std::max(static_cast<int>(from), growth); j < std::min(static_cast<int>(to), lattice().ny - growth); ++j)
        for (int i = growth; i < lattice().nx - growth; ++i)
          for (std::uint32_t k = first(i, j); k < last(i, j); ++k) wide_[k] = is_wide(planes_[k], i, j, cells, tolerance);
    });
  }

  /// Share of the windows around that have a plane through return p, of those that planes were looked for in; and of wide planes.
  struct Share {
    float any = 0, wide = 0;
  };
  Share share(const core::Block& b, size_t p, float tolerance) const {
    const core::Lattice& l = lattice();
    const CellIndex c = cell_of(l, b, p);
    const auto x = static_cast<float>(b.origin.x() + b.x[p] - l.centre_x(c.i)),
               y = static_cast<float>(b.origin.y() + b.y[p] - l.centre_y(c.j)), z = static_cast<float>(b.z[p]);
    int looked = 0, any = 0, wide = 0;
    for (int dj = -ring; dj <= ring; ++dj)
      for (int di = -ring; di <= ring; ++di) {
        looked += looked_[l.at(c.i + di, c.j + dj)];
        bool is_any = false, is_wide = false;
        for (std::uint32_t k = first(c.i + di, c.j + dj); k < last(c.i + di, c.j + dj); ++k) {
          const float above = planes_[k].above(x - static_cast<float>(di) * side_, y - static_cast<float>(dj) * side_, z);
          if (std::abs(above) * planes_[k].cosine() > tolerance) continue;
          is_any = true;
          is_wide = is_wide || wide_[k];
        }
        any += is_any, wide += is_wide;
      }
    if (looked == 0) return {};
    return {static_cast<float>(any) / static_cast<float>(looked), static_cast<float>(wide) / static_cast<float>(looked)};
  }

 private:
  const core::Lattice& lattice() const { return samples_.lattice(); }
  std::uint32_t first(int i, int j) const { return start_[lattice().at(i, j)]; }
  std::uint32_t last(int i, int j) const { return start_[lattice().at(i, j) + 1]; }

  void find(const core::Block& b, const std::vector<std::uint8_t>& candidate, const Districts& where, size_t level, float tolerance) {
    const core::Lattice& l = lattice();
    const auto cells = static_cast<std::int64_t>(std::lround(district_side / l.cell));
    std::vector<std::vector<Plane>> of_row(static_cast<size_t>(l.ny));
    core::in_parallel(of_row.size(), rows_at_once, [&](size_t from, size_t to) {
      for (int j = static_cast<int>(from); j < static_cast<int>(to); ++j)
        for (int i = 0; i < l.nx; ++i) {
          if (samples_.in(i, j).empty()) continue;
          const int u = static_cast<int>(core::floor_div(l.i0 + i, cells) - where.lattice.i0),
                    v = static_cast<int>(core::floor_div(l.j0 + j, cells) - where.lattice.j0);
          if (where.side[where.lattice.at(u, v)] != level) continue;
          std::vector<Plane>& planes = of_row[static_cast<size_t>(j)];
          const size_t before = planes.size();
          Window window(b, samples_, candidate, i, j);
          looked_[l.at(i, j)] = window.has_own();
          window.find(tolerance, planes);
          start_[l.at(i, j) + 1] = static_cast<std::uint32_t>(planes.size() - before);
        }
    });
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    for (const std::vector<Plane>& planes : of_row) planes_.insert(planes_.end(), planes.begin(), planes.end());
  }

  /// Do the planes of enough cells around, connected with (i, j), continue the plane, and do the returns follow them closely on average?
  bool is_wide(const Plane& plane, int i, int j, int cells, float tolerance) const {
    const int enough = plane.glass ? static_cast<int>(std::ceil(std::min(glass_area * cells, most_cells))) : cells;
    constexpr int width = 2 * growth + 1;
    std::array<std::uint8_t, static_cast<size_t>(width) * width> seen{};
    std::array<CellIndex, static_cast<size_t>(width) * width> found;
    const auto local = [](int di, int dj) { return static_cast<size_t>(dj + growth) * width + static_cast<size_t>(di + growth); };
    size_t n = 1;
    found[0] = {0, 0};
    seen[local(0, 0)] = 1;
    float close = plane.close;
    for (size_t k = 0; k < n; ++k) {
      if (static_cast<int>(k) + 1 >= enough) return close >= closeness * static_cast<float>(n);
      for (int dj = std::max(found[k].j - 1, -growth); dj <= std::min(found[k].j + 1, growth); ++dj)
        for (int di = std::max(found[k].i - 1, -growth); di <= std::min(found[k].i + 1, growth); ++di) {
          std::uint8_t& known = seen[local(di, dj)];
          const Plane* const next = known ? nullptr : continued(plane, i, j, di, dj, tolerance);
          if (next == nullptr) continue;
          known = 1;
          close += next->close;
          found[n++] = {di, dj};
        }
    }
    return false;
  }

  /// The plane of cell (i + di, j + dj) that continues one of (i, j); null where there is none.
  const Plane* continued(const Plane& plane, int i, int j, int di, int dj, float tolerance) const {
    for (std::uint32_t k = first(i + di, j + dj); k < last(i + di, j + dj); ++k) {
      const Plane& next = planes_[k];
      const float off =
          next.above(0, 0, plane.level + plane.east * static_cast<float>(di) * side_ + plane.north * static_cast<float>(dj) * side_);
      const float east = next.east - plane.east, north = next.north - plane.north;
      const float cosine = plane.cosine();
      if (std::abs(off) * cosine <= tolerance &&
          (east * east + north * north) * cosine * cosine * cosine * cosine <= most_turned * most_turned)
        return &next;
    }
    return nullptr;
  }

  Samples samples_;
  float side_;
  std::vector<std::uint32_t> start_;  // per cell, of planes_
  std::vector<std::uint8_t> looked_;  // per cell: it has candidates
  std::vector<Plane> planes_;
  std::vector<std::uint8_t> wide_;
};

}  // namespace

double planar_points_halo() { return Districts::halo() + (2.0 * ring + growth + 1) * sample_sides.back(); }

std::vector<Planar> planar_points(const core::Block& b, const std::vector<std::uint8_t>& candidate, const Districts& where,
                                  double tolerance, double area) {
  std::vector<Planar> planar(b.size(), Planar::none);
  if (std::find(candidate.begin(), candidate.end(), 1) == candidate.end()) return planar;
  const auto within = static_cast<float>(tolerance);
  for (size_t level = 0; level < sample_sides.size(); ++level) {
    if (std::find(where.side.begin(), where.side.end(), level) == where.side.end()) continue;
    const Planes planes(b, candidate, where, level, within, area);
    core::in_parallel(b.size(), points_at_once, [&](size_t from, size_t to) {
      for (size_t p = from; p < to; ++p) {
        if (!candidate[p]) continue;
        const Planes::Share share = planes.share(b, p, within);
        planar[p] = std::max(planar[p], share.wide >= agreement ? Planar::wide : share.any >= agreement ? Planar::some : Planar::none);
      }
    });
  }
  return planar;
}

}  // namespace swath::filters
