// SPDX-License-Identifier: GPL-3.0-or-later
// A thin plate as sums of squared second differences, z_xx^2 + 2 z_xy^2 + z_yy^2 (Briggs 1974, "Machine contouring using minimum
// curvature", with the twist beside the two bends), over every stencil that reaches an open cell. Heights at places enter as
// bilinear means of four cells. Parts that no stencil joins are solved apart, each by a sparse Cholesky factorization.
#include "terrain/contours/least_bending.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "core/error.h"

namespace swath::terrain {
namespace {

constexpr int reach_of_stencil = 2;      // cells: open cells this near to one another are of one part
constexpr double weight_of_known = 100;  // of a squared misfit beside a squared second difference
constexpr double weight_before = 1e-8;   // of the height before, which alone decides where the rest leaves it open

/// One weighted cell of an equation.
struct Term {
  int i, j;
  double weight;
};

/// The equations of one part.
class Plate {
 public:
  Plate(core::Grid& grid, const std::vector<std::int32_t>& unknown_of, const std::vector<std::uint8_t>& open, size_t count)
      : grid_(grid), unknown_of_(unknown_of), open_(open), right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count))) {}

  /// sum of weight * height = value, as a least squares equation; left out where it reaches no unknown or a cell without a height.
  void add(std::initializer_list<Term> terms, double value, double weight) {
    std::array<std::pair<std::int32_t, double>, 4> of{};
    size_t n = 0;
    for (const Term& t : terms) {
      if (!grid_.lattice.holds(t.i, t.j)) return;
      const size_t c = grid_.lattice.at(t.i, t.j);
      if (std::isnan(grid_.height[c])) return;
      if (open_[c])
        of[n++] = {unknown_of_[c], t.weight};
      else
        value -= t.weight * static_cast<double>(grid_.height[c]);
    }
    for (size_t a = 0; a < n; ++a) {
      right_[of[a].first] += weight * of[a].second * value;
      for (size_t b = 0; b < n; ++b)
        if (of[b].first <= of[a].first) normal_.emplace_back(of[a].first, of[b].first, weight * of[a].second * of[b].second);
    }
  }

  /// All second differences about the cell.
  void bend(int i, int j) {
    add({{i - 1, j, 1.0}, {i, j, -2.0}, {i + 1, j, 1.0}}, 0.0, 1.0);
    add({{i, j - 1, 1.0}, {i, j, -2.0}, {i, j + 1, 1.0}}, 0.0, 1.0);
    add({{i, j, 1.0}, {i + 1, j, -1.0}, {i, j + 1, -1.0}, {i + 1, j + 1, 1.0}}, 0.0, 2.0);
  }

  Eigen::VectorXd solution() const {
    Eigen::SparseMatrix<double> normal(right_.size(), right_.size());
    normal.setFromTriplets(normal_.begin(), normal_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(normal);
    if (factors.info() != Eigen::Success)
      throw core::Error("the equations of a flat part have no solution", "", "this is a fault of the program");
    return factors.solve(right_);
  }

 private:
  core::Grid& grid_;
  const std::vector<std::int32_t>& unknown_of_;
  const std::vector<std::uint8_t>& open_;
  Eigen::VectorXd right_;
  std::vector<Eigen::Triplet<double>> normal_;
};

/// South-west of the four cells around a place, and how far east and north of its centre the place lies, in cells.
struct Among {
  int i, j;
  double u, v;
};
Among among(const core::Lattice& l, const Eigen::Vector3d& p) {
  const double x = p.x() / l.cell - 0.5 - static_cast<double>(l.i0), y = p.y() / l.cell - 0.5 - static_cast<double>(l.j0);
  return {static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)), x - std::floor(x), y - std::floor(y)};
}

using Cell = std::pair<int, int>;

/// Open cells that stencils join, from one of them; takes their marks.
std::vector<Cell> part_from(Cell first, const core::Grid& grid, const std::vector<std::uint8_t>& open, std::vector<std::uint8_t>& waiting) {
  std::vector<Cell> part{first};
  waiting[grid.lattice.at(first.first, first.second)] = 0;
  for (size_t k = 0; k < part.size(); ++k)
    for (int j = part[k].second - reach_of_stencil; j <= part[k].second + reach_of_stencil; ++j)
      for (int i = part[k].first - reach_of_stencil; i <= part[k].first + reach_of_stencil; ++i)
        if (grid.lattice.holds(i, j) && open[grid.lattice.at(i, j)] && waiting[grid.lattice.at(i, j)]) {
          waiting[grid.lattice.at(i, j)] = 0;
          part.emplace_back(i, j);
        }
  return part;
}

/// Cells about whose middle a second difference reaches the part, each once.
std::vector<Cell> stencils_of(const std::vector<Cell>& part) {
  std::vector<Cell> out;
  for (const auto& [i, j] : part)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) out.emplace_back(i + di, j + dj);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

FilledParts fill_by_least_bending(core::Grid& grid, const std::vector<std::uint8_t>& open_cells, const std::vector<Eigen::Vector3d>& known,
                                  size_t most, std::vector<std::uint8_t>& filled) {
  const core::Lattice& l = grid.lattice;
  std::vector<std::uint8_t> open = open_cells;
  for (size_t c = 0; c < open.size(); ++c) open[c] = open[c] && !std::isnan(grid.height[c]);
  filled.assign(open.size(), 0);
  std::vector<std::uint32_t> order;  // of the known heights, by the south-west cell of the four around
  std::vector<size_t> cell_of_known(known.size(), l.size());
  for (size_t k = 0; k < known.size(); ++k) {
    const Among a = among(l, known[k]);
    if (!l.holds(a.i, a.j) || !l.holds(a.i + 1, a.j + 1)) continue;
    cell_of_known[k] = l.at(a.i, a.j);
    order.push_back(static_cast<std::uint32_t>(k));
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair{cell_of_known[a], a} < std::pair{cell_of_known[b], b};
  });
  FilledParts out;
  std::vector<std::int32_t> unknown_of(l.size(), -1);
  std::vector<std::uint8_t> waiting = open;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      if (!waiting[l.at(i, j)]) continue;
      const std::vector<Cell> part = part_from({i, j}, grid, open, waiting);
      if (part.size() > most) {
        ++out.parts_left, out.cells_left += part.size();
        continue;
      }
      for (size_t k = 0; k < part.size(); ++k) unknown_of[l.at(part[k].first, part[k].second)] = static_cast<std::int32_t>(k);
      Plate plate(grid, unknown_of, open, part.size());
      for (const auto& [a, b] : part) plate.add({{a, b, 1.0}}, static_cast<double>(grid.height[l.at(a, b)]), weight_before);
      for (const auto& [a, b] : stencils_of(part)) {
        plate.bend(a, b);
        if (!l.holds(a, b)) continue;
        const auto first = std::partition_point(order.begin(), order.end(), [&](std::uint32_t k) { return cell_of_known[k] < l.at(a, b); });
        for (auto k = first; k != order.end() && cell_of_known[*k] == l.at(a, b); ++k) {
          const Among p = among(l, known[*k]);
          plate.add({{a, b, (1 - p.u) * (1 - p.v)}, {a + 1, b, p.u * (1 - p.v)}, {a, b + 1, (1 - p.u) * p.v}, {a + 1, b + 1, p.u * p.v}},
                    known[*k].z(), weight_of_known);
        }
      }
      const Eigen::VectorXd z = plate.solution();
      for (size_t k = 0; k < part.size(); ++k) {
        const size_t c = l.at(part[k].first, part[k].second);
        grid.height[c] = static_cast<float>(z[static_cast<Eigen::Index>(k)]);
        filled[c] = 1;
      }
      ++out.parts, out.cells += part.size();
    }
  return out;
}

}  // namespace swath::terrain
