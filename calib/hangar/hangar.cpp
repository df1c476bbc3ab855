// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski et al., lever arm by a hangar survey. Beyond the paper: covariances go all the way (stations into points, points into
// the vector), the aircraft's attitude in the hangar enters with its sigma, and where observations scatter more than their stated
// sigmas allow, the covariance is multiplied by the variance factor and a warning says so.
#include "calib/hangar/hangar.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "calib/hangar/refusals.h"
#include "calib/words.h"
#include "core/config/units.h"
#include "core/distributions.h"
#include "core/error.h"

namespace swath::calib {
namespace {

using core::Error;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using io::HangarRole;

constexpr double doubtful = 3.29;       // |w|: one in a thousand good observations
constexpr double odd_scale = 0.01;      // scale error of distances that is no instrument's
constexpr double far_better = 1e-3;     // variance factor after by before a change of unit
constexpr double mirror_apart = 0.001;  // m; nearer than this the mirror image is the point itself
constexpr double least_base = 0.5;      // m between the means of the marks fore and aft

Vector3d vector_of(const std::array<core::Metres, 3>& a) { return {a[0].value, a[1].value, a[2].value}; }
std::optional<Vector3d> vector_of(const std::optional<std::array<core::Metres, 3>>& a) {
  return a ? std::optional(vector_of(*a)) : std::nullopt;
}
std::string name_of(HangarRole r) { return std::string(core::Choices<HangarRole>::names[static_cast<size_t>(r)]); }

template <class T>
std::map<std::string, size_t> indices(const std::vector<T>& list) {
  std::map<std::string, size_t> out;
  for (size_t i = 0; i < list.size(); ++i) out[list[i].name] = i;
  return out;
}

/// The steps in their order; each leaves its part in the result.
class Solver {
 public:
  Solver(const io::HangarSurvey& hangar, bool hold) : h_(hangar), hold_(hold), file_(hangar.file.string()) {}

  HangarResult run() {
    stations();
    points();
    axes();
    lever_arms();
    return std::move(out_);
  }

 private:
  void warn(const std::string& what) { out_.warnings.push_back(what); }

  void stations() {
    const auto targets = indices(h_.targets);
    for (const io::HangarStation& s : h_.stations) {
      StationResult one;
      one.name = s.name;
      one.stated = s.at.has_value();
      std::vector<TargetDistance> distances;
      for (const io::HangarDistance& d : h_.distances) {
        const auto target = targets.find(d.to);
        if (d.from != s.name || target == targets.end()) continue;
        distances.push_back({vector_of(h_.targets[target->second].at), d.distance.value, d.sigma->value});
        one.targets.push_back(d.to);
        one.places.push_back(d.place);
      }
      if (one.stated) {
        one.position = vector_of(*s.at);
        one.covariance = vector_of(*s.sigma).cwiseAbs2().asDiagonal();
        if (!distances.empty()) warn("station '" + s.name + "' has stated coordinates: its distances to targets are not used");
      } else {
        one.resection = resect(distances, vector_of(s.start));
        refuse_other_unit(one.resection, "station '" + s.name + "'", distances);
        refuse(one.resection, s.name, distances.size(), file_);
        one.position = one.resection.position;
        settle(one);
      }
      out_.stations.push_back(std::move(one));
    }
  }

  /// Distances that fit with another unit are in that unit.
  void refuse_other_unit(const Resection& r, const std::string& station, std::vector<TargetDistance> distances) const {
    if (r.state == ResectionState::in_line || !(std::abs(r.scale - 1) > odd_scale)) return;
    for (TargetDistance& d : distances) d.distance *= r.scale;
    const Resection other = resect(distances);
    if (other.state != ResectionState::solved && other.state != ResectionState::two_fit) return;
    if (r.state != ResectionState::not_found && !(other.variance_factor < far_better * r.variance_factor)) return;
    throw Error(station + words(": its distances fit when they are multiplied by %.4f", r.scale), file_,
                "is their unit right? tables have length_unit; 1 ft is 0.3048 m");
  }

  void settle(StationResult& s) {
    const Resection& r = s.resection;
    const std::string station = "station '" + s.name + "'";
    if (scatter_too_large(r.variance_factor, r.redundancy)) {
      s.factor = r.variance_factor;
      warn(station + words(": its distances scatter %.1f times more than stated; its covariance is enlarged by that", std::sqrt(s.factor)));
    }
    s.covariance = s.factor * r.covariance;
    if (r.redundancy == 0) warn(station + " has three distances: nothing checks them");
    for (size_t i = 0; i < r.w.size(); ++i)
      if (std::abs(r.w[i]) > doubtful)
        warn(station + ": the distance to '" + s.targets[i] + "' (" + s.places[i] + ") is off by " +
             words("%.1f mm, w = %.1f", 1e3 * r.residual[i], r.w[i]));
    if (r.start_led_to_mirror)
      warn(station + ": its start value leads to the mirror image " + place_text(*r.mirror) +
           words(" (variance factor %.3g); the right side was found without it (%.3g)", r.mirror_variance_factor, r.variance_factor));
    if (r.decided_by_start) warn(station + ": its targets lie in one plane; the side was decided by its start value alone");
  }

  /// Sights at points, as indices.
  PointNetwork network(const std::map<std::string, size_t>& points, size_t n) const {
    PointNetwork net;
    net.points = n;
    net.signed_elevations = h_.elevation_signs;
    const auto station = indices(h_.stations);
    for (const StationResult& s : out_.stations) net.stations.push_back(s.position);
    if (!hold_) {
      const auto rows = static_cast<Index>(3 * net.stations.size());
      net.station_covariance.setZero(rows, rows);
      for (size_t s = 0; s < net.stations.size(); ++s)
        net.station_covariance.block<3, 3>(static_cast<Index>(3 * s), static_cast<Index>(3 * s)) = out_.stations[s].covariance;
    }
    const auto known = [&](const std::string& p) { return points.count(p) > 0; };
    for (const io::HangarAngle& a : h_.angles)
      if (known(a.to)) net.angles.push_back({station.at(a.at), station.at(a.from), points.at(a.to), a.angle.value, a.sigma->value});
    for (const io::HangarVertical& v : h_.verticals)
      if (known(v.to)) net.verticals.push_back({station.at(v.at), points.at(v.to), v.angle.value, v.sigma->value});
    for (const io::HangarDistance& d : h_.distances)
      if (known(d.to)) net.distances.push_back({station.at(d.from), points.at(d.to), d.distance.value, d.sigma->value});
    return net;
  }

  void points() {
    std::map<std::string, size_t> sighted;
    std::vector<std::optional<Vector3d>> starts;
    for (const io::HangarPoint& p : h_.points) {
      if (p.at) continue;
      sighted[p.name] = starts.size();
      starts.push_back(vector_of(p.start));
    }
    FoundPoints found;
    if (!starts.empty()) {
      const PointNetwork net = network(sighted, starts.size());
      found = find_points(net, starts);
      for (const io::HangarPoint& p : h_.points)
        if (!p.at) refuse(found.searches[sighted[p.name]], p.name, file_);
      if (!found.adjusted.solved)
        throw Error("the points cannot be adjusted together", file_, "check names and units of the sights; see whether each has its own");
      settle(net, found.adjusted);
    }
    const auto n = static_cast<Index>(h_.points.size());
    all_.covariance.setZero(3 * n, 3 * n);
    for (Index i = 0; i < n; ++i) {
      const io::HangarPoint& p = h_.points[static_cast<size_t>(i)];
      PointResult one;
      one.name = p.name;
      one.role = p.role;
      one.stated = p.at.has_value();
      if (p.at) {
        one.position = vector_of(*p.at);
        all_.covariance.block<3, 3>(3 * i, 3 * i) = vector_of(*p.sigma).cwiseAbs2().asDiagonal();
        warn_of_unused(p.name);
      } else {
        const size_t k = sighted[p.name];
        one.search = found.searches[k];
        one.position = found.adjusted.points.segment<3>(static_cast<Index>(3 * k));
        warn_of_mirror(one);
        for (Index j = 0; j < n; ++j) {
          const auto other = sighted.find(h_.points[static_cast<size_t>(j)].name);
          if (other == sighted.end()) continue;
          all_.covariance.block<3, 3>(3 * i, 3 * j) =
              out_.point_factor * found.adjusted.covariance.block<3, 3>(static_cast<Index>(3 * k), static_cast<Index>(3 * other->second));
        }
      }
      one.covariance = all_.covariance.block<3, 3>(3 * i, 3 * i);
      all_.position.push_back(one.position);
      out_.points.push_back(std::move(one));
    }
  }

  void warn_of_unused(const std::string& point) {
    const bool sighted = std::any_of(h_.angles.begin(), h_.angles.end(), [&](const auto& a) { return a.to == point; }) ||
                         std::any_of(h_.verticals.begin(), h_.verticals.end(), [&](const auto& a) { return a.to == point; }) ||
                         std::any_of(h_.distances.begin(), h_.distances.end(), [&](const auto& d) { return d.to == point; });
    if (sighted) warn("point '" + point + "' has stated coordinates: the sights at it are not used");
  }

  void warn_of_mirror(const PointResult& p) {
    const PointSearch& s = p.search;
    if (!s.mirror || (*s.mirror - s.position).norm() < mirror_apart) return;
    const std::string point = "point '" + p.name + "'";
    if (s.start_led_to_mirror)
      warn(point + ": its start value leads to the mirror image " + place_text(*s.mirror) +
           words(" (variance factor %.3g); the mirrored start finds the right one (%.3g)", s.mirror_variance_factor, s.variance_factor));
    if (s.decided_by_elevation)
      warn(point + ": its mirror image " + place_text(*s.mirror) + " fits as well but for the signs of the vertical angles, which decided");
    if (s.decided_by_start) warn(point + ": its mirror image " + place_text(*s.mirror) + " fits as well; the start value alone decided");
    if (s.elevations_contradict)
      warn(point + ": the signs of its vertical angles fit the mirror image and not the point: are they positive upwards?");
  }

  /// Variance factor, residuals and what was not used.
  void settle(const PointNetwork& net, const CombinedPoints& a) {
    if (scatter_too_large(a.variance_factor, a.redundancy)) {
      out_.point_factor = a.variance_factor;
      warn(words("the sights at the points scatter %.1f times more than stated; their covariance is enlarged by that",
                 std::sqrt(a.variance_factor)));
    }
    if (a.redundancy == 0) warn("the sights at the points are just enough: nothing checks them");
    std::vector<bool> used(net.angles.size() + net.verticals.size(), false);
    for (const PointCondition& c : conditions_of(net)) {
      if (c.kind == PointCondition::Kind::measured) continue;
      if (c.kind == PointCondition::Kind::height) {
        used[net.angles.size() + c.other] = true;
        continue;
      }
      used[c.alpha] = used[c.beta] = used[net.angles.size() + c.other] = true;
    }
    Index row = 0;
    const auto add = [&](const std::string& what, const std::string& place, double observed, double sigma, double unit, const char* name) {
      const SightResult s{what, place, observed, a.residual[row], sigma, a.w[row]};
      if (row < static_cast<Index>(used.size()) && !used[static_cast<size_t>(row)])
        warn("the " + what + " (" + place + ") is not used: a triangle needs the angles at both its stations and a vertical angle");
      else if (std::abs(s.w) > doubtful)
        warn("the " + what + " (" + place + ") is off by " + words("%.1f ", -s.residual * unit) + name + words(", w = %.1f", s.w));
      out_.sights.push_back(s);
      ++row;
    };
    const auto sighted = [&](const std::string& name) {
      return std::any_of(h_.points.begin(), h_.points.end(), [&](const auto& p) { return p.name == name && !p.at; });
    };
    constexpr double arc_seconds = 3600 / core::degree, millimetres = 1e3;
    for (const io::HangarAngle& o : h_.angles)
      if (sighted(o.to))
        add("angle at '" + o.at + "' from '" + o.from + "' to '" + o.to + "'", o.place, o.angle.value, o.sigma->value, arc_seconds,
            "arcsec");
    for (const io::HangarVertical& o : h_.verticals)
      if (sighted(o.to))
        add("vertical angle at '" + o.at + "' to '" + o.to + "'", o.place, o.angle.value, o.sigma->value, arc_seconds, "arcsec");
    for (const io::HangarDistance& o : h_.distances)
      if (sighted(o.to))
        add("distance from '" + o.from + "' to '" + o.to + "'", o.place, o.distance.value, o.sigma->value, millimetres, "mm");
    out_.adjusted = a;
  }

  void axes() {
    std::vector<size_t> fore, aft;
    for (size_t i = 0; i < h_.points.size(); ++i) {
      if (h_.points[i].role == HangarRole::fore) fore.push_back(i);
      if (h_.points[i].role == HangarRole::aft) aft.push_back(i);
    }
    const io::HangarAxes& a = h_.axes;
    const Vector3d sigma(a.roll_sigma.value, a.pitch_sigma.value, a.heading_sigma.value);
    const core::Attitude level{a.roll.value, a.pitch.value, a.heading.value_or(core::Radians(0)).value};
    const size_t n = h_.points.size();
    if (a.heading) {
      out_.axes = stated_axes(level, sigma, n);
      if (!fore.empty() || !aft.empty()) warn("the heading is stated: the marks fore and aft are not used for it");
    } else {
      if (fore.empty() || aft.empty())
        throw Error("the heading of the aircraft in the hangar is not known", file_,
                    "sight a point with role = \"fore\" and one with role = \"aft\" along the fuselage, or state axes.heading");
      Vector3d base = Vector3d::Zero();
      for (const size_t f : fore) base += all_.position[f] / static_cast<double>(fore.size());
      for (const size_t b : aft) base -= all_.position[b] / static_cast<double>(aft.size());
      if (base.head<2>().norm() < least_base)
        throw Error("the marks fore and aft are " + words("%.2f m apart, too little for a heading", base.head<2>().norm()), file_,
                    "choose marks far apart along the fuselage");
      out_.axes = axes_of_marks(all_, aft, fore, a.heading_offset.value, level, sigma);
    }
    const Eigen::RowVectorXd& by = out_.axes.heading_by_points;
    out_.heading_sigma = std::sqrt(by.dot(by * all_.covariance) + sigma.z() * sigma.z());
  }

  void lever_arms() {
    std::map<HangarRole, BodyPoint> at;
    for (size_t i = 0; i < h_.points.size(); ++i)
      at[h_.points[i].role] = {i, vector_of(h_.points[i].offset), h_.points[i].offset_sigma.value};
    const auto add = [&](HangarRole from, HangarRole to) {
      if (!at.count(from) || !at.count(to)) return;
      const BodyVector v = body_vector(all_, at[from], at[to], out_.axes);
      out_.lever_arms.push_back({from, to, v.value, v.covariance});
    };
    add(HangarRole::imu, HangarRole::scanner);
    add(HangarRole::imu, HangarRole::antenna);
    add(HangarRole::scanner, HangarRole::antenna);
    if (out_.lever_arms.empty())
      throw Error("two of the points imu, scanner and antenna are needed for a lever arm", file_, "state `role` of the points");
    if (!at.count(HangarRole::imu))
      warn("no point has the role imu: survey.toml counts its lever arms from the IMU's centre, add the way from there to the scanner");
  }

  const io::HangarSurvey& h_;
  bool hold_;
  std::string file_;
  HangarResult out_;
  HangarPoints all_;
};

}  // namespace

double LeverArm::sigma() const { return std::sqrt(covariance.diagonal().maxCoeff()); }

bool scatter_too_large(double factor, int redundancy) {
  constexpr double one_in_thousand = 1e-3;
  return redundancy > 0 && factor * redundancy > core::chi_square_limit(one_in_thousand, redundancy);
}

HangarResult solve_hangar(const io::HangarSurvey& hangar, bool hold_stations) { return Solver(hangar, hold_stations).run(); }

std::string survey_lines(const HangarResult& result) {
  const auto metres = [](double v) { return "\"" + words("%.4f", v) + " m\""; };
  const auto vector = [&](const Vector3d& v) { return "[" + metres(v.x()) + ", " + metres(v.y()) + ", " + metres(v.z()) + "]"; };
  std::string out;
  for (const LeverArm& l : result.lever_arms) {
    if (l.from != HangarRole::imu) continue;
    if (l.to == HangarRole::antenna)
      out += "[antenna]\nlever_arm = " + vector(l.value) + "\nlever_arm_sigma = " + metres(l.sigma()) + "\n\n";
    else
      out += "[calibration]\nlever_arm_scanner = " + vector(l.value) + "\n\n[sigma]\nlever_arm = " + metres(l.sigma()) + "\n\n";
  }
  if (out.empty()) {
    const LeverArm& l = result.lever_arms.front();
    return "# From " + name_of(l.from) + " to " + name_of(l.to) + ", sigma " + words("%.4f m", l.sigma()) +
           ". Add the way from the IMU's centre to the scanner for survey.toml.\n# " + vector(l.value) + "\n";
  }
  return "# Lever arms by a hangar survey: forward, right, down from the IMU's centre; sigma of the least known component.\n\n" + out;
}

}  // namespace swath::calib
