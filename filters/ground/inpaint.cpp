// SPDX-License-Identifier: GPL-3.0-or-later
// Stands for the spring metaphor of Pingel, Clarke & McBride 2013 (a Laplace-like system over the whole raster, whose answer depends
// on its whole extent). Here every filled cell depends on values within reach + relax cells only, as tiles need. Start: linear
// interpolation along the four lines through the cell, weighted by the inverse product of the distances to the line's two ends; then a
// few Jacobi passes of the Laplace equation. One sweep upwards and one downwards carry the nearest values along from row to row.
#include "filters/ground/inpaint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/wide.h"

namespace swath::filters {
namespace {

/// The nearest value along a line, and its distance in steps; beyond the reach there is none.
struct Sight {
  float value, steps;
};

SWATH_WIDE void carry(const float* row, const float* value_before, const float* steps_before, float* value, float* steps, int n,
                      float beyond) {
  for (int i = 0; i < n; ++i) {
    const float farther = steps_before[i] + 1.0F, bounded = farther < beyond ? farther : beyond;
    value[i] = row[i] == row[i] ? row[i] : value_before[i];
    steps[i] = row[i] == row[i] ? 0.0F : bounded;
  }
}

/// What is seen from the cells of one row towards the rows swept before, straight and along both diagonals.
class Sweep {
 public:
  Sweep(int nx, int reach) : nx_(nx), beyond_(static_cast<float>(reach + 1)) {
    for (Front& f : fronts_) f.value.assign(static_cast<size_t>(nx) + 2, 0.0F), f.steps.assign(static_cast<size_t>(nx) + 2, beyond_);
    next_ = fronts_[0];
  }
  void add(const float* row) {
    for (size_t k = 0; k < fronts_.size(); ++k) {
      Front& f = fronts_[k];
      const float *value = f.value.data() + 1 + shift[k], *steps = f.steps.data() + 1 + shift[k];
      carry(row, value, steps, next_.value.data() + 1, next_.steps.data() + 1, nx_, beyond_);
      std::swap(f, next_);
    }
  }
  /// Straight; from the west; from the east.
  std::array<Sight, 3> at(int i) const {
    const size_t c = static_cast<size_t>(i) + 1;
    return {{{fronts_[0].value[c], fronts_[0].steps[c]},
             {fronts_[1].value[c], fronts_[1].steps[c]},
             {fronts_[2].value[c], fronts_[2].steps[c]}}};
  }

 private:
  static constexpr std::array<int, 3> shift{0, -1, 1};
  struct Front {
    std::vector<float> value, steps;
  };
  int nx_;
  float beyond_;
  std::array<Front, 3> fronts_;
  Front next_;
};

/// Weighted means: of lines with both ends, and of single ends.
class Lines {
 public:
  explicit Lines(const Inpainting& how) : reach_(static_cast<float>(how.reach)), extrapolate_(how.extrapolate) {}
  void add(const Sight& back, const Sight& ahead, float step) {
    const bool one = back.steps <= reach_, other = ahead.steps <= reach_;
    const float a = back.steps * step, b = ahead.steps * step;
    if (one && other) {
      const float w = 1.0F / (a * b);
      weight_ += w, value_ += w * ((back.value * b + ahead.value * a) / (a + b));
    } else if (extrapolate_ && (one || other)) {
      const float d = one ? a : b, w = 1.0F / (d * d);
      single_weight_ += w, single_value_ += w * (one ? back.value : ahead.value);
    }
  }
  bool any() const { return weight_ > 0 || single_weight_ > 0; }
  float mean() const { return weight_ > 0 ? value_ / weight_ : single_value_ / single_weight_; }

 private:
  float reach_;
  bool extrapolate_;
  float weight_ = 0, value_ = 0, single_weight_ = 0, single_value_ = 0;
};

/// Cells without value, by rows.
struct Holes {
  std::vector<int> column;
  std::vector<size_t> first;  ///< by row, and the end
};

Holes holes_of(const Raster& r) {
  Holes h;
  h.first.reserve(static_cast<size_t>(r.ny) + 1);
  for (int j = 0; j < r.ny; ++j) {
    h.first.push_back(h.column.size());
    const float* row = r.value.data() + r.at(0, j);
    const size_t before = h.column.size();
    h.column.resize(before + static_cast<size_t>(r.nx));
    int* to = h.column.data() + before;
    size_t n = 0;
    for (int i = 0; i < r.nx; ++i) to[n] = i, n += std::isnan(row[i]);
    h.column.resize(before + n);
  }
  h.first.push_back(h.column.size());
  return h;
}

void relax_once(Raster& r, const Holes& holes, std::vector<float>& fresh) {
  fresh.resize(holes.column.size());
  const auto each = [&](const auto& take) {
    for (int j = 0; j < r.ny; ++j)
      for (size_t k = holes.first[static_cast<size_t>(j)]; k < holes.first[static_cast<size_t>(j) + 1]; ++k)
        if (const size_t c = r.at(holes.column[k], j); !std::isnan(r.value[c])) take(holes.column[k], j, c, k);
  };
  each([&](int i, int j, size_t c, size_t k) {
    float sum = 0.0F;
    int n = 0;
    // Opposite neighbours count only together, so that a slope is not bent where one is missing.
    const auto add = [&](size_t one, size_t other) {
      const float a = r.value[one], b = r.value[other];
      if (!std::isnan(a) && !std::isnan(b)) sum += a + b, n += 2;
    };
    if (i > 0 && i + 1 < r.nx) add(c - 1, c + 1);
    if (j > 0 && j + 1 < r.ny) add(c - static_cast<size_t>(r.nx), c + static_cast<size_t>(r.nx));
    fresh[k] = n > 0 ? sum / static_cast<float>(n) : r.value[c];
  });
  each([&](int, int, size_t c, size_t k) { r.value[c] = fresh[k]; });
}

}  // namespace

Raster inpaint(const Raster& surface, const Inpainting& how) {
  constexpr float diagonal = 1.41421356F;
  const Holes holes = holes_of(surface);
  const auto row = [&](int j) { return surface.value.data() + surface.at(0, j); };
  std::vector<std::array<Sight, 3>> back(holes.column.size());
  Sweep up(surface.nx, how.reach), down = up;
  for (int j = 0; j < surface.ny; ++j) {
    up.add(row(j));
    for (size_t k = holes.first[static_cast<size_t>(j)]; k < holes.first[static_cast<size_t>(j) + 1]; ++k) back[k] = up.at(holes.column[k]);
  }
  Raster out = surface;
  const auto beyond = static_cast<float>(how.reach + 1);
  std::vector<Sight> west(static_cast<size_t>(surface.nx));
  for (int j = surface.ny; j-- > 0;) {
    down.add(row(j));
    const size_t first = holes.first[static_cast<size_t>(j)], last = holes.first[static_cast<size_t>(j) + 1];
    for (size_t k = first; k < last; ++k) {
      const int i = holes.column[k];
      if (k > first && holes.column[k - 1] == i - 1)
        west[k - first] = {west[k - first - 1].value, std::min(west[k - first - 1].steps + 1.0F, beyond)};
      else
        west[k - first] = i > 0 ? Sight{row(j)[i - 1], 1.0F} : Sight{0.0F, beyond};
    }
    Sight east{0.0F, beyond};
    for (size_t k = last; k-- > first;) {
      const int i = holes.column[k];
      if (k + 1 < last && holes.column[k + 1] == i + 1)
        east.steps = std::min(east.steps + 1.0F, beyond);
      else
        east = i + 1 < surface.nx ? Sight{row(j)[i + 1], 1.0F} : Sight{0.0F, beyond};
      const std::array<Sight, 3> ahead = down.at(i);
      Lines lines(how);
      lines.add(west[k - first], east, 1.0F);
      lines.add(back[k][0], ahead[0], 1.0F);
      lines.add(back[k][1], ahead[2], diagonal);
      lines.add(back[k][2], ahead[1], diagonal);
      if (lines.any()) out.value[out.at(i, j)] = lines.mean();
    }
  }
  std::vector<float> fresh;
  for (int pass = 0; pass < how.relax; ++pass) relax_once(out, holes, fresh);
  return out;
}

}  // namespace swath::filters
