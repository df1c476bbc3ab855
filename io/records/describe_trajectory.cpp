// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/describe_trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/config/interval.h"
#include "core/config/result_visitors.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/records/sbet.h"

namespace swath::io {
namespace {

constexpr double slow = 5.0;                 // m/s; below it the track shows nothing of the heading
constexpr double odd_crab = 30.0;            // deg between heading and track
constexpr double steep = 60 * core::degree;  // roll or pitch no survey flight has

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

struct TimeFacts {
  std::array<double, 2> ends{};
  std::optional<double> rate{};
};
template <class V>
void describe(const TimeFacts& r, V& v) {
  v.result("time", r.ends, "First and last time, as recorded.");
  v.result("duration_s", r.ends[1] - r.ends[0], core::seconds(), "Time from the first to the last; below 0 over a week's end.");
  v.result("rate_hz", r.rate, core::Form{"Hz"}, "Records per second, by the median step.");
}

/// Median step of the times; gaps and steps back are warned of.
TimeFacts times_of(const std::vector<double>& time, std::vector<std::string>& warnings) {
  TimeFacts out;
  std::vector<double> steps;
  size_t back = 0, repeated = 0;
  for (size_t i = 1; i < time.size(); ++i) {
    const double step = time[i] - time[i - 1];
    back += step < 0;
    repeated += step == 0;
    if (step > 0) steps.push_back(step);
  }
  out.ends = {time.front(), time.back()};
  if (back) warnings.push_back("time goes back " + core::counted(back, "time") + ": the file is not sorted");
  if (repeated) warnings.push_back(core::counted(repeated, "record repeats the time before it", "records repeat the time before them"));
  if (time.front() >= 0 && time.back() < 2 * core::seconds_per_week)
    warnings.push_back("times look like seconds of the GPS week (or of a day); the file does not say of which");
  if (steps.empty()) return out;
  const double median = core::median(steps);
  out.rate = std::round(1e3 / median) / 1e3;
  size_t gaps = 0;
  double longest = 0;
  for (const double s : steps)
    if (s > std::max(5 * median, 0.05)) {
      ++gaps;
      longest = std::max(longest, s);
    }
  if (gaps) warnings.push_back(core::counted(gaps, "gap") + ", the longest " + core::format_number(std::round(longest * 1e3) / 1e3) + " s");
  return out;
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

struct SbetFacts {
  std::uint64_t records = 0;
  TimeFacts times{};
  core::Interval latitude{}, longitude{}, height{}, roll{}, pitch{}, wander{};  ///< rad, or what the file has in its place
  bool in_degrees = false;
  std::optional<double> speed{}, crab{};
  std::optional<std::string> velocity_axes{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const SbetFacts& r, V& v) {
  const auto angle = [&r](const core::Interval& i) {
    const double unit = r.in_degrees ? 1.0 : 1.0 / core::degree;
    return core::Interval{i.low * unit, i.high * unit};
  };
  v.result("format", std::string("SBET"), "Format.");
  v.result("records", r.records, "Records.");
  describe(r.times, v);
  v.result("latitude_deg", angle(r.latitude), "Smallest and largest latitude.");
  v.result("longitude_deg", angle(r.longitude), "Smallest and largest longitude.");
  v.result("height_m", r.height, "Smallest and largest height.");
  v.result("roll_deg", angle(r.roll), "Smallest and largest roll.");
  v.result("pitch_deg", angle(r.pitch), "Smallest and largest pitch.");
  v.result("wander_deg", angle(r.wander), "Smallest and largest wander angle.");
  v.result("mean_speed_m_s", r.speed, core::Form{"m/s"}, "Mean speed over the ground.");
  v.result("heading_minus_track_deg", r.crab, core::in_degrees(), "Mean of heading less track.");
  v.result("velocity_axes", r.velocity_axes, "Axes of the velocities that fit the positions.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

struct SmrmsgFacts {
  std::uint64_t records = 0;
  TimeFacts times{};
  core::Interval horizontal{}, down{}, roll_pitch{}, heading{};  ///< m, deg
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const SmrmsgFacts& r, V& v) {
  v.result("format", std::string("smrmsg"), "Format.");
  v.result("records", r.records, "Records.");
  describe(r.times, v);
  v.result("sigma_north_east_m", r.horizontal, "Smallest and largest sigma of north or east.");
  v.result("sigma_down_m", r.down, "Smallest and largest sigma of the height.");
  v.result("sigma_roll_pitch_deg", r.roll_pitch, "Smallest and largest sigma of roll or pitch.");
  v.result("sigma_heading_deg", r.heading, "Smallest and largest sigma of the heading.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

/// The angles, and the velocities against the positions.
void judge(const std::vector<SbetRecord>& rows, const std::filesystem::path& path, bool is_finite, SbetFacts& out) {
  const auto largest = [](const core::Interval& i) { return std::max(std::abs(i.low), std::abs(i.high)); };
  out.in_degrees = largest(out.latitude) > core::pi / 2 || largest(out.longitude) > 2 * core::pi;
  if (out.in_degrees) out.warnings.push_back("positions are in degrees; an SBET holds radians");
  if (!out.in_degrees && std::max(largest(out.roll), largest(out.pitch)) > steep)
    out.warnings.push_back("roll or pitch beyond 60 deg: are the attitudes in degrees?");
  if (out.in_degrees || !is_finite) return;
  const auto [with, speed] = crab(rows, -1.0);
  const double without = crab(rows, 0.0).first;
  out.speed = speed;
  if (std::isfinite(with)) {
    out.crab = with;
    if (std::abs(with) > odd_crab)
      out.warnings.push_back("heading - wander angle differs from the track by " + core::format_number(std::round(with * 10) / 10) +
                             " deg in the mean; without the wander angle by " + core::format_number(std::round(without * 10) / 10) +
                             " deg");
  }
  core::Tally tally;
  TimeTags any;
  any.scale = core::TimeScale::gps;
  if (read_sbet(path, any, true, VelocityAxes::automatic, std::nullopt, tally).has_velocity())
    out.velocity_axes = tally.of("SBET files with velocities north, west, up") ? "north, west, up" : "north, east, down";
  else
    out.warnings.push_back("velocities disagree with the positions in every known choice of axes");
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
  SbetFacts out{rows.size()};
  std::vector<double> time;
  size_t not_finite = 0;
  for (const SbetRecord& r : rows) {
    if (!std::isfinite(r.time + r.latitude + r.longitude + r.altitude + r.roll + r.pitch + r.platform_heading + r.wander_angle)) {
      ++not_finite;
      continue;
    }
    time.push_back(r.time);
    out.latitude.add(r.latitude);
    out.longitude.add(r.longitude);
    out.height.add(r.altitude);
    out.roll.add(r.roll);
    out.pitch.add(r.pitch);
    out.wander.add(r.wander_angle);
  }
  if (not_finite) out.warnings.push_back(core::counted(not_finite, "record holds", "records hold") + " values that are not finite");
  if (!time.empty()) {
    out.times = times_of(time, out.warnings);
    judge(rows, path, not_finite == 0, out);
  }
  return core::reported(out);
}

core::Value describe_smrmsg(const std::filesystem::path& path) {
  const std::vector<SmrmsgRecord> rows = all_of<SmrmsgRecord>(path);
  SmrmsgFacts out{rows.size()};
  std::vector<double> time;
  for (const SmrmsgRecord& r : rows) {
    time.push_back(r.time);
    for (const double sigma : {r.position[0], r.position[1]}) out.horizontal.add(sigma);
    out.down.add(r.position[2]);
    for (const double sigma : {r.attitude[0], r.attitude[1]}) out.roll_pitch.add(sigma * (1.0 / 60));
    out.heading.add(r.attitude[2] * (1.0 / 60));
  }
  out.times = times_of(time, out.warnings);
  if (out.down.high > 1.0 || out.horizontal.high > 1.0)
    out.warnings.push_back("positions are worse than 1 m at times: no fixed solution there?");
  return core::reported(out);
}

}  // namespace swath::io
