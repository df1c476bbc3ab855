// SPDX-License-Identifier: GPL-3.0-or-later
// Serra, Image Analysis and Mathematical Morphology (1982): opening = erosion, then dilation. The disk is exact (no polygon stands for it):
// it is the union of horizontal chords, so a raster row takes part in 2 r + 1 output rows by its running minimum over the chord's width,
// and the running minimum of half-width w is the smaller of two of half-width w - 1. All inner loops run along rows and vectorize; the cost
// is about 3 r row operations per row and operator.
#include "filters/morphology.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/wide.h"

namespace swath::filters {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

std::vector<int> chord_half_widths(int radius) {
  std::vector<int> half(static_cast<size_t>(radius) + 1);
  for (int dy = 0; dy <= radius; ++dy) {
    int w = radius;
    while (w * w + dy * dy > radius * radius) --w;
    half[static_cast<size_t>(dy)] = w;
  }
  return half;
}

SWATH_WIDE void keep_smaller(float* to, const float* from, int n) {
  for (int i = 0; i < n; ++i) to[i] = from[i] < to[i] ? from[i] : to[i];
}

/// Erosion by the disk; +infinity marks cells that take no part.
SWATH_WIDE std::vector<float> erode(const std::vector<float>& in, int nx, int ny, int radius) {
  const std::vector<int> half = chord_half_widths(radius);
  const int stride = nx + 2 * radius;
  std::vector<float> out(in.size(), infinity);
  std::vector<float> chords(static_cast<size_t>(radius + 1) * static_cast<size_t>(stride), infinity);
  const auto chord = [&](int w) { return chords.data() + static_cast<size_t>(w) * static_cast<size_t>(stride); };
  const auto row = [nx](auto& v, int j) { return v.data() + static_cast<size_t>(j) * static_cast<size_t>(nx); };
  for (int j = 0; j < ny; ++j) {
    std::copy_n(row(in, j), nx, chord(0) + radius);
    for (int w = 1; w <= radius; ++w) {
      const float* inner = chord(w - 1);
      float* outer = chord(w);
      for (int i = 1; i < stride - 1; ++i) outer[i] = inner[i - 1] < inner[i + 1] ? inner[i - 1] : inner[i + 1];
      if (w == 1) keep_smaller(outer + 1, inner + 1, stride - 2);
    }
    for (int dy = -radius; dy <= radius; ++dy)
      if (j + dy >= 0 && j + dy < ny) keep_smaller(row(out, j + dy), chord(half[static_cast<size_t>(std::abs(dy))]) + radius, nx);
  }
  return out;
}

/// Opening of sign * surface, times sign again.
Raster opened(const Raster& surface, int radius, float sign) {
  Raster out = surface;
  std::vector<float> work(surface.value.size());
  for (size_t c = 0; c < work.size(); ++c) work[c] = std::isnan(surface.value[c]) ? infinity : sign * surface.value[c];
  work = erode(work, surface.nx, surface.ny, radius);
  for (float& v : work) v = v == infinity ? infinity : -v;
  work = erode(work, surface.nx, surface.ny, radius);
  for (size_t c = 0; c < work.size(); ++c)
    if (!std::isnan(surface.value[c])) out.value[c] = -sign * work[c];
  return out;
}

}  // namespace

Raster open_disk(const Raster& surface, int radius) { return opened(surface, radius, 1.0F); }

Raster close_disk(const Raster& surface, int radius) { return opened(surface, radius, -1.0F); }

}  // namespace swath::filters
