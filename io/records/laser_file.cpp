// SPDX-License-Identifier: GPL-3.0-or-later
// Deviations: the strip pointers of CSD files are not used (see io/records/csd.cpp).
#include "io/records/laser_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/time.h"
#include "core/time_gap.h"
#include "io/las/las_header.h"
#include "io/records/laser_times.h"
#include "io/survey/wild_records.h"
#include "io/text/cut_line.h"
#include "io/text/delimited.h"

namespace swath::io {
namespace {

constexpr size_t chunk = 1 << 15;  // records decoded at once
constexpr const char* laser_records = "records";
constexpr const char* damaged = "the file is damaged: export the records again";
constexpr double farthest = 1e5;         // m; no airborne laser reaches a tenth of it
constexpr size_t most_of_a_pulse = 255;  // return numbers are 8-bit
constexpr double full_turn = 2 * core::pi * (1 + 1e-9);

std::string record_text(std::uint64_t record) { return "record " + std::to_string(record); }

/// GPS time of the records of a chunk, in file order.
class Clock {
 public:
  Clock(core::TimeReader reader, std::string name) : reader_(std::move(reader)), name_(std::move(name)) {}
  const core::TimeReader& reader() const { return reader_; }

  double operator()(const LaserRecords& r, size_t i) {
    const auto place = [&] { return name_ + ": " + record_text(r.record[i]); };
    if (!std::isfinite(r.time[i])) throw core::Error("the time is missing or not finite", place(), damaged);
    if (!r.week.empty() && !(r.week[i] >= 0 && r.week[i] <= 10000))
      throw core::Error("the GPS week is " + core::format_number(r.week[i]) + ", which is none from 0 to 10000", place(), damaged);
    try {
      if (!r.week.empty()) return reader_.in_week(static_cast<int>(r.week[i]), r.time[i]);
      const double time = reader_(r.time[i]);
      if (is_instant(time)) return time;
    } catch (const core::Error& e) {
      throw core::Error(e.what(), place(), e.hint(), e.code());
    }
    throw core::Error("the time " + core::format_number(r.time[i]) + " is not between 1980 and 2100", place(), scale_hint(r.time[i]));
  }

 private:
  core::TimeReader reader_;
  std::string name_;
};

core::TimeReader clock_of(const Survey& survey, const LaserFile& f) {
  return reader_of(time_of(survey, f), resolve(survey, f.file).string(), !f.columns.week.empty());
}

/// Decides the flight line of a record (see scan()).
class LineRule {
 public:
  LineRule(const Survey& survey, size_t file) : windows_(line_windows(survey)), name_(resolve(survey, survey.laser[file].file).string()) {
    const LaserFile& f = survey.laser[file];
    from_column_ = !f.columns.line.empty() || (format_of(f) == LaserFormat::las && !f.line && windows_.empty());
    if (!from_column_ && f.line) stated_ = *f.line;
    if (!from_column_ && !f.line && windows_.empty()) stated_ = static_cast<int>(file) + 1;
  }

  /// The id, or -1 outside every line.
  int of(const LaserRecords& r, size_t i, double time) const {
    if (from_column_) {
      const double id = r.line[i];
      if (!(id >= 0 && id <= 65535 && id == std::floor(id)))
        throw core::Error("line id " + core::format_number(id) + " is no whole number from 0 to 65535",
                          name_ + ": " + record_text(r.record[i]));
      return within_window(static_cast<int>(id), time);
    }
    if (stated_) return within_window(*stated_, time);
    // The last window that starts at or before the time; lines do not overlap, but may touch.
    const auto after = std::upper_bound(windows_.begin(), windows_.end(), time, [](double t, const LineWindow& w) { return t < w.start; });
    if (after == windows_.begin() || !(time <= std::prev(after)->end)) return -1;
    return std::prev(after)->id;
  }

 private:
  int within_window(int id, double time) const {
    if (windows_.empty()) return id;
    for (const LineWindow& w : windows_)
      if (w.id == id) return time >= w.start && time <= w.end ? id : -1;
    return -1;
  }
  std::vector<LineWindow> windows_;
  std::string name_;
  bool from_column_ = false;
  std::optional<int> stated_;
};

/// An angle beyond a full turn is none of a scanner, in the unit that is stated.
core::Error angle_fault(double recorded, AngleUnit unit, const std::string& place) {
  const bool radians = unit == AngleUnit::rad;
  return core::Error("a scan angle of " + core::format_number(recorded) + (radians ? " rad" : "") + " is more than a full turn", place,
                     radians ? "are the angles in degrees? State angle_unit = \"deg\" in this [[laser]]"
                             : "check angle_unit and columns.scan_angle of this [[laser]]");
}

/// A number as an unsigned field of the shot: cut to its range (`cut`) or 0 where it is none; counted.
template <class T>
T field(double v, bool cut, const char* what, std::uint64_t record, core::Tally& tally) {
  constexpr double top = std::numeric_limits<T>::max();
  if (v >= 0 && v <= top && (cut || v == std::floor(v))) return static_cast<T>(v + 0.5 > top ? v : v + 0.5);
  tally.count(what, record_text(record) + ": " + core::format_number(v));
  return cut && v > top ? std::numeric_limits<T>::max() : T{0};
}

}  // namespace

std::string StripInfo::name(const Survey& survey) const {
  return "line " + std::to_string(line) + " of " + survey.laser[file].file.filename().string();
}

namespace {

/// What one pass over a file finds.
struct Pass {
  std::vector<StripInfo> strips;
  std::vector<std::uint64_t> bad;  ///< rows without a time or line that can be theirs
  std::uint64_t records = 0, unreadable = 0, wild = 0;
  core::FileTimes outside;           ///< of records outside every line
  std::optional<core::Error> first;  ///< that is not readable
  core::Tally tally;
};

/// Records that the file can hold at most: each has at least two fields of text and what parts them.
std::uint64_t max_records(const Survey& survey, const LaserFile& f) {
  const std::filesystem::path path = resolve(survey, f.file);
  std::vector<std::string> ignored;
  if (format_of(f) == LaserFormat::las) return read_las_header(path, ignored).point_count;
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(path, unknown);
  return unknown ? std::numeric_limits<std::uint64_t>::max() : bytes / 4;
}

/// `judge`: are records left out whose time lies far from those around them?
Pass pass_over(const Survey& survey, size_t file, bool judge) {
  const LaserFile& f = survey.laser[file];
  const std::string name = resolve(survey, f.file).string();
  const LineRule rule(survey, file);
  Clock clock(clock_of(survey, f), name);
  LaserTimes reader(open_laser_records(survey, f, Wanted::plan), time_of(survey, f));
  const std::uint64_t all = max_records(survey, f);
  Pass out;
  std::map<int, size_t> strip_of;
  size_t last = 0;  // strip of the record before
  LaserRecords r;
  std::vector<std::uint8_t> wild;
  while (reader.next(r, wild, chunk)) {
    out.records += r.size();
    for (size_t i = 0; i < r.size(); ++i) {
      const auto bad = [&](const char* what, const std::string& example) {
        out.tally.count(what, f.file.filename().string() + ": " + record_text(r.record[i]) + ": " + example);
        if (out.bad.empty() || out.bad.back() != r.record[i]) out.bad.push_back(r.record[i]);
      };
      if (judge && wild[i]) {
        ++out.wild;
        bad("records with an impossible time, left out", "time " + core::format_number(r.time[i]));
        continue;
      }
      double time = 0;
      int line = -1;
      try {
        time = clock(r, i);
        line = rule.of(r, i, time);
      } catch (const core::Error& e) {
        ++out.unreadable;
        if (!out.first) out.first = e;
        if (out.unreadable > max_looked_at && !are_few(out.unreadable, all)) throw core::Error(*out.first);
        bad("records without a valid time or line, left out", e.what());
        continue;
      }
      if (line < 0) {
        out.tally.count("records outside every line, left out", f.file.filename().string() + ": " + record_text(r.record[i]));
        out.outside.add(time);
        continue;
      }
      if (out.strips.empty() || out.strips[last].line != line) {
        const auto [at, fresh] = strip_of.try_emplace(line, out.strips.size());
        last = at->second;
        if (fresh) {
          const bool text = !r.byte.empty();
          const LaserPlace place{r.record[i], text ? r.byte[i] : 0, text ? r.text_line[i] : 0};
          out.strips.push_back({file, line, r.record[i], 0, 0, std::nan(""), std::nan(""), place, clock.reader()});
        }
      }
      StripInfo& s = out.strips[last];
      s.last = r.record[i] + 1;
      ++s.records;
      if (std::isnan(s.first_time)) s.first_time = time;
      s.last_time = time;
    }
  }
  return out;
}

/// The strips of a file; times of its records outside every line are added to `outside`.
std::vector<StripInfo> strips_of(const Survey& survey, size_t file, core::Tally& tally, LineSpan& outside) {
  const LaserFile& f = survey.laser[file];
  const std::string name = resolve(survey, f.file).string();
  if (format_of(f) == LaserFormat::text) count_cut_line(inspect_delimited(name, f.delimiter).cut_line, name, laser_records, tally);
  Pass pass = pass_over(survey, file, true);
  if (pass.wild > 0 && !are_few(pass.wild, pass.records)) pass = pass_over(survey, file, false);
  if (pass.first && !are_few(pass.unreadable, pass.records)) throw *pass.first;
  tally.read(laser_records, pass.records);
  tally.add(pass.tally);
  tally.add_times("records outside every line, left out", f.file.filename().string(), pass.outside);
  outside.first = std::min(outside.first, pass.outside.first), outside.last = std::max(outside.last, pass.outside.last);
  if (pass.bad.empty()) return std::move(pass.strips);
  const auto bad = std::make_shared<const std::vector<std::uint64_t>>(std::move(pass.bad));
  for (StripInfo& s : pass.strips) s.bad = bad;
  return std::move(pass.strips);
}

/// Every record lies outside the flight lines: by how much says why.
void refuse_outside(const Survey& survey, const LineSpan& records) {
  const std::vector<LineWindow> lines = line_windows(survey);
  if (lines.empty() || !(records.first <= records.last)) return;
  double last = lines.front().end;
  for (const LineWindow& l : lines) last = std::max(last, l.end);
  const double first = lines.front().start;
  const std::string gap =
      core::usual_time_gap(0.5 * (records.first + records.last - first - last), records.last - records.first + last - first);
  throw core::Error("no laser return to work on: records from " + core::utc_text(records.first) + " to " + core::utc_text(records.last) +
                        ", flight lines from " + core::utc_text(first) + " to " + core::utc_text(last),
                    survey.name, gap.empty() ? "are the lines' times those of the records? see `swath info` of the laser file" : gap);
}

constexpr LineSpan no_time{0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

}  // namespace

std::vector<StripInfo> scan(const Survey& survey, size_t file, core::Tally& tally) {
  LineSpan outside = no_time;
  return strips_of(survey, file, tally, outside);
}

std::vector<StripInfo> scan(const Survey& survey, core::Tally& tally) {
  std::vector<StripInfo> out;
  LineSpan outside = no_time;
  for (size_t i = 0; i < survey.laser.size(); ++i)
    for (StripInfo& s : strips_of(survey, i, tally, outside)) out.push_back(std::move(s));
  if (out.empty()) refuse_outside(survey, outside);
  std::vector<LineSpan> spans;
  // A line may be stated by its records' times or by the instants they were measured at.
  const double late = survey.calibration.latency.value;
  for (const StripInfo& s : out) spans.push_back({s.line, s.first_time + std::min(0.0, late), s.last_time + std::max(0.0, late)});
  count_cut_lines(line_windows(survey), spans, tally);
  return out;
}

struct LaserSource::State {
  State(const Survey& survey, const StripInfo& strip)
      : file(survey.laser[strip.file]),
        name(resolve(survey, file.file).string()),
        line(strip.line),
        rule(survey, strip.file),
        clock(strip.clock, name),
        reader(open_laser_records(survey, file, Wanted::all, strip.begin, strip.last)),
        records(strip.records),
        bad(strip.bad),
        angle_unit((format_of(file) == LaserFormat::csd ? 1.0 : radians_per(file.angle_unit)) * (file.angle_to_port ? -1.0 : 1.0)) {
    is_profile = file.model == core::ScannerModel::profile && survey.scanner.model != core::ScannerModel::profile;
    if (angle_unit == 0 && !file.columns.scan_angle.empty())
      throw core::usage_error("the unit of the recorded angles is not stated", name, "angle_unit = \"deg\", \"rad\" or \"gon\"");
  }

  const LaserFile& file;
  std::string name;
  int line;
  LineRule rule;
  Clock clock;
  std::unique_ptr<LaserRecordReader> reader;
  std::uint64_t records;
  std::shared_ptr<const std::vector<std::uint64_t>> bad;  // rows to pass over; may be null
  double angle_unit;
  bool is_profile = false;  // beside a mirror, whose beam at angle 0 is the profile's
  core::Tally tally;
  LaserRecords raw;
  size_t at = 0;
  double last_time = -std::numeric_limits<double>::infinity();
  double last_recorded = std::nan("");  // of the record passed last, in the file's scale
  std::uint64_t damaged_records = 0;
  bool ended = false;

  bool is_bad(std::uint64_t record) const { return bad && std::binary_search(bad->begin(), bad->end(), record); }

  /// Leaves out a record with an impossible value, or throws where these are not few.
  void leave_out(const core::Error& e, std::uint64_t record) {
    if (!are_few(++damaged_records, records)) throw core::Error(e);
    tally.count("records with an invalid range or angle, left out", record_text(record) + ": " + e.what());
  }

  /// Appends record i of the chunk to the batch, or counts why not.
  void take(size_t i, double time, core::Shots& out) {
    const std::uint64_t record = raw.record[i];
    const auto drop = [&](const char* what) { tally.count(what, record_text(record)); };
    double range, angle = 0.0, forward = 0.0;
    if (!raw.x.empty()) {
      const double x = raw.x[i], y = raw.y[i], z = raw.z[i];
      range = std::sqrt(x * x + y * y + z * z);
      angle = std::atan2(y, z);
      forward = range > 0 ? x / range : 0.0;
    } else {
      range = raw.range[i];
      if (!raw.angle.empty() && !is_profile) angle = raw.angle[i] * angle_unit;
    }
    if (!std::isfinite(range))
      return leave_out(core::Error("the range is missing or not finite", name + ": " + record_text(record),
                                   "export the records again; a pulse without a return is written with range 0"),
                       record);
    if (!(range > 0)) return drop("records with a range not positive, left out");
    if (!(range * file.range_unit.value <= farthest)) return drop("records with a range over 100 km, left out");
    if (!std::isfinite(angle))
      return leave_out(core::Error("the scan angle is missing or not finite", name + ": " + record_text(record), damaged), record);
    if (std::abs(angle) > full_turn)
      return leave_out(angle_fault(raw.angle[i], file.angle_unit, name + ": " + record_text(record)), record);
    if (time < last_time)
      throw core::Error("time goes back by " + core::format_number(last_time - time, 4) + " s inside line " + std::to_string(line),
                        name + ": " + record_text(record), "records of a line must be in the order of their time");
    if (record > std::numeric_limits<std::uint32_t>::max())
      throw core::Error("more records than 32 bits count", name + ": " + record_text(record), "split the file by flight line");
    last_time = time;
    out.time.push_back(time);
    out.angle.push_back(angle);
    if (!raw.x.empty()) out.forward.push_back(forward);
    out.range.push_back(range * file.range_unit.value);
    const auto intensity = [&] { return field<std::uint16_t>(raw.intensity[i], true, "intensities cut to 0 to 65535", record, tally); };
    const auto number = [&](const std::vector<double>& v, const char* what) {
      return field<std::uint8_t>(v[i], false, what, record, tally);
    };
    out.intensity.push_back(raw.intensity.empty() ? std::uint16_t{0} : intensity());
    out.return_number.push_back(raw.return_number.empty() ? std::uint8_t{0}
                                                          : number(raw.return_number, "return numbers that are none, set to unknown"));
    out.return_count.push_back(raw.return_count.empty() ? std::uint8_t{0}
                                                        : number(raw.return_count, "return counts that are none, set to unknown"));
    out.flags.push_back(raw.flags.empty() ? std::uint16_t{0} : raw.flags[i]);
    out.record.push_back(static_cast<std::uint32_t>(record));
  }
};

LaserSource::LaserSource(const Survey& survey, const StripInfo& strip) : state_(std::make_unique<State>(survey, strip)) {}
LaserSource::~LaserSource() = default;
LaserSource::LaserSource(LaserSource&&) noexcept = default;
LaserSource& LaserSource::operator=(LaserSource&&) noexcept = default;
int LaserSource::line() const { return state_->line; }
const core::Tally& LaserSource::tally() const { return state_->tally; }

bool LaserSource::next(core::Shots& batch, size_t most) {
  State& s = *state_;
  batch.clear();
  most = std::max<size_t>(most, 1);
  for (;;) {
    if (s.at == s.raw.size()) {
      s.at = 0;
      if (!s.reader->next(s.raw, chunk)) {
        if (!std::exchange(s.ended, true)) s.reader->count_oddities(s.file.file.string() + ": line " + std::to_string(s.line), s.tally);
        s.raw.clear();
        s.tally.keep(laser_records, batch.size());
        return batch.size() > 0;
      }
    }
    for (; s.at < s.raw.size(); ++s.at) {
      // A batch ends before the first record of a new pulse, judged by the time as recorded.
      const size_t i = s.at;
      if (s.is_bad(s.raw.record[i])) continue;
      const bool full = batch.size() >= most && (s.raw.time[i] != s.last_recorded || batch.size() >= most + most_of_a_pulse);
      if (full) {
        s.tally.keep(laser_records, batch.size());
        return true;
      }
      const double time = s.clock(s.raw, i);
      s.last_recorded = s.raw.time[i];
      if (s.rule.of(s.raw, i, time) != s.line) continue;
      s.reader->take(i);
      s.take(i, time, batch);
    }
  }
}

}  // namespace swath::io
