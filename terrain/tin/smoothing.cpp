// SPDX-License-Identifier: GPL-3.0-or-later
// Prediction of a vertex by the tangent planes of its surroundings (Jones, Durand & Desbrun 2003, "Non-iterative, feature-preserving mesh
// smoothing", ACM Trans. Graph. 22), of single rings and repeated, so that it stays narrow beside a break and grows wide elsewhere. In
// place of the distance between prediction and height, which a point's own error spoils, a plane's say follows from its misfit: at a break
// those on either side foretell the edge (Kuwahara et al. 1976).
// The share of variance that is left is counted on white noise that goes the same way (Hutchinson 1990, Commun. Stat. Simul. Comput. 19).
#include "terrain/tin/smoothing.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "terrain/tin/faces.h"

namespace swath::terrain {
namespace {

constexpr int passes = 3;
constexpr double longest_edge = 2.0;  // radii
constexpr float least_taken = 0.25F;  // share of the variance
constexpr int scatter_rings = 2;      // over which it is averaged how far vertices have moved
constexpr float alike = 0.05F;        // m: planes of less misfit have the same say
constexpr size_t least_ring = 4;      // neighbours of a plane
constexpr float least_area = 0.01F;   // det / trace^2 of the neighbours' spread, 0.25 where it is round

/// What goes the same way from pass to pass: m that a vertex has moved up, and three draws of white noise.
using Signal = Eigen::Array4f;

/// Signs that follow from the place alone (mixing of Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators").
Signal white_noise(double x, double y) {
  std::uint64_t h = std::bit_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15U + std::bit_cast<std::uint64_t>(y);
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9U;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebU;
  const auto sign = [h](int k) { return (h >> (40 + k)) & 1U ? 1.0F : -1.0F; };
  return {0.0F, sign(0), sign(1), sign(2)};
}

float noise_square(const Signal& s) { return (s[1] * s[1] + s[2] * s[2] + s[3] * s[3]) / 3.0F; }

/// To a neighbour, m; the rise is that of the heights as they came.
struct Edge {
  std::int32_t to;
  float east, north, rise;
};

/// A neighbour on its way to its place in the order.
struct Near {
  Edge edge;
  std::uint64_t key;  ///< what it is does not matter, as long as place and height alone decide it
  std::uint32_t rank;
};

std::uint64_t key_of(const Edge& e) {
  const auto bits = [](float f) { return std::uint64_t{std::bit_cast<std::uint32_t>(f)}; };
  return (bits(e.east) << 32 | bits(e.north)) ^ bits(e.rise) * 0x9e3779b97f4a7c15U;
}

/// The neighbours of each vertex that moves, in an order that their places and heights alone decide.
class Rings {
 public:
  Rings(const Tin& tin, size_t points, double radius) : start_(tin.x.size() + 1, 0) {
    const size_t size = tin.x.size();
    std::vector<std::uint32_t> start(size + 1, 0);
    std::vector<char> open(size, 0);
    const auto each_edge = [&tin](auto&& see) {  // once
      for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t) {
        const auto& v = tin.triangles[static_cast<size_t>(t)];
        for (int k = 0; k < 3; ++k) {
          const std::int32_t other = tin.across[static_cast<size_t>(t)][k];
          if (other < t) see(static_cast<size_t>(v[ccw(k)]), static_cast<size_t>(v[cw(k)]), other < 0);
        }
      }
    };
    each_edge([&](size_t p, size_t q, bool is_border) {
      ++start[p], ++start[q];
      if (is_border) open[p] = open[q] = 1;
    });
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) sum += std::exchange(s, sum);
    std::vector<std::int32_t> neighbours(sum);
    each_edge([&](size_t p, size_t q, bool) {
      neighbours[start[p]++] = static_cast<std::int32_t>(q);
      neighbours[start[q]++] = static_cast<std::int32_t>(p);
    });
    std::vector<Eigen::Vector3d> place(size);
    for (size_t v = 0; v < size; ++v) place[v] = {tin.x[v], tin.y[v], tin.z[v]};
    edges_ = std::make_unique_for_overwrite<Edge[]>(sum);
    std::vector<Near> near;
    std::uint32_t first = 0, taken = 0;
    for (size_t v = 0; v < size; first = start[v++]) {
      if (tin.row[v] < points && !open[v]) {
        look_around(place, v, std::span(neighbours).subspan(first, start[v] - first), radius, near);
        put_in_order(near, edges_.get() + taken);
        taken += static_cast<std::uint32_t>(near.size());
      }
      start_[v + 1] = taken;
    }
  }

  std::span<const Edge> of(size_t v) const { return {edges_.get() + start_[v], edges_.get() + start_[v + 1]}; }

 private:
  /// None where one of them is far or too few are near.
  static void look_around(const std::vector<Eigen::Vector3d>& place, size_t v, std::span<const std::int32_t> neighbours, double radius,
                          std::vector<Near>& near) {
    near.resize(neighbours.size());
    size_t count = 0;
    double longest = 0.0;
    for (const std::int32_t n : neighbours) {
      const Eigen::Vector3d d = place[static_cast<size_t>(n)] - place[v];
      const double square = d.x() * d.x() + d.y() * d.y();
      const Edge e{n, static_cast<float>(d.x()), static_cast<float>(d.y()), static_cast<float>(d.z())};
      near[count] = {e, key_of(e), 0};
      count += square < radius * radius;
      longest = std::max(longest, square);
    }
    near.resize(longest > longest_edge * longest_edge * radius * radius || count < least_ring ? 0 : count);
  }

  /// Each to where as many are before it: a few, nearly always six.
  static void put_in_order(std::vector<Near>& near, Edge* out) {
    for (size_t i = 0; i < near.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const bool before = near[j].key < near[i].key;
        near[i].rank += before;
        near[j].rank += !before;
      }
    for (const Near& n : near) out[n.rank] = n.edge;
  }

  std::vector<std::uint32_t> start_;
  std::unique_ptr<Edge[]> edges_;
};

/// Through a vertex's surroundings: the signal at the vertex and its change per metre, heights over the vertex's own as it came.
struct Plane {
  Signal at = Signal::Zero(), east = Signal::Zero(), north = Signal::Zero();
  float quality = 0.0F;  ///< 0 where there is none
};

/// Tukey's biweight.
float weight(const Edge& e, float per_square) {
  const float u = 1.0F - (e.east * e.east + e.north * e.north) * per_square;
  return u * u;
}

/// By weighted least squares through a vertex and its neighbours. `per_square`: of the radius.
Plane plane_at(const std::vector<Signal>& signals, size_t v, std::span<const Edge> ring, float per_square) {
  float s = 1.0F, sx = 0.0F, sy = 0.0F, sxx = 0.0F, sxy = 0.0F, syy = 0.0F, rise = 0.0F, rise_x = 0.0F, rise_y = 0.0F;
  Signal f = signals[v], fx = Signal::Zero(), fy = Signal::Zero();
  for (const Edge& e : ring) {
    const float w = weight(e, per_square), wx = w * e.east, wy = w * e.north;
    s += w, sx += wx, sy += wy, sxx += wx * e.east, sxy += wx * e.north, syy += wy * e.north;
    rise += w * e.rise, rise_x += wx * e.rise, rise_y += wy * e.rise;
    const Signal& at = signals[static_cast<size_t>(e.to)];
    f += w * at, fx += wx * at, fy += wy * at;
  }
  f[0] += rise, fx[0] += rise_x, fy[0] += rise_y;
  // About the places' mean.
  const float per_s = 1.0F / s, mx = sx * per_s, my = sy * per_s, xx = sxx - mx * sx, xy = sxy - mx * sy, yy = syy - my * sy;
  const float det = xx * yy - xy * xy;
  Plane p;
  if (!(det > least_area * (xx + yy) * (xx + yy))) return p;
  fx -= mx * f, fy -= my * f;
  const float per_det = 1.0F / det;
  p.east = (per_det * yy) * fx - (per_det * xy) * fy;
  p.north = (per_det * xx) * fy - (per_det * xy) * fx;
  p.at = per_s * f - mx * p.east - my * p.north;
  float left = (signals[v][0] - p.at[0]) * (signals[v][0] - p.at[0]);
  for (const Edge& e : ring) {
    const float misfit = signals[static_cast<size_t>(e.to)][0] + e.rise - p.at[0] - p.east[0] * e.east - p.north[0] * e.north;
    left += weight(e, per_square) * misfit * misfit;
  }
  const auto count = static_cast<float>(ring.size() + 1);
  const float misfit = alike * alike + left * per_s * count / (count - 3.0F);
  p.quality = alike * alike * alike * alike / (misfit * misfit);
  return p;
}

/// The mean of what the planes foretell.
Signal moved(const Signal& signal, const std::vector<Plane>& planes, size_t v, std::span<const Edge> ring, float per_square) {
  float weights = planes[v].quality, rise = 0.0F;
  Signal sum = weights * planes[v].at;
  for (const Edge& e : ring) {
    const Plane& p = planes[static_cast<size_t>(e.to)];
    const float w = p.quality * weight(e, per_square);
    weights += w;
    rise += w * e.rise;
    sum += w * (p.at - e.east * p.east - e.north * p.north);
  }
  sum[0] += rise;
  return weights > 0.0F ? Signal(sum * (1.0F / weights)) : signal;
}

/// Mean square of what vertices have moved, over rings around each; NaN where none has.
std::vector<float> squares_around(const Rings& rings, const std::vector<Signal>& signals) {
  const size_t size = signals.size();
  std::vector<float> square(size, std::numeric_limits<float>::quiet_NaN()), mean(size);
  for (size_t v = 0; v < size; ++v)
    if (!rings.of(v).empty()) square[v] = signals[v][0] * signals[v][0];
  for (int ring = 0; ring < scatter_rings; ++ring) {
    for (size_t v = 0; v < size; ++v) {
      float sum = 0.0F, count = 0.0F;
      const auto add = [&](float s) {
        if (!std::isnan(s)) sum += s, count += 1.0F;
      };
      add(square[v]);
      for (const Edge& e : rings.of(v)) add(square[static_cast<size_t>(e.to)]);
      mean[v] = count > 0.0F ? sum / count : square[v];
    }
    square.swap(mean);
  }
  return square;
}

}  // namespace

double smoothing_reach(double radius) { return (longest_edge + 2.0 * passes + longest_edge * scatter_rings) * radius; }

Smoothed smooth_heights(Tin& tin, size_t points, double radius) {
  const Rings rings(tin, points, radius);
  const size_t size = tin.x.size();
  const auto per_square = static_cast<float>(1.0 / (radius * radius));
  std::vector<Signal> signals(size);
  for (size_t v = 0; v < size; ++v) signals[v] = white_noise(tin.x[v], tin.y[v]);
  std::vector<Plane> planes(size);
  for (int pass = 0; pass < passes; ++pass) {
    for (size_t v = 0; v < size; ++v)
      if (!rings.of(v).empty()) planes[v] = plane_at(signals, v, rings.of(v), per_square);
    for (size_t v = 0; v < size; ++v)
      if (!rings.of(v).empty()) signals[v] = moved(signals[v], planes, v, rings.of(v), per_square);
  }
  Smoothed out{std::vector<float>(size, 1.0F), squares_around(rings, signals)};
  for (size_t v = 0; v < size; ++v) {
    const auto ring = rings.of(v);
    if (ring.empty()) continue;
    tin.z[v] += static_cast<double>(signals[v][0]);
    float sum = noise_square(signals[v]);
    for (const Edge& e : ring) sum += noise_square(signals[static_cast<size_t>(e.to)]);
    out.left[v] = std::min(1.0F, sum / static_cast<float>(ring.size() + 1));
    out.scatter[v] /= std::max(least_taken, 1.0F - out.left[v]);
  }
  return out;
}

}  // namespace swath::terrain
