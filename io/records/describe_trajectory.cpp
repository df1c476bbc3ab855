// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/describe_trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/records/sbet.h"

namespace swath::io {
namespace {

using core::Value;

constexpr double slow = 5.0;                 // m/s; below it the track shows nothing of the heading
constexpr double odd_crab = 30.0;            // deg between heading and track
constexpr double steep = 60 * core::degree;  // roll or pitch no survey flight has

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  Value value(double factor = 1.0) const { return Value(Value::Array{low * factor, high * factor}); }
};

template <class Record>
std::vector<Record> all_of(const std::filesystem::path& path) {
  const RecordFile<Record> file(path);
  std::vector<Record> rows;
  file.read(0, static_cast<size_t>(file.records()), rows);
  return rows;
}

template <class Record, class Plausible>
bool looks_like(const std::filesystem::path& path, Plausible plausible) {
  std::error_code ec;
  const auto size = std::filesystem::file_size(path, ec);
  if (ec || size == 0 || size % sizeof(Record) != 0) return false;
  const RecordFile<Record> file(path);
  std::vector<Record> rows, last;
  file.read(0, static_cast<size_t>(std::min<std::uint64_t>(file.records(), 50)), rows);
  file.read(file.records() - 1, 1, last);
  rows.push_back(last[0]);
  double before = -std::numeric_limits<double>::infinity();
  size_t back = 0;
  for (const Record& r : rows) {
    if (!std::isfinite(r.time) || std::abs(r.time) > 1e11 || (r.time != 0 && std::abs(r.time) < 1e-6) || !plausible(r)) return false;
    back += r.time < before;
    before = r.time;
  }
  return 2 * back < rows.size();
}

/// Median step of the times, gaps and steps back.
void describe_times(const std::vector<double>& time, Value& out, Value& warnings) {
  std::vector<double> steps;
  size_t back = 0, repeated = 0;
  for (size_t i = 1; i < time.size(); ++i) {
    const double step = time[i] - time[i - 1];
    back += step < 0;
    repeated += step == 0;
    if (step > 0) steps.push_back(step);
  }
  out["time"] = Value(Value::Array{time.front(), time.back()});
  out["duration_s"] = time.back() - time.front();
  if (back) warnings.push("time goes back " + std::to_string(back) + " times: the file is not sorted");
  if (repeated) warnings.push(std::to_string(repeated) + " records repeat the time before them");
  if (time.front() >= 0 && time.back() < 2 * core::seconds_per_week)
    warnings.push("times look like seconds of the GPS week (or of a day); the file does not say of which");
  if (steps.empty()) return;
  const double median = core::median(steps);
  out["rate_hz"] = std::round(1e3 / median) / 1e3;
  size_t gaps = 0;
  double longest = 0;
  for (const double s : steps)
    if (s > std::max(5 * median, 0.05)) {
      ++gaps;
      longest = std::max(longest, s);
    }
  if (gaps) warnings.push(std::to_string(gaps) + " gaps, the longest " + core::format_number(std::round(longest * 1e3) / 1e3) + " s");
}

/// Mean angle from track to heading, deg, and the mean speed; NaN where the carrier hardly moves.
std::pair<double, double> crab(const std::vector<SbetRecord>& rows, double wander_sign) {
  double sum_sin = 0, sum_cos = 0, path = 0, time = 0;
  for (size_t i = 0, j = 0; i + 1 < rows.size(); i = j) {
    for (j = i + 1; j + 1 < rows.size() && rows[j].time < rows[i].time + 0.5;) ++j;
    const SbetRecord &a = rows[i], &b = rows[j];
    const double dt = b.time - a.time;
    if (!(dt > 0) || dt > 2) continue;
    const double north = (core::meridian_radius(a.latitude) + a.altitude) * (b.latitude - a.latitude);
    const double east =
        (core::prime_vertical_radius(a.latitude) + a.altitude) * std::cos(a.latitude) * core::wrap_pi(b.longitude - a.longitude);
    path += std::hypot(north, east);
    time += dt;
    if (std::hypot(north, east) < slow * dt) continue;
    const double off = b.platform_heading + wander_sign * b.wander_angle - std::atan2(east, north);
    sum_sin += std::sin(off);
    sum_cos += std::cos(off);
  }
  const bool moved = sum_sin != 0 || sum_cos != 0;
  return {moved ? core::to_degrees(std::atan2(sum_sin, sum_cos)) : std::nan(""), time > 0 ? path / time : 0};
}

}  // namespace

bool looks_like_sbet(const std::filesystem::path& path) {
  return looks_like<SbetRecord>(path, [](const SbetRecord& r) {
    return std::abs(r.latitude) <= 90 && std::abs(r.longitude) <= 400 && std::abs(r.altitude) < 1e5 && std::abs(r.x_velocity) < 1e4 &&
           std::abs(r.y_velocity) < 1e4 && std::abs(r.roll) <= 400 && std::abs(r.pitch) <= 400 && std::abs(r.platform_heading) <= 400 &&
           (std::abs(r.latitude) > 1e-9 || std::abs(r.longitude) > 1e-9);
  });
}

bool looks_like_smrmsg(const std::filesystem::path& path) {
  return looks_like<SmrmsgRecord>(path, [](const SmrmsgRecord& r) {
    for (size_t k = 0; k < 3; ++k)
      if (!(r.position[k] >= 0 && r.position[k] < 1e4 && r.velocity[k] >= 0 && r.velocity[k] < 1e3 && r.attitude[k] >= 0 &&
            r.attitude[k] < 2e4))
        return false;
    return r.time >= 0 && r.position[0] + r.position[1] + r.position[2] > 1e-9;
  });
}

core::Value describe_sbet(const std::filesystem::path& path) {
  const std::vector<SbetRecord> rows = all_of<SbetRecord>(path);
  Value out = Value::object(), warnings = Value::array();
  Extent latitude, longitude, height, roll, pitch, wander;
  std::vector<double> time;
  size_t not_finite = 0;
  for (const SbetRecord& r : rows) {
    if (!std::isfinite(r.time + r.latitude + r.longitude + r.altitude + r.roll + r.pitch + r.platform_heading + r.wander_angle)) {
      ++not_finite;
      continue;
    }
    time.push_back(r.time);
    latitude.add(r.latitude);
    longitude.add(r.longitude);
    height.add(r.altitude);
    roll.add(r.roll);
    pitch.add(r.pitch);
    wander.add(r.wander_angle);
  }
  out["format"] = "SBET";
  out["records"] = static_cast<std::uint64_t>(rows.size());
  if (not_finite) warnings.push(std::to_string(not_finite) + " records hold values that are not finite");
  if (!time.empty()) {
    describe_times(time, out, warnings);
    const bool degrees = std::max(std::abs(latitude.low), std::abs(latitude.high)) > core::pi / 2 ||
                         std::max(std::abs(longitude.low), std::abs(longitude.high)) > 2 * core::pi;
    const double unit = degrees ? 1.0 : 1.0 / core::degree;
    if (degrees) warnings.push("positions are in degrees; an SBET holds radians");
    out["latitude_deg"] = latitude.value(unit);
    out["longitude_deg"] = longitude.value(unit);
    out["height_m"] = height.value();
    out["roll_deg"] = roll.value(unit);
    out["pitch_deg"] = pitch.value(unit);
    out["wander_deg"] = wander.value(unit);
    if (!degrees && std::max({std::abs(roll.low), std::abs(roll.high), std::abs(pitch.low), std::abs(pitch.high)}) > steep)
      warnings.push("roll or pitch beyond 60 deg: are the attitudes in degrees?");
    if (!degrees && not_finite == 0) {
      const auto [with, speed] = crab(rows, -1.0);
      const double without = crab(rows, 0.0).first;
      out["mean_speed_m_s"] = speed;
      if (std::isfinite(with)) {
        out["heading_minus_track_deg"] = with;
        if (std::abs(with) > odd_crab)
          warnings.push("heading - wander angle differs from the track by " + core::format_number(std::round(with * 10) / 10) +
                        " deg in the mean; without the wander angle by " + core::format_number(std::round(without * 10) / 10) + " deg");
      }
      core::Tally tally;
      TimeTags any;
      any.scale = core::TimeScale::gps;
      const core::TrajectoryData t = read_sbet(path, any, true, VelocityAxes::automatic, std::nullopt, tally);
      if (!t.has_velocity())
        warnings.push("velocities disagree with the positions in every known choice of axes");
      else
        out["velocity_axes"] = tally.of("SBET files with velocities north, west, up") ? "north, west, up" : "north, east, down";
    }
  }
  out["warnings"] = std::move(warnings);
  return out;
}

core::Value describe_smrmsg(const std::filesystem::path& path) {
  const std::vector<SmrmsgRecord> rows = all_of<SmrmsgRecord>(path);
  Value out = Value::object(), warnings = Value::array();
  Extent horizontal, down, roll_pitch, heading;
  std::vector<double> time;
  for (const SmrmsgRecord& r : rows) {
    time.push_back(r.time);
    horizontal.add(r.position[0]);
    horizontal.add(r.position[1]);
    down.add(r.position[2]);
    roll_pitch.add(r.attitude[0]);
    roll_pitch.add(r.attitude[1]);
    heading.add(r.attitude[2]);
  }
  out["format"] = "smrmsg";
  out["records"] = static_cast<std::uint64_t>(rows.size());
  describe_times(time, out, warnings);
  out["sigma_north_east_m"] = horizontal.value();
  out["sigma_down_m"] = down.value();
  out["sigma_roll_pitch_deg"] = roll_pitch.value(1.0 / 60);
  out["sigma_heading_deg"] = heading.value(1.0 / 60);
  if (down.high > 1.0 || horizontal.high > 1.0) warnings.push("positions are worse than 1 m at times: no fixed solution there?");
  out["warnings"] = std::move(warnings);
  return out;
}

}  // namespace swath::io
