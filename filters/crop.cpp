// SPDX-License-Identifier: GPL-3.0-or-later
// Sides are sorted into bands of northing; a point looks at those of its band. Each point is judged by its own place alone.
#include "filters/crop.h"

#include <algorithm>
#include <cmath>

#include "core/ring.h"

namespace swath::filters {
namespace {

using Eigen::Vector2d;

constexpr double band_height = 4.0;  // m

struct Side {
  Vector2d a, b;
  size_t area = 0;
};

double distance2(const Vector2d& p, const Side& s) {
  const Vector2d d = s.b - s.a;
  const double length2 = d.squaredNorm(), t = length2 > 0.0 ? std::clamp((p - s.a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (s.a + t * d - p).squaredNorm();
}

/// The sides that may matter between two northings.
class Bands {
 public:
  Bands(double south, double north) : south_(south), bands_(static_cast<size_t>((north - south) / band_height) + 1) {}

  void add(const Side& s, double around) {
    const double low = std::min(s.a.y(), s.b.y()) - around, high = std::max(s.a.y(), s.b.y()) + around;
    const double last = static_cast<double>(bands_.size()) - 1.0;
    const double from = std::floor((low - south_) / band_height), to = std::floor((high - south_) / band_height);
    if (to < 0.0 || from > last) return;
    for (auto k = static_cast<size_t>(std::max(from, 0.0)); k <= static_cast<size_t>(std::min(to, last)); ++k) bands_[k].push_back(s);
  }
  const std::vector<Side>& at(double y) const { return bands_[static_cast<size_t>((y - south_) / band_height)]; }

 private:
  double south_;
  std::vector<std::vector<Side>> bands_;
};

/// Sides of an area follow one another in a band.
bool is_in_an_area(const std::vector<Side>& sides, const Vector2d& p) {
  bool inside = false;
  for (size_t k = 0; k < sides.size(); ++k) {
    if (k > 0 && sides[k].area != sides[k - 1].area) {
      if (inside) return true;
      inside = false;
    }
    inside ^= core::crosses_eastward(sides[k].a, sides[k].b, p.x(), p.y());
  }
  return inside;
}

}  // namespace

CropCounts crop(core::Block& b, size_t own, const CropShapes& shapes, bool outside) {
  CropCounts counts;
  if (own == 0) return counts;
  const auto [south, north] = std::minmax_element(b.y.begin(), b.y.begin() + static_cast<std::ptrdiff_t>(own));
  Bands areas(*south, *north), axes(*south, *north);
  for (size_t k = 0; k < shapes.areas.size(); ++k)
    for (const CropLine& ring : shapes.areas[k])
      for (size_t i = 0; i < ring.size(); ++i) areas.add({ring[i], ring[(i + 1) % ring.size()], k}, 0.0);
  for (const CropLine& line : shapes.axes)
    for (size_t i = 1; i < line.size(); ++i) axes.add({line[i - 1], line[i], 0}, shapes.buffer);
  for (size_t p = 0; p < own; ++p) {
    if (b.flags[p] & core::flag::withheld) {
      ++counts.untouched;
      continue;
    }
    const Vector2d at(b.x[p], b.y[p]);
    const std::vector<Side>& near = axes.at(at.y());
    const bool inside = is_in_an_area(areas.at(at.y()), at) || std::any_of(near.begin(), near.end(), [&](const Side& s) {
                          return distance2(at, s) <= shapes.buffer * shapes.buffer;
                        });
    if (inside != outside) {
      ++counts.inside;
      continue;
    }
    b.flags[p] |= core::flag::withheld;
    ++counts.outside;
  }
  return counts;
}

}  // namespace swath::filters
