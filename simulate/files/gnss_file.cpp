// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of a fix: sigma times (sqrt(1 - share) white + sqrt(share) Gauss-Markov) per axis, sigma by the number of satellites.
#include "simulate/files/gnss_file.h"

#include <algorithm>
#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "io/text/text_rows.h"
#include "simulate/files/laser_file.h"
#include "simulate/inertial.h"

namespace swath::simulate {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr int fewest_satellites = 10, most_satellites = 16;
constexpr double sky_seconds = 30.0;  // the number of satellites holds so long
/// Harmonic mean of 10 to 16: sigmas go with 1 / sqrt(satellites), and their mean square is that of the options.
constexpr double mean_satellites = 12.687;

bool any_holds(const std::vector<Stretch>& stretches, double t) {
  return std::any_of(stretches.begin(), stretches.end(), [t](const Stretch& s) { return s.holds(t); });
}

Vector3d normals(Random random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

}  // namespace

Receiver::Receiver(const Flight& flight, const GnssOptions& options, const std::array<core::Metres, 3>& lever_arm, bool noise_free,
                   std::int64_t seed)
    : flight_(flight),
      options_(options),
      lever_arm_(lever_arm[0].value, lever_arm[1].value, lever_arm[2].value),
      noise_free_(noise_free),
      seed_(seed) {
  for (std::uint64_t i = 0; i < 3; ++i) correlated_.emplace_back(options.correlation_time.value, random_of(seed, Stream::gnss_drift, i));
}

std::optional<Fix> Receiver::next() {
  for (;;) {
    const std::int64_t k = step_++;
    const double tag = static_cast<double>(k) / options_.rate.value, t = tag + options_.latency.value;
    if (std::max(tag, t) > flight_.duration() + 1e-9) return std::nullopt;
    if (k > 0)
      for (GaussMarkov& c : correlated_) c.advance(1.0 / options_.rate.value);
    if (t >= 0 && !any_holds(options_.outages, t)) return fix_at(k, tag);
  }
}

Fix Receiver::fix_at(std::int64_t k, double tag) {
  const auto index = static_cast<std::uint64_t>(k);
  const double t = std::min(tag + options_.latency.value, flight_.duration());
  Fix f{};
  f.tag = tag;
  f.quality = any_holds(options_.floats, t) ? core::FixQuality::float_ambiguity : core::FixQuality::fixed;
  Random sky = random_of(seed_, Stream::gnss_sky, static_cast<std::uint64_t>(t / sky_seconds));
  f.satellites = fewest_satellites + static_cast<int>(sky.uniform() * (most_satellites - fewest_satellites + 1));
  const double factor =
      std::sqrt(mean_satellites / f.satellites) * (f.quality == core::FixQuality::float_ambiguity ? options_.float_factor : 1.0);
  f.sigma = factor * Vector3d(options_.sigma_horizontal.value, options_.sigma_horizontal.value, options_.sigma_vertical.value);
  f.white = f.correlated = f.outlier = Vector3d::Zero();
  Vector3d velocity_error = Vector3d::Zero();
  if (!noise_free_) {
    const Vector3d walk(correlated_[0].value(), correlated_[1].value(), correlated_[2].value());
    f.white = std::sqrt(1 - options_.correlated_share) * f.sigma.cwiseProduct(normals(random_of(seed_, Stream::gnss, index)));
    f.correlated = std::sqrt(options_.correlated_share) * f.sigma.cwiseProduct(walk);
    Random outlier = random_of(seed_, Stream::gnss_outlier, index);
    if (outlier.uniform() < options_.outlier_share) {
      const double size = options_.outlier_size.value * outlier.uniform(0.5, 1.5);
      f.outlier = size * normals(outlier).normalized();
    }
    velocity_error = options_.sigma_velocity.value * normals(random_of(seed_, Stream::gnss_velocity, index));
  }
  const Motion m = flight_.motion(t);
  const Matrix3d ecef_R_ned = core::ecef_R_ned(m.pose.position.latitude, m.pose.position.longitude);
  const Vector3d antenna = core::matrix_of(m.pose.attitude) * lever_arm_;
  f.position = core::ecef_of(m.pose.position) + ecef_R_ned * (antenna + f.white + f.correlated + f.outlier);
  f.velocity = velocity_at(m, lever_arm_) + velocity_error;
  return f;
}

std::int64_t write_gnss(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const GnssOptions& options,
                        const std::array<core::Metres, 3>& lever_arm, bool noise_free, std::int64_t seed) {
  io::TextRows rows(folder / "gnss.csv",
                    std::string("gps_sow_s,lat_deg,lon_deg,h_ell_m,ecef_x_m,ecef_y_m,ecef_z_m,cov_xx_m2,cov_xy_m2,cov_xz_m2,cov_yy_m2,"
                                "cov_yz_m2,cov_zz_m2,sd_north_m,sd_east_m,sd_down_m,n_sat,quality") +
                        (options.velocity ? ",v_north_mps,v_east_mps,v_up_mps,sd_v_north_mps,sd_v_east_mps,sd_v_up_mps\n" : "\n"));
  io::TextRows truth(
      folder / "truth" / "gnss.csv",
      "gps_sow_s,white_north_m,white_east_m,white_down_m,correlated_north_m,correlated_east_m,correlated_down_m,outlier_north_m,"
      "outlier_east_m,outlier_down_m\n");
  const double sow = start - core::seconds_per_week * core::week_of(start);
  const int decimals = io::decimals_of(sow, 1.0 / options.rate.value, 3);
  Receiver receiver(flight, options, lever_arm, noise_free, seed);
  std::int64_t n = 0;
  for (; const std::optional<Fix> f = receiver.next(); ++n) {
    const core::Geodetic g = core::geodetic_of(f->position);
    const Matrix3d R = core::ecef_R_ned(g.latitude, g.longitude);
    const Matrix3d cov = R * f->sigma.cwiseAbs2().asDiagonal() * R.transpose();
    rows.number(sow + f->tag, decimals);
    rows.number(g.latitude / core::degree, 11);
    rows.number(g.longitude / core::degree, 11);
    rows.number(g.height, 4);
    for (const double x : f->position) rows.number(x, 4);
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = i; j < 3; ++j) rows.scientific(cov(i, j), 8);
    for (const double x : f->sigma) rows.number(x, 4);
    rows.number(f->satellites, 0);
    rows.number(f->quality == core::FixQuality::fixed ? 1 : 2, 0);
    if (options.velocity) {
      for (const double x : {f->velocity.x(), f->velocity.y(), -f->velocity.z()}) rows.number(x, 5);
      for (int i = 0; i < 3; ++i) rows.number(options.sigma_velocity.value, 5);
    }
    rows.end();
    truth.number(sow + f->tag, decimals);
    for (const Vector3d* v : {&f->white, &f->correlated, &f->outlier})
      for (const double x : *v) truth.number(x, 5);
    truth.end();
  }
  rows.commit();
  truth.commit();
  return n;
}

io::GnssFile describe_gnss_file(const GnssOptions& options, core::GpsTime start) {
  io::GnssFile f;
  f.file = "gnss.csv";
  f.time = tags_of(core::TimeScale::gps_week, start);
  io::GnssColumns& c = f.columns;
  c.time = "gps_sow_s";
  c.x = "ecef_x_m";
  c.y = "ecef_y_m";
  c.z = "ecef_z_m";
  c.cov_xx = "cov_xx_m2";
  c.cov_xy = "cov_xy_m2";
  c.cov_xz = "cov_xz_m2";
  c.cov_yy = "cov_yy_m2";
  c.cov_yz = "cov_yz_m2";
  c.cov_zz = "cov_zz_m2";
  c.quality = "quality";
  c.satellites = "n_sat";
  if (!options.velocity) return f;
  c.v_north = "v_north_mps";
  c.v_east = "v_east_mps";
  c.v_up = "v_up_mps";
  c.sigma_v_north = "sd_v_north_mps";
  c.sigma_v_east = "sd_v_east_mps";
  c.sigma_v_up = "sd_v_up_mps";
  return f;
}

io::Antenna describe_antenna(const GnssOptions& options, const std::array<core::Metres, 3>& lever_arm) {
  io::Antenna a;
  for (size_t i = 0; i < 3; ++i) a.lever_arm[i] = lever_arm[i] + options.lever_arm_error[i];
  a.lever_arm_sigma = options.lever_arm_sigma;
  a.latency = options.latency + options.latency_error;
  return a;
}

}  // namespace swath::simulate
