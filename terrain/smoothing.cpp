// SPDX-License-Identifier: GPL-3.0-or-later
// Prediction of a vertex by the tangent planes of its surroundings (Jones, Durand & Desbrun 2003, "Non-iterative, feature-preserving mesh
// smoothing", ACM Trans. Graph. 22), of single rings and repeated, so that it stays narrow beside a break and grows wide elsewhere. In
// place of the distance between prediction and height, which a point's own error spoils, a plane's say follows from its misfit: at a break
// those on either side foretell the edge (Kuwahara et al. 1976).
// The share of variance that is left is counted on white noise that goes the same way (Hutchinson 1990, Commun. Stat. Simul. Comput. 19).
#include "terrain/smoothing.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>

#include "terrain/delaunay.h"

namespace swath::terrain {
namespace {

constexpr int passes = 3;
constexpr double longest_edge = 2.0;  // radii
constexpr double alike = 0.05;        // m: planes of less misfit have the same say
constexpr size_t least_ring = 4;      // neighbours of a plane
constexpr double least_area = 0.01;   // det / trace^2 of the neighbours' spread, 0.25 where it is round

constexpr int probes = 4;
using Probe = Eigen::Array<float, probes, 1>;

struct Vertex {
  double x, y, z;
  Probe noise;
};

/// Through a vertex's surroundings, heights at the vertex; quality 0 where there is none.
struct Plane {
  double height = 0.0;
  float east = 0.0F, north = 0.0F, quality = 0.0F;
  Probe noise = Probe::Zero(), noise_east = Probe::Zero(), noise_north = Probe::Zero();
};

/// Signs that follow from the place alone (mixing of Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators").
Probe white_noise(double x, double y) {
  std::uint64_t h = std::bit_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15U + std::bit_cast<std::uint64_t>(y);
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9U;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebU;
  Probe p;
  for (int k = 0; k < probes; ++k) p[k] = (h >> (40 + k)) & 1U ? 1.0F : -1.0F;
  return p;
}

/// The neighbours of each vertex that moves, in an order that the places alone decide.
class Rings {
 public:
  Rings(const Tin& tin, size_t points, double radius) : tin_(tin), radius_(radius), start_(tin.x.size() + 1, 0) {
    std::vector<std::int32_t> triangle(tin.x.size(), -1);
    for (size_t t = 0; t < tin.size(); ++t)
      for (const std::int32_t v : tin.triangles[t]) triangle[static_cast<size_t>(v)] = static_cast<std::int32_t>(t);
    near_.reserve(6 * tin.x.size());
    std::vector<std::int32_t> ring;
    for (size_t v = 0; v < tin.x.size(); ++v) {
      if (tin.row[v] < points && triangle[v] >= 0 && goes_round(static_cast<std::int32_t>(v), triangle[v], ring)) take(v, ring);
      start_[v + 1] = static_cast<std::uint32_t>(near_.size());
    }
  }

  std::span<const std::int32_t> of(size_t v) const { return {near_.data() + start_[v], near_.data() + start_[v + 1]}; }

 private:
  /// Collects the vertices around v; false where a triangle is missing.
  bool goes_round(std::int32_t v, std::int32_t first, std::vector<std::int32_t>& ring) const {
    ring.clear();
    std::int32_t t = first, behind = 0, ahead = 0;
    for (const std::int32_t u : tin_.triangles[static_cast<size_t>(t)])
      if (u != v) behind = ahead, ahead = u;
    do {
      ring.push_back(ahead);
      const auto& [a, b, c] = tin_.triangles[static_cast<size_t>(t)];
      t = tin_.across[static_cast<size_t>(t)][behind == a ? 0 : behind == b ? 1 : 2];
      if (t < 0) return false;
      const auto& [d, e, f] = tin_.triangles[static_cast<size_t>(t)];
      behind = std::exchange(ahead, d ^ e ^ f ^ v ^ ahead);
    } while (t != first);
    return true;
  }

  void take(size_t v, std::vector<std::int32_t>& ring) {
    const auto before = [&](std::int32_t a, std::int32_t b) { return is_before(tin_.place(a), tin_.place(b)); };
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), before), ring.end());
    if (before(ring.back(), ring[1])) std::reverse(ring.begin() + 1, ring.end());
    const size_t first = near_.size();
    for (const std::int32_t u : ring) {
      const double dx = tin_.x[static_cast<size_t>(u)] - tin_.x[v], dy = tin_.y[static_cast<size_t>(u)] - tin_.y[v];
      const double square = dx * dx + dy * dy;
      if (square > longest_edge * longest_edge * radius_ * radius_) return near_.resize(first);
      if (square < radius_ * radius_) near_.push_back(u);
    }
    if (near_.size() - first < least_ring) near_.resize(first);
  }

  const Tin& tin_;
  double radius_;
  std::vector<std::uint32_t> start_;
  std::vector<std::int32_t> near_;
};

/// Tukey's biweight.
double weight(double square, double radius) {
  const double u = 1.0 - square / (radius * radius);
  return u * u;
}

/// By weighted least squares through a vertex and its neighbours.
Plane plane_at(const std::vector<Vertex>& vertices, size_t v, std::span<const std::int32_t> ring, double radius) {
  const Vertex& at = vertices[v];
  double s = 1.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0, sz = 0.0, sxz = 0.0, syz = 0.0, szz = 0.0;
  Probe n = at.noise, nx = Probe::Zero(), ny = Probe::Zero();
  for (const std::int32_t u : ring) {
    const Vertex& o = vertices[static_cast<size_t>(u)];
    const double x = o.x - at.x, y = o.y - at.y, z = o.z - at.z, w = weight(x * x + y * y, radius);
    const double wx = w * x, wy = w * y, wz = w * z;
    s += w, sx += wx, sy += wy, sz += wz;
    sxx += wx * x, sxy += wx * y, syy += wy * y, sxz += wx * z, syz += wy * z, szz += wz * z;
    n += static_cast<float>(w) * o.noise, nx += static_cast<float>(wx) * o.noise, ny += static_cast<float>(wy) * o.noise;
  }
  // Cholesky, the height first.
  const double lx = sx / s, ly = sy / s, xx = sxx - lx * sx, xy = sxy - lx * sy, yy = syy - ly * sy;
  Plane p;
  if (!(xx * yy - xy * xy > least_area * (xx + yy) * (xx + yy))) return p;
  const double lxy = xy / xx, rest = yy - lxy * xy;
  const double xz = sxz - lx * sz, yz = syz - ly * sz;
  const double north = (yz - lxy * xz) / rest, east = (xz - xy * north) / xx, height = (sz - sx * east - sy * north) / s;
  const double left = std::max(0.0, szz - height * sz - east * sxz - north * syz);
  const auto count = static_cast<double>(ring.size() + 1);
  const double misfit = left / s * count / (count - 3.0) + alike * alike;
  const Probe nxc = nx - static_cast<float>(lx) * n, nyc = ny - static_cast<float>(ly) * n;
  p.noise_north = (nyc - static_cast<float>(lxy) * nxc) / static_cast<float>(rest);
  p.noise_east = (nxc - static_cast<float>(xy) * p.noise_north) / static_cast<float>(xx);
  p.noise = (n - static_cast<float>(sx) * p.noise_east - static_cast<float>(sy) * p.noise_north) / static_cast<float>(s);
  p.height = at.z + height;
  p.east = static_cast<float>(east), p.north = static_cast<float>(north);
  p.quality = static_cast<float>(alike * alike * alike * alike / (misfit * misfit));
  return p;
}

void move(std::vector<Vertex>& vertices, size_t v, std::span<const std::int32_t> ring, const std::vector<Plane>& planes, double radius) {
  Vertex& at = vertices[v];
  const Plane& own = planes[v];
  double weights = own.quality, z = own.quality * (own.height - at.z);
  Probe noise = own.quality * own.noise;
  for (const std::int32_t u : ring) {
    const Plane& p = planes[static_cast<size_t>(u)];
    const Vertex& o = vertices[static_cast<size_t>(u)];
    const double x = at.x - o.x, y = at.y - o.y, w = p.quality * weight(x * x + y * y, radius);
    if (!(w > 0.0)) continue;
    const auto fw = static_cast<float>(w), fx = static_cast<float>(x), fy = static_cast<float>(y);
    weights += w;
    z += w * (p.height - at.z + p.east * x + p.north * y);
    noise += fw * (p.noise + p.noise_east * fx + p.noise_north * fy);
  }
  if (!(weights > 0.0)) return;
  at.z += z / weights;
  at.noise = noise / static_cast<float>(weights);
}

}  // namespace

double smoothing_reach(double radius) { return (longest_edge + 2.0 * passes) * radius; }

std::vector<float> smooth_heights(Tin& tin, size_t points, double radius) {
  const Rings rings(tin, points, radius);
  const size_t size = tin.x.size();
  std::vector<Vertex> vertices(size);
  for (size_t v = 0; v < size; ++v) vertices[v] = {tin.x[v], tin.y[v], tin.z[v], white_noise(tin.x[v], tin.y[v])};
  {
    std::vector<Plane> planes(size);
    for (int pass = 0; pass < passes; ++pass) {
      for (size_t v = 0; v < size; ++v)
        if (!rings.of(v).empty()) planes[v] = plane_at(vertices, v, rings.of(v), radius);
      for (size_t v = 0; v < size; ++v)
        if (!rings.of(v).empty()) move(vertices, v, rings.of(v), planes, radius);
    }
  }
  std::vector<float> left(size, 1.0F);
  for (size_t v = 0; v < size; ++v) {
    tin.z[v] = vertices[v].z;
    const auto ring = rings.of(v);
    if (ring.empty()) continue;
    float sum = vertices[v].noise.square().mean();
    for (const std::int32_t u : ring) sum += vertices[static_cast<size_t>(u)].noise.square().mean();
    left[v] = std::min(1.0F, sum / static_cast<float>(ring.size() + 1));
  }
  return left;
}

}  // namespace swath::terrain
