// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/black_rim.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

constexpr std::size_t photographs_read = 5;

bool is_black(const io::ImageRaster& image, int column, int row) {
  const std::uint16_t* pixel = &image.values[image.at(column, row)];
  return std::all_of(pixel, pixel + std::min(image.bands, 3), [](std::uint16_t v) { return v == 0; });
}

/// [first, last) of `count` pixels that is left when black ones are taken off both ends; [count, 0) where all are black.
template <class IsBlack>
void shown_of(int count, const IsBlack& is_black_at, int& first, int& last) {
  first = 0, last = count;
  while (first < count && is_black_at(first)) ++first;
  if (first == count) last = 0;
  while (last > first && is_black_at(last - 1)) --last;
}

void widen(std::vector<int>& first, std::vector<int>& last, const std::vector<int>& other_first, const std::vector<int>& other_last) {
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = std::min(first[k], other_first[k]), last[k] = std::max(last[k], other_last[k]);
}

bool leaves_out(int at, int first, int last, int count, int margin) {
  return (first > 0 && at < first + margin) || (last < count && at >= last - margin);
}

}  // namespace

BlackRim::BlackRim(const io::ImageRaster& image)
    : left_(static_cast<std::size_t>(image.rows)),
      right_(left_.size()),
      top_(static_cast<std::size_t>(image.columns)),
      bottom_(top_.size()) {
  for (int r = 0; r < image.rows; ++r) {
    const auto k = static_cast<std::size_t>(r);
    shown_of(
        image.columns, [&](int c) { return is_black(image, c, r); }, left_[k], right_[k]);
  }
  for (int c = 0; c < image.columns; ++c) {
    const auto k = static_cast<std::size_t>(c);
    shown_of(
        image.rows, [&](int r) { return is_black(image, c, r); }, top_[k], bottom_[k]);
  }
  look_for_any();
}

void BlackRim::intersect(const BlackRim& other) {
  widen(left_, right_, other.left_, other.right_);
  widen(top_, bottom_, other.top_, other.bottom_);
  look_for_any();
}

void BlackRim::look_for_any() {
  const int columns = static_cast<int>(top_.size()), rows = static_cast<int>(left_.size());
  const auto hidden = [](const std::vector<int>& first, const std::vector<int>& last, int count) {
    return std::any_of(first.begin(), first.end(), [](int v) { return v > 0; }) ||
           std::any_of(last.begin(), last.end(), [count](int v) { return v < count; });
  };
  any_ = hidden(left_, right_, columns) || hidden(top_, bottom_, rows);
}

bool BlackRim::hides(const Eigen::Vector2d& place, int margin) const {
  if (!any_) return false;
  const int columns = static_cast<int>(top_.size()), rows = static_cast<int>(left_.size());
  const int c = std::clamp(static_cast<int>(std::floor(place.x())), 0, columns - 1),
            r = std::clamp(static_cast<int>(std::floor(place.y())), 0, rows - 1);
  const auto row = static_cast<std::size_t>(r), column = static_cast<std::size_t>(c);
  return leaves_out(c, left_[row], right_[row], columns, margin) || leaves_out(r, top_[column], bottom_[column], rows, margin);
}

BlackRim rim_of(const std::vector<std::filesystem::path>& photographs) {
  BlackRim rim;
  const std::size_t n = std::min(photographs.size(), photographs_read);
  for (std::size_t k = 0; k < n; ++k) {
    const BlackRim one(io::read_image_raster(photographs[k * photographs.size() / n]));
    if (!one.any()) return {};
    k == 0 ? static_cast<void>(rim = one) : rim.intersect(one);
  }
  return rim;
}

}  // namespace swath::calib
