// SPDX-License-Identifier: GPL-3.0-or-later
// All parts are smooth, so heights and gradients are exact; the lake is the one kink. Bounds of slope and height are sums of
// the parts' bounds: wide, but safe for the ray's first hit.
#include "simulate/world/relief.h"

#include <cmath>
#include <limits>
#include <utility>

#include "simulate/random.h"
#include "simulate/world/bearing.h"

namespace swath::simulate {

void Relief::plan_parts(const WorldOptions& world, const Features& f, std::int64_t seed, core::Radians direction) {
  Random random = random_of(seed, Stream::relief);
  const double length = world.length.value, width = world.width.value, size = std::sqrt(length * width);
  const Eigen::Vector2d along = along_bearing(direction.value), across(along.y(), -along.x());

  if (f.relief > 0.0) {
    for (int i = 0; i < 4; ++i) {
      const double wavelength = std::exp(random.uniform(std::log(90.0), std::log(500.0)));
      const double amplitude = f.relief * 0.12 * std::sqrt(wavelength / 500.0) * random.uniform(0.6, 1.4);
      waves_.push_back(
          {2 * core::pi / wavelength * along_bearing(random.uniform(0, 2 * core::pi)), amplitude, random.uniform(0, 2 * core::pi)});
    }
    for (int i = 0; i < 5; ++i) {
      const double sigma = random.uniform(0.12, 0.3) * size;
      const Eigen::Vector2d centre = along * random.uniform(-0.5, 0.5) * length + across * random.uniform(-0.5, 0.5) * width;
      const double amplitude = (i % 2 ? -0.6 : 1.0) * f.relief * random.uniform(0.5, 1.0);
      hills_.push_back({centre, amplitude, 0.5 / (sigma * sigma)});
    }
  }
  if (f.scarp > 0.0) {
    // Steepest in the middle: height / (2 width).
    const Eigen::Vector2d normal = along_bearing(direction.value + 75 * core::degree);
    steps_.push_back({normal, 0.28 * width, f.scarp, f.scarp / (2 * f.scarp_slope), 0.0});
  }
  if (f.embankment > 0.0) {
    // A crest 8 m wide with flanks of about 1 : 1.5.
    const Eigen::Vector2d normal = along_bearing(direction.value + 20 * core::degree);
    steps_.push_back({normal, f.embankment_at * length, f.embankment, 0.75 * f.embankment, 4.0 + 0.75 * f.embankment});
  }
  if (f.ditch > 0.0) {
    // A bottom 3 m wide with flanks of about 1 : 1.5.
    const Eigen::Vector2d normal = along_bearing(direction.value + 15 * core::degree);
    const double flank = 0.75 * f.ditch, half_bottom = 1.5 + flank;
    steps_.push_back({normal, 0.33 * length, -f.ditch, flank, half_bottom});
    ditch_ = {normal, 0.33 * length, half_bottom + 2 * flank};
  }
  if (f.water) {
    lake_ = true;
    lake_radius_ = 0.13 * size;
    lake_centre_ = 0.22 * length * along - 0.3 * width * across;
    const double sigma = 0.45 * lake_radius_;
    hills_.push_back({lake_centre_, -0.12 * lake_radius_, 0.5 / (sigma * sigma)});
  }
}

Relief::Relief(const WorldOptions& world, std::int64_t seed, core::Radians direction, double half) : base_(world.ground.value) {
  const Features f = features_of(world);
  slope_ = f.slope * along_bearing(-135 * core::degree);
  double up = f.slope * half * std::sqrt(2.0), down = up;
  steepest_ = f.slope;
  plan_parts(world, f, seed, direction);
  for (const Wave& w : waves_) {
    steepest_ += w.amplitude * w.k.norm();
    up += w.amplitude;
    down += w.amplitude;
  }
  for (const Hill& h : hills_) {
    steepest_ += std::abs(h.amplitude) * std::sqrt(2.0 * h.inverse_width2) * std::exp(-0.5);
    (h.amplitude > 0 ? up : down) += std::abs(h.amplitude);
  }
  for (const Step& s : steps_) {
    steepest_ += std::abs(s.amplitude) / (2 * s.width);
    up += std::abs(s.amplitude);
    down += std::abs(s.amplitude);
  }
  highest_ = base_ + up;
  lowest_ = base_ - down;

  if (lake_) {
    // The water stands 40 % of the basin's depth above its bottom.
    lake_level_ = -std::numeric_limits<double>::infinity();
    lake_level_ = at(lake_centre_.x(), lake_centre_.y()).height + 0.4 * 0.12 * lake_radius_;
  }
}

Relief::Relief(core::HeightField field, const Eigen::Vector2d& middle) : field_(std::move(field)), middle_(middle) {
  steepest_ = field_->steepest();
  highest_ = field_->highest();
  lowest_ = field_->lowest();
}

Relief::Sample Relief::at(double e, double n) const {
  if (field_) {
    const core::HeightField::Sample s = field_->at(middle_.x() + e, middle_.y() + n);
    return {s.height, s.gradient, false};
  }
  const Eigen::Vector2d p(e, n);
  Sample s;
  s.height = base_ + slope_.dot(p);
  s.gradient = slope_;
  for (const Wave& w : waves_) {
    const double a = w.k.dot(p) + w.phase;
    s.height += w.amplitude * std::sin(a);
    s.gradient += w.amplitude * std::cos(a) * w.k;
  }
  for (const Hill& h : hills_) {
    const Eigen::Vector2d d = p - h.centre;
    const double v = h.amplitude * std::exp(-d.squaredNorm() * h.inverse_width2);
    s.height += v;
    s.gradient -= 2 * h.inverse_width2 * v * d;
  }
  for (const Step& t : steps_) {
    const double d = t.normal.dot(p) - t.offset;
    const double a = std::tanh((d + t.half) / t.width);
    double value = a, slope = 1 - a * a;
    if (t.half > 0.0) {
      const double b = std::tanh((d - t.half) / t.width);
      value -= b;
      slope -= 1 - b * b;
    }
    s.height += 0.5 * t.amplitude * value;
    s.gradient += 0.5 * t.amplitude / t.width * slope * t.normal;
  }
  if (lake_ && s.height < lake_level_ && (p - lake_centre_).squaredNorm() < lake_radius_ * lake_radius_) {
    s.height = lake_level_;
    s.gradient.setZero();
    s.water = true;
  }
  return s;
}

}  // namespace swath::simulate
