// SPDX-License-Identifier: GPL-3.0-or-later
// A pulse that passes the edge hits ground or wall beyond and below: its return lies elsewhere than where it pierced the roof's plane (3.6
// m for 20 deg and a height of 10 m). Pulses are therefore distinguished by their returns' heights, but placed where their beam pierces the
// plane. A return on the wall less than the tolerance below the roof counts as on the roof: the edge of a wall that faces the scanner is
// corrected for it (tolerance times the beam's horizontal way per metre down: 2 cm at 20 deg).
#include "calib/target/target_edges.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/target/roof_plane.h"
#include "core/statistics.h"

namespace swath::calib {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double tolerance_in_sigma = 3.5;

using enum RoofMotion::Unknown;
using Row = RoofMotion::Row;
using Unknown = RoofMotion::Unknown;

/// Places east, north relative to the beams' indices: pulses of `pierced` know their beam by position in `beams`.
std::vector<Beamline> numbered(std::vector<Beamline> beams, std::vector<size_t>& record) {
  record.resize(beams.size());
  for (size_t i = 0; i < beams.size(); ++i) {
    record[i] = beams[i].pulse;
    beams[i].pulse = i;
  }
  return beams;
}

class Viewer {
 public:
  Viewer(const TargetPulses& pulses, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory, const RoofTarget& target,
         const EdgeOptions& options)
      : pulses_(pulses), geometry_(geometry), trajectory_(trajectory), target_(target), options_(options) {}

  TargetView run() {
    view_.sides.resize(target_.sides());
    beams_ = numbered(beamlines(pulses_, geometry_, trajectory_, target_), record_);
    view_.pulses = static_cast<std::uint32_t>(beams_.size());
    if (beams_.size() < fewest_on_roof) return refused("no returns near the target");
    set_axes();
    if (!find_roof()) return refused("no flat roof where the target should be: not under this line, or hidden");
    shape_.blur = expected_blur();
    // Wide bands and a wide blur first: the coarse shift is good to half a metre, turns are not known yet.
    constexpr double first_band = 3.0, first_margin = 2.5, first_blur = 0.15;
    fit_edges(std::min(first_band, widest_band()), first_margin, std::max(shape_.blur, first_blur));
    for (int pass = 0; pass < 2; ++pass) {
      measure_plane();
      if (pass > 0) learn_shape();
      fit_edges(band(), 0.3 + 4.0 * shape_.blur + shape_.half, shape_.blur);
    }
    if (!determined()) return refused("none of its edges was seen");
    measure_plane();
    finish();
    return view_;
  }

 private:
  TargetView refused(const std::string& why) {
    view_.seen = false;
    view_.why_not = why;
    return view_;
  }

  void set_axes() {
    const auto pose = trajectory_.pose_at(geometry_.time(pulses_.time[record_[beams_.size() / 2]]));
    const Vector3d forward = target_.frame.local_R_ecef * pose->ecef_R_body.col(0);
    view_.heading = std::atan2(forward.x(), forward.y());
    motion_.x = {std::sin(view_.heading), std::cos(view_.heading)};
    motion_.y = {motion_.x.y(), -motion_.x.x()};
    motion_.centre = target_.centre();
  }

  /// The roof's height and its shift, both coarse.
  bool find_roof() {
    const std::vector<Pierced> pierced = pierce(beams_, target_.plane);
    std::vector<double> slopes, ranges;
    for (const Pierced& p : pierced) slopes.push_back(p.slope.norm());
    constexpr double datum = 1.0;  // m, heights of survey and trajectory may differ by
    const double reach = options_.search * core::median(slopes, 0.0) + datum;
    double best = 0.5;  // of the score: half of what lies on the roof is at its height and not much else
    bool found = false;
    for (const double height : frequent_heights(pierced, reach)) {
      const Vector3d plane = target_.plane + Vector3d(height, 0, 0);
      double score = 0.0;
      const Vector2d shift = coarse_shift(pierce(beams_, plane), target_, options_.search, score);
      if (score <= best) continue;
      best = score;
      found = true;
      plane_ = plane;
      motion_.value[along] = motion_.x.dot(shift);
      motion_.value[across] = motion_.y.dot(shift);
    }
    if (!found) return false;
    pierced_ = pierce(beams_, plane_);
    measure_plane();
    return fit_.n > 0;
  }

  void measure_plane() {
    // Twice: the first fit moves the plane, and with it the places where beams pierce it.
    for (int i = 0; i < 2; ++i) {
      fit_ = fit_roof_plane(pierced_, beams_, target_, motion_, options_.range_sigma);
      if (fit_.n == 0) return;
      plane_ += fit_.as_plane(motion_);
      pierced_ = pierce(beams_, plane_);
    }
    tolerance_ = tolerance_in_sigma * std::max(fit_.rms, options_.range_sigma);
  }

  double mean_range() const {
    double sum = 0.0;
    for (const size_t r : record_) sum += pulses_.first[r];
    return sum / static_cast<double>(record_.size());
  }
  double footprint() const { return options_.beam_divergence * mean_range(); }
  double expected_blur() const {
    constexpr double least = 0.01;  // m
    return std::max(least, std::hypot(options_.pointing_sigma * mean_range(), 0.25 * footprint()));
  }
  double widest_band() const {
    double width = 1e300;
    for (size_t k = 0; k < target_.sides(); ++k) width = std::min(width, target_.side(k).length);
    return 0.35 * width;
  }
  double band() const {
    // Some pulses on either side whatever their spacing.
    size_t near = 0;
    for (const Pierced& p : pierced_) near += target_.holds(p.place - motion_.at(p.place));
    const double spacing = std::sqrt(target_.area() / static_cast<double>(std::max<size_t>(near, 1)));
    return std::min(std::max({1.0, 6.0 * shape_.blur + 2.0 * shape_.half, 2.0 * spacing}), widest_band());
  }

  EdgePulse::Outcome outcome(const Pierced& p) const {
    const bool first = std::abs(p.first) <= tolerance_, last = std::abs(p.last) <= tolerance_;
    return !first ? EdgePulse::off : last ? EdgePulse::on : EdgePulse::both;
  }

  /// A wall that the beam meets behind the edge, too near below it for a return of its own.
  static bool facing(const RoofTarget::Side& side, const Pierced& p) {
    constexpr double steep = 0.03;  // a footprint of 0.3 m then reaches 10 m down the wall
    return -side.outward.dot(p.slope) > steep;
  }

  /// The pulses near side k, seen from where the motion so far puts it.
  std::vector<EdgePulse> near_side(size_t k, double band, double margin) const {
    const RoofTarget::Side side = target_.side(k);
    std::vector<EdgePulse> out;
    for (const Pierced& p : pierced_) {
      if (p.first > tolerance_) continue;  // something above the roof
      const Vector2d at = p.place - motion_.at(p.place) - side.middle;
      const double t = side.along.dot(at);
      if (std::abs(t) > 0.5 * side.length - margin) continue;
      const double s = side.outward.dot(at) - motion_.value[growth] - tolerance_ * std::max(0.0, -side.outward.dot(p.slope));
      if (std::abs(s) > band) continue;
      EdgePulse::Outcome what = outcome(p);
      if (facing(side, p) && what != EdgePulse::off) what = EdgePulse::first_on;
      out.push_back({static_cast<float>(s), static_cast<float>(t), what});
    }
    // More pulses than these make the edge no better than the survey is.
    constexpr size_t enough = 3000;
    if (out.size() > enough) {
      const size_t every = out.size() / enough + 1;
      size_t kept = 0;
      for (size_t i = 0; i < out.size(); i += every) out[kept++] = out[i];
      out.resize(kept);
    }
    return out;
  }

  void learn_shape() {
    std::vector<EdgePulse> all;
    size_t mixed = 0;
    for (size_t k = 0; k < target_.sides(); ++k) {
      if (!view_.sides[k].used) continue;
      for (const EdgePulse& p : near_side(k, band(), 0.3 + 4.0 * shape_.blur))
        if (p.outcome != EdgePulse::first_on) all.push_back(p);
    }
    for (const EdgePulse& p : all) mixed += p.outcome == EdgePulse::both;
    constexpr size_t enough_mixed = 5;
    shape_ = edge_shape(all, expected_blur(), mixed >= enough_mixed ? std::max(0.75 * footprint(), 0.1) : 0.0);
    mixed_ = mixed >= enough_mixed;
  }

  /// Locates all edges and puts them together. Adds to the motion.
  void fit_edges(double band, double margin, double blur) {
    struct Seen {
      Row row, slope;
    };
    const auto previous = motion_.value;
    Vector2d centre(0, 0);
    int used = 0;
    const RoofMotion before = motion_;
    for (size_t k = 0; k < target_.sides(); ++k) {
      const RoofTarget::Side side = target_.side(k);
      SideView& v = view_.sides[k];
      const double turn =
          std::hypot(options_.shear * std::abs(motion_.x.dot(side.outward)), options_.turn * std::abs(motion_.y.dot(side.outward)));
      v = locate_edge(near_side(k, band, margin), {blur, shape_.half, 0.9 * band, turn});
      if (!v.used) continue;
      // From where the survey has it: the motion so far is added again.
      const Vector2d p = side.middle + v.at * side.along;
      v.offset += before.along_normal(p, side.outward).dot(previous) + previous[growth];
      v.slope += before.slope_normal(side.along, side.outward).dot(previous);
      centre += p;
      ++used;
    }
    if (used == 0) return;
    motion_.centre = centre / used;
    solve();
  }

  void solve() {
    Eigen::Matrix<double, unknowns, unknowns> N = Eigen::Matrix<double, unknowns, unknowns>::Zero();
    Eigen::Matrix<double, unknowns, 1> b = Eigen::Matrix<double, unknowns, 1>::Zero();
    const auto prior = [&](Unknown u, double value, double sigma) {
      N(u, u) += 1.0 / (sigma * sigma);
      b[u] += value / (sigma * sigma);
    };
    prior(along, 0.0, options_.search);
    prior(across, 0.0, options_.across);
    prior(along_by_y, 0.0, options_.shear);
    prior(across_by_x, 0.0, options_.turn);
    prior(along_by_x, 0.0, options_.strain_along);
    prior(across_by_y, 0.0, options_.strain_across);
    growth_prior(growth_, growth_sigma_);
    prior(growth, growth_, growth_sigma_);
    std::vector<Eigen::Matrix<double, 2, unknowns>> rows(target_.sides());
    std::vector<Matrix2d> weights(target_.sides());
    int observations = 0;
    for (size_t k = 0; k < target_.sides(); ++k) {
      const SideView& v = view_.sides[k];
      if (!v.used) continue;
      const RoofTarget::Side side = target_.side(k);
      rows[k].row(0) = motion_.along_normal(side.middle + v.at * side.along, side.outward);
      rows[k](0, growth) = 1.0;
      rows[k].row(1) = motion_.slope_normal(side.along, side.outward);
      weights[k] = v.covariance.inverse();
      N += rows[k].transpose() * weights[k] * rows[k];
      b += rows[k].transpose() * weights[k] * Vector2d(v.offset, v.slope);
      observations += 2;
    }
    covariance_ = N.inverse();
    motion_.value = covariance_ * b;
    // Residuals of edges and of the five priors on turns, strains and growth against the seven unknowns.
    double chi2 = 0.0;
    const auto lean = [&](Unknown u, double value, double sigma) { chi2 += std::pow((motion_.value[u] - value) / sigma, 2); };
    lean(along_by_y, 0.0, options_.shear);
    lean(across_by_x, 0.0, options_.turn);
    lean(along_by_x, 0.0, options_.strain_along);
    lean(across_by_y, 0.0, options_.strain_across);
    lean(growth, growth_, growth_sigma_);
    gains_.assign(target_.sides(), Eigen::Matrix<double, unknowns, 2>::Zero());
    for (size_t k = 0; k < target_.sides(); ++k) {
      const SideView& v = view_.sides[k];
      if (!v.used) continue;
      const Vector2d r = Vector2d(v.offset, v.slope) - rows[k] * motion_.value;
      chi2 += r.dot(weights[k] * r);
      gains_[k] = covariance_ * rows[k].transpose() * weights[k];
    }
    view_.chi2 = observations > 2 ? chi2 / (observations - 2) : 0.0;
  }

  void growth_prior(double& value, double& sigma) const {
    constexpr double least = 0.005;            // m
    constexpr double share_of_mixed = 0.1;     // of the footprint: roof and ground reflect differently
    constexpr double share_of_hidden = 0.125;  // of the footprint: two returns are possible, but none was seen at the edges
    if (mixed_ || options_.several_returns) {
      value = 0.0;
      sigma = std::hypot(least, (mixed_ ? share_of_mixed : share_of_hidden) * footprint());
    } else {
      value = options_.single_growth * footprint();
      sigma = std::hypot(least, options_.single_growth_sigma * footprint());
    }
  }

  bool determined() {
    bool any = false;
    for (const SideView& v : view_.sides) any = any || v.used;
    return any && fit_.n >= fewest_on_roof;
  }

  void finish() {
    view_.seen = true;
    view_.centre = motion_.centre;
    view_.displacement = motion_.value.head<2>();
    const double inflation = std::max(1.0, view_.chi2);
    view_.covariance = inflation * covariance_.topLeftCorner<2, 2>();
    const auto sigma = [&](Unknown u) { return std::sqrt(inflation * covariance_(u, u)); };
    view_.shear = motion_.value[along_by_y];
    view_.turn = motion_.value[across_by_x];
    view_.strain_along = motion_.value[along_by_x];
    view_.strain_along_sigma = sigma(along_by_x);
    view_.strain_across = motion_.value[across_by_y];
    view_.strain_across_sigma = sigma(across_by_y);
    view_.strain_across_by_growth = covariance_(across_by_y, growth) / growth_sigma_;
    view_.growth = motion_.value[growth];
    view_.blur = shape_.blur;
    view_.half_footprint = shape_.half;
    view_.by_corners = MatrixXd::Zero(2, 2 * static_cast<Eigen::Index>(target_.sides()));
    for (size_t k = 0; k < target_.sides(); ++k) {
      const SideView& v = view_.sides[k];
      if (!v.used) continue;
      const RoofTarget::Side side = target_.side(k);
      const auto i = 2 * static_cast<Eigen::Index>(k), j = 2 * static_cast<Eigen::Index>((k + 1) % target_.sides());
      const Eigen::RowVector2d n = side.outward.transpose();
      const double share = 0.5 + v.at / side.length;  // of the second corner
      const auto gain = gains_[k].topRows<2>();
      view_.by_corners.middleCols<2>(i) -= gain.col(0) * (1.0 - share) * n - gain.col(1) / side.length * n;
      view_.by_corners.middleCols<2>(j) -= gain.col(0) * share * n + gain.col(1) / side.length * n;
    }
    finish_plane();
  }

  void finish_plane() {
    // Over the surveyed plane, at the centre as it appears here.
    const Vector2d here = motion_.centre + motion_.at(motion_.centre);
    view_.height = Vector3d(1.0, here.x(), here.y()).dot(plane_) - target_.up(motion_.centre);
    view_.height_sigma = fit_.sigma[0];
    const Vector2d tilt = plane_.tail<2>() - target_.plane.tail<2>();
    view_.tilt_along = tilt.dot(motion_.x);
    view_.tilt_across = tilt.dot(motion_.y);
    view_.tilt_along_sigma = fit_.sigma[1];
    view_.tilt_across_sigma = fit_.sigma[2];
    view_.roughness = fit_.rms;
    double nearest = 1e300, sum = 0.0;
    for (const Pierced& p : pierced_) {
      if (outcome(p) != EdgePulse::on || !target_.holds(p.place - motion_.at(p.place))) continue;
      const size_t record = record_[p.pulse];
      ++view_.on_roof;
      sum += pulses_.time[record];
      const double distance = (p.place - here).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      view_.middle = {pulses_.angle[record], pulses_.forward[record], pulses_.first[record]};
      middle_time_ = pulses_.time[record];
    }
    view_.time = middle_time_;
    if (view_.on_roof < fewest_on_roof) refused("too few returns on the roof");
  }

  const TargetPulses& pulses_;
  const ShotGeometry& geometry_;
  const trajectory::Trajectory& trajectory_;
  const RoofTarget& target_;
  const EdgeOptions& options_;

  TargetView view_;
  std::vector<Beamline> beams_;
  std::vector<size_t> record_;
  std::vector<Pierced> pierced_;
  RoofMotion motion_;
  Vector3d plane_ = Vector3d::Zero();
  RoofPlane fit_;
  EdgeShape shape_{0.05, 0.0};
  bool mixed_ = false;
  double tolerance_ = coarse_tolerance, growth_ = 0.0, growth_sigma_ = 1.0, middle_time_ = 0.0;
  Eigen::Matrix<double, unknowns, unknowns> covariance_;
  std::vector<Eigen::Matrix<double, unknowns, 2>> gains_;
};

}  // namespace

TargetView view_target(const TargetPulses& pulses, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                       const RoofTarget& target, const EdgeOptions& options) {
  return Viewer(pulses, geometry, trajectory, target, options).run();
}

bool TargetView::all_sides() const {
  return std::all_of(sides.begin(), sides.end(), [](const SideView& v) { return v.used; });
}

}  // namespace swath::calib
