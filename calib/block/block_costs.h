// SPDX-License-Identifier: GPL-3.0-or-later
// The observation equations, for any type of number (Ceres differentiates them). Residuals are computed less observed, over sigma.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "calib/block/brown.h"

namespace swath::calib {

/// out = exp([w]x) v (Rodrigues; first order near zero, where the derivatives stay finite).
template <class T>
void rotate(const T* w, const std::array<T, 3>& v, std::array<T, 3>& out) {
  using std::cos, std::sin, std::sqrt;
  const T square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  const std::array<T, 3> cross{w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], w[0] * v[1] - w[1] * v[0]};
  if (square > T(1e-20)) {
    const T angle = sqrt(square), s = sin(angle) / angle, c = cos(angle);
    const T along = (w[0] * v[0] + w[1] * v[1] + w[2] * v[2]) * (T(1.0) - c) / square;
    for (int i = 0; i < 3; ++i)
      out[static_cast<size_t>(i)] = c * v[static_cast<size_t>(i)] + s * cross[static_cast<size_t>(i)] + along * w[i];
  } else {
    for (size_t i = 0; i < 3; ++i) out[i] = v[i] + cross[i];
  }
}

/// out = M v, M by rows.
template <class T>
void times(const double* M, const std::array<T, 3>& v, std::array<T, 3>& out) {
  for (size_t i = 0; i < 3; ++i) out[i] = M[3 * i] * v[0] + M[3 * i + 1] * v[1] + M[3 * i + 2] * v[2];
}

/// Collinearity. `pose`: perspective centre and rotation vector; `base`: camera_R_local0 by rows.
struct RayCost {
  double x, y, sigma;
  const double* base;
  const double* factor;  ///< on sigma
  const double* weight;
  DistortionAt at;

  template <class T>
  bool operator()(const T* pose, const T* point, const T* c, T* r) const {
    std::array<T, 3> v{point[0] - pose[0], point[1] - pose[1], point[2] - pose[2]}, turned, d;
    times(base, v, turned);
    rotate(pose + 3, turned, d);
    const T ix = -c[0] * d[0] / d[2], iy = -c[0] * d[1] / d[2];
    const double by = std::sqrt(*weight) / (sigma * *factor);
    T dx, dy;
    if (at == DistortionAt::ideal) {
      brown(c, ix, iy, dx, dy);
      r[0] = (c[1] + ix + dx - x) * by;
      r[1] = (c[2] + iy + dy - y) * by;
    } else {
      const T mx = x - c[1], my = y - c[2];
      brown(c, mx, my, dx, dy);
      r[0] = (ix - mx + dx) * by;
      r[1] = (iy - my + dy) * by;
    }
    return true;
  }
};

/// X_GPS + v = X + a0 + a1 u, X = X0 + local_R_camera a (Ackermann, eq 1, with the antenna's lever arm a); or, where `centre` is given, of
/// another datum: centre + (1 + m) exp(w) (X - centre) + t, the seven being t, w, m.
struct StationCost {
  std::array<double, 3> position;
  std::array<double, 9> root;  ///< by rows, root' root = inverse covariance
  const double* base;
  const double* factor;
  double u;
  const double* centre = nullptr;

  template <class T>
  bool operator()(const T* pose, const T* antenna, const T* moved, T* r) const {
    const std::array<T, 3> back{-pose[3], -pose[4], -pose[5]}, a{antenna[0], antenna[1], antenna[2]};
    std::array<T, 3> turned, e, v;
    rotate(back.data(), a, turned);
    for (size_t i = 0; i < 3; ++i) {
      const T arm = base[i] * turned[0] + base[3 + i] * turned[1] + base[6 + i] * turned[2];
      e[i] = pose[i] + arm - position[i];
      if (moved && !centre) e[i] += moved[i] + u * moved[3 + i];
    }
    if (moved && centre) {
      const std::array<T, 3> from{e[0] + (position[0] - centre[0]), e[1] + (position[1] - centre[1]), e[2] + (position[2] - centre[2])};
      std::array<T, 3> there;
      rotate(moved + 3, from, there);
      for (size_t i = 0; i < 3; ++i) e[i] += (there[i] - from[i]) + moved[6] * there[i] + moved[i];
    }
    times(root.data(), e, v);
    for (size_t i = 0; i < 3; ++i) r[i] = v[i] / *factor;
    return true;
  }
  template <class T>
  bool operator()(const T* pose, const T* antenna, T* r) const {
    return (*this)(pose, antenna, static_cast<const T*>(nullptr), r);
  }
};

/// The rotation from the camera as observed, exp(b) body_R_camera' body_R_local, to the camera as adjusted; about the camera's axes. With a
/// datum: to the adjusted one in the datum of the observed.
struct AttitudeCost {
  std::array<double, 9> local_R_camera;  ///< as observed, with the nominal boresight; by rows
  std::array<double, 9> root;
  const double* base;
  const double* factor;

  template <class T>
  bool operator()(const T* pose, const T* boresight, T* r) const {
    return (*this)(pose, boresight, static_cast<const T*>(nullptr), r);
  }
  template <class T>
  bool operator()(const T* pose, const T* boresight, const T* datum, T* r) const {
    const std::array<T, 3> back{-boresight[0], -boresight[1], -boresight[2]};
    std::array<std::array<T, 3>, 3> column;
    for (size_t j = 0; j < 3; ++j) {
      std::array<T, 3> e{T(0.0), T(0.0), T(0.0)}, a, b, c;
      e[j] = T(1.0);
      rotate(back.data(), e, a);
      times(local_R_camera.data(), a, b);
      if (datum) {
        const std::array<T, 3> to_control{-datum[3], -datum[4], -datum[5]}, there = b;
        rotate(to_control.data(), there, b);
      }
      times(base, b, c);
      rotate(pose + 3, c, column[j]);
    }
    std::array<T, 3> w, v;
    rotation_vector(column, w);
    times(root.data(), w, v);
    for (size_t i = 0; i < 3; ++i) r[i] = v[i] / *factor;
    return true;
  }

 private:
  /// Of a rotation below 180 deg.
  template <class T>
  static void rotation_vector(const std::array<std::array<T, 3>, 3>& column, std::array<T, 3>& w) {
    using std::atan2, std::sqrt;
    const std::array<T, 3> twice{column[1][2] - column[2][1], column[2][0] - column[0][2], column[0][1] - column[1][0]};
    const T square = twice[0] * twice[0] + twice[1] * twice[1] + twice[2] * twice[2];
    const T cosine = column[0][0] + column[1][1] + column[2][2] - T(1.0);  // twice the cosine
    T by(0.5);
    if (square > T(1e-16)) {
      const T sine = sqrt(square);
      by = atan2(sine, cosine) / sine;
    }
    for (size_t i = 0; i < 3; ++i) w[i] = by * twice[i];
  }
};

/// One coordinate of a control point.
struct ControlCost {
  int coordinate;
  double value, sigma;
  const double* factor;
  template <class T>
  bool operator()(const T* point, T* r) const {
    r[0] = (point[coordinate] - value) / (sigma * *factor);
    return true;
  }
};

/// A value that is observed itself.
struct PriorCost {
  int component;
  double value, sigma;
  template <class T>
  bool operator()(const T* values, T* r) const {
    r[0] = (values[component] - value) / sigma;
    return true;
  }
};

}  // namespace swath::calib
