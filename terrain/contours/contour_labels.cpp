// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/contour_labels.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"

namespace swath::terrain {
namespace {

constexpr double letter_width = 0.7;  // of its height, and as much room for two letters beside the text
constexpr double straightest = 0.85;  // chord over arc; a stronger bend carries no label
constexpr int tries = 16;             // places looked at within a label's share of the line
constexpr double bucket = 64.0;       // m

std::int64_t bucket_row(double v) { return static_cast<std::int64_t>(std::floor(v / bucket)); }

std::uint64_t bucket_of(std::int64_t i, std::int64_t j) {
  return (static_cast<std::uint64_t>(i) << 32) ^ (static_cast<std::uint64_t>(j) & 0xffffffffu);
}

/// A line by its length.
class Arc {
 public:
  explicit Arc(const std::vector<Eigen::Vector2d>& v) : v_(v), at_(v.size(), 0.0) {
    for (size_t k = 1; k < v.size(); ++k) at_[k] = at_[k - 1] + (v[k] - v[k - 1]).norm();
  }
  double length() const { return at_.back(); }
  Eigen::Vector2d point(double s) const {
    const auto k = static_cast<size_t>(std::clamp<std::ptrdiff_t>(std::upper_bound(at_.begin(), at_.end(), s) - at_.begin(), 1,
                                                                  static_cast<std::ptrdiff_t>(at_.size()) - 1));
    const double step = at_[k] - at_[k - 1];
    return v_[k - 1] + (step > 0.0 ? (s - at_[k - 1]) / step : 0.0) * (v_[k] - v_[k - 1]);
  }

 private:
  const std::vector<Eigen::Vector2d>& v_;
  std::vector<double> at_;
};

}  // namespace

bool Labeller::is_free(const Eigen::Vector2d& at, double radius) const {
  const double reach = radius + largest_;
  for (std::int64_t j = bucket_row(at.y() - reach); j <= bucket_row(at.y() + reach); ++j)
    for (std::int64_t i = bucket_row(at.x() - reach); i <= bucket_row(at.x() + reach); ++i)
      if (const auto found = buckets_.find(bucket_of(i, j)); found != buckets_.end())
        for (const size_t k : found->second)
          if ((taken_[k].at - at).norm() < taken_[k].radius + radius) return false;
  return true;
}

std::vector<ContourLabel> Labeller::add(const ContourLine& line, size_t letters) {
  std::vector<ContourLabel> out;
  if (line.vertices.size() < 2) return out;
  const Arc arc(line.vertices);
  const double width = letter_width * options_.height.value * static_cast<double>(letters + 2);
  if (arc.length() < 3.0 * width) return out;
  const int shares = std::max(1, static_cast<int>(arc.length() / std::max(options_.spacing.value, 3.0 * width)));
  const double share = arc.length() / shares;
  for (int n = 0; n < shares; ++n) {
    double best = straightest;
    ContourLabel label;
    bool found = false;
    for (int k = 0; k < tries; ++k) {
      const double s = n * share + 0.5 * width + (share - width) * (k + 0.5) / tries;
      const Eigen::Vector2d a = arc.point(s - 0.5 * width), b = arc.point(s + 0.5 * width), middle = arc.point(s);
      const double straight = (b - a).norm() / width;
      if (straight <= best + 1e-9) continue;
      if (!is_free(middle, 0.5 * width)) continue;
      best = straight;
      found = true;
      label.at = middle;
      label.angle = std::atan2(b.y() - a.y(), b.x() - a.x());  // higher ground on the left of the line is above the text
    }
    if (!found) continue;
    if (options_.facing == LabelFacing::upright && label.angle > 0.5 * core::pi) label.angle -= core::pi;
    if (options_.facing == LabelFacing::upright && label.angle <= -0.5 * core::pi) label.angle += core::pi;
    buckets_[bucket_of(bucket_row(label.at.x()), bucket_row(label.at.y()))].push_back(taken_.size());
    largest_ = std::max(largest_, 0.5 * width);
    taken_.push_back({label.at, 0.5 * width});
    out.push_back(label);
  }
  return out;
}

}  // namespace swath::terrain
