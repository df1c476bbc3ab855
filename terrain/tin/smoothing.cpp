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
#include <span>
#include <utility>

#include "core/wide.h"
#include "terrain/tin/faces.h"

namespace swath::terrain {
namespace {

constexpr int passes = 3;
constexpr double longest_edge = 2.0;  // radii
constexpr float least_taken = 0.25F;  // share of the variance
constexpr int scatter_rings = 2;      // over which it is averaged how far vertices have moved
// A height follows from planes one ring around it, each of these from heights another ring around, pass by pass.
constexpr int moving_rings = scatter_rings + 2 * passes - 1;
constexpr size_t part_size = 65536;  // vertices smoothed together: they stay in the processor's cache, and a tenth is around them
constexpr float alike = 0.05F;       // m: planes of less misfit have the same say
constexpr size_t least_ring = 4;     // neighbours of a plane
constexpr float least_area = 0.01F;  // det / trace^2 of the neighbours' spread, 0.25 where it is round

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
  float east, north, rise;
  float weight;  ///< Tukey's biweight
  std::int32_t to;
};

/// {east, north, rise, weight}
Eigen::Map<const Eigen::Array4f> vector(const Edge& e) { return Eigen::Map<const Eigen::Array4f>(&e.east); }

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

/// The vertices that share an edge with each vertex of a TIN.
class Neighbours {
 public:
  explicit Neighbours(const Tin& tin) : end_(tin.x.size() + 1, 0), is_open_(tin.x.size(), 0) {
    const auto size = static_cast<std::int32_t>(tin.size());
    // As many as triangles, and one more for every two edges on the border.
    for (std::int32_t t = 0; t < size; ++t)
      for (int k = 0; k < 3; ++k) {
        const auto& v = tin.triangles[static_cast<size_t>(t)];
        end_[static_cast<size_t>(v[k])] += 2;
        if (tin.across[static_cast<size_t>(t)][k] >= 0) continue;
        for (const std::int32_t p : {v[ccw(k)], v[cw(k)]}) ++end_[static_cast<size_t>(p)], is_open_[static_cast<size_t>(p)] = 1;
      }
    std::uint32_t sum = 0;
    for (std::uint32_t& e : end_) sum += std::exchange(e, sum) / 2;
    all_.resize(sum);
    for (std::int32_t t = 0; t < size; ++t)
      for (int k = 0; k < 3; ++k) {
        if (tin.across[static_cast<size_t>(t)][k] >= t) continue;  // each edge once
        const auto& v = tin.triangles[static_cast<size_t>(t)];
        const std::int32_t p = v[ccw(k)], q = v[cw(k)];
        all_[end_[static_cast<size_t>(p)]++] = q;
        all_[end_[static_cast<size_t>(q)]++] = p;
      }
  }

  std::span<const std::int32_t> of(size_t v) const { return {all_.data() + (v == 0 ? 0 : end_[v - 1]), all_.data() + end_[v]}; }
  /// Of all vertices together.
  size_t size() const { return all_.size(); }
  /// Whether it is on the border.
  bool is_open(size_t v) const { return is_open_[v]; }

 private:
  std::vector<std::uint32_t> end_;
  std::vector<std::int32_t> all_;
  std::vector<char> is_open_;
};

/// Whether a triangle may touch the rectangle.
bool comes_near(const Tin& tin, const std::array<std::int32_t, 3>& v, const Rectangle& r) {
  const double a = tin.y[v[0]], b = tin.y[v[1]], c = tin.y[v[2]];
  return (tin.x[v[2]] >= r.west) & (tin.x[v[0]] <= r.east) & (std::max(std::max(a, b), c) >= r.south) &
         (std::min(std::min(a, b), c) <= r.north);
}

/// The vertices of triangles that touch `where`.
std::vector<char> vertices_near(const Tin& tin, const Rectangle& where) {
  std::vector<char> is_near(tin.x.size(), 0);
  for (const auto& t : tin.triangles)
    if (comes_near(tin, t, where))
      for (const std::int32_t v : t) is_near[static_cast<size_t>(v)] = 1;
  return is_near;
}

/// Some vertices with numbers of their own: those whose heights count, then ring by ring those that have a say in them.
class Part {
 public:
  Part(const Neighbours& neighbours, size_t vertices) : neighbours_(neighbours), number_(vertices, -1) {}

  /// Those of `first` to `last` - 1 that count.
  void take(size_t first, size_t last, const std::vector<char>& counts) {
    for (const std::int32_t v : vertices_) number_[static_cast<size_t>(v)] = -1;
    vertices_.clear();
    for (size_t v = first; v < last; ++v)
      if (counts[v]) add(static_cast<std::int32_t>(v));
    counting_ = vertices_.size();
    size_t from = 0;
    for (int ring = 0; ring <= moving_rings; ++ring) {
      moving_ = vertices_.size();
      for (size_t i = from; i < moving_; ++i)
        for (const std::int32_t n : neighbours_.of(at(i)))
          if (number_[static_cast<size_t>(n)] < 0) add(n);
      from = moving_;
    }
  }

  size_t size() const { return vertices_.size(); }
  size_t counting() const { return counting_; }  ///< the first, whose heights count
  size_t moving() const { return moving_; }      ///< the first, that move and have all their neighbours here
  size_t at(size_t number) const { return static_cast<size_t>(vertices_[number]); }
  std::int32_t number(std::int32_t vertex) const { return number_[static_cast<size_t>(vertex)]; }
  const Neighbours& neighbours() const { return neighbours_; }

 private:
  void add(std::int32_t v) {
    number_[static_cast<size_t>(v)] = static_cast<std::int32_t>(vertices_.size());
    vertices_.push_back(v);
  }

  const Neighbours& neighbours_;
  std::vector<std::int32_t> vertices_, number_;
  size_t counting_ = 0, moving_ = 0;
};

/// The neighbours of each vertex of a part that moves, in an order that their places and heights alone decide.
class Rings {
 public:
  void take(const Tin& tin, const Part& part, size_t points, double radius) {
    edges_.clear();
    start_.assign(1, 0);
    for (size_t i = 0; i < part.size(); ++i) {
      const size_t v = part.at(i);
      if (i < part.moving() && tin.row[v] < points && !part.neighbours().is_open(v)) {
        look_around(tin, part, v, radius);
        put_in_order();
      }
      start_.push_back(static_cast<std::uint32_t>(edges_.size()));
    }
  }

  std::span<const Edge> of(size_t i) const { return {edges_.data() + start_[i], edges_.data() + start_[i + 1]}; }

 private:
  /// None where one of them is far or too few are near.
  void look_around(const Tin& tin, const Part& part, size_t v, double radius) {
    const auto per_square = static_cast<float>(1.0 / (radius * radius));
    const double x = tin.x[v], y = tin.y[v], z = tin.z[v];
    const std::span<const std::int32_t> neighbours = part.neighbours().of(v);
    near_.resize(neighbours.size());
    size_t count = 0;
    double longest = 0.0;
    for (const std::int32_t n : neighbours) {
      const auto at = static_cast<size_t>(n);
      const double dx = tin.x[at] - x, dy = tin.y[at] - y, square = dx * dx + dy * dy;
      Edge e{static_cast<float>(dx), static_cast<float>(dy), static_cast<float>(tin.z[at] - z), 0.0F, part.number(n)};
      const float u = 1.0F - (e.east * e.east + e.north * e.north) * per_square;
      e.weight = u * u;
      near_[count] = {e, key_of(e), 0};
      count += square < radius * radius;
      longest = std::max(longest, square);
    }
    near_.resize(longest > longest_edge * longest_edge * radius * radius || count < least_ring ? 0 : count);
  }

  /// Each to where as many are before it: a few, nearly always six.
  void put_in_order() {
    for (size_t i = 0; i < near_.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const bool before = near_[j].key < near_[i].key;
        near_[i].rank += before;
        near_[j].rank += !before;
      }
    const size_t first = edges_.size();
    edges_.resize(first + near_.size());
    for (const Near& n : near_) edges_[first + n.rank] = n.edge;
  }

  std::vector<std::uint32_t> start_;
  std::vector<Edge> edges_;
  std::vector<Near> near_;
};

/// Through a vertex's surroundings: the signal at the vertex and its change per metre, heights over the vertex's own as it came.
struct Plane {
  Signal at = Signal::Zero(), east = Signal::Zero(), north = Signal::Zero();
  float quality = 0.0F;  ///< 0 where there is none
};

/// By weighted least squares through a vertex and its neighbours.
[[gnu::always_inline]] inline Plane plane_at(const std::vector<Signal>& signals, size_t v, std::span<const Edge> ring) {
  float s = 1.0F;
  Signal f = signals[v], fx = Signal::Zero(), fy = Signal::Zero();
  Eigen::Array4f sum = Signal::Zero(), sum_x = Signal::Zero(), sum_y = Signal::Zero();  // of {x, y, rise}, times 1, x and y
  for (const Edge& e : ring) {
    const Eigen::Array4f weighted = e.weight * vector(e);
    const float wx = weighted[0], wy = weighted[1];
    s += e.weight, sum += weighted, sum_x += wx * vector(e), sum_y += wy * vector(e);
    const Signal& at = signals[static_cast<size_t>(e.to)];
    f += e.weight * at, fx += wx * at, fy += wy * at;
  }
  f[0] += sum[2], fx[0] += sum_x[2], fy[0] += sum_y[2];
  // About the places' mean.
  const float per_s = 1.0F / s, mx = sum[0] * per_s, my = sum[1] * per_s;
  const float xx = sum_x[0] - mx * sum[0], xy = sum_x[1] - mx * sum[1], yy = sum_y[1] - my * sum[1];
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
    left += e.weight * misfit * misfit;
  }
  const auto count = static_cast<float>(ring.size() + 1);
  const float misfit = alike * alike + left * per_s * count / (count - 3.0F);
  p.quality = alike * alike * alike * alike / (misfit * misfit);
  return p;
}

/// The mean of what the planes foretell.
[[gnu::always_inline]] inline Signal moved(const Signal& signal, const std::vector<Plane>& planes, size_t v, std::span<const Edge> ring) {
  float weights = planes[v].quality, rise = 0.0F;
  Signal sum = weights * planes[v].at;
  for (const Edge& e : ring) {
    const Plane& p = planes[static_cast<size_t>(e.to)];
    const float w = p.quality * e.weight;
    weights += w;
    rise += w * e.rise;
    sum += w * (p.at - e.east * p.east - e.north * p.north);
  }
  sum[0] += rise;
  return weights > 0.0F ? Signal(sum * (1.0F / weights)) : signal;
}

/// The signals of a part's vertices after all passes; those on its rim are not of use.
SWATH_WIDE void smooth(const Tin& tin, const Part& part, const Rings& rings, std::vector<Signal>& signals, std::vector<Plane>& planes) {
  signals.resize(part.size());
  for (size_t i = 0; i < part.size(); ++i) signals[i] = white_noise(tin.x[part.at(i)], tin.y[part.at(i)]);
  planes.assign(part.size(), Plane());
  for (int pass = 0; pass < passes; ++pass) {
    for (size_t i = 0; i < part.moving(); ++i)
      if (!rings.of(i).empty()) planes[i] = plane_at(signals, i, rings.of(i));
    for (size_t i = 0; i < part.moving(); ++i)
      if (!rings.of(i).empty()) signals[i] = moved(signals[i], planes, i, rings.of(i));
  }
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

Smoothed smooth_heights(Tin& tin, size_t points, double radius, const Rectangle& where) {
  const size_t size = tin.x.size();
  const Neighbours neighbours(tin);
  const std::vector<char> counts = vertices_near(tin, where);
  std::vector<double> height = tin.z;
  Smoothed out{std::vector<float>(size, 1.0F), std::vector<float>(size, std::numeric_limits<float>::quiet_NaN())};
  Part part(neighbours, size);
  Rings rings;
  std::vector<Signal> signals;
  std::vector<Plane> planes;
  for (size_t first = 0; first < size; first += part_size) {
    part.take(first, std::min(first + part_size, size), counts);
    rings.take(tin, part, points, radius);
    smooth(tin, part, rings, signals, planes);
    const std::vector<float> scatter = squares_around(rings, signals);
    for (size_t i = 0; i < part.counting(); ++i) {
      const auto ring = rings.of(i);
      if (ring.empty()) continue;
      const size_t v = part.at(i);
      height[v] += static_cast<double>(signals[i][0]);
      float sum = noise_square(signals[i]);
      for (const Edge& e : ring) sum += noise_square(signals[static_cast<size_t>(e.to)]);
      out.left[v] = std::min(1.0F, sum / static_cast<float>(ring.size() + 1));
      out.scatter[v] = scatter[i] / std::max(least_taken, 1.0F - out.left[v]);
    }
  }
  tin.z.swap(height);
  return out;
}

}  // namespace swath::terrain
