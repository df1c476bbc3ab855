// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/world/power_line.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace swath::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double corridor = 30.0;  // m to both sides

class Survey {
 public:
  Survey(PowerLineScene& s, const LineOfWires& o) : scene_(s), options_(o), random_(o.seed) {
    scene_.block.origin = {512300.0, 5402100.0, 0.0};
  }

  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  int poisson(double mean) { return std::poisson_distribution<int>(mean)(random_); }

  void add(double x, double y, double z, std::uint8_t truth) {
    core::Block& b = scene_.block;
    const auto line = static_cast<std::uint16_t>(1 + static_cast<int>(uniform(0.0, options_.flight_lines - 1e-9)));
    b.x.push_back(x);
    b.y.push_back(y);
    b.z.push_back(z + std::normal_distribution<double>(0.0, options_.noise)(random_) + (line == 2 ? options_.step : 0.0));
    b.strip.push_back(line);
    b.return_number.push_back(1);
    b.return_count.push_back(1);
    b.height.push_back(static_cast<float>(b.z.back() - scene_.terrain(x, y)));
    scene_.truth.push_back(truth);
  }

  /// Pulses whose footprint holds a part of the wire: their returns lie on the beam's axis, up to half its width beside the wire.
  void wire(const TrueWire& w) {
    for (const Vector2d& part : options_.bundle) {
      const Vector2d across(-w.along.y(), w.along.x());
      for (int k = poisson(options_.density * options_.footprint * w.length); k > 0; --k) {
        const double u = uniform(0.0, w.length), side = part.x() + uniform(-0.5, 0.5) * options_.footprint;
        const Vector2d p = w.from + u * w.along + side * across;
        add(p.x(), p.y(), w.z(u) + part.y(), core::point_class::wire);
      }
    }
  }

  /// A mast of 1 m square with arms.
  void pylon(const Vector2d& at, const Vector2d& along) {
    const Vector2d across(-along.y(), along.x());
    double top = 0.0;
    for (const Vector2d& arm : options_.arms) top = std::max(top, arm.y());
    const double ground = scene_.terrain(at.x(), at.y());
    for (int k = poisson(6.0 * options_.density); k > 0; --k) {
      const Vector2d p = at + uniform(-0.5, 0.5) * along + uniform(-0.5, 0.5) * across;
      add(p.x(), p.y(), ground + uniform(0.5, top), tower_class);
    }
    for (const Vector2d& arm : options_.arms)
      for (int k = poisson(0.5 * options_.density * std::abs(arm.x())); k > 0; --k) {
        const Vector2d p = at + uniform(-0.3, 0.3) * along + uniform(0.0, 1.0) * arm.x() * across;
        add(p.x(), p.y(), ground + arm.y(), tower_class);
      }
  }

  /// Ground and trees over the corridor of a span.
  void corridor_of(const Vector2d& from, const Vector2d& along, double length) {
    const Vector2d across(-along.y(), along.x());
    for (int k = poisson(options_.density * length * 2 * corridor); k > 0; --k) {
      const Vector2d p = from + uniform(0.0, length) * along + uniform(-corridor, corridor) * across;
      add(p.x(), p.y(), scene_.terrain(p.x(), p.y()), core::point_class::ground);
    }
    if (!options_.trees) return;
    for (double u = 7.0; u < length; u += 14.0)
      for (const double side : {-1.0, 1.0}) {
        const Vector2d tree = from + u * along + side * uniform(11.0, 24.0) * across;
        const double height = uniform(8.0, 24.0), radius = 0.2 * height;
        for (int k = poisson(options_.density * 3.14159265 * radius * radius); k > 0; --k) {
          const double r = radius * std::sqrt(uniform(0.0, 1.0)), angle = uniform(0.0, 6.283185);
          const Vector2d p = tree + r * Vector2d(std::cos(angle), std::sin(angle));
          add(p.x(), p.y(), scene_.terrain(tree.x(), tree.y()) + height * (1.0 - 0.4 * r / radius * uniform(0.5, 1.0)),
              core::point_class::high_vegetation);
        }
      }
  }

 private:
  PowerLineScene& scene_;
  const LineOfWires& options_;
  std::mt19937 random_;
};

/// The catenary between two attachments.
TrueWire hang(const Vector3d& p, const Vector3d& q, double a, int span) {
  TrueWire w;
  w.from = p.head<2>();
  w.length = (q - p).head<2>().norm();
  w.along = (q - p).head<2>() / w.length;
  w.a = a;
  w.middle = w.length / 2 - a * std::asinh((q.z() - p.z()) / (2 * a * std::sinh(w.length / (2 * a))));
  w.low = p.z() - a * (std::cosh(w.middle / a) - 1.0);
  w.span = span;
  return w;
}

}  // namespace

double TrueWire::z(double u) const { return low + a * (std::cosh((u - middle) / a) - 1.0); }
Vector3d TrueWire::at(double u) const {
  const Vector2d p = from + u * along;
  return {p.x(), p.y(), z(u)};
}
double TrueWire::sag() const {
  const double slope = (z(length) - z(0)) / length, u = middle + a * std::asinh(slope);
  return z(0) + slope * u - z(u);
}

PowerLineScene make_power_line(const LineOfWires& o) {
  PowerLineScene s;
  s.terrain = [o](double x, double y) { return 300.0 + o.slope * x + o.waves * std::sin(x / 40.0) * std::cos(y / 55.0); };
  Survey survey(s, o);
  std::vector<double> bearing;
  double direction = 0.4 + 0.01 * o.seed;
  for (const double turn : o.turns) bearing.push_back(direction += turn);
  Vector2d at(20.0, 30.0);
  s.pylons.push_back(at);
  for (const double b : bearing) s.pylons.push_back(at += o.span * Vector2d(std::cos(b), std::sin(b)));
  const auto attachment = [&](size_t pylon, const Vector2d& arm) {
    // Across the line that halves the turn.
    const double before = bearing[pylon > 0 ? pylon - 1 : 0], after = bearing[std::min(pylon, bearing.size() - 1)],
                 b = 0.5 * (before + after);
    const Vector2d p = s.pylons[pylon] + arm.x() * Vector2d(-std::sin(b), std::cos(b));
    return Vector3d(p.x(), p.y(), s.terrain(s.pylons[pylon].x(), s.pylons[pylon].y()) + arm.y());
  };
  for (size_t k = 0; k < bearing.size(); ++k) {
    const Vector2d along(std::cos(bearing[k]), std::sin(bearing[k]));
    survey.corridor_of(s.pylons[k], along, o.span);
    for (const Vector2d& arm : o.arms) {
      s.wires.push_back(hang(attachment(k, arm), attachment(k + 1, arm), o.a, static_cast<int>(k)));
      survey.wire(s.wires.back());
    }
  }
  for (size_t k = 0; k < s.pylons.size(); ++k) {
    const double b = bearing[std::min(k, bearing.size() - 1)];
    survey.pylon(s.pylons[k], {std::cos(b), std::sin(b)});
  }
  core::add_columns(s.block, {core::Column::classification, core::Column::flags});
  return s;
}

}  // namespace swath::test
