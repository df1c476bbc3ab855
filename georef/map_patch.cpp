// SPDX-License-Identifier: GPL-3.0-or-later
// Source: discrete least squares on Chebyshev nodes (Mason & Handscomb 2003, 4.6 and 6.3), here in three variables
// with total degree 3. Deviation: PROJ is replaced by the polynomial; its fourth-order rest in a cube of 2048 m is below 1e-8 m for a
// conformal projection, and no patch is used that is off by more than 0.02 mm at any of 125 check points. A kink between check points can
// exceed that, by less than five times: the check points include the corners, where a kink that cuts the cube shows most.
#include "georef/map_patch.h"

#include <cmath>

#include "core/config/units.h"

namespace swath::georef {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const std::array<std::array<int, 3>, 20> MapPatches::powers{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {1, 1, 0}, {1, 0, 1},
                                                             {0, 2, 0}, {0, 1, 1}, {0, 0, 2}, {3, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0},
                                                             {1, 1, 1}, {1, 0, 2}, {0, 3, 0}, {0, 2, 1}, {0, 1, 2}, {0, 0, 3}}};

namespace {

constexpr int nodes_per_axis = 4;
constexpr int node_count = nodes_per_axis * nodes_per_axis * nodes_per_axis;
constexpr double metres_per_degree = 111320.0;  // of latitude; of longitude it is less, so that the tolerance is kept

// T_0 to T_3 in powers of u: T_k = sum chebyshev[k][j] u^j.
constexpr double chebyshev[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {-1, 0, 2, 0}, {0, -3, 0, 4}};

double node_angle(int i) { return core::pi * (i + 0.5) / nodes_per_axis; }
double chebyshev_at_node(int degree, int i) { return std::cos(degree * node_angle(i)); }

std::int32_t cube_number(double coordinate, double side) { return static_cast<std::int32_t>(std::floor(coordinate / side)); }

// The weight of each node's value in each coefficient of the cubic. The coefficients of T_a T_b T_c are plain sums over the nodes, on which
// these products are orthogonal; each is then expanded into powers.
using Weights = std::array<std::array<double, node_count>, 20>;
Weights least_squares() {
  const auto& powers = MapPatches::powers;
  Weights w{};
  for (const auto& p : powers) {
    double norm = node_count;
    for (const int k : p)
      if (k > 0) norm /= 2.0;
    size_t row = 0;
    for (int i = 0; i < nodes_per_axis; ++i)
      for (int j = 0; j < nodes_per_axis; ++j)
        for (int k = 0; k < nodes_per_axis; ++k, ++row) {
          const double value = chebyshev_at_node(p[0], i) * chebyshev_at_node(p[1], j) * chebyshev_at_node(p[2], k) / norm;
          for (size_t out = 0; out < powers.size(); ++out) {
            const auto& q = powers[out];
            w[out][row] += chebyshev[p[0]][q[0]] * chebyshev[p[1]][q[1]] * chebyshev[p[2]][q[2]] * value;
          }
        }
  }
  return w;
}

struct Columns {
  std::vector<double> x, y, z;
  void add(const Vector3d& p) { x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z()); }
  Vector3d at(size_t i) const { return {x[i], y[i], z[i]}; }
  size_t through(const core::Transform& t) { return t.apply(x.data(), y.data(), z.data(), x.size()); }
};

}  // namespace

struct MapPatches::Node {
  Patch patch;
  bool divided = false;
};

MapPatches::MapPatches(const core::Crs& map) {
  const double horizontal = map.metres_per_unit() > 0.0 ? map.metres_per_unit() : metres_per_degree;
  const double vertical = map.vertical_metres_per_unit() > 0.0 ? map.vertical_metres_per_unit() : 1.0;
  horizontal_tolerance_ = tolerance / horizontal;
  vertical_tolerance_ = tolerance / vertical;
  pool_.emplace_back(core::wgs84_ecef(), map);
}

MapPatches::~MapPatches() = default;

core::Transform MapPatches::borrow() const {
  const std::lock_guard lock(pool_mutex_);
  if (pool_.size() == 1) return pool_.front().copy();  // the first stays, to be copied
  core::Transform t = std::move(pool_.back());
  pool_.pop_back();
  return t;
}

void MapPatches::give_back(core::Transform t) const {
  const std::lock_guard lock(pool_mutex_);
  pool_.push_back(std::move(t));
}

namespace {
// The cubic in Horner's form.
double cubic(const std::array<double, 20>& a, double x, double y, double z) {
  const double by_x = a[1] + x * (a[4] + x * a[10] + y * a[11] + z * a[12]) + y * (a[5] + y * a[13] + z * a[14]) + z * (a[6] + z * a[15]);
  const double by_y = a[2] + y * (a[7] + y * a[16] + z * a[17]) + z * (a[8] + z * a[18]);
  const double by_z = a[3] + z * (a[9] + z * a[19]);
  return a[0] + x * by_x + y * by_y + z * by_z;
}
}  // namespace

Vector3d MapPatches::Patch::operator()(const Vector3d& ecef) const {
  const Vector3d u = (ecef - centre) / half;
  return {cubic(c[0], u.x(), u.y(), u.z()), cubic(c[1], u.x(), u.y(), u.z()), cubic(c[2], u.x(), u.y(), u.z())};
}

void MapPatches::Patch::apply(double* x, double* y, double* z, size_t n, const Vector3d& origin) const {
  std::array<std::array<double, 20>, 3> a = c;
  for (int k = 0; k < 3; ++k) a[static_cast<size_t>(k)][0] -= origin[k];
  const double cx = centre.x(), cy = centre.y(), cz = centre.z();
  const double scale = 1.0 / half;  // a power of two: as exact as the division
  for (size_t i = 0; i < n; ++i) {
    const double u = (x[i] - cx) * scale, v = (y[i] - cy) * scale, w = (z[i] - cz) * scale;
    x[i] = cubic(a[0], u, v, w);
    y[i] = cubic(a[1], u, v, w);
    z[i] = cubic(a[2], u, v, w);
  }
}

Matrix3d MapPatches::Patch::gradient(const Vector3d& ecef) const {
  const Vector3d u = (ecef - centre) / half;
  Matrix3d J = Matrix3d::Zero();
  for (size_t i = 0; i < powers.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      std::array<int, 3> p = powers[i];
      const size_t at = static_cast<size_t>(axis);
      if (p[at] == 0) continue;
      const double factor = p[at]-- / half;
      const double term = factor * std::pow(u.x(), p[0]) * std::pow(u.y(), p[1]) * std::pow(u.z(), p[2]);
      for (int k = 0; k < 3; ++k) J(k, axis) += c[static_cast<size_t>(k)][i] * term;
    }
  return J;
}

MapPatches::Patch MapPatches::fit(const Vector3d& centre, double half, const core::Transform& t, bool& good) const {
  Patch p;
  p.centre = centre;
  p.half = half;
  Columns nodes;
  for (int i = 0; i < nodes_per_axis; ++i)
    for (int j = 0; j < nodes_per_axis; ++j)
      for (int k = 0; k < nodes_per_axis; ++k)
        nodes.add(centre + half * Vector3d(std::cos(node_angle(i)), std::cos(node_angle(j)), std::cos(node_angle(k))));
  good = nodes.through(t) == 0;
  if (!good) return p;
  static const Weights weights = least_squares();
  for (size_t i = 0; i < weights.size(); ++i)
    for (size_t row = 0; row < node_count; ++row)
      for (int axis = 0; axis < 3; ++axis) p.c[static_cast<size_t>(axis)][i] += weights[i][row] * (nodes.at(row) - nodes.at(0))[axis];
  for (int axis = 0; axis < 3; ++axis) p.c[static_cast<size_t>(axis)][0] += nodes.at(0)[axis];
  // The corners first: most of the patches that fail do so there.
  good = keeps(p, {-1.0, 1.0}, t) && keeps(p, {-1.0, -0.5, 0.0, 0.5, 1.0}, t);
  return p;
}

bool MapPatches::keeps(const Patch& p, const std::vector<double>& lattice, const core::Transform& t) const {
  Columns checks;
  for (const double x : lattice)
    for (const double y : lattice)
      for (const double z : lattice) checks.add(p.centre + p.half * Vector3d(x, y, z));
  const Columns places = checks;
  if (checks.through(t) != 0) return false;
  for (size_t i = 0; i < checks.x.size(); ++i) {
    const Vector3d off = (p(places.at(i)) - checks.at(i)).cwiseAbs();
    if (off.x() > horizontal_tolerance_ || off.y() > horizontal_tolerance_ || off.z() > vertical_tolerance_) return false;
  }
  return true;
}

const MapPatches::Node& MapPatches::node(const Key& key) const {
  {
    const std::shared_lock lock(nodes_mutex_);
    const auto at = nodes_.find(key);
    if (at != nodes_.end()) return *at->second;
  }
  const double side = std::ldexp(cube_side, -key[0]);
  const Vector3d centre = side * (Vector3d(key[1], key[2], key[3]) + Vector3d::Constant(0.5));
  core::Transform t = borrow();
  auto made = std::make_unique<Node>();
  bool good = false;
  made->patch = fit(centre, 0.5 * side, t, good);
  made->divided = !good && side > smallest_side;
  made->patch.by_proj = !good && !made->divided;
  give_back(std::move(t));
  const std::unique_lock lock(nodes_mutex_);
  return *nodes_.emplace(key, std::move(made)).first->second;  // two threads may have made it: both are alike
}

const MapPatches::Patch& MapPatches::patch(const Vector3d& p) const {
  for (std::int32_t level = 0;; ++level) {
    const double side = std::ldexp(cube_side, -level);
    const Node& n = node({level, cube_number(p.x(), side), cube_number(p.y(), side), cube_number(p.z(), side)});
    if (!n.divided) return n.patch;
  }
}

size_t MapPatches::apply(double* x, double* y, double* z, size_t n) const {
  const Patch* last = nullptr;
  std::vector<size_t> left;
  for (size_t i = 0; i < n; ++i) {
    if (!last || !last->holds(x[i], y[i], z[i])) last = &patch({x[i], y[i], z[i]});
    if (last->by_proj) {
      left.push_back(i);
      continue;
    }
    last->apply(x + i, y + i, z + i, 1, Vector3d::Zero());
  }
  if (left.empty()) return 0;
  Columns rest;
  for (const size_t i : left) rest.add({x[i], y[i], z[i]});
  const size_t failed = apply_proj(rest.x.data(), rest.y.data(), rest.z.data(), left.size());
  for (size_t k = 0; k < left.size(); ++k) x[left[k]] = rest.x[k], y[left[k]] = rest.y[k], z[left[k]] = rest.z[k];
  return failed;
}

size_t MapPatches::apply_proj(double* x, double* y, double* z, size_t n) const {
  core::Transform t = borrow();
  const size_t failed = t.apply(x, y, z, n);
  give_back(std::move(t));
  return failed;
}

Vector3d MapPatches::operator()(const Vector3d& ecef) const {
  Vector3d m = ecef;
  apply(&m.x(), &m.y(), &m.z(), 1);
  return m;
}

Matrix3d MapPatches::gradient(const Vector3d& ecef) const {
  const Patch& p = patch(ecef);
  if (!p.by_proj) return p.gradient(ecef);
  constexpr double h = 1.0;  // m: PROJ's rounding of 1e-9 m is then 1e-9 of the slope
  Matrix3d J;
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d a = ecef + h * Vector3d::Unit(axis), b = ecef - h * Vector3d::Unit(axis);
    apply_proj(&a.x(), &a.y(), &a.z(), 1);
    apply_proj(&b.x(), &b.y(), &b.z(), 1);
    J.col(axis) = (a - b) / (2.0 * h);
  }
  return J;
}

MapPatches::Made MapPatches::made() const {
  const std::shared_lock lock(nodes_mutex_);
  Made m;
  for (const auto& [key, n] : nodes_) {
    if (n->patch.by_proj) ++m.by_proj;
    if (!n->divided && !n->patch.by_proj) ++m.polynomial;
  }
  return m;
}

}  // namespace swath::georef
