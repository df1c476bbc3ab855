// SPDX-License-Identifier: GPL-3.0-or-later
// Felzenszwalb and Huttenlocher (2012): the lower envelope of parabolas, along columns and then along rows. Columns hold whole numbers up
// to their length, so that float is exact up to 4096 cells and right to 1e-7 beyond.
#include "quality/distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/wide.h"

namespace swath::quality {
namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();

/// One row in place: f becomes the lower envelope of (x - i)^2 + f(i).
class Envelope {
 public:
  explicit Envelope(int longest) : at_(static_cast<size_t>(longest)), from_(static_cast<size_t>(longest) + 1), value_(at_.size()) {}
  void apply(float* f, int n) {
    int last = -1;
    for (int q = 0; q < n; ++q) {
      if (f[q] == nowhere) continue;
      double s = -std::numeric_limits<double>::infinity();
      for (; last >= 0; --last) {
        const int p = at_[static_cast<size_t>(last)];
        s = ((f[q] + static_cast<double>(q) * q) - (f[p] + static_cast<double>(p) * p)) / (2.0 * (q - p));
        if (s > from_[static_cast<size_t>(last)]) break;
      }
      ++last;
      at_[static_cast<size_t>(last)] = q;
      from_[static_cast<size_t>(last)] = last == 0 ? -std::numeric_limits<double>::infinity() : s;
    }
    if (last < 0) return;
    for (int k = 0; k <= last; ++k) value_[static_cast<size_t>(k)] = f[at_[static_cast<size_t>(k)]];
    for (int q = 0, k = 0; q < n; ++q) {
      while (k < last && from_[static_cast<size_t>(k) + 1] < q) ++k;
      const double d = q - at_[static_cast<size_t>(k)];
      f[q] = static_cast<float>(d * d + static_cast<double>(value_[static_cast<size_t>(k)]));
    }
  }

 private:
  std::vector<int> at_;
  std::vector<double> from_;
  std::vector<float> value_;
};

/// Cells to the nearest one of the row that is set; 255: that or more.
void distances_in_row(const std::uint8_t* mask, std::uint8_t* out, int n) {
  int d = 255;
  for (int i = 0; i < n; ++i) {
    d = mask[i] ? 0 : std::min(d + 1, 255);
    out[i] = static_cast<std::uint8_t>(d);
  }
  d = 255;
  for (int i = n - 1; i >= 0; --i) {
    d = mask[i] ? 0 : std::min(d + 1, 255);
    out[i] = std::min(out[i], static_cast<std::uint8_t>(d));
  }
}

/// Sets those of `to` whose distance along the row is at most `most`.
SWATH_WIDE void set_within(const std::uint8_t* __restrict distance, std::uint8_t most, std::uint8_t* __restrict to, int n) {
  for (int i = 0; i < n; ++i) to[i] = static_cast<std::uint8_t>(to[i] | static_cast<std::uint8_t>(distance[i] <= most));
}

}  // namespace

std::vector<std::uint8_t> cells_within(const std::vector<std::uint8_t>& mask, int nx, int ny, double radius) {
  std::vector<std::uint8_t> along(mask.size()), out(mask.size(), 0);
  const auto row = [nx](int j) { return static_cast<size_t>(j) * static_cast<size_t>(nx); };
  for (int j = 0; j < ny; ++j) distances_in_row(mask.data() + row(j), along.data() + row(j), nx);
  const int reach = static_cast<int>(radius);
  for (int j = 0; j < ny; ++j)
    for (int v = std::max(0, j - reach); v <= std::min(ny - 1, j + reach); ++v) {
      int left = reach;  // of the radius, along the row
      while (left > 0 && left * left + (v - j) * (v - j) > radius * radius) --left;
      set_within(along.data() + row(v), static_cast<std::uint8_t>(left), out.data() + row(j), nx);
    }
  return out;
}

std::vector<float> squared_distances(const std::vector<std::uint8_t>& mask, int nx, int ny) {
  std::vector<float> out(mask.size(), nowhere);
  const auto at = [nx](int i, int j) { return static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i); };
  for (int i = 0; i < nx; ++i) {  // along columns: the nearest above and below
    double d = std::numeric_limits<double>::infinity();
    for (int j = 0; j < ny; ++j) {
      d = mask[at(i, j)] ? 0.0 : d + 1.0;
      out[at(i, j)] = static_cast<float>(d);
    }
    d = std::numeric_limits<double>::infinity();
    for (int j = ny - 1; j >= 0; --j) {
      d = mask[at(i, j)] ? 0.0 : d + 1.0;
      const float nearest = std::min(out[at(i, j)], static_cast<float>(d));
      out[at(i, j)] = nearest * nearest;
    }
  }
  Envelope rows(nx);
  for (int j = 0; j < ny; ++j) rows.apply(out.data() + at(0, j), nx);
  return out;
}

}  // namespace swath::quality
