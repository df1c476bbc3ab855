// SPDX-License-Identifier: GPL-3.0-or-later
// Serra 1982 ("Image Analysis and Mathematical Morphology"): opening = erosion, then dilation. The disk is exact (no polygon stands for
// it): it is the union of horizontal chords, so a raster row takes part in 2 r + 1 output rows by its running minimum over the chord's
// width. Each width is made from the one before: the running minimum of half-width w + d, d <= w, is the smaller of two of half-width w.
// Four rows at a time; all inner loops run along rows and vectorize. Rows of the erosion go to the dilation as soon as they are there, in
// strips of columns, so that what is worked on stays in the processor's cache.
#include "filters/ground/morphology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/wide.h"

namespace swath::filters {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr int strip = 512;   // columns at a time
constexpr int together = 4;  // rows at a time

/// The chords of a disk.
struct Disk {
  int radius;
  std::vector<int> widths;  ///< half-widths that occur, ascending
  std::vector<size_t> at;   ///< by distance of the row from the centre: index into widths

  explicit Disk(int r) : radius(r), at(static_cast<size_t>(r) + 1) {
    for (int dy = r, w = 0; dy >= 0; --dy) {
      while ((w + 1) * (w + 1) + dy * dy <= r * r) ++w;
      if (widths.empty() || widths.back() != w) widths.push_back(w);
      at[static_cast<size_t>(dy)] = widths.size() - 1;
    }
  }
};

/// sign * in; +infinity where that is not a number or has been +infinity.
SWATH_WIDE void copy_row(const float* in, float* out, int n, float sign) {
  for (int i = 0; i < n; ++i) {
    const float v = sign * in[i];
    out[i] = in[i] < infinity ? v : infinity;
  }
}

/// sign * high; not a number where `given` is not one.
SWATH_WIDE void copy_back(const float* high, const float* given, float* out, int n, float sign) {
  for (int i = 0; i < n; ++i) {
    const float v = sign * high[i];
    out[i] = given[i] == given[i] ? v : given[i];
  }
}

/// Running minimum over 2 d + 1 fewer values at each end than given: only in[i - d] and in[i + d] are looked at.
SWATH_WIDE void widen(const float* in, float* out, int n, int d) {
  for (int i = d; i < n - d; ++i) out[i] = in[i - d] < in[i + d] ? in[i - d] : in[i + d];
}

SWATH_WIDE void widen_by_one(const float* in, float* out, int n) {
  for (int i = 1; i < n - 1; ++i) {
    const float ends = in[i - 1] < in[i + 1] ? in[i - 1] : in[i + 1];
    out[i] = ends < in[i] ? ends : in[i];
  }
}

SWATH_WIDE void keep_smallest(float* to, const std::array<const float*, together>& from, int n) {
  const float *a = from[0], *b = from[1], *c = from[2], *d = from[3];
  for (int i = 0; i < n; ++i) {
    const float first = a[i] < b[i] ? a[i] : b[i], second = c[i] < d[i] ? c[i] : d[i];
    const float least = first < second ? first : second;
    to[i] = least < to[i] ? least : to[i];
  }
}

/// Running minima of one row over all chords of a disk, at `columns` places; the row is `radius` longer at both ends.
class Chords {
 public:
  Chords(const Disk& disk, int columns)
      : disk_(disk), n_(columns + 2 * disk.radius), between_(static_cast<size_t>(n_), infinity), other_(between_) {
    rows_.assign(disk.widths.size() * static_cast<size_t>(n_), infinity);
  }
  float* row() { return rows_.data(); }
  /// To be called when row() has been written.
  void update() {
    for (size_t k = 1; k < disk_.widths.size(); ++k) grow(of(k - 1), disk_.widths[k - 1], of(k), disk_.widths[k]);
  }
  void clear() { std::fill(rows_.begin(), rows_.end(), infinity); }
  const float* at(int dy) const { return rows_.data() + disk_.at[static_cast<size_t>(dy)] * static_cast<size_t>(n_) + disk_.radius; }

 private:
  float* of(size_t k) { return rows_.data() + k * static_cast<size_t>(n_); }
  void grow(const float* from, int width, float* to, int wanted) {
    while (true) {
      const int next = width == 0 ? 1 : std::min(wanted, 2 * width);
      float* out = next == wanted ? to : from == between_.data() ? other_.data() : between_.data();
      if (width == 0)
        widen_by_one(from, out, n_);
      else
        widen(from, out, n_, next - width);
      if (next == wanted) return;
      from = out, width = next;
    }
  }

  const Disk& disk_;
  int n_;
  std::vector<float> rows_, between_, other_;
};

/// Erosion by the disk, row after row: takes rows that are `radius` longer at both ends, gives rows of `columns` values.
class Erosion {
 public:
  Erosion(const Disk& disk, int columns)
      : disk_(disk),
        columns_(columns),
        kept_(2 * disk.radius + together),
        chords_(static_cast<size_t>(together), Chords(disk, columns)),
        none_(static_cast<size_t>(columns), infinity),
        rows_(static_cast<size_t>(kept_) * static_cast<size_t>(columns), infinity) {}

  /// Where the next row is to be written, then added.
  float* row() { return chords_[static_cast<size_t>(added_ % together)].row(); }
  template <class Take>
  void add(const Take& take) {
    chords_[static_cast<size_t>(added_ % together)].update();
    if (++added_ % together == 0) spread(take);
  }
  /// After the last row: gives the rows that are left.
  template <class Take>
  void finish(const Take& take) {
    const int rows = added_;
    while (added_ % together != 0) chords_[static_cast<size_t>(added_++ % together)].clear();
    if (rows != added_) spread(take);
    for (; given_ < rows; ++given_) take(given_, ring(given_));
  }

 private:
  float* ring(int y) { return rows_.data() + static_cast<size_t>(y % kept_) * static_cast<size_t>(columns_); }

  /// The last rows added take part in those up to a radius away; gives those that no further row takes part in.
  template <class Take>
  void spread(const Take& take) {
    const int j = added_ - together, r = disk_.radius;
    for (int y = std::max(0, j - r); y < j + together + r; ++y) {
      std::array<const float*, together> from{};
      for (int k = 0; k < together; ++k) {
        const int dy = std::abs(j + k - y);
        from[static_cast<size_t>(k)] = dy <= r ? chords_[static_cast<size_t>(k)].at(dy) : none_.data();
      }
      if (y >= started_) std::fill_n(ring(y), columns_, infinity), started_ = y + 1;
      keep_smallest(ring(y), from, columns_);
    }
    for (; given_ < added_ - r; ++given_) take(given_, ring(given_));
  }

  const Disk& disk_;
  int columns_, kept_;
  std::vector<Chords> chords_;
  std::vector<float> none_, rows_;
  int added_ = 0, started_ = 0, given_ = 0;
};

/// Opening of sign * surface, times sign again, in rows of strips.
void opened(const Raster& surface, int radius, float sign, const OpenedRow& take) {
  const Disk disk(radius);
  const int nx = surface.nx;
  std::vector<float> high(static_cast<size_t>(strip));
  for (int from = 0; from < nx; from += strip) {
    const int to = std::min(nx, from + strip), n = to - from;
    Erosion low(disk, n + 2 * radius), dilation(disk, n);
    const auto give = [&](int j, const float* row) {
      if (j >= surface.ny) return;
      copy_back(row, surface.value.data() + surface.at(from, j), high.data(), n, -sign);
      take(j, from, high.data(), n);
    };
    // Disks with centres outside the raster do not count.
    const int outside_west = std::max(0, radius - from), outside_east = std::max(0, to + radius - nx);
    const auto dilate = [&](int j, const float* row) {
      if (j >= surface.ny) return;
      const int all = n + 2 * radius;
      float* in = dilation.row();
      std::fill_n(in, outside_west, infinity);
      copy_row(row + outside_west, in + outside_west, all - outside_west - outside_east, -1.0F);
      std::fill_n(in + all - outside_east, outside_east, infinity);
      dilation.add(give);
    };
    const int first = std::max(0, from - 2 * radius), last = std::min(nx, to + 2 * radius), before = first - (from - 2 * radius);
    for (int j = 0; j < surface.ny; ++j) {
      float* in = low.row();
      std::fill_n(in, before, infinity);
      copy_row(surface.value.data() + surface.at(first, j), in + before, last - first, sign);
      std::fill(in + before + (last - first), in + n + 4 * radius, infinity);
      low.add(dilate);
    }
    low.finish(dilate);
    dilation.finish(give);
  }
}

Raster opened(const Raster& surface, int radius, float sign) {
  Raster out(surface.nx, surface.ny, 0.0F);
  opened(surface, radius, sign, [&](int j, int i, const float* row, int n) { std::copy_n(row, n, out.value.data() + out.at(i, j)); });
  return out;
}

}  // namespace

void open_disk(const Raster& surface, int radius, const OpenedRow& take) { opened(surface, radius, 1.0F, take); }

Raster open_disk(const Raster& surface, int radius) { return opened(surface, radius, 1.0F); }

Raster close_disk(const Raster& surface, int radius) { return opened(surface, radius, -1.0F); }

}  // namespace swath::filters
