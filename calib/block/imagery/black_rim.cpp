// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/black_rim.h"

#include <algorithm>
#include <cmath>

#include "core/printable.h"

namespace swath::calib {
namespace {

constexpr std::size_t photographs_read = 5;
constexpr double values_at_a_time = 1e8;
constexpr int block_of_jpeg = 16;  // pixels, with halved colours: black beside an image is no longer exact in the blocks that hold both

bool is_jpeg(const std::filesystem::path& file) {
  const std::string ending = core::lower_case(file.extension().string());
  return ending == ".jpg" || ending == ".jpeg";
}

/// By bands of rows: photographs of large frames do not fit into memory at once.
BlackRim rim_of_one(const std::filesystem::path& file) {
  const io::ImageRaster facts = io::read_image_facts(file);
  const int rows = std::max(1, static_cast<int>(std::min<double>(facts.rows, values_at_a_time / facts.columns / facts.bands)));
  BlackRim rim(facts.columns, facts.rows);
  for (int r = 0; r < facts.rows; r += rows) rim.add(io::read_image_window(file, {0, r, facts.columns, std::min(rows, facts.rows - r)}), r);
  return rim;
}

bool is_black(const io::ImageRaster& image, int column, int row) {
  const std::uint16_t* pixel = &image.values[image.at(column, row)];
  return std::all_of(pixel, pixel + std::min(image.bands, 3), [](std::uint16_t v) { return v == 0; });
}

void widen(std::vector<int>& first, std::vector<int>& last, const std::vector<int>& other_first, const std::vector<int>& other_last) {
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = std::min(first[k], other_first[k]), last[k] = std::max(last[k], other_last[k]);
}

bool leaves_out(int at, int first, int last, int count, int margin) {
  return (first > 0 && at < first + margin) || (last < count && at >= last - margin);
}

}  // namespace

BlackRim::BlackRim(int columns, int rows)
    : left_(static_cast<std::size_t>(rows), columns),
      right_(static_cast<std::size_t>(rows), 0),
      top_(static_cast<std::size_t>(columns), rows),
      bottom_(static_cast<std::size_t>(columns), 0) {}

BlackRim::BlackRim(const io::ImageRaster& image) : BlackRim(image.columns, image.rows) { add(image, 0); }

void BlackRim::add(const io::ImageRaster& band, int first_row) {
  for (int r = 0; r < band.rows; ++r)
    for (int c = 0; c < band.columns; ++c) {
      if (is_black(band, c, r)) continue;
      const auto row = static_cast<std::size_t>(first_row + r), column = static_cast<std::size_t>(c);
      left_[row] = std::min(left_[row], c), right_[row] = std::max(right_[row], c + 1);
      top_[column] = std::min(top_[column], first_row + r), bottom_[column] = std::max(bottom_[column], first_row + r + 1);
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
  margin = std::max(margin, mixed_);
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
    const std::filesystem::path& file = photographs[k * photographs.size() / n];
    const BlackRim one = rim_of_one(file);
    if (!one.any()) return {};
    k == 0 ? static_cast<void>(rim = one) : rim.intersect(one);
    if (is_jpeg(file)) rim.expect_mixed(block_of_jpeg);
  }
  return rim;
}

}  // namespace swath::calib
