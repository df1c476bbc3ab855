// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/geodesy.h"
#include "io/cut_line.h"
#include "io/fix_list.h"
#include "io/nmea.h"
#include "io/record_times.h"
#include "io/rtklib_pos.h"
#include "io/table_rows.h"
#include "io/wild_records.h"

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

core::GnssData read_text(const std::filesystem::path& path, const GnssFile& f, double latency, core::Tally& tally) {
  const std::string name = path.string();
  const GnssColumns& c = f.columns;
  NamedColumns v;
  const size_t time = v.add(c.time), week = v.add(c.week);
  const std::array place{v.add(c.latitude), v.add(c.longitude), v.add(c.height)}, ecef{v.add(c.x), v.add(c.y), v.add(c.z)};
  const std::array cov{v.add(c.cov_xx), v.add(c.cov_xy), v.add(c.cov_xz), v.add(c.cov_yy), v.add(c.cov_yz), v.add(c.cov_zz)};
  const std::array sigma{v.add(c.sigma_north), v.add(c.sigma_east), v.add(c.sigma_up)};
  const std::array velocity{v.add(c.v_north), v.add(c.v_east), v.add(c.v_up)};
  const std::array sigma_v{v.add(c.sigma_v_north), v.add(c.sigma_v_east), v.add(c.sigma_v_up)};
  const size_t quality = v.add(c.quality), satellites = v.add(c.satellites);
  const bool geodetic = ecef[0] == NamedColumns::none;
  const double unit = radians_per(f.angle_unit);
  if (geodetic && unit == 0) throw core::usage_error("the unit of angles is not stated", name, "angle_unit = \"deg\", \"rad\" or \"gon\"");
  const auto rows = open_table(path, RecordFormat::text, f.delimiter, v.names());
  count_cut_line(rows->cut_line(), path, tally);
  struct Row {
    Fix fix;
    std::uint64_t number;
  };
  std::vector<Row> read;
  std::vector<double> times, weeks;
  double farthest_north = 0, farthest_east = 0;
  while (v.next(*rows)) {
    Fix fix;
    core::Geodetic g;
    if (geodetic) {
      const Vector3d p = v.three(place);
      if (std::abs(p[0] * unit) > core::pi / 2 || std::abs(p[1] * unit) > 2 * core::pi) {
        fix.fault = "latitude " + core::format_number(p[0]) + ", longitude " + core::format_number(p[1]) + " are no " +
                    std::string(core::Choices<AngleUnit>::names[static_cast<size_t>(f.angle_unit)]);
        fix.hint = f.angle_unit == AngleUnit::rad ? "state angle_unit = \"deg\"?" : "check columns and angle_unit";
      } else {
        farthest_north = std::max(farthest_north, std::abs(p[0]));
        farthest_east = std::max(farthest_east, std::abs(p[1]));
      }
      g = {p[0] * unit, p[1] * unit, p[2]};
      fix.position = core::ecef_of(g);
    } else {
      fix.position = v.three(ecef);
      if (fix.position.allFinite()) g = core::geodetic_of(fix.position);
    }
    if (cov[0] != NamedColumns::none) {
      fix.covariance << v[cov[0]], v[cov[1]], v[cov[2]], v[cov[1]], v[cov[3]], v[cov[4]], v[cov[2]], v[cov[4]], v[cov[5]];
    } else if (sigma[0] != NamedColumns::none) {
      fix.covariance = ecef_covariance(diagonal(v.three(sigma)), g.latitude, g.longitude);
    }
    if (velocity[0] != NamedColumns::none) fix.velocity = ecef_vector(v.three(velocity), g.latitude, g.longitude);
    if (sigma_v[0] != NamedColumns::none) fix.velocity_covariance = ecef_covariance(diagonal(v.three(sigma_v)), g.latitude, g.longitude);
    fix.quality = quality_of_rtklib(v[quality]);
    fix.satellites = v[satellites];
    read.push_back({std::move(fix), rows->number()});
    times.push_back(v[time]);
    if (week != NamedColumns::none) weeks.push_back(v[week]);
  }
  FixList fixes(f, name, latency, false, tally);
  const auto place_of = [&](size_t k) { return rows->place_of(read[k].number); };
  const std::vector<double> gps = gps_times(f.time, name, times, weeks, "GNSS fixes with an impossible time, left out", tally, place_of);
  for (size_t k = 0; k < read.size(); ++k) {
    read[k].fix.time = gps[k];
    if (!std::isnan(gps[k])) fixes.add(std::move(read[k].fix), place_of(k));
  }
  core::GnssData out = fixes.finish();
  if (geodetic && f.angle_unit != AngleUnit::rad && farthest_north <= core::pi / 2 && farthest_east <= core::pi)
    tally.count(
        "GNSS files whose latitudes and longitudes would all be radians: radians stated as degrees?",
        name + ": |latitude| up to " + core::format_number(farthest_north) + ", |longitude| up to " + core::format_number(farthest_east));
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
                            core::format_number(out.time.back() - part.time.front()) + " s",
                        parts[i].second, "trim one of them: two solutions for one instant have no order");
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(out.time, part.time);
    append(out.position, part.position);
    append(out.covariance, part.covariance);
    append(out.velocity, part.velocity);
    append(out.velocity_covariance, part.velocity_covariance);
    append(out.quality, part.quality);
    append(out.satellites, part.satellites);
  }
  return out;
}

}  // namespace swath::io
