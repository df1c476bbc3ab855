// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/gnss_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/records/gnss_columns.h"
#include "io/gnss/fix_list.h"
#include "io/gnss/nmea.h"
#include "io/gnss/rtklib_pos.h"
#include "io/survey/record_times.h"
#include "io/survey/wild_records.h"
#include "io/text/cut_line.h"
#include "io/text/table_rows.h"

namespace swath::io {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The columns that the survey names, and the values of a row by their place in it; NaN for those not named.
class NamedColumns {
 public:
  size_t add(const std::string& column) {
    if (column.empty()) return none;
    names_.push_back(column);
    return names_.size() - 1;
  }
  const std::vector<std::string>& names() const { return names_; }
  bool next(TableRows& rows) {
    values_.resize(names_.size());
    return rows.next(values_.data());
  }
  double operator[](size_t at) const { return at == none ? Fix::none : values_[at]; }
  Vector3d three(const std::array<size_t, 3>& at) const { return {(*this)[at[0]], (*this)[at[1]], (*this)[at[2]]}; }

  static constexpr size_t none = ~size_t{0};

 private:
  std::vector<std::string> names_;
  std::vector<double> values_;
};

/// North, east, up sigmas to a covariance; not finite where one of them is not.
Matrix3d diagonal(const Vector3d& sigma) {
  if (!sigma.allFinite()) return Matrix3d::Constant(Fix::none);
  const Vector3d signed_squares = sigma.cwiseProduct(sigma.cwiseAbs());
  return signed_squares.asDiagonal();
}

/// Fixes out of the columns that a text file has.
class TextFixes {
 public:
  TextFixes(const GnssFile& f, const std::string& name) : file_(f), name_(name), unit_(radians_per(f.angle_unit)) {
    if (geodetic() && unit_ == 0)
      throw core::usage_error("the unit of angles is not stated", name, "angle_unit = \"deg\", \"rad\" or \"gon\"");
  }
  NamedColumns& columns() { return v_; }
  double time() const { return v_[time_]; }
  bool has_week() const { return week_ != NamedColumns::none; }
  double week() const { return v_[week_]; }

  /// Of the row that was read last, without its time.
  Fix fix() {
    Fix fix;
    core::Geodetic g;
    if (geodetic()) {
      g = geodetic_place(fix);
      fix.position = core::ecef_of(g);
    } else {
      fix.position = v_.three(ecef_);
      if (fix.position.allFinite()) g = core::geodetic_of(fix.position);
    }
    if (cov_[0] != NamedColumns::none) {
      const auto c = [&](size_t k) { return v_[cov_[k]]; };
      fix.covariance << c(0), c(1), c(2), c(1), c(3), c(4), c(2), c(4), c(5);
    } else if (sigma_[0] != NamedColumns::none) {
      fix.covariance = ecef_covariance(diagonal(v_.three(sigma_)), g.latitude, g.longitude);
    }
    if (velocity_[0] != NamedColumns::none) fix.velocity = ecef_vector(v_.three(velocity_), g.latitude, g.longitude);
    if (sigma_v_[0] != NamedColumns::none) fix.velocity_covariance = ecef_covariance(diagonal(v_.three(sigma_v_)), g.latitude, g.longitude);
    fix.quality = quality_of_rtklib(v_[quality_]);
    fix.satellites = v_[satellites_];
    return fix;
  }

  void count_radians(core::Tally& tally) const {
    if (geodetic() && file_.angle_unit != AngleUnit::rad && farthest_north_ <= core::pi / 2 && farthest_east_ <= core::pi)
      tally.count("GNSS files whose latitudes and longitudes would all be radians: radians stated as degrees?",
                  name_ + ": |latitude| up to " + core::format_number(farthest_north_) + ", |longitude| up to " +
                      core::format_number(farthest_east_));
  }

 private:
  using Three = std::array<size_t, 3>;
  bool geodetic() const { return ecef_[0] == NamedColumns::none; }

  core::Geodetic geodetic_place(Fix& fix) {
    const Vector3d p = v_.three(place_);
    if (std::abs(p[0] * unit_) > core::pi / 2 || std::abs(p[1] * unit_) > 2 * core::pi) {
      fix.fault = "latitude " + core::format_number(p[0]) + ", longitude " + core::format_number(p[1]) + " are no " +
                  std::string(core::Choices<AngleUnit>::names[static_cast<size_t>(file_.angle_unit)]);
      fix.hint = file_.angle_unit == AngleUnit::rad ? "state angle_unit = \"deg\"?" : "check columns and angle_unit";
    } else {
      farthest_north_ = std::max(farthest_north_, std::abs(p[0]));
      farthest_east_ = std::max(farthest_east_, std::abs(p[1]));
    }
    return {p[0] * unit_, p[1] * unit_, p[2]};
  }

  const GnssFile& file_;
  const std::string& name_;
  const GnssColumns& c_ = file_.columns;
  NamedColumns v_;
  size_t time_ = v_.add(c_.time), week_ = v_.add(c_.week);
  Three place_{v_.add(c_.latitude), v_.add(c_.longitude), v_.add(c_.height)}, ecef_{v_.add(c_.x), v_.add(c_.y), v_.add(c_.z)};
  std::array<size_t, 6> cov_{v_.add(c_.cov_xx), v_.add(c_.cov_xy), v_.add(c_.cov_xz),
                             v_.add(c_.cov_yy), v_.add(c_.cov_yz), v_.add(c_.cov_zz)};
  Three sigma_{v_.add(c_.sigma_north), v_.add(c_.sigma_east), v_.add(c_.sigma_up)};
  Three velocity_{v_.add(c_.v_north), v_.add(c_.v_east), v_.add(c_.v_up)};
  Three sigma_v_{v_.add(c_.sigma_v_north), v_.add(c_.sigma_v_east), v_.add(c_.sigma_v_up)};
  size_t quality_ = v_.add(c_.quality), satellites_ = v_.add(c_.satellites);
  double unit_;
  double farthest_north_ = 0, farthest_east_ = 0;
};

core::GnssData read_text(const std::filesystem::path& path, const GnssFile& f, double latency, core::Tally& tally) {
  const std::string name = path.string();
  TextFixes text(f, name);
  const auto rows = open_table(path, RecordFormat::text, f.delimiter, text.columns().names());
  count_cut_line(rows->cut_line(), path, "GNSS fixes", tally);
  FixList fixes(f, name, latency, false, tally);
  std::vector<double> times, weeks;
  while (text.columns().next(*rows)) {
    fixes.add(text.fix(), rows->number());
    times.push_back(text.time());
    if (text.has_week()) weeks.push_back(text.week());
  }
  fixes.set_times(gps_times(f.time, name, times, weeks, "GNSS fixes with an impossible time, left out", tally,
                            [&](size_t k) { return fixes.place_of(k); }));
  core::GnssData out = fixes.finish();
  text.count_radians(tally);
  return out;
}

}  // namespace

core::GnssData read_gnss(const Survey& survey, const GnssFile& f, core::Tally& tally) {
  const std::filesystem::path path = resolve(survey, f.file);
  const double latency = survey.antenna.latency.value;
  switch (format_of(f)) {
    case GnssFormat::text:
      return read_text(path, f, latency, tally);
    case GnssFormat::pos:
      return read_pos(path, f, latency, tally);
    case GnssFormat::nmea:
      return read_nmea(path, f, latency, tally);
    case GnssFormat::automatic:
      break;
  }
  throw core::usage_error("the name does not tell the format of the GNSS records", path.string(),
                          "state format = \"text\", \"pos\" or \"nmea\"");
}

core::GnssData read_gnss(const Survey& survey, core::Tally& tally) {
  if (survey.gnss.empty()) throw core::usage_error("the survey has no GNSS records");
  std::vector<std::pair<core::GnssData, std::string>> parts;
  for (const GnssFile& f : survey.gnss) parts.emplace_back(read_gnss(survey, f, tally), f.file.string());
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first.time.front() < b.first.time.front(); });
  const bool velocities = std::any_of(parts.begin(), parts.end(), [](const auto& p) { return p.first.has_velocity(); });
  core::GnssData out;
  for (size_t i = 0; i < parts.size(); ++i) {
    core::GnssData& part = parts[i].first;
    if (velocities && !part.has_velocity()) {
      part.velocity.assign(part.size(), Vector3d::Constant(Fix::none));
      part.velocity_covariance.assign(part.size(), Matrix3d::Identity());
    }
    if (i > 0 && part.time.front() <= out.time.back())
      throw core::Error(parts[i - 1].second + " and " + parts[i].second + " overlap by " +
                            core::format_number(out.time.back() - part.time.front(), 4) + " s",
                        parts[i].second, "trim one of them: two solutions for one instant have no order");
    core::for_each_gnss_column(
        [&](auto member) { (out.*member).insert((out.*member).end(), (part.*member).begin(), (part.*member).end()); });
  }
  return out;
}

}  // namespace swath::io
