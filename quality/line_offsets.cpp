// SPDX-License-Identifier: GPL-3.0-or-later
// Offsets by least squares, d_ab = o_a - o_b, with a mean of zero in every group of lines that overlaps join. A pair's sigma counts blocks
// within 256 m of one another as one, since the errors of a trajectory stay for seconds.
// Two lines have independent errors: a difference's variance, less its white part, is twice that of one line's error. The part that all
// lines share (of the base station, of the geoid) no overlap shows. On a slope g an error h of place, the same along each axis, moves
// heights by g h: the variance of a difference is 2 (c^2 + g^2 h^2), c the error of height. Level and steep ground give two equations for
// the two.
#include "quality/line_offsets.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "core/distributions.h"
#include "core/floor_div.h"
#include "core/statistics.h"

namespace swath::quality {
namespace {

constexpr int blocks_alike = 8;        // blocks along a side within which the lines' errors stay the same
constexpr double least_sigma = 0.002;  // m, of a pair's difference: what rounding of the files leaves
constexpr double outlying = 5.0;       // standard deviations
constexpr double median_loss = 1.2533;
constexpr size_t least_steep = 3;  // blocks, for an error of place

/// Sums of one level's cells, for the choice of the level.
double area(const LineCells& c, std::int32_t level, double side) {
  double pairs = 0.0, planes = 0.0;
  for (const LineDifference& d : c.differences) pairs += d.level == level && d.aspect == 0 ? d.cells : 0.0;
  for (const LineScatter& s : c.scatters) planes += s.level == level ? s.cells : 0.0;
  return (c.differences.empty() ? planes : pairs) * side * side;
}

/// The narrowest cells that cover at least half of what the best do.
std::int32_t chosen_level(const LineCells& c, const std::vector<double>& sides) {
  std::vector<double> areas;
  for (size_t l = 0; l < sides.size(); ++l) areas.push_back(area(c, static_cast<std::int32_t>(l), sides[l]));
  const double best = *std::max_element(areas.begin(), areas.end());
  std::int32_t level = 0;
  while (areas[static_cast<size_t>(level)] < 0.5 * best) ++level;
  return level;
}

double white_variance(const LineDifference& d) {
  const double sigma = median_loss * d.spread;
  return sigma * sigma / d.cells;
}

/// The overlap of two lines.
struct Overlap {
  int a = 0, b = 0;
  std::vector<LineDifference> blocks;  ///< without outliers

  /// Stretches within which the lines' errors stay the same.
  int places() const {
    std::set<std::pair<std::int32_t, std::int32_t>> out;
    for (const LineDifference& d : blocks) out.insert({core::floor_div(d.i, blocks_alike), core::floor_div(d.j, blocks_alike)});
    return static_cast<int>(out.size());
  }

  LinePair pair() const {
    LinePair p{a, b};
    std::vector<double> values, apart;
    double white = 0.0;
    for (const LineDifference& d : blocks) {
      values.push_back(d.difference);
      p.cells += d.cells;
      white += white_variance(d);
    }
    p.blocks = blocks.size();
    p.difference = core::middle(values);
    for (const double v : values) apart.push_back(std::abs(v - p.difference));
    const auto n = static_cast<double>(blocks.size());
    const double drift = core::mad_to_sigma * core::median(apart);
    p.sigma = std::sqrt(drift * drift / static_cast<double>(places()) + white / (n * n) + least_sigma * least_sigma);
    return p;
  }
};

std::vector<Overlap> overlaps_of(const std::vector<LineDifference>& differences, std::int32_t level, bool steep) {
  std::map<std::pair<int, int>, std::vector<LineDifference>> by_pair;
  for (const LineDifference& d : differences)
    if (d.level == level && (d.aspect != 0) == steep) by_pair[{d.line_a, d.line_b}].push_back(d);
  std::vector<Overlap> out;
  for (const auto& [pair, blocks] : by_pair) {
    std::vector<double> values, apart;
    for (const LineDifference& d : blocks) values.push_back(d.difference);
    const double middle = core::middle(values);
    for (const double v : values) apart.push_back(std::abs(v - middle));
    const double reach = outlying * std::max(core::mad_to_sigma * core::median(apart), 0.01);
    Overlap o{pair.first, pair.second, {}};
    for (const LineDifference& d : blocks)
      if (std::abs(d.difference - middle) <= reach) o.blocks.push_back(d);
    out.push_back(std::move(o));
  }
  return out;
}

/// Numbers the lines that pairs join, in the order of their first line.
void number_groups(LineComparison& c, const std::map<int, size_t>& at) {
  std::vector<size_t> root(c.lines.size());
  std::iota(root.begin(), root.end(), size_t{0});
  const auto find = [&root](size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (const LinePair& p : c.pairs) {
    const size_t a = find(at.at(p.line_a)), b = find(at.at(p.line_b));
    root[std::max(a, b)] = std::min(a, b);
  }
  std::map<size_t, int> number;
  for (size_t k = 0; k < c.lines.size(); ++k) c.lines[k].group = number.emplace(find(k), static_cast<int>(number.size()) + 1).first->second;
}

/// The lines of one group: offsets and sigmas, larger where loops of overlaps contradict one another.
void adjust(LineComparison& c, const std::map<int, size_t>& at, int group) {
  std::vector<size_t> mine;
  std::map<size_t, Eigen::Index> row;
  for (size_t k = 0; k < c.lines.size(); ++k)
    if (c.lines[k].group == group) row[k] = static_cast<Eigen::Index>(mine.size()), mine.push_back(k);
  const auto n = static_cast<Eigen::Index>(mine.size());
  if (n < 2) return;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  double weights = 0.0;
  Eigen::Index count = 0;
  const auto each = [&](auto&& f) {
    for (const LinePair& p : c.pairs)
      if (c.lines[at.at(p.line_a)].group == group) f(p, row.at(at.at(p.line_a)), row.at(at.at(p.line_b)), 1.0 / (p.sigma * p.sigma));
  };
  each([&](const LinePair& p, Eigen::Index a, Eigen::Index b, double w) {
    normal(a, a) += w, normal(b, b) += w, normal(a, b) -= w, normal(b, a) -= w;
    right(a) += w * p.difference, right(b) -= w * p.difference;
    weights += w;
    ++count;
  });
  const double datum = weights / static_cast<double>(count * n);  // of the condition that the offsets' sum is zero
  normal.array() += datum;
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
  const Eigen::VectorXd offsets = solver.solve(right);
  Eigen::MatrixXd cofactors = solver.solve(Eigen::MatrixXd::Identity(n, n));
  cofactors.array() -= 1.0 / (datum * static_cast<double>(n * n));
  double squares = 0.0;
  each([&](const LinePair& p, Eigen::Index a, Eigen::Index b, double w) {
    const double left = p.difference - (offsets(a) - offsets(b));
    squares += w * left * left;
  });
  const Eigen::Index redundancy = count - (n - 1);
  const double factor = redundancy > 0 ? std::max(1.0, squares / static_cast<double>(redundancy)) : 1.0;
  for (size_t k = 0; k < mine.size(); ++k) {
    const auto r = static_cast<Eigen::Index>(k);
    c.lines[mine[k]].offset = offsets(r);
    c.lines[mine[k]].sigma = std::sqrt(factor * std::max(0.0, cofactors(r, r)));
  }
}

/// Weighted median.
double scatter_of(const std::vector<LineScatter>& scatters, std::int32_t level) {
  std::vector<std::pair<double, std::uint64_t>> values;
  std::uint64_t all = 0;
  for (const LineScatter& s : scatters)
    if (s.level == level) values.emplace_back(s.sigma, s.cells), all += s.cells;
  std::sort(values.begin(), values.end());
  std::uint64_t sum = 0;
  for (const auto& [sigma, cells] : values)
    if ((sum += cells) * 2 >= all) return sigma;
  return std::numeric_limits<double>::quiet_NaN();
}

/// rms per pair and, over all blocks, a line's own error before and behind the offsets.
void judge_errors(LineComparison& c, const std::vector<Overlap>& overlaps, const std::map<int, size_t>& at) {
  double before = 0.0, after = 0.0, n = 0.0;
  for (size_t k = 0; k < overlaps.size(); ++k) {
    LinePair& p = c.pairs[k];
    const double shift = c.lines[at.at(p.line_a)].offset - c.lines[at.at(p.line_b)].offset;
    double squares = 0.0, squares_after = 0.0;
    for (const LineDifference& d : overlaps[k].blocks) {
      const double square = double{d.difference} * double{d.difference}, left = d.difference - shift, white = white_variance(d);
      squares += square;
      squares_after += left * left;
      before += square - white;
      after += left * left - white;
    }
    const auto blocks = static_cast<double>(p.blocks);
    n += blocks;
    p.rms = std::sqrt(squares / blocks);
    p.rms_after = std::sqrt(squares_after / blocks);
  }
  if (n == 0.0) return;
  c.common = std::sqrt(std::max(0.0, 0.5 * before / n));
  c.residual = std::sqrt(std::max(0.0, 0.5 * after / n));
}

/// Sums over blocks: of twice the variance of what a line's neighbours share, and of the slopes that made it.
struct SharedSums {
  double count = 0.0, squares = 0.0, slopes = 0.0;
  explicit SharedSums(const std::vector<Overlap>& overlaps) {
    for (const Overlap& o : overlaps)
      for (const LineDifference& d : o.blocks) {
        count += 1.0;
        squares += 0.5 * (double{d.difference} * double{d.difference} - white_variance(d));
        slopes += double{d.slope} * double{d.slope};
      }
  }
};

constexpr double least_of_height = 0.5;  // of the variance that level ground shows

/// Errors of height and of place from level and steep ground: squares = count c^2 + slopes h^2 of each.
void judge_place(LineComparison& c, const SharedSums& level, const SharedSums& steep) {
  if (steep.count < least_steep) return;
  const double det = level.count * steep.slopes - steep.count * level.slopes;
  double height = det > 0.0 ? (steep.slopes * level.squares - level.slopes * steep.squares) / det : 0.0;
  double place = det > 0.0 ? (level.count * steep.squares - steep.count * level.squares) / det : 0.0;
  if (level.count == 0.0) height = place = steep.squares / (steep.count + steep.slopes);  // not to be distinguished: alike
  if (place < 0.0) height = (level.squares + steep.squares) / (level.count + steep.count), place = 0.0;
  if (height < 0.0) place = (level.squares + steep.squares) / (level.slopes + steep.slopes), height = 0.0;
  // A few steep places, one of them a shrub, must not explain away what much level ground shows.
  const double least = level.count > 0.0 && c.common > 0.0 ? least_of_height * c.common * c.common : 0.0;
  if (height < least) height = least, place = std::max(0.0, (steep.squares - steep.count * least) / steep.slopes);
  c.common = std::sqrt(std::max(0.0, height));
  c.common_horizontal = std::sqrt(std::max(0.0, place));
}

template <class T>
void once(std::vector<T>& records) {
  std::sort(records.begin(), records.end());
  records.erase(std::unique(records.begin(), records.end()), records.end());
}

}  // namespace

LineComparison compare_lines(LineCells cells, const LineOptions& o) {
  once(cells.differences);
  once(cells.scatters);
  const std::vector<double> sides = cell_sides(o);
  const std::int32_t level = chosen_level(cells, sides);
  LineComparison c;
  c.cell = sides[static_cast<size_t>(level)];
  c.scatter = scatter_of(cells.scatters, level);
  std::map<int, size_t> at;
  for (const LineScatter& s : cells.scatters) at[s.line] = 0;
  for (const LineDifference& d : cells.differences) at[d.line_a] = at[d.line_b] = 0;
  for (auto& [line, number] : at) number = c.lines.size(), c.lines.push_back({line});
  const std::vector<Overlap> overlaps = overlaps_of(cells.differences, level, false);
  for (const Overlap& overlap : overlaps) {
    c.pairs.push_back(overlap.pair());
    c.places += overlap.places();
    ++c.lines[at.at(overlap.a)].pairs;
    ++c.lines[at.at(overlap.b)].pairs;
  }
  number_groups(c, at);
  const int groups = c.lines.empty() ? 0 : std::max_element(c.lines.begin(), c.lines.end(), [](const LineOffset& a, const LineOffset& b) {
                                             return a.group < b.group;
                                           })->group;
  for (int g = 1; g <= groups; ++g) adjust(c, at, g);
  judge_errors(c, overlaps, at);
  const std::vector<Overlap> steep = overlaps_of(cells.differences, level, true);
  for (const Overlap& overlap : steep) c.steep_places += overlap.places();
  judge_place(c, SharedSums(overlaps), SharedSums(steep));
  return c;
}

std::vector<std::string> not_shown(const LineComparison& c) {
  std::vector<std::string> out{
      "Errors that all lines share (base station, geoid, calibration, a GNSS error that stays over a short survey) do not show where lines "
      "are compared: they are in neither common_m nor the sigma that terrain.dtm gives to points without one. State its assumed_sigma "
      "where they are known."};
  if (std::isnan(c.common))
    out.push_back(
        "No two lines are seen on the same smooth ground: the error that neighbouring points share is unknown; terrain.dtm takes "
        "it to be as large as their scatter.");
  else if (std::isnan(c.common_horizontal))
    out.push_back("No steep ground is seen by two lines: along each axis the error of place is taken to be as large as that of height.");
  return out;
}

}  // namespace swath::quality
