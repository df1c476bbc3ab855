// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_box.h"

#include <cmath>
#include <cstdio>

namespace swath::io {
namespace {

constexpr double rounded_steps = 10.0;  // of the scale: bounds written with a digit less than the points

/// Does the box hold the point, by so many steps of the scale? A bound that is no number holds nothing.
bool holds(const LasHeader& header, const Eigen::Vector3d& p, double steps) {
  const Eigen::Array3d room = steps * header.scale.array().abs();
  return (p.array() >= header.min.array() - room).all() && (p.array() <= header.max.array() + room).all();
}

}  // namespace

void LasBox::add(const LasPoints& points, const LasHeader& header, std::uint64_t first) {
  for (std::size_t i = 0; i < points.size(); ++i) add_one(points, header, first, i);
}

void LasBox::add_one(const LasPoints& points, const LasHeader& header, std::uint64_t first, std::size_t i) {
  const Eigen::Vector3d p(points.x[i], points.y[i], points.z[i]);
  ++points_;
  if (holds(header, p, 1.0)) return;
  has_box_ = !header.min.isZero(0) || !header.max.isZero(0);
  wrong_ = wrong_ || !has_box_ || !holds(header, p, rounded_steps);
  if (examples_.size() < examples_kept) examples_.push_back(first + i);
  ++outside_;
  // A bound that is no number has no distance.
  const Eigen::Vector3d beyond = (header.min - p).cwiseMax(p - header.max);
  for (int k = 0; k < 3; ++k)
    if (std::isfinite(beyond[k]) && beyond[k] > farthest_[k]) farthest_[k] = beyond[k];
}

void LasBox::count(const std::string& name, core::Tally& tally) const {
  if (outside_ == 0) return;
  const std::string example = name + ": " + fault();
  if (!wrong_) return tally.count(outside_box, example, outside_);
  tally.count(outside_box, outside_);
  tally.count(wrong_box, example);
}

std::string LasBox::fault() const {
  if (outside_ == 0) return {};
  if (!has_box_) return "the header states no box: its bounds are all 0";
  char share[32];
  std::snprintf(share, sizeof share, "%.3g %%", 100.0 * static_cast<double>(outside_) / static_cast<double>(points_));
  std::string out =
      std::to_string(outside_) + " of " + std::to_string(points_) + " points (" + share + ") lie outside the box of the header";
  Eigen::Index axis = 0;
  if (farthest_.maxCoeff(&axis) > 0) {
    char far[64];
    std::snprintf(far, sizeof far, ", by up to %.6g in %c", farthest_[axis], "xyz"[axis]);
    out += far;
  }
  out += examples_.size() > 1 ? ": records " : ": record ";
  for (std::size_t k = 0; k < examples_.size(); ++k) out += (k > 0 ? ", " : "") + std::to_string(examples_[k]);
  return out;
}

}  // namespace swath::io
