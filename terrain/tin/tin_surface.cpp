// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle by triangle: each triangle visits the places in its bounding box. Whether a place lies in it is decided exactly, so that edges
// shared by two triangles leave neither gaps nor doubt.
#include "terrain/tin/tin_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::terrain {
namespace {

/// Exact test of one triangle against many places.
class Inside {
 public:
  Inside(const Tin& tin, const std::array<std::int32_t, 3>& t) {
    for (int k = 0; k < 3; ++k) p_[k] = tin.place(t[k]);
    if (orientation(p_[0], p_[1], p_[2]) < 0) std::swap(p_[1], p_[2]);
  }
  bool operator()(double x, double y) const {
    for (int k = 0; k < 3; ++k)
      if (orientation(p_[k], p_[(k + 1) % 3], {x, y}) < 0) return false;
    return true;
  }
  /// Interval of x that the triangle spans at height y (rounded; y within the triangle's range).
  std::pair<double, double> span(double y) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int k = 0; k < 3; ++k) {
      const Place &a = p_[k], &b = p_[(k + 1) % 3];
      if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
      if (a.y == b.y) {
        low = std::min({low, a.x, b.x});
        high = std::max({high, a.x, b.x});
        continue;
      }
      const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    return {low, high};
  }

 private:
  std::array<Place, 3> p_;
};

// The first triangle of two that share a place.
void claim(const Tin& tin, std::int32_t t, std::int32_t& held) {
  if (held < 0 || tin.is_before(t, held)) held = t;
}

}  // namespace

std::array<double, 3> weights(const Tin& tin, std::int32_t triangle, double x, double y) {
  const auto [a, b, c] = tin.triangles[static_cast<size_t>(triangle)];
  const double bx = tin.x[b] - tin.x[a], by = tin.y[b] - tin.y[a];
  const double cx = tin.x[c] - tin.x[a], cy = tin.y[c] - tin.y[a];
  const double qx = x - tin.x[a], qy = y - tin.y[a];
  const double twice_area = bx * cy - by * cx;
  const double wb = (qx * cy - qy * cx) / twice_area, wc = (bx * qy - by * qx) / twice_area;
  return {1.0 - wb - wc, wb, wc};
}

double height_in(const Tin& tin, std::int32_t triangle, double x, double y) {
  const auto [a, b, c] = tin.triangles[static_cast<size_t>(triangle)];
  const auto w = weights(tin, triangle, x, y);
  return tin.z[a] + w[1] * (tin.z[b] - tin.z[a]) + w[2] * (tin.z[c] - tin.z[a]);
}

Eigen::Vector2d gradient(const Tin& tin, std::int32_t triangle) {
  const auto [a, b, c] = tin.triangles[static_cast<size_t>(triangle)];
  const double bx = tin.x[b] - tin.x[a], by = tin.y[b] - tin.y[a], bz = tin.z[b] - tin.z[a];
  const double cx = tin.x[c] - tin.x[a], cy = tin.y[c] - tin.y[a], cz = tin.z[c] - tin.z[a];
  const double twice_area = bx * cy - by * cx;
  return {(bz * cy - cz * by) / twice_area, (bx * cz - cx * bz) / twice_area};
}

std::vector<std::int32_t> triangles_at_centres(const Tin& tin, const Eigen::Vector3d& origin, const core::Lattice& window) {
  // Bounding boxes are rounded outward by this share of a cell: over the rounding of map coordinates, under a visible cost.
  static constexpr double slack = 1e-6;
  std::vector<std::int32_t> out(window.size(), -1);
  // Cell centres lie at whole numbers of these.
  const double inverse = 1.0 / window.cell;
  const double east = (origin.x() - window.west()) * inverse - 0.5, north = (origin.y() - window.south()) * inverse - 0.5;
  const auto column = [&](double x) { return x * inverse + east; };
  const auto row = [&](double y) { return y * inverse + north; };
  const auto first = [](double v) {  // at least 0
    const auto whole = static_cast<int>(std::max(v - slack, 0.0));
    return whole < v - slack ? whole + 1 : whole;
  };
  const auto last = [](double v, int n) { return v + slack < 0.0 ? -1 : static_cast<int>(std::min(v + slack, n - 1.0)); };
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t) {
    const auto& v = tin.triangles[t];
    const double y0 = tin.y[v[0]], y1 = tin.y[v[1]], y2 = tin.y[v[2]];
    const double y_low = std::min(std::min(y0, y1), y2), y_high = std::max(std::max(y0, y1), y2);
    const double low = column(tin.x[v[0]]), high = column(tin.x[v[2]]);  // vertices ascend in x
    if (!(low < window.nx && row(y_low) < window.ny)) continue;
    const int i0 = first(low), i1 = last(high, window.nx), j0 = first(row(y_low)), j1 = last(row(y_high), window.ny);
    if (i0 > i1 || j0 > j1) continue;
    const Inside inside(tin, v);
    for (int j = j0; j <= j1; ++j) {
      const double y = window.centre_y(j) - origin.y();
      int a = i0, b = i1;
      if (b - a > 2) {  // wide triangle: only the part of the row that it spans
        const auto [from, to] = inside.span(std::clamp(y, y_low, y_high));
        a = std::max(a, first(column(from)) - 1);
        b = std::min(b, last(column(to), window.nx) + 1);
      }
      for (int i = a; i <= b; ++i)
        if (inside(window.centre_x(i) - origin.x(), y)) claim(tin, t, out[window.at(i, j)]);
    }
  }
  return out;
}

std::vector<std::int32_t> triangles_at(const Tin& tin, const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<std::int32_t> out(x.size(), -1), order;
  for (size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && std::isfinite(y[i])) order.push_back(static_cast<std::int32_t>(i));
  if (order.empty() || tin.triangles.empty()) return out;

  // Places in columns of equal width, ascending in y within a column.
  double x_low = std::numeric_limits<double>::infinity(), x_high = -x_low;
  for (const std::int32_t i : order) x_low = std::min(x_low, x[i]), x_high = std::max(x_high, x[i]);
  const double columns = std::clamp(std::ceil(std::sqrt(static_cast<double>(order.size()))), 1.0, 1e6);
  const double width = std::max((x_high - x_low) / columns, 1e-9);
  const auto column = [&](double v) { return static_cast<std::int64_t>(std::clamp(std::floor((v - x_low) / width), 0.0, columns - 1.0)); };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return std::make_tuple(column(x[a]), y[a], x[a], a) < std::make_tuple(column(x[b]), y[b], x[b], b);
  });
  std::vector<size_t> start(static_cast<size_t>(columns) + 1, 0);
  for (const std::int32_t i : order) ++start[column(x[i]) + 1];
  for (size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];

  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t) {
    const auto& v = tin.triangles[t];
    if (tin.x[v[2]] < x_low || tin.x[v[0]] > x_high) continue;
    const auto [y_low, y_high] = std::minmax({tin.y[v[0]], tin.y[v[1]], tin.y[v[2]]});
    const Inside inside(tin, v);
    for (std::int64_t c = column(tin.x[v[0]]); c <= column(tin.x[v[2]]); ++c) {
      const auto end = order.begin() + static_cast<std::ptrdiff_t>(start[c + 1]);
      auto at = std::lower_bound(order.begin() + static_cast<std::ptrdiff_t>(start[c]), end, y_low,
                                 [&](std::int32_t i, double low) { return y[i] < low; });
      for (; at != end && y[*at] <= y_high; ++at)
        if (inside(x[*at], y[*at])) claim(tin, t, out[*at]);
    }
  }
  return out;
}

}  // namespace swath::terrain
