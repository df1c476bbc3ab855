// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/height_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace swath::core {

HeightField::HeightField(double level)
    : everywhere_(true), heights_{static_cast<float>(level)}, known_{true}, lowest_(level), highest_(level) {}

HeightField::HeightField(const Nodes& nodes, std::vector<float> heights) : nodes_(nodes), heights_(std::move(heights)) {
  fill_unknown();
  const auto [low, high] = std::minmax_element(heights_.begin(), heights_.end());
  lowest_ = static_cast<double>(*low);
  highest_ = static_cast<double>(*high);
  // Within a cell each component of the gradient lies between those along its two sides.
  double steepest_x = 0.0, steepest_y = 0.0;
  const auto node = [this](int i, int j) {
    return static_cast<double>(heights_[static_cast<size_t>(j) * static_cast<size_t>(nodes_.nx) + static_cast<size_t>(i)]);
  };
  for (int j = 0; j < nodes_.ny; ++j)
    for (int i = 0; i < nodes_.nx; ++i) {
      if (i + 1 < nodes_.nx) steepest_x = std::max(steepest_x, std::abs(node(i + 1, j) - node(i, j)) / nodes_.step_x);
      if (j + 1 < nodes_.ny) steepest_y = std::max(steepest_y, std::abs(node(i, j + 1) - node(i, j)) / nodes_.step_y);
    }
  steepest_ = std::hypot(steepest_x, steepest_y);
}

/// From all known nodes outward, ring by ring.
void HeightField::fill_unknown() {
  known_.resize(heights_.size());
  std::vector<size_t> front;
  for (size_t k = 0; k < heights_.size(); ++k) {
    known_[k] = std::isfinite(heights_[k]);
    if (known_[k]) front.push_back(k);
  }
  if (front.empty()) throw Error("no height is known");
  if (front.size() == heights_.size()) return;
  const auto nx = static_cast<size_t>(nodes_.nx), ny = static_cast<size_t>(nodes_.ny);
  while (!front.empty()) {
    std::vector<size_t> next;
    for (const size_t k : front) {
      const size_t i = k % nx, j = k / nx;
      const std::array<std::pair<bool, size_t>, 4> around{{{i > 0, k - 1}, {i + 1 < nx, k + 1}, {j > 0, k - nx}, {j + 1 < ny, k + nx}}};
      for (const auto& [inside, n] : around)
        if (inside && !std::isfinite(heights_[n])) {
          heights_[n] = heights_[k];
          next.push_back(n);
        }
    }
    front = std::move(next);
  }
}

HeightField::Sample HeightField::at(double x, double y) const {
  if (everywhere_) return {lowest_, Eigen::Vector2d::Zero()};
  const double u = (x - nodes_.west) / nodes_.step_x, v = (y - nodes_.south) / nodes_.step_y;
  const double cu = std::clamp(u, 0.0, nodes_.nx - 1.0), cv = std::clamp(v, 0.0, nodes_.ny - 1.0);
  const int i = std::clamp(static_cast<int>(cu), 0, std::max(0, nodes_.nx - 2)),
            j = std::clamp(static_cast<int>(cv), 0, std::max(0, nodes_.ny - 2));
  const int right = std::min(i + 1, nodes_.nx - 1), above = std::min(j + 1, nodes_.ny - 1);
  const double fu = cu - i, fv = cv - j;
  const auto node = [this](int a, int b) {
    return static_cast<double>(heights_[static_cast<size_t>(b) * static_cast<size_t>(nodes_.nx) + static_cast<size_t>(a)]);
  };
  const double sw = node(i, j), se = node(right, j), nw = node(i, above), ne = node(right, above);
  Sample s;
  s.height = (1 - fv) * ((1 - fu) * sw + fu * se) + fv * ((1 - fu) * nw + fu * ne);
  if (cu == u) s.gradient.x() = ((1 - fv) * (se - sw) + fv * (ne - nw)) / nodes_.step_x;
  if (cv == v) s.gradient.y() = ((1 - fu) * (nw - sw) + fu * (ne - se)) / nodes_.step_y;
  return s;
}

bool HeightField::knows(double x, double y) const {
  if (everywhere_) return true;
  const double u = std::floor((x - nodes_.west) / nodes_.step_x + 0.5), v = std::floor((y - nodes_.south) / nodes_.step_y + 0.5);
  if (!(u >= 0 && v >= 0 && u < nodes_.nx && v < nodes_.ny)) return false;
  return known_[static_cast<size_t>(v) * static_cast<size_t>(nodes_.nx) + static_cast<size_t>(u)];
}

}  // namespace swath::core
