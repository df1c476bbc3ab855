// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/hilbert_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace swath::terrain {
namespace {

constexpr int levels = 12;  // 4096 x 4096 cells: two passes of a radix sort
constexpr std::uint32_t side = 1u << levels;

// Each quadrant's curve is its parent's, mirrored in both axes (flip) and in the diagonal (swap). Steps of several levels are read from a
// table: of the place within the step's square, row by row, and how the curve through it is mirrored.
constexpr int step = 4;
constexpr std::uint32_t step_side = 1u << step;
struct Step {
  std::uint8_t index, mirrored;  // mirrored: flip | swap << 1, of the curve in that place
};
using Steps = std::array<std::array<Step, step_side * step_side>, 4>;

constexpr Step step_to(std::uint32_t x, std::uint32_t y, std::uint32_t mirrored) {
  std::uint32_t index = 0, flip = mirrored & 1u, swap = mirrored >> 1;
  for (int level = step - 1; level >= 0; --level) {
    const std::uint32_t bx = (x >> level) & 1u, by = (y >> level) & 1u;
    const std::uint32_t rx = (swap ? by : bx) ^ flip, ry = (swap ? bx : by) ^ flip;
    index = index << 2 | ((3 * rx) ^ ry);
    flip ^= rx & ~ry;
    swap ^= ry ^ 1u;
  }
  return {static_cast<std::uint8_t>(index), static_cast<std::uint8_t>((flip & 1u) | (swap & 1u) << 1)};
}

constexpr Steps all_steps() {
  Steps out{};
  for (std::uint32_t mirrored = 0; mirrored < 4; ++mirrored)
    for (std::uint32_t y = 0; y < step_side; ++y)
      for (std::uint32_t x = 0; x < step_side; ++x) out[mirrored][y * step_side + x] = step_to(x, y, mirrored);
  return out;
}
constexpr Steps steps = all_steps();

/// Place of a cell on the curve.
std::uint32_t index_of(std::uint32_t x, std::uint32_t y) {
  std::uint32_t index = 0, mirrored = 0;
  for (int level = levels - step; level >= 0; level -= step) {
    const Step s = steps[mirrored][((y >> level) % step_side) * step_side + (x >> level) % step_side];
    index = index << 2 * step | s.index;
    mirrored = s.mirrored;
  }
  return index;
}

}  // namespace

std::vector<OnCurve> along_hilbert_curve(const std::vector<Place>& places) {
  Place low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}, high{-low.x, -low.y};
  for (const Place& p : places) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double span = std::max({high.x - low.x, high.y - low.y, std::numeric_limits<double>::min()});
  const double scale = static_cast<double>(side) / span;
  const auto cell = [scale](double v) { return std::min(static_cast<std::uint32_t>(v * scale), side - 1); };
  std::vector<OnCurve> order(places.size()), other(places.size());
  std::array<std::array<std::uint32_t, side>, 2> start{};
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    order[i] = {index_of(cell(places[i].x - low.x), cell(places[i].y - low.y)), i};
    ++start[0][order[i].cell % side];
    ++start[1][order[i].cell / side];
  }
  for (auto& digit : start) {
    std::uint32_t sum = 0;
    for (std::uint32_t& s : digit) sum += std::exchange(s, sum);
  }
  for (const OnCurve& o : order) other[start[0][o.cell % side]++] = o;
  for (const OnCurve& o : other) order[start[1][o.cell / side]++] = o;
  return order;
}

std::vector<std::int32_t> from_coarse_to_fine(std::int32_t first, std::int32_t last) {
  constexpr std::int32_t row_size = 4096, coarsest = 32;  // the finest selection is every second place
  std::vector<std::int32_t> order;
  order.reserve(static_cast<size_t>(last - first));
  for (std::int32_t row = first; row < last; row += row_size) {
    const std::int32_t end = std::min(row + row_size, last);
    for (std::int32_t p = row; p < end; p += coarsest) order.push_back(p);
    for (std::int32_t step = coarsest; step > 1; step /= 2)
      for (std::int32_t p = row + step / 2; p < end; p += step) order.push_back(p);
  }
  return order;
}

}  // namespace swath::terrain
