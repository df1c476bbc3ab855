// SPDX-License-Identifier: GPL-3.0-or-later
// Ideal motions: a triangle turns without delay, a polygon's facets leave no gap.
#include "simulate/scan.h"

#include <algorithm>
#include <cmath>

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

/// Angle of a triangle wave of unit amplitude at phase in turns: -1 at 0, +1 at 1/2.
double triangle(double phase) { return phase < 0.5 ? 4 * phase - 1 : 3 - 4 * phase; }

}  // namespace

ScanState scan_at(const ScannerOptions& s, double t) {
  const double turns = t * s.frequency.value, phase = turns - std::floor(turns);
  const double next = phase + s.frequency.value / s.prf.value;
  ScanState out;
  switch (s.pattern) {
    case Pattern::triangle:
    case Pattern::beam:
      out.angle = s.half_angle.value * triangle(phase);
      out.positive = phase < 0.5;
      out.edge = next >= 1.0 || (phase < 0.5 && next >= 0.5);
      // The nod has a third of the scan's frequency, so that the forward look changes from scan to scan.
      if (s.pattern == Pattern::beam) out.forward = std::sin(s.forward_tilt.value * std::sin(2 * core::pi * turns / 3));
      break;
    case Pattern::sine:
      out.angle = -s.half_angle.value * std::cos(2 * core::pi * phase);
      out.positive = phase < 0.5;
      out.edge = next >= 1.0 || (phase < 0.5 && next >= 0.5);
      break;
    case Pattern::polygon:
      out.angle = s.half_angle.value * (2 * phase - 1);
      out.edge = next >= 1.0;
      break;
    case Pattern::multibeam: {
      out.angle = s.half_angle.value * (2 * phase - 1);
      out.edge = next >= 1.0;
      const double beam = std::fmod(std::floor(t * s.prf.value + 0.5), s.beams);
      out.forward = std::sin(s.forward_tilt.value * (2 * beam / (s.beams - 1) - 1));
      break;
    }
    case Pattern::profile:
      break;
    case Pattern::conical:
    case Pattern::palmer:
      out.angle = 2 * core::pi * phase;
      out.edge = next >= 1.0;
      break;
  }
  return out;
}

Vector3d beam_of(const ScannerOptions& s, double a, double f) {
  switch (s.pattern) {
    case Pattern::conical: {
      const double c = s.half_angle.value;
      return {std::sin(c) * std::cos(a), std::sin(c) * std::sin(a), std::cos(c)};
    }
    case Pattern::palmer: {
      const double b = s.shaft_angle.value, t = s.mirror_tilt.value;
      const Vector3d shaft(-std::sin(b), 0, std::cos(b)), u(std::cos(b), 0, std::sin(b)), v(0, 1, 0);
      const Vector3d n = std::cos(t) * shaft + std::sin(t) * (std::cos(a) * u + std::sin(a) * v);
      const Vector3d in = Vector3d::UnitZ() - 2 * shaft.z() * shaft;
      return in - 2 * in.dot(n) * n;
    }
    default: {
      const double w = std::sqrt(1 - f * f);
      return {f, w * std::sin(a), w * std::cos(a)};
    }
  }
}

double widest_angle(const ScannerOptions& s) {
  if (s.pattern == Pattern::profile) return 0.0;
  if (s.pattern == Pattern::beam || s.pattern == Pattern::multibeam)
    return std::acos(std::cos(s.half_angle.value) * std::cos(s.forward_tilt.value));
  if (s.pattern != Pattern::palmer) return s.half_angle.value;
  double widest = 0.0;
  for (int i = 0; i < 360; ++i) widest = std::max(widest, std::acos(beam_of(s, i * core::degree, 0.0).z()));
  return widest;
}

}  // namespace swath::simulate
