// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/imu_file.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/records/imu_columns.h"
#include "core/statistics.h"
#include "io/records/frozen_axes.h"
#include "io/records/imu_axes.h"
#include "io/records/imu_checks.h"
#include "io/survey/record_times.h"
#include "io/survey/wild_records.h"
#include "io/text/cut_line.h"
#include "io/text/table_rows.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;

constexpr double most_not_finite = 0.03, most_repeated = 0.05;  // of the records
constexpr const char *records = "IMU records", *gap_count = "IMU gaps";
constexpr double fastest_turn = 100.0, largest_force = 1000.0;    // rad/s, m/s2: twice what the widest sensors measure
constexpr double least_jump_turn = 2.0, least_jump_force = 20.0;  // rad/s, m/s2: of one record against its neighbours
constexpr double jump_ratio = 25.0;                               // of the median change from record to record
constexpr double most_wild = 0.5;             // of the records: where more are, kind or units are others, which the median shows
constexpr double most_standing_out = 1e-3;    // of the records
constexpr size_t neighbours = 5;              // records on either side
constexpr size_t changes_looked_at = 100000;  // changes for their median

/// Records as recorded, in the record's axes and units.
struct Raw {
  std::vector<double> time;
  std::vector<Vector3d> gyro, accelerometer;

  void move(size_t from, size_t to) {
    time[to] = time[from];
    gyro[to] = gyro[from];
    accelerometer[to] = accelerometer[from];
  }
  void resize(size_t n) {
    time.resize(n);
    gyro.resize(n);
    accelerometer.resize(n);
  }
};

void refuse_share(std::uint64_t n, std::uint64_t of, double most, const char* what, const std::string& name, const char* hint) {
  if (static_cast<double>(n) > most * static_cast<double>(of))
    throw core::Error(std::to_string(n) + " of " + std::to_string(of) + " IMU records " + what, name, hint);
}

/// From a record's numbers to rad/s and m/s2.
struct Scale {
  double gyro, force;
  double turn_of(const Vector3d& v) const { return v.cwiseAbs().maxCoeff() * gyro; }
  double force_of(const Vector3d& v) const { return v.cwiseAbs().maxCoeff() * force; }
};

/// Nothing where the records have no step.
std::optional<Scale> scale_of(const Raw& raw, const ImuFile& f) {
  const double step = f.rate ? 1.0 / f.rate->value : core::median_step(raw.time);
  if (!(step > 0)) return std::nullopt;
  const double per_second = f.kind == ImuKind::rates ? 1.0 : 1.0 / step;
  return Scale{radians_per(f.angle_unit) * std::abs(f.gyro_factor) * per_second,
               mps2_per(f.acceleration_unit) * std::abs(f.accelerometer_factor) * per_second};
}

/// Numbers of the records with rates or forces that no IMU measures.
std::vector<size_t> beyond_any_imu(const Raw& raw, const Scale& s) {
  std::vector<size_t> out;
  for (size_t k = 0; k < raw.time.size(); ++k)
    if (s.turn_of(raw.gyro[k]) > fastest_turn || s.force_of(raw.accelerometer[k]) > largest_force) out.push_back(k);
  return out;
}

/// Numbers of the single records that stand out from those before and after them: a damaged digit, of which no filter can know. Vibration,
/// landings and turns change neighbours, too.
std::vector<size_t> standing_out(const Raw& raw, const Scale& s) {
  std::vector<double> turns, forces;
  const size_t n = raw.time.size(), stride = std::max<size_t>(1, n / changes_looked_at);
  for (size_t k = 1; k < n; k += stride) {
    turns.push_back(s.turn_of(raw.gyro[k] - raw.gyro[k - 1]));
    forces.push_back(s.force_of(raw.accelerometer[k] - raw.accelerometer[k - 1]));
  }
  if (turns.empty()) return {};
  const double turn = std::max(least_jump_turn, jump_ratio * core::median(std::move(turns))),
               force = std::max(least_jump_force, jump_ratio * core::median(std::move(forces)));
  const auto contradict = [&](size_t i, size_t j) {
    return s.turn_of(raw.gyro[i] - raw.gyro[j]) > turn || s.force_of(raw.accelerometer[i] - raw.accelerometer[j]) > force;
  };
  std::vector<size_t> out = contradicted(n, contradict);
  std::erase_if(out, [&](size_t k) {  // without it all around are smooth
    for (size_t i = k - std::min(k, neighbours), j = i + 1; j < std::min(n, k + neighbours + 1); ++j) {
      if (j == k) continue;
      if (i != k && contradict(i, j)) return true;
      i = j;
    }
    return false;
  });
  return out;
}

/// Takes out the records of these numbers, rising.
void erase(Raw& raw, std::vector<std::uint64_t>& numbers, const std::vector<size_t>& bad) {
  size_t kept = 0;
  for (size_t k = 0, next = 0; k < raw.time.size(); ++k) {
    if (next < bad.size() && bad[next] == k) {
      ++next;
      continue;
    }
    raw.move(k, kept);
    numbers[kept++] = numbers[k];
  }
  raw.resize(kept);
}

/// Takes out records, counted as `what` with the place and the values; leaves all where they are more than `most` of all and not few: then
/// the units are others than stated, which check_imu() says, or the carrier shakes so.
void leave_out(Raw& raw, std::vector<std::uint64_t>& numbers, const std::vector<size_t>& bad, double most, const Scale& s,
               const TableRows& rows, const char* what, core::Tally& tally) {
  if (bad.empty() || !are_few(bad.size(), raw.time.size(), most)) return;
  for (const size_t k : bad)
    tally.count(what, rows.place_of(numbers[k]) + ": " + core::format_number(s.turn_of(raw.gyro[k]), 4) + " rad/s, " +
                          core::format_number(s.force_of(raw.accelerometer[k]), 4) + " m/s2");
  erase(raw, numbers, bad);
}

constexpr std::array<const char*, 6> axis_names{"gyro_x", "gyro_y", "gyro_z", "accelerometer_x", "accelerometer_y", "accelerometer_z"};

/// A trajectory of such records would be off by far more than its sigmas.
void refuse_standing(const Raw& raw, const std::string& name) {
  std::string axes;
  const std::vector<size_t> standing = standing_axes(raw.gyro, raw.accelerometer);
  for (const size_t axis : standing) axes += (axes.empty() ? "" : ", ") + std::string(axis_names[axis]);
  if (standing.empty()) return;
  const size_t axis = standing.front();
  const auto& middle = (axis < 3 ? raw.gyro : raw.accelerometer)[raw.time.size() / 2];
  throw core::Error(axes + (standing.size() == 1 ? " repeats" : " repeat") + " one value throughout the file (" +
                        core::format_number(middle[static_cast<Eigen::Index>(axis % 3)], 6) + ") while other axes go on",
                    name,
                    "the sensor was frozen, or the column is not the axis: compare the columns of [[imu]] with the file, export it again, "
                    "or take the file out of the survey");
}

/// Records of a sensor that stopped do not show the motion: without them there is a gap, of which smoothers know.
void leave_out_frozen(Raw& raw, std::vector<std::uint64_t>& numbers, const TableRows& rows, core::Tally& tally) {
  std::vector<char> is_bad(raw.time.size(), 0);
  for (const FrozenAxis& f : frozen_axes(raw.gyro, raw.accelerometer)) {
    std::uint64_t others = 0;  // of an axis before this one
    for (size_t k = f.first; k < f.last; ++k) others += is_bad[k] != 0, is_bad[k] = 1;
    tally.count("IMU records in which an axis is frozen while others go on, left out",
                rows.place_of(numbers[f.first]) + ": " + axis_names[f.axis] + " repeats one value for " +
                    core::format_number(std::round((raw.time[f.last - 1] - raw.time[f.first - 1]) * 1e4) / 1e4) + " s",
                f.last - f.first - others);
  }
  std::vector<size_t> bad;
  for (size_t k = 0; k < is_bad.size(); ++k)
    if (is_bad[k]) bad.push_back(k);
  erase(raw, numbers, bad);
}

void leave_out_wild(Raw& raw, const ImuFile& f, std::vector<std::uint64_t>& numbers, const TableRows& rows, core::Tally& tally) {
  const std::optional<Scale> scale = scale_of(raw, f);
  if (!scale) return;
  leave_out(raw, numbers, beyond_any_imu(raw, *scale), most_wild, *scale, rows,
            "IMU records with rates or forces that no IMU measures, left out", tally);
  leave_out(raw, numbers, standing_out(raw, *scale), most_standing_out, *scale, rows,
            "IMU records that stand out from all around them, left out", tally);
}

/// The records as they are, but for those with a value or time that cannot be.
struct Recorded {
  Raw raw;
  std::vector<std::uint64_t> numbers;  ///< of the rows
  std::uint64_t read = 0;
};

Recorded read_rows(TableRows& rows, const ImuFile& f, size_t columns, const std::string& name, core::Tally& tally) {
  Recorded out;
  std::vector<double> v(columns), weeks;
  std::uint64_t not_finite = 0;
  Raw& raw = out.raw;
  while (rows.next(v.data())) {
    ++out.read;
    if (!std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); })) {
      ++not_finite;
      tally.count("IMU records with a value that is empty or not finite, left out", rows.place());
      continue;
    }
    raw.time.push_back(v[0]);
    raw.gyro.emplace_back(v[1], v[2], v[3]);
    raw.accelerometer.emplace_back(v[4], v[5], v[6]);
    out.numbers.push_back(rows.number());
    if (!f.columns.week.empty()) weeks.push_back(v.back());
  }
  refuse_share(not_finite, out.read, most_not_finite, "have a value that is empty or not finite", name,
               "check the columns, or export again");
  raw.time = gps_times(f.time, name, raw.time, weeks, "IMU records with an impossible time, left out", tally,
                       [&](size_t k) { return rows.place_of(out.numbers[k]); });
  size_t kept = 0;
  for (size_t k = 0; k < raw.time.size(); ++k) {
    if (std::isnan(raw.time[k])) continue;
    raw.move(k, kept);
    out.numbers[kept++] = out.numbers[k];
  }
  raw.resize(kept);
  return out;
}

Raw read_raw(const std::filesystem::path& path, const ImuFile& f, core::Tally& tally) {
  const std::string name = path.string();
  const ImuColumns& c = f.columns;
  std::vector<std::string> columns{c.time, c.gyro_x, c.gyro_y, c.gyro_z, c.accelerometer_x, c.accelerometer_y, c.accelerometer_z};
  if (!c.week.empty()) columns.push_back(c.week);
  const std::unique_ptr<TableRows> rows = open_table(path, format_of(f), f.delimiter, columns);
  count_cut_line(rows->cut_line(), path, records, tally);
  Recorded all = read_rows(*rows, f, columns.size(), name, tally);
  Raw& raw = all.raw;
  std::uint64_t repeated = 0, same = 0;
  size_t kept = 0;
  for (size_t k = 0; k < raw.time.size(); ++k) {
    if (kept > 0 && raw.time[k] < raw.time[kept - 1])
      throw core::Error("time goes back by " + core::format_number(raw.time[kept - 1] - raw.time[k], 4) + " s",
                        rows->place_of(all.numbers[k]), "export the records in the order of time");
    if (kept > 0 && raw.time[k] == raw.time[kept - 1]) {
      ++repeated;
      tally.count("IMU records at a repeated time, left out", rows->place_of(all.numbers[k]));
      continue;
    }
    if (kept > 0 && raw.gyro[k] == raw.gyro[kept - 1] && raw.accelerometer[k] == raw.accelerometer[kept - 1]) ++same;
    raw.move(k, kept);
    all.numbers[kept++] = all.numbers[k];
  }
  raw.resize(kept);
  refuse_share(repeated, all.read, most_repeated, "are at the time of the record before", name,
               "the times are too coarse for the rate: export them with more digits");
  if (raw.time.empty()) throw core::Error("the file has no IMU records", name);
  leave_out_wild(raw, f, all.numbers, *rows, tally);
  refuse_standing(raw, name);
  leave_out_frozen(raw, all.numbers, *rows, tally);
  tally.read(records, all.read);
  tally.keep(records, raw.time.size());
  if (same > 0)
    tally.count("IMU records that repeat the values of the one before (kept)", name + ": of " + std::to_string(raw.time.size()), same);
  return std::move(raw);
}

/// Moves the times to the ends of the intervals.
void to_ends(std::vector<double>& time, ImuStamp stamp, double step) {
  const double shift = stamp == ImuStamp::start ? step : stamp == ImuStamp::middle ? 0.5 * step : 0.0;
  if (shift != 0)
    for (double& t : time) t += shift;
}

core::ImuData increments_of(Raw&& raw, const ImuFile& f, const Cadence& cadence, const std::string& name, core::Tally& tally) {
  const bool instant = f.kind == ImuKind::rates && f.sample == ImuSample::instant;
  const Eigen::Matrix3d body_R = body_R_record(f);
  const Eigen::Matrix3d angle_of = body_R * (radians_per(f.angle_unit) * f.gyro_factor);
  const Eigen::Matrix3d velocity_of = body_R * (mps2_per(f.acceleration_unit) * f.accelerometer_factor);
  core::ImuData out;
  std::vector<double> from, to;
  std::uint64_t ends = 0;
  auto restart = cadence.restarts.begin();
  for (size_t k = 0; k < raw.time.size(); ++k) {
    const bool gap = restart != cadence.restarts.end() && *restart == k;
    if (gap) {
      ++restart;
      from.push_back(raw.time[k - 1]);
      to.push_back(raw.time[k] - (instant ? 0 : cadence.step));
    }
    if (instant && (gap || k == 0)) {
      ++ends;
      continue;
    }
    const double step = gap || k == 0 ? cadence.step : raw.time[k] - raw.time[k - 1];
    Vector3d angle = raw.gyro[k], velocity = raw.accelerometer[k];
    if (instant) {
      angle = 0.5 * (angle + raw.gyro[k - 1]);
      velocity = 0.5 * (velocity + raw.accelerometer[k - 1]);
    }
    const double length = f.kind == ImuKind::rates ? step : 1.0;
    out.time.push_back(raw.time[k]);
    out.step.push_back(step);
    out.angle.emplace_back(angle_of * angle * length);
    out.velocity.emplace_back(velocity_of * velocity * length);
  }
  count_gaps(from, to, gap_count, tally);
  if (ends > 0) tally.count("IMU records that only begin a stretch of instants (no increment of their own)", name, ends);
  if (out.size() == 0) throw core::Error("no two IMU records follow one another", name);
  return out;
}

void require_units(const ImuFile& f, const std::string& name) {
  if (f.kind == ImuKind::unstated)
    throw core::usage_error("it is not stated whether the IMU gives increments or rates", name, "kind = \"increments\" or \"rates\"");
  if (f.angle_unit == AngleUnit::unstated)
    throw core::usage_error("the unit of angles is not stated", name, "angle_unit = \"deg\", \"rad\" or \"gon\"");
  if (f.acceleration_unit == AccelerationUnit::unstated)
    throw core::usage_error("the unit of specific force is not stated", name, "acceleration_unit = \"m/s2\", \"g\" or \"mg\"");
}

}  // namespace

core::ImuData read_imu(const Survey& survey, const ImuFile& f, core::Tally& tally) {
  const std::filesystem::path path = resolve(survey, f.file);
  const std::string name = path.string();
  require_units(f, name);
  body_R_record(f);  // a wrong map is reported before the file is read
  Raw raw = read_raw(path, f, tally);
  note_date(raw.time.front(), name, tally);
  CadenceRule rule;
  if (f.rate) rule.step = 1.0 / f.rate->value;
  rule.smooth = f.even_times;
  rule.strict = f.kind == ImuKind::increments;
  const Cadence cadence = settle_times(raw.time, rule, name);
  if (cadence.smoothed)
    tally.count("IMU files whose times jitter and are smoothed",
                name + ": rms " + core::format_number(std::round(cadence.jitter * 1e7) / 1e4) + " ms, largest " +
                    core::format_number(std::round(cadence.largest_jitter * 1e7) / 1e4) + " ms, step " +
                    core::format_number(std::round(cadence.step * 1e7) / 1e4) + " ms");
  to_ends(raw.time, f.stamp, cadence.step);
  core::ImuData out = increments_of(std::move(raw), f, cadence, name, tally);
  check_imu(out, f, cadence.step, name, tally);
  return out;
}

core::ImuData read_imu(const Survey& survey, core::Tally& tally) {
  if (survey.imu.empty()) throw core::usage_error("the survey has no IMU records");
  struct Part {
    core::ImuData data;
    const ImuFile* file;
  };
  std::vector<Part> parts;
  for (const ImuFile& f : survey.imu) parts.push_back({read_imu(survey, f, tally), &f});
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.data.time.front() < b.data.time.front(); });
  core::ImuData out = std::move(parts.front().data);
  for (size_t i = 1; i < parts.size(); ++i) {
    core::ImuData& part = parts[i].data;
    const double end = out.time.back(), step = part.step.front(), start = part.time.front() - step;
    const std::string before = parts[i - 1].file->file.string(), name = parts[i].file->file.string();
    if (start < end - 0.5 * step)
      throw core::Error(before + " and " + name + " overlap by " + core::format_number(std::round((end - start) * 1e6) / 1e6) + " s", name,
                        "trim one of them, or check their time scales");
    if (start > end + 0.5 * step) {
      count_gaps({end}, {start}, gap_count, tally);
    } else {
      part.step.front() = part.time.front() - end;
      if (parts[i].file->kind == ImuKind::rates) {
        part.angle.front() *= part.step.front() / step;
        part.velocity.front() *= part.step.front() / step;
      }
    }
    core::for_each_imu_column([&](auto member) {
      (out.*member).insert((out.*member).end(), (part.*member).begin(), (part.*member).end());
      part.*member = {};
    });
  }
  return out;
}

}  // namespace swath::io
