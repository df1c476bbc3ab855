// SPDX-License-Identifier: GPL-3.0-or-later
// Rusu, Marton, Blodow, Dolha & Beetz 2008, "Towards 3D point cloud based object maps for household environments", Robotics and Autonomous
// Systems 56, section 3.2: mean distance to the k nearest neighbours, outliers beyond mean + multiplier * standard deviation.
//
// Deviations.
// - Mean and standard deviation are those of the 3 x 3 cells of the survey's lattice around the point's own (cells of a third of
//   `window`), not of the whole cloud: the result does not depend on tiles, and sparse strips are not judged by dense ones. In a window of
//   n points both are uncertain by about 1 / sqrt(2 n) of the standard deviation (5 % for 200 points).
// - Sums are of whole multiples of 2^-12 m (0.24 mm), so that they do not depend on the order of the points.
// - Neighbours farther than `reach` count as lying there: distances are bounded, and with them the weight of an outlier in the window.
// - Below min_distance nothing is an outlier: in an aerial survey the spread of distances on open ground is so small that wires, which
//   are sampled along one line only, lie beyond any multiple of it.
#include "filters/noise/outlier.h"

#include <algorithm>
#include <cmath>

#include "filters/bins.h"
#include "filters/noise/point_groups.h"

namespace swath::filters {
namespace {

constexpr double resolution = 0x1p12;  // per m
constexpr int cells_of_window = 3;

/// Number, sum and sum of squares of distances in units of 1 / resolution.
struct Sums {
  std::uint64_t n = 0, sum = 0, square = 0;
  void add(std::uint64_t v) {
    ++n;
    sum += v;
    square += v * v;
  }
  void add(const Sums& o) {
    n += o.n;
    sum += o.sum;
    square += o.square;
  }
  double threshold(double multiplier) const {
    const auto count = static_cast<double>(n);
    const double mean = static_cast<double>(sum) / count;
    return mean + multiplier * std::sqrt(std::max(0.0, static_cast<double>(square) / count - mean * mean));
  }
};

std::uint64_t quantum(double metres) { return static_cast<std::uint64_t>(std::llround(metres * resolution)); }

/// 1 for the cells of the rows' points and those around them.
std::vector<std::uint8_t> cells_around(const core::Block& b, const std::vector<std::uint32_t>& rows, const core::Lattice& l) {
  std::vector<std::uint8_t> mine(l.size(), 0), out(l.size(), 0);
  for (const std::uint32_t p : rows) {
    const CellIndex c = cell_of(l, b, p);
    mine[l.at(c.i, c.j)] = 1;
  }
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      if (!mine[l.at(i, j)]) continue;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di)
          if (l.holds(i + di, j + dj)) out[l.at(i + di, j + dj)] = 1;
    }
  return out;
}

std::vector<Sums> around(const std::vector<Sums>& cells, const core::Lattice& l) {
  std::vector<Sums> out(cells.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di)
          if (l.holds(i + di, j + dj)) out[l.at(i, j)].add(cells[l.at(i + di, j + dj)]);
  return out;
}

/// Rows of the statistical outliers among the first `own`.
std::vector<std::uint32_t> statistical(const core::Block& b, size_t own, const std::vector<std::uint8_t>& usable, const OutlierOptions& o) {
  const core::Lattice l = lattice_around(b, outlier_cell(o), 0);
  std::vector<std::uint32_t> judged;
  for (std::uint32_t p = 0; p < own; ++p)
    if (usable[p]) judged.push_back(p);
  const std::vector<std::uint8_t> needed = cells_around(b, judged, l);
  std::vector<std::uint32_t> cell(b.size(), 0);
  std::vector<std::uint8_t> wanted(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    const CellIndex c = cell_of(l, b, p);
    cell[p] = static_cast<std::uint32_t>(l.at(c.i, c.j));
    wanted[p] = usable[p] && needed[cell[p]];
  }
  const std::vector<double> mean = mean_neighbour_distance(b, usable, wanted, o.mean_k, o.reach.value);
  std::vector<Sums> sums(l.size());
  for (size_t p = 0; p < b.size(); ++p)
    if (wanted[p]) sums[cell[p]].add(quantum(mean[p]));
  sums = around(sums, l);
  std::vector<double> threshold(l.size(), 0.0);
  for (size_t c = 0; c < l.size(); ++c)
    if (sums[c].n > 0) threshold[c] = std::max(sums[c].threshold(o.multiplier), static_cast<double>(quantum(o.min_distance.value)));
  std::vector<std::uint32_t> rows;
  for (size_t p = 0; p < own; ++p)
    if (usable[p] && (mean[p] >= o.reach.value || static_cast<double>(quantum(mean[p])) > threshold[cell[p]]))
      rows.push_back(static_cast<std::uint32_t>(p));
  return rows;
}

/// Do more of the points of the columns around lie above the point than below?
bool is_low(const Bins& columns, const core::Block& b, size_t p) {
  const core::Lattice& l = columns.lattice();
  const CellIndex c = cell_of(l, b, p);
  std::int64_t above = 0;
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di)
      for (const Bins::Point& q : columns.in(c.i + di, c.j + dj)) above += (q.z > b.z[p]) - (q.z < b.z[p]);
  return above > 0;
}

void set_noise(core::Block& b, size_t p, bool low) {
  b.flags[p] = static_cast<std::uint16_t>(b.flags[p] | (low ? core::flag::low_point : core::flag::isolated));
  b.classification[p] = low ? core::point_class::low_noise : core::point_class::high_noise;
}

}  // namespace

double outlier_cell(const OutlierOptions& o) { return o.window.value / cells_of_window; }

double halo(const OutlierOptions& o) {
  const double statistics = 2.0 * o.window.value / cells_of_window + o.reach.value;
  return std::max({statistics, 2.0 * o.reach.value, o.group > 0 ? lone_points_halo(o.gap.value) : 0.0});
}

OutlierCounts flag_outliers(core::Block& b, size_t own, const OutlierOptions& o) {
  OutlierCounts n;
  core::add_columns(b, {core::Column::classification, core::Column::flags});
  if (own == 0) return n;
  std::vector<std::uint8_t> usable(b.size());
  for (size_t p = 0; p < b.size(); ++p) usable[p] = core::is_usable(b, p);
  n.untouched = static_cast<std::uint64_t>(std::count(usable.begin(), usable.begin() + static_cast<std::ptrdiff_t>(own), 0));

  const std::vector<std::uint32_t> outliers = statistical(b, own, usable, o);
  const std::vector<LonePoint> lone = lone_points(b, usable, o.gap.value, o.group);
  if (!outliers.empty()) {
    const core::Lattice l = lattice_around(b, o.reach.value, 1);
    const std::vector<std::uint8_t> near = cells_around(b, outliers, l);
    const Bins columns(b, o.reach.value, 1, [&](size_t p) {
      const CellIndex c = cell_of(l, b, p);
      return usable[p] && near[l.at(c.i, c.j)];
    });
    for (const std::uint32_t p : outliers) set_noise(b, p, is_low(columns, b, p));
  }
  n.statistical = outliers.size();
  for (const LonePoint& p : lone) {
    if (p.row >= own) break;
    set_noise(b, p.row, !p.above);
    ++n.grouped;
  }
  for (size_t p = 0; p < own; ++p) {
    if (!usable[p]) continue;
    n.low_noise += b.classification[p] == core::point_class::low_noise;
    n.high_noise += b.classification[p] == core::point_class::high_noise;
  }
  return n;
}

}  // namespace swath::filters
