// SPDX-License-Identifier: GPL-3.0-or-later
// The equation of georef/shot_geometry.cpp, for batches: returns of one trajectory interval are taken in chunks, as columns, and every loop
// below is over one chunk. All vectors are in the body frame at the interval's first record ("base") until they are turned to ecef once.
// Deviations from the single-shot form, with their size: the nadir is that of the interval's first record (1e-8 rad per 0.1 m flown) and
// the lever arm is not turned within the interval where the refraction term takes the ray from (1e-8 m); sigmas use the attitude at the
// interval's first record and the trajectory's sigmas at its middle, and take J without the derivative of the bending (together 3e-3 of
// themselves at 200 Hz); arc cosine by Abramowitz & Stegun 4.4.46, 2e-8 rad.
#include "georef/georeference.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geo/frames.h"

namespace swath::georef {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr size_t chunk_size = 256;
constexpr double earth_radius = 6371000.0;  // m, for the turn of the vertical between scanner and ground: 1e-4 rad at most
constexpr double series_limit = 0.01;       // squared rotation (rad^2) up to which the series of exp_so3 below is exact to 3e-14
constexpr double lowest_incidence = 0.1;    // as georef/atmosphere.cpp

using Column = double[chunk_size];

struct Chunk {
  size_t n = 0;
  size_t row[chunk_size];  // in the shots
  Column s;                // time since the interval's first record, s
  Column angle, forward, raw_range, range;
  Column rx, ry, rz;  // ray in body, then in base
  Column ax, ay, az;  // derivative of the ray by a', body
  Column cosine;      // of the ray with the nadir
  Column x, y, z;     // ecef, then map
  Column across;      // scan angle as given out
  float sigma_h[chunk_size], sigma_v[chunk_size];
};

// What is constant over an interval of the trajectory.
struct Local {
  Matrix3d ecef_R_base;
  Vector3d down;  // in base
  trajectory::Pose pose;
  trajectory::PoseSigma sigma;
  SharedErrors errors;  // where they are correlated
};

void make_rays(const ShotGeometry& g, bool with_derivative, Chunk& c) {
  const Matrix3d& B = g.body_R_scanner();
  if (!g.beam().is_across()) {
    for (size_t i = 0; i < c.n; ++i) {
      const Beam beam = g.beam()(c.angle[i], c.forward[i]);
      const Vector3d ray = B * (c.range[i] * beam.direction), by = B * (c.range[i] * beam.by_angle);
      c.across[i] = std::atan2(beam.direction.y(), beam.direction.z());
      c.rx[i] = ray.x(), c.ry[i] = ray.y(), c.rz[i] = ray.z();
      c.ax[i] = by.x(), c.ay[i] = by.y(), c.az[i] = by.z();
    }
    return;
  }
  Column sine, cosine;
  for (size_t i = 0; i < c.n; ++i) {
    sine[i] = std::sin(c.angle[i]);
    cosine[i] = std::cos(c.angle[i]);
    c.across[i] = std::abs(c.angle[i]) <= core::pi ? c.angle[i] : core::wrap_pi(c.angle[i]);
  }
  for (size_t i = 0; i < c.n; ++i) {
    const double w = c.range[i] * std::sqrt(1.0 - c.forward[i] * c.forward[i]);
    const double x = c.range[i] * c.forward[i], y = w * sine[i], z = w * cosine[i];
    c.rx[i] = B(0, 0) * x + B(0, 1) * y + B(0, 2) * z;
    c.ry[i] = B(1, 0) * x + B(1, 1) * y + B(1, 2) * z;
    c.rz[i] = B(2, 0) * x + B(2, 1) * y + B(2, 2) * z;
    if (!with_derivative) continue;
    c.ax[i] = B(0, 1) * z - B(0, 2) * y;
    c.ay[i] = B(1, 1) * z - B(1, 2) * y;
    c.az[i] = B(2, 1) * z - B(2, 2) * y;
  }
}

// From body at each instant to base: lever arm + ray, turned by exp(w(s)); leaves rx, ry, rz = turned sum.
void turn_to_base(const trajectory::Interval& k, const Vector3d& lever, Chunk& c) {
  const Vector3d *w = k.rotation, l = lever;
  const double step = k.end - k.start;
  const double widest = w[0].norm() + step * (w[1].norm() + step * (w[2].norm() + step * w[3].norm()));
  if (widest * widest > series_limit) {
    for (size_t i = 0; i < c.n; ++i) {
      const double s = c.s[i];
      const Vector3d v = core::exp_so3(w[0] + s * (w[1] + s * (w[2] + s * w[3]))) * (lever + Vector3d(c.rx[i], c.ry[i], c.rz[i]));
      c.rx[i] = v.x(), c.ry[i] = v.y(), c.rz[i] = v.z();
    }
    return;
  }
  for (size_t i = 0; i < c.n; ++i) {
    const double s = c.s[i];
    const double wx = w[0].x() + s * (w[1].x() + s * (w[2].x() + s * w[3].x()));
    const double wy = w[0].y() + s * (w[1].y() + s * (w[2].y() + s * w[3].y()));
    const double wz = w[0].z() + s * (w[1].z() + s * (w[2].z() + s * w[3].z()));
    const double q = wx * wx + wy * wy + wz * wz;
    const double a = 1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0));   // sin(t) / t
    const double b = 0.5 - q / 24.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0));  // (1 - cos(t)) / t^2
    const double x = c.rx[i] + l.x(), y = c.ry[i] + l.y(), z = c.rz[i] + l.z();
    const double ux = wy * z - wz * y, uy = wz * x - wx * z, uz = wx * y - wy * x;  // w x v
    c.rx[i] = x + a * ux + b * (wy * uz - wz * uy);
    c.ry[i] = y + a * uy + b * (wz * ux - wx * uz);
    c.rz[i] = z + a * uz + b * (wx * uy - wy * ux);
  }
}

// The bending of the ray, then base to ecef and the IMU's place.
void place(const trajectory::Interval& k, const Local& here, const Vector3d& lever, double bending, Chunk& c) {
  const Vector3d D = here.down, l = lever;
  const Matrix3d& R = here.ecef_R_base;
  const Vector3d* p = k.position;
  for (size_t i = 0; i < c.n; ++i) {
    const double qx = c.rx[i] - l.x(), qy = c.ry[i] - l.y(), qz = c.rz[i] - l.z();
    const double height = qx * D.x() + qy * D.y() + qz * D.z();
    const double r = c.range[i];
    const double lowest = lowest_incidence * r;
    c.cosine[i] = height / std::sqrt(qx * qx + qy * qy + qz * qz);  // of the vector itself: exact to second order at the nadir
    const double f = bending * r * r / (height > lowest ? height : lowest);
    const double x = c.rx[i] + f * D.x() - bending * qx;
    const double y = c.ry[i] + f * D.y() - bending * qy;
    const double z = c.rz[i] + f * D.z() - bending * qz;
    const double s = c.s[i];
    c.x[i] = R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + (p[0].x() + s * (p[1].x() + s * (p[2].x() + s * p[3].x())));
    c.y[i] = R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + (p[0].y() + s * (p[1].y() + s * (p[2].y() + s * p[3].y())));
    c.z[i] = R(2, 0) * x + R(2, 1) * y + R(2, 2) * z + (p[0].z() + s * (p[1].z() + s * (p[2].z() + s * p[3].z())));
  }
}

// What every record adds by itself: range, angle, pointing, time. `total` and `down` grow by it.
void add_records(const Variances& v, const core::Calibration& cal, double pointing, double factor2, bool recorded, const PointTerms& p,
                 double cosine, const Vector3d& D, double& total, double& down) {
  const double range = factor2 * v[record_range] * cal.range_scale * cal.range_scale;
  total += range;
  down += range * cosine * cosine;
  const double angle = recorded ? v[record_angle] * cal.scan_scale * cal.scan_scale : 0.0;
  const double lift = p.by_angle.dot(D), sink = p.by_time.dot(D), r2 = p.ray.squaredNorm();
  total += angle * p.by_angle.squaredNorm() + 2.0 * pointing * r2 + v[record_time] * p.by_time.squaredNorm();
  down += angle * lift * lift + pointing * r2 * (1.0 - cosine * cosine) + v[record_time] * sink * sink;
}

// The same as propagate() where the shared errors are correlated.
void propagate_correlated(const ShotGeometry& g, const core::SensorSigma& sensor, const Local& here, Chunk& c) {
  const Variances v = variances(sensor, here.sigma);
  const double factor = g.air().range_factor;
  const double pointing = sensor.beam_divergence.value * sensor.beam_divergence.value / 16.0;
  const bool recorded = !g.beam().ignores_record();
  const Vector3d speed = here.ecef_R_base.transpose() * here.pose.velocity;
  for (size_t i = 0; i < c.n; ++i) {
    const Vector3d t(c.rx[i], c.ry[i], c.rz[i]), q = t - g.lever_arm();
    const PointTerms p{q,          q * (factor / c.range[i]),      c.raw_range[i], Vector3d(c.ax[i], c.ay[i], c.az[i]),
                       c.angle[i], speed + here.pose.rate.cross(t)};
    PointVariance s = variance_of(p, here.errors, here.down);
    add_records(v, g.calibration(), pointing, factor * factor, recorded, p, c.cosine[i], here.down, s.total, s.down);
    c.sigma_h[i] = static_cast<float>(std::sqrt(std::max(s.total - s.down, 0.0)));
    c.sigma_v[i] = static_cast<float>(std::sqrt(std::max(s.down, 0.0)));
  }
}

// J S J^T: total variance and its vertical part. A turn by axis a moves a vector v by a x v: squared length v^2 - (a v)^2, vertical part (D
// x a) v.
void propagate(const ShotGeometry& g, const core::SensorSigma& sensor, const Local& here, Chunk& c) {
  const Variances v = variances(sensor, here.sigma);
  const core::Calibration& cal = g.calibration();
  const double factor2 = g.air().range_factor * g.air().range_factor;
  const bool recorded = !g.beam().ignores_record();
  const Vector3d D = here.down, l = g.lever_arm();
  const double common = v[lever_forward] * 3.0 + v[position_north] + v[position_east] + v[position_down];
  const double common_vertical = v[lever_forward] + v[position_down];
  const double range_constant = factor2 * (v[range_offset] + v[record_range] * cal.range_scale * cal.range_scale);
  const double range_growing = factor2 * v[range_scale];
  const double angle_constant = v[scan_offset] + (recorded ? v[record_angle] * cal.scan_scale * cal.scan_scale : 0.0);
  const double angle_growing = recorded ? v[scan_scale] : 0.0;
  const double pointing = sensor.beam_divergence.value * sensor.beam_divergence.value / 16.0;
  const double time = v[latency] + v[record_time];
  Vector3d axis[6], vertical[6];
  double variance[6];
  const Matrix3d attitude = attitude_axes(D);
  for (int k = 0; k < 3; ++k) {
    axis[k] = attitude.col(k);
    variance[k] = v[static_cast<size_t>(attitude_roll + k)];
    axis[k + 3] = g.boresight_axes().col(k);
    variance[k + 3] = v[static_cast<size_t>(boresight_roll + k)];
  }
  for (int k = 0; k < 6; ++k) vertical[k] = D.cross(axis[k]);
  const Vector3d speed = here.ecef_R_base.transpose() * here.pose.velocity, rate = here.pose.rate;

  for (size_t i = 0; i < c.n; ++i) {
    const double tx = c.rx[i], ty = c.ry[i], tz = c.rz[i];
    const double qx = tx - l.x(), qy = ty - l.y(), qz = tz - l.z();
    const double t2 = tx * tx + ty * ty + tz * tz, r2 = c.range[i] * c.range[i], cos2 = c.cosine[i] * c.cosine[i];
    double total = common, down = common_vertical;
    const auto turn = [&](int k, double x, double y, double z, double squared) {
      const double along = axis[k].x() * x + axis[k].y() * y + axis[k].z() * z;
      const double lift = vertical[k].x() * x + vertical[k].y() * y + vertical[k].z() * z;
      total += variance[k] * (squared - along * along);
      down += variance[k] * lift * lift;
    };
    for (int k = 0; k < 3; ++k) turn(k, tx, ty, tz, t2);
    for (int k = 3; k < 6; ++k) turn(k, qx, qy, qz, r2);
    const double range = range_constant + range_growing * c.raw_range[i] * c.raw_range[i];
    total += range;
    down += range * cos2;
    const double angle = angle_constant + angle_growing * c.angle[i] * c.angle[i];
    const double lift = c.ax[i] * D.x() + c.ay[i] * D.y() + c.az[i] * D.z();
    total += angle * (c.ax[i] * c.ax[i] + c.ay[i] * c.ay[i] + c.az[i] * c.az[i]);
    down += angle * lift * lift;
    total += 2.0 * pointing * r2;
    down += pointing * r2 * (1.0 - cos2);
    const double mx = speed.x() + rate.y() * tz - rate.z() * ty, my = speed.y() + rate.z() * tx - rate.x() * tz;
    const double mz = speed.z() + rate.x() * ty - rate.y() * tx;
    const double sink = mx * D.x() + my * D.y() + mz * D.z();
    total += time * (mx * mx + my * my + mz * mz);
    down += time * sink * sink;
    const double level = total - down;
    c.sigma_h[i] = static_cast<float>(std::sqrt(level > 0.0 ? level : 0.0));
    c.sigma_v[i] = static_cast<float>(std::sqrt(down));
  }
}

// What holds over the interval that the cursor is in.
Local local_of(const trajectory::Cursor& cursor, const CorrelatedErrors* correlated) {
  const trajectory::Interval& k = cursor.interval();
  Local out;
  out.pose = k.pose(k.start);
  out.ecef_R_base = k.base_attitude;
  out.sigma = cursor.sigma(0.5 * (k.start + k.end));
  const Matrix3d base_R_ned = out.ecef_R_base.transpose() * ecef_R_ned_at(out.pose);
  out.down = base_R_ned.col(2);
  if (correlated && correlated->any()) out.errors = correlated->at(k.start, out.sigma, base_R_ned);
  return out;
}

// ecef to map minus origin, in place; NaN where there is none.
void to_map(const MapPatches& map, const Vector3d& origin, const MapPatches::Patch*& patch, Chunk& c) {
  for (size_t first = 0; first < c.n;) {
    if (!patch || !patch->holds(c.x[first], c.y[first], c.z[first])) patch = &map.patch({c.x[first], c.y[first], c.z[first]});
    size_t end = first + 1;
    while (end < c.n && patch->holds(c.x[end], c.y[end], c.z[end])) ++end;
    if (patch->by_proj) {
      map.apply_proj(c.x + first, c.y + first, c.z + first, end - first);
      for (size_t i = first; i < end; ++i) c.x[i] -= origin.x(), c.y[i] -= origin.y(), c.z[i] -= origin.z();
    } else {
      patch->apply(c.x + first, c.y + first, c.z + first, end - first, origin);
    }
    first = end;
  }
}

double arc_cosine(double c) {
  const double x = std::abs(c);
  const double y =
      std::sqrt(std::max(1.0 - x, 0.0)) *
      (1.5707963050 +
       x * (-0.2145988016 +
            x * (0.0889789874 + x * (-0.0501743046 + x * (0.0308918810 + x * (-0.0170881256 + x * (0.0066700901 - x * 0.0012624911)))))));
  return c < 0.0 ? core::pi - y : y;
}

// The columns given out, from row `at` on; rows without a place are skipped. Returns the number written.
size_t write(const Chunk& c, const trajectory::Interval& k, const core::Shots& shots, bool with_sigma, core::Block& out, size_t at) {
  const size_t before = at;
  for (size_t i = 0; i < c.n; ++i) {
    if (!std::isfinite(c.x[i] + c.y[i] + c.z[i])) continue;
    out.x[at] = c.x[i];
    out.y[at] = c.y[i];
    out.z[at] = c.z[i];
    out.time[at] = k.start + c.s[i];
    out.scan_angle[at] = static_cast<float>(c.across[i]);
    out.range[at] = static_cast<float>(c.range[i]);
    const double cosine = c.cosine[i];
    const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
    out.incidence[at] = static_cast<float>(arc_cosine(cosine) + c.range[i] * sine / earth_radius);
    if (with_sigma) out.sigma_h[at] = c.sigma_h[i], out.sigma_v[at] = c.sigma_v[i];
    const size_t row = c.row[i];
    if (!shots.intensity.empty()) out.intensity[at] = shots.intensity[row];
    if (!shots.return_number.empty()) out.return_number[at] = shots.return_number[row];
    if (!shots.return_count.empty()) out.return_count[at] = shots.return_count[row];
    if (!shots.flags.empty()) out.flags[at] = shots.flags[row];
    if (!shots.record.empty()) out.record[at] = shots.record[row];
    ++at;
  }
  return at - before;
}

// Makes room for n more points in the columns that are there and in those to be filled.
void make_room(core::Block& out, const core::Shots& shots, bool with_sigma, size_t n) {
  using C = core::Column;
  core::ColumnSet columns = core::columns_of(out) | core::ColumnSet{C::x, C::y, C::z, C::time, C::scan_angle, C::range, C::incidence};
  if (with_sigma) columns = columns | core::ColumnSet{C::sigma_h, C::sigma_v};
  if (!shots.intensity.empty()) columns.add(C::intensity);
  if (!shots.return_number.empty()) columns.add(C::return_number);
  if (!shots.return_count.empty()) columns.add(C::return_count);
  if (!shots.flags.empty()) columns.add(C::flags);
  if (!shots.record.empty()) columns.add(C::record);
  out.x.resize(out.x.size() + n);
  core::add_columns(out, columns);
}

}  // namespace

Counts& Counts::operator+=(const Counts& o) {
  georeferenced += o.georeferenced;
  outside += o.outside;
  outside_times.add(o.outside_times);
  no_range += o.no_range;
  no_beam += o.no_beam;
  no_map += o.no_map;
  return *this;
}

Georeferencer::Georeferencer(const core::Scanner& scanner, const core::Calibration& calibration, const core::SensorSigma& sigma,
                             const trajectory::Trajectory& trajectory, const core::Crs& map, Vector3d block_origin, bool with_sigma)
    : geometry_(scanner, calibration),
      sigma_(sigma),
      correlated_(geometry_, sigma, trajectory.data().response),
      trajectory_(&trajectory),
      map_(map),
      origin_(std::move(block_origin)),
      with_sigma_(with_sigma) {}

Counts Georeferencer::run(const core::Shots& shots, core::Block& out) const {
  if (out.size() == 0) out.origin = origin_;
  if (out.origin != origin_) throw core::Error("points of two origins in one block", "georeference");
  Counts counts;
  const size_t before = out.size();
  size_t at = before;
  make_room(out, shots, with_sigma_, shots.size());

  trajectory::Cursor cursor(*trajectory_);
  const MapPatches::Patch* patch = nullptr;
  Chunk c;
  Local here;
  long number = -1;
  const auto finish_chunk = [&] {
    if (c.n == 0) return;
    const trajectory::Interval& k = cursor.interval();
    if (cursor.number() != number) here = local_of(cursor, with_sigma_ ? &correlated_ : nullptr), number = cursor.number();
    make_rays(geometry_, with_sigma_, c);
    turn_to_base(k, geometry_.lever_arm(), c);
    place(k, here, geometry_.lever_arm(), geometry_.air().bending, c);
    if (with_sigma_) (correlated_.any() ? propagate_correlated : propagate)(geometry_, sigma_, here, c);
    to_map(map_, origin_, patch, c);
    const size_t written = write(c, k, shots, with_sigma_, out, at);
    counts.no_map += c.n - written;
    at += written;
    c.n = 0;
  };

  for (size_t i = 0; i < shots.size(); ++i) {
    const double raw = shots.range[i], range = geometry_.range(raw);
    const double angle = geometry_.angle(shots.angle[i]);
    const double forward = shots.forward.empty() ? 0.0 : shots.forward[i];
    const double t = geometry_.time(shots.time[i]);
    if (!(raw > 0.0 && range > 0.0 && std::isfinite(range))) {
      ++counts.no_range;
      continue;
    }
    if (!std::isfinite(angle) || !(std::abs(forward) <= 1.0)) {
      ++counts.no_beam;
      continue;
    }
    if (c.n == chunk_size || (c.n > 0 && !(t >= cursor.interval().start && t < cursor.interval().end))) finish_chunk();
    if (!(std::isfinite(t) && cursor.seek(t))) {
      ++counts.outside;
      if (std::isfinite(t)) counts.outside_times.add(t);
      continue;
    }
    c.row[c.n] = i;
    c.s[c.n] = t - cursor.interval().start;
    c.angle[c.n] = angle;
    c.forward[c.n] = forward;
    c.raw_range[c.n] = raw;
    c.range[c.n] = range;
    ++c.n;
  }
  finish_chunk();
  counts.georeferenced = at - before;
  core::resize(out, at);
  return counts;
}

}  // namespace swath::georef
