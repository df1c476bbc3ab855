// SPDX-License-Identifier: GPL-3.0-or-later
// Of what is known of lasers over water (Höfle, Vetter, Pfeifer, Mandlburger & Stötter 2009, "Water surface mapping from airborne laser
// scanning using signal intensity and elevation data", Earth Surface Processes and Landforms 34): specular reflection leaves few returns
// away from the nadir, and these lie in one level surface below its shores. Intensities, which need calibration, are not used.
//
// 1. Sparse returns: around them their own flight line has far fewer last returns than is usual in the 160 m around (the density that
//    half of its returns there have at most: voids do not pull it down).
// 2. From each square of 12 m with sparse returns the water at their level is grown by plots of 4 m, over gaps of one plot, within `reach`.
// 3. It is water where enough sparse returns lie in it, those there lie in one plane, the plane is level, and what is around is not lower
//    (a dark flat roof's surroundings are). The plane's slope has a prior of 0.001, that of rivers: few returns leave it level.
// 4. Near the nadir all pulses come back. A water that lies there altogether shows by its form: ground's returns in one plane, level
//    within 0.001, with rising ground all around. Squares whose plots lie at one level start it.
// 5. Returns in the plots within three sigma of the plane are water; in the plots of the shore, which rises, up to one and a half above it.
#include "filters/classes/water.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/floor_div.h"
#include "core/statistics.h"
#include "filters/bins.h"
#include "filters/classes/level_plane.h"
#include "filters/noise/sparse_returns.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr double plot = 4.0;              // m
constexpr int seed_plots = 3;             // a side of the squares that water is grown from
constexpr int link = 2;                   // plots
constexpr double level_share = 0.7;       // of a plot's last returns, and of the sparse returns in and around the water
constexpr double lower_share = 0.25;      // of the plots around
constexpr double least_band = 0.06;       // m: three sigma of a good scanner
constexpr double most_waves = 1.0 / 3.0;  // of `level`: standard deviation of the returns about the plane
constexpr size_t least_closed = 12;       // plots, some 200 m2
constexpr double closed_slope = 0.001;    // rise / run; courts and pitches are laid out with 0.005 to 0.01
constexpr double closed_distance = 0.03;  // m: rms of the plots' means about the plane
constexpr double hollow = 0.01;           // m
constexpr double known_share = 0.9;       // of the plots 4 to 12 m beyond the shore that must have returns
constexpr double rising_share = 0.7;      // of these that must lie above the water: a shore may be marshy
constexpr double outlet_share = 0.25;     // of these that may lie below it: behind a dam, one side
constexpr double lowest_share = 0.1;      // of a plot's last returns that may be low outliers
constexpr size_t fewest_on_land = 3;      // returns of a plot that shows whether the land rises
constexpr double dense = 0.5;             // of the usual density
constexpr double dense_distance = 0.05;   // m: mean and rms of a dense plot's returns about the plane

class Plots {
 public:
  Plots(const core::Block& b, const WaterOptions& o)
      : block_(b),
        options_(o),
        bins_(b, plot, sparse_circle, [&b](size_t p) { return core::is_usable(b, p) && core::is_last_return(b, p); }),
        sparse_(lattice().size()),
        heights_(lattice().size()),
        ground_(lattice().size(), 0),
        all_(lattice().size()),
        thin_(lattice().size()),
        thin_returns_(sparse_returns(b, bins_, o.sparse)) {
    for (int j = 0; j < lattice().ny; ++j)
      for (int i = 0; i < lattice().nx; ++i) {
        std::vector<double>& z = heights_[lattice().at(i, j)];
        for (const Bins::Point& p : bins_.in(i, j)) z.push_back(p.z);
        std::sort(z.begin(), z.end());
        for (const std::uint32_t row : bins_.rows(i, j)) ground_[lattice().at(i, j)] += b.classification[row] == cls::ground;
      }
    forms_.reserve(lattice().size());
    for (int j = 0; j < lattice().ny; ++j)
      for (int i = 0; i < lattice().nx; ++i) forms_.push_back(form_of(i, j));
    for (int j = 0; j < lattice().ny; ++j)
      for (int i = 0; i < lattice().nx; ++i) {
        const auto points = bins_.in(i, j);
        const auto rows = bins_.rows(i, j);
        for (size_t k = 0; k < points.size(); ++k)
          if (thin_returns_.sparse[rows[k]]) sparse_[lattice().at(i, j)].emplace_back(points[k].x, points[k].y, points[k].z);
      }
  }

  const core::Lattice& lattice() const { return bins_.lattice(); }

  /// Grows and judges the water at every square with sparse returns, and at every plot that is level with those around.
  void find_water() {
    const core::Lattice& l = lattice();
    constexpr int half = seed_plots / 2;
    const auto is_middle = [](std::int64_t k) { return k - core::floor_div(k, seed_plots) * seed_plots == half; };
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        if (is_middle(l.i0 + i) && is_middle(l.j0 + j)) {
          std::vector<double> z;
          for (int dj = -half; dj <= half; ++dj)
            for (int di = -half; di <= half; ++di)
              if (l.holds(i + di, j + dj))
                for (const Eigen::Vector3d& s : sparse_[l.at(i + di, j + dj)]) z.push_back(s.z());
          if (!z.empty()) judge_sparse(i, j, core::median(std::move(z)));
        }
        if (is_level(i, j)) judge_closed(i, j, middle(l.at(i, j)));
      }
  }

  /// Is the return of plot c a water's?
  bool is_water(size_t c, size_t row) const {
    return all_[c].holds(block_.z[row]) || (thin_returns_.sparse[row] && thin_[c].holds(block_.z[row]));
  }

 private:
  double middle(size_t c) const { return heights_[c][heights_[c].size() / 2]; }

  /// Do the plots around lie in one level plane, by their medians?
  bool is_level(int i, int j) const {
    double low = std::numeric_limits<double>::infinity(), high = -low, east = 0, north = 0;
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!lattice().holds(i + di, j + dj) || heights_[lattice().at(i + di, j + dj)].empty()) return false;
        const double z = middle(lattice().at(i + di, j + dj));
        low = std::min(low, z), high = std::max(high, z);
        east += di * z / (6.0 * plot), north += dj * z / (6.0 * plot);
      }
    return high - low <= dense_distance && std::hypot(east, north) <= 2.0 * closed_slope;
  }

  /// Last returns of the plot within `level` of z.
  size_t level_returns(size_t c, double z) const {
    const std::vector<double>& h = heights_[c];
    return static_cast<size_t>(std::upper_bound(h.begin(), h.end(), z + options_.level.value) -
                               std::lower_bound(h.begin(), h.end(), z - options_.level.value));
  }

  /// The plots around (i, j) that are connected at one level, and those beside them. Indices are relative to (i, j).
  struct Region {
    int i = 0, j = 0, radius = 0;
    double level = 0;
    std::vector<CellIndex> water, shore;
    std::vector<std::uint8_t> distance;  // from the water, by local(): 0 water, else at most `far`

    static constexpr std::uint8_t far = 4;
    size_t local(int di, int dj) const {
      return static_cast<size_t>(dj + radius) * static_cast<size_t>(2 * radius + 1) + static_cast<size_t>(di + radius);
    }
  };

  bool inside(const Region& r, int di, int dj) const {
    return std::max(std::abs(di), std::abs(dj)) <= r.radius && lattice().holds(r.i + di, r.j + dj);
  }
  size_t plot_of(const Region& r, const CellIndex& at) const { return lattice().at(r.i + at.i, r.j + at.j); }

  Region none_at(int i, int j, double level) const {
    Region r{i, j, static_cast<int>(std::ceil(options_.reach.value / plot)), level, {}, {}, {}};
    const auto side = static_cast<size_t>(2 * r.radius + 1);
    r.distance.assign(side * side, Region::far);
    return r;
  }

  template <class Member>
  Region grow(int i, int j, double level, int gap, Member&& is_member) const {
    Region r = none_at(i, j, level);
    const auto take = [&](int di, int dj) {
      if (!inside(r, di, dj) || r.distance[r.local(di, dj)] == 0 || !is_member(lattice().at(i + di, j + dj))) return;
      r.distance[r.local(di, dj)] = 0;
      r.water.push_back({di, dj});
    };
    for (int dj = -(seed_plots / 2); dj <= seed_plots / 2; ++dj)
      for (int di = -(seed_plots / 2); di <= seed_plots / 2; ++di) take(di, dj);
    for (size_t k = 0; k < r.water.size(); ++k) {
      const CellIndex from = r.water[k];
      for (int dj = -gap; dj <= gap; ++dj)
        for (int di = -gap; di <= gap; ++di) take(from.i + di, from.j + dj);
    }
    for (const CellIndex& w : r.water)
      for (int dj = 1 - Region::far; dj < Region::far; ++dj)
        for (int di = 1 - Region::far; di < Region::far; ++di) {
          if (!inside(r, w.i + di, w.j + dj)) continue;
          std::uint8_t& d = r.distance[r.local(w.i + di, w.j + dj)];
          const auto here = static_cast<std::uint8_t>(std::max(std::abs(di), std::abs(dj)));
          if (here < d) {
            if (here == 1) r.shore.push_back({w.i + di, w.j + dj});
            d = here;
          }
        }
    return r;
  }

  /// Would what grow() finds come within two plots of the edge? Goes straight for it: level land is plots by the thousand.
  template <class Member>
  bool goes_on(int i, int j, double level, Member&& is_member) const {
    Region r = none_at(i, j, level);  // its distances: 0 where it was
    std::vector<CellIndex>& open = r.water;
    const auto take = [&](int di, int dj) {
      if (!inside(r, di, dj) || r.distance[r.local(di, dj)] == 0) return;
      r.distance[r.local(di, dj)] = 0;
      if (is_member(lattice().at(i + di, j + dj))) open.push_back({di, dj});
    };
    const auto is_near_edge = [&](const CellIndex& at) {
      constexpr int near = Region::far - 2;
      if (std::max(std::abs(at.i), std::abs(at.j)) + near < r.radius) return false;
      for (int dj = -near; dj <= near; ++dj)
        for (int di = -near; di <= near; ++di)
          if (std::max(std::abs(at.i + di), std::abs(at.j + dj)) == r.radius && inside(r, at.i + di, at.j + dj)) return true;
      return false;
    };
    for (int dj = -(seed_plots / 2); dj <= seed_plots / 2; ++dj)
      for (int di = -(seed_plots / 2); di <= seed_plots / 2; ++di) take(di, dj);
    while (!open.empty()) {
      const CellIndex from = open.back();
      open.pop_back();
      if (is_near_edge(from)) return true;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) take(from.i + di, from.j + dj);
    }
    return false;
  }

  bool is_at_level(size_t c, double level) const {
    const size_t n = level_returns(c, level);
    return n > 0 && static_cast<double>(n) >= level_share * static_cast<double>(heights_[c].size());
  }

  /// Water that few pulses come back from.
  void judge_sparse(int i, int j, double level) {
    const Region r = grow(i, j, level, link, [&](size_t c) { return is_at_level(c, level); });
    std::vector<Eigen::Vector3d> returns;
    size_t all = 0;
    for (const auto* plots : {&r.water, &r.shore})
      for (const CellIndex& at : *plots)
        for (const Eigen::Vector3d& s : sparse_[plot_of(r, at)]) {
          ++all;
          if (std::abs(s.z() - level) <= options_.level.value) returns.push_back(s);
        }
    if (static_cast<int>(returns.size()) < options_.returns || static_cast<double>(returns.size()) < level_share * static_cast<double>(all))
      return;
    size_t lower = 0, known = 0;
    for (const CellIndex& at : r.shore) {
      const std::vector<double>& z = heights_[plot_of(r, at)];
      if (z.empty()) continue;
      ++known;
      lower += middle(plot_of(r, at)) < level - options_.level.value;
    }
    if (static_cast<double>(lower) > lower_share * static_cast<double>(known)) return;
    const auto found = level_plane(returns, options_.slope, options_.slope);
    if (found && found->sigma <= most_waves * options_.level.value) mark(r, *found);
  }

  /// Water that all pulses come back from: a level plane of ground's returns with rising ground all around.
  void judge_closed(int i, int j, double level) {
    const auto is_member = [&](size_t c) {
      return is_at_level(c, level) && static_cast<double>(ground_[c]) >= level_share * static_cast<double>(heights_[c].size()) &&
             is_smooth(c, level, 0.0);
    };
    if (goes_on(i, j, level, is_member)) return;
    const Region r = grow(i, j, level, 1, is_member);
    if (r.water.size() < least_closed) return;
    std::vector<Eigen::Vector3d> means;
    double squares = 0, n = 0, rim = 0, rim_plots = 0, interior = 0, interior_plots = 0;
    for (const CellIndex& at : r.water) {
      const size_t c = plot_of(r, at);
      double sum = 0, count = 0;
      for (const double z : heights_[c])
        if (std::abs(z - level) <= options_.level.value) sum += z, ++count;
      const double mean = sum / count;
      for (const double z : heights_[c])
        if (std::abs(z - level) <= options_.level.value) squares += (z - mean) * (z - mean);
      n += count;
      (is_interior(r, at) ? interior : rim) += mean;
      ++(is_interior(r, at) ? interior_plots : rim_plots);
      means.emplace_back(lattice().centre_x(r.i + at.i) - block_.origin.x(), lattice().centre_y(r.j + at.j) - block_.origin.y(), mean);
    }
    auto found = level_plane(means, closed_slope, closed_slope);
    if (!found || found->sigma > closed_distance) return;
    // A hollow's rim is higher than its middle.
    if (interior_plots == 0 || rim / rim_plots - interior / interior_plots > hollow) return;
    found->sigma = std::sqrt(squares / n);
    size_t rising = 0, lower = 0, known = 0, ring = 0;
    for (int dj = -r.radius; dj <= r.radius; ++dj)
      for (int di = -r.radius; di <= r.radius; ++di) {
        const std::uint8_t d = r.distance[r.local(di, dj)];
        if (d == Region::far || d < 2) continue;
        ++ring;
        if (!lattice().holds(r.i + di, r.j + dj)) continue;
        const std::vector<double>& z = heights_[plot_of(r, {di, dj})];
        if (z.size() < fewest_on_land) continue;
        ++known;
        const double above = z[static_cast<size_t>(lowest_share * static_cast<double>(z.size()))] - level,
                     band = std::max(3.0 * found->sigma, least_band);
        rising += above > band;
        lower += above < -band;
      }
    if (static_cast<double>(known) >= known_share * static_cast<double>(ring) &&
        static_cast<double>(rising) >= rising_share * static_cast<double>(known) &&
        static_cast<double>(lower) <= outlet_share * static_cast<double>(known))
      mark(r, *found);
  }

  bool is_interior(const Region& r, const CellIndex& at) const {
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di)
        if (!inside(r, at.i + di, at.j + dj) || r.distance[r.local(at.i + di, at.j + dj)] != 0) return false;
    return true;
  }

  void mark(const Region& r, const LevelPlane& found) {
    const double band = std::max(3.0 * found.sigma, least_band);
    const auto height = [&](const CellIndex& at) {
      return found.at(lattice().centre_x(r.i + at.i) - block_.origin.x(), lattice().centre_y(r.j + at.j) - block_.origin.y());
    };
    // Plots that are water all over; then those beside them, where what is dense is land unless dense water is next to it.
    std::vector<std::uint8_t> certain(r.distance.size(), 0), beside(r.distance.size(), 0);
    constexpr std::uint8_t thin = 1, thick = 2;
    for (const CellIndex& at : r.water)
      if (is_smooth(plot_of(r, at), height(at), found.sigma)) certain[r.local(at.i, at.j)] = is_dense(plot_of(r, at)) ? thick : thin;
    for (const CellIndex& at : r.water) {
      const std::uint8_t kind = certain[r.local(at.i, at.j)];
      if (kind == 0) continue;
      const size_t c = plot_of(r, at);
      all_[c].add(height(at) - band, height(at) + band);
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          if (!inside(r, at.i + di, at.j + dj) || certain[r.local(at.i + di, at.j + dj)]) continue;
          std::uint8_t& known = beside[r.local(at.i + di, at.j + dj)];
          if (known >= kind) continue;
          known = kind;
          const CellIndex to{at.i + di, at.j + dj};
          (kind == thick ? all_ : thin_)[plot_of(r, to)].add(height(to) - band, height(to) + 0.5 * band);
        }
    }
  }

  bool is_dense(size_t c) const { return static_cast<double>(heights_[c].size()) >= dense * thin_returns_.usual[c]; }

  /// Dense plots must follow the water closely and be level themselves: flat land beside it is not.
  bool is_smooth(size_t c, double z, double sigma) const {
    return !is_dense(c) ||
           (forms_[c].level && std::abs(forms_[c].mean - z) <= closed_distance && forms_[c].sigma <= std::max(2.0 * sigma, dense_distance));
  }

  /// The plane of a plot's returns about their median.
  struct Form {
    bool level = false;
    double mean = 0, sigma = 0;
  };
  Form form_of(int i, int j) const {
    const size_t c = lattice().at(i, j);
    if (heights_[c].size() < fewest_on_land) return {};
    const double z = middle(c);
    std::vector<Eigen::Vector3d> points;
    for (const Bins::Point& p : bins_.in(i, j))
      if (std::abs(p.z - z) <= options_.level.value) points.emplace_back(p.x, p.y, p.z);
    const auto plane = level_plane(points, options_.slope, std::numeric_limits<double>::infinity());
    return plane ? Form{true, plane->centre.z(), plane->sigma} : Form{};
  }

  /// Heights from `low` to `high`.
  struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    void add(double from, double to) { low = std::min(low, from), high = std::max(high, to); }
    bool holds(double z) const { return z >= low && z <= high; }
  };

  const core::Block& block_;
  const WaterOptions& options_;
  Bins bins_;
  std::vector<std::vector<Eigen::Vector3d>> sparse_;  // per plot
  std::vector<std::vector<double>> heights_;          // of the last returns per plot, ascending
  std::vector<std::uint32_t> ground_;                 // of these of class ground
  std::vector<Form> forms_;
  std::vector<Range> all_, thin_;  // of water per plot: of all returns, of sparse ones
  SparseReturns thin_returns_;
};

}  // namespace

double halo(const WaterOptions& o) {
  const double grown = 2.0 * (std::ceil(o.reach.value / plot) + seed_plots + 1.0);
  return (grown + 1.0 + sparse_returns_reach) * plot;
}

WaterCounts classify_water(core::Block& b, size_t own, const WaterOptions& o) {
  WaterCounts n;
  if (own == 0) return n;
  core::add_columns(b, {core::Column::classification});
  Plots plots(b, o);
  plots.find_water();
  for (size_t p = 0; p < own; ++p) {
    const std::uint8_t before = b.classification[p];
    const bool may = before == cls::ground || before == cls::unassigned || before == cls::never_classified;
    if (!may || !core::is_usable(b, p) || !core::is_last_return(b, p)) continue;
    const CellIndex at = cell_of(plots.lattice(), b, p);
    if (!plots.is_water(plots.lattice().at(at.i, at.j), p)) continue;
    b.classification[p] = cls::water;
    ++n.water;
    n.ground += before == cls::ground;
  }
  return n;
}

}  // namespace swath::filters
