// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/describe_tables.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/time.h"
#include "io/records/csd.h"
#include "io/records/repeated_times.h"
#include "io/survey/column_roles.h"
#include "io/survey/file_facts.h"
#include "io/text/delimited.h"
#include "io/text/fields.h"
#include "io/text/line_reader.h"
#include "io/text/npy.h"
#include "io/text/table_start.h"

namespace swath::io {
namespace {

using Path = std::filesystem::path;

constexpr size_t chunk = 16384;

/// A column and how many of its values are not finite.
struct Column {
  core::Interval span;
  std::uint64_t not_finite = 0;
  void add(double v) {
    if (std::isfinite(v))
      span.add(v);
    else
      ++not_finite;
  }
};

struct CsdFacts {
  const CsdHeader& h;
  std::uint64_t pulses = 0;
  Column time{}, range{}, angle{}, latitude{}, longitude{}, height{};
  std::map<int, std::uint64_t> returns{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const CsdFacts& r, V& v) {
  const core::Calibration boresight = calibration_of(r.h);
  const Eigen::Vector3d angles(core::to_degrees(boresight.roll), core::to_degrees(boresight.pitch), core::to_degrees(boresight.heading));
  v.result("format", std::string("Optech CSD"), "Format.");
  v.result("vendor", r.h.vendor, "Vendor that the header names.");
  v.result("software", r.h.software, "Software that the header names.");
  v.result("pulses", r.pulses, "Pulses.");
  v.result("gps_week", r.h.gps_week, "GPS week that the header states.");
  v.result("seconds_of_week", r.time.span, core::seconds(), "First and last time of a pulse.");
  if (r.pulses) v.result("from", core::utc_text(core::from_week(r.h.gps_week, r.time.span.low)), "UTC of the first.");
  v.tables("pulses_by_returns", core::counts_of(r.returns), "Pulses by the number of their returns.");
  v.result("range_m", r.range.span, core::metres(), "Smallest and largest range.");
  v.result("scan_angle_deg", r.angle.span, core::in_degrees(), "Smallest and largest scan angle.");
  v.result("carrier_latitude_deg", r.latitude.span, core::in_degrees(), "Smallest and largest latitude of the carrier.");
  v.result("carrier_longitude_deg", r.longitude.span, core::in_degrees(), "Smallest and largest longitude.");
  v.result("carrier_height_m", r.height.span, core::metres(), "Smallest and largest height.");
  v.result("boresight_roll_pitch_heading_deg", angles, core::in_degrees(), "Boresight that the header states.");
  v.result("temperature_c", r.h.temperature, "Temperature that the header states, degrees Celsius.");
  v.result("pressure_mbar", r.h.pressure, "Air pressure that the header states.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

/// A column of a table of numbers.
struct NamedColumn {
  std::string name;
  std::optional<std::string> type{};
  std::optional<std::string> unit{};
  Column values{};
};
template <class V>
void describe(const NamedColumn& r, V& v) {
  v.result("name", r.name, "Name as the file has it, or the column's number from 1.");
  v.result("type", r.type, "Type as NumPy writes it.");
  v.result("unit", r.unit, "Unit by the row below the names.");
  v.result("span", r.values.span, core::Form{}.always(), "Smallest and largest finite value; null where there is none.");
}

struct TableFacts {
  std::string format;
  std::optional<std::string> delimiter{};
  std::optional<bool> header{};
  std::uint64_t rows = 0;
  std::vector<NamedColumn> columns{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const TableFacts& r, V& v) {
  v.result("format", r.format, "Format.");
  v.result("delimiter", r.delimiter, "Separator of the columns.");
  v.result("header", r.header, "Does a line name the columns?");
  v.result("rows", r.rows, "Rows.");
  v.tables("columns", r.columns, "Columns.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

/// The number of the column in a role; nothing where none has it.
std::optional<size_t> column_of(const ColumnRoles& roles, std::string_view key, const std::vector<std::string>& names) {
  const auto role = std::find_if(roles.columns.begin(), roles.columns.end(), [&](const auto& c) { return c.first == key; });
  if (role == roles.columns.end()) return std::nullopt;
  return static_cast<size_t>(std::find(names.begin(), names.end(), role->second) - names.begin());
}

/// Times that do not increase, in records that each have a time of their own: a pulse has several returns.
class TimeOrder {
 public:
  explicit TimeOrder(const std::vector<NamedColumn>& columns) {
    std::vector<std::string> names;
    for (const NamedColumn& c : columns) names.push_back(c.name);
    const ColumnRoles roles = roles_of(names);
    if (roles.kind == TableKind::none || roles.kind == TableKind::laser || roles.kind == TableKind::image_points) return;
    column_ = column_of(roles, "time", names);
    has_weeks_ = column_of(roles, "week", names).has_value();
    if (roles.time_unit == "1 ms") unit_ = 1e-3;
  }
  bool is_of(size_t column) const { return column_ == column; }
  void add(double time) {
    repeated_ += time == last_;
    back_ += time < last_ && (last_ - time) * unit_ < least_restart;
    last_ = time;
  }
  void warn(std::vector<std::string>& warnings) const {
    if (repeated_ > 0)
      warnings.push_back(core::counted(repeated_, "record repeats the time before it", "records repeat the time before them") +
                         ": written twice, or times with too few digits");
    if (back_ > 0 && !has_weeks_)
      warnings.push_back("time goes back " + core::counted(back_, "time") + ": the file is not sorted, or records are written twice");
  }

 private:
  static constexpr double least_restart = 43200.0;  // s: farther back, seconds of the day or week begin anew
  std::optional<size_t> column_{};
  double unit_ = 1.0;       // s
  bool has_weeks_ = false;  // whose seconds begin anew
  double last_ = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t repeated_ = 0, back_ = 0;
};

core::Value reported(TableFacts& t) {
  for (const NamedColumn& c : t.columns)
    if (c.values.not_finite)
      t.warnings.push_back("column " + c.name + " holds " + core::counted(c.values.not_finite, "value that is", "values that are") +
                           " empty or not finite");
  return core::reported(t);
}

/// Is the first value of a column a number? Names of events are not.
bool holds_numbers(const Path& path, const DelimitedLayout& layout, size_t column) {
  double value = 0;
  try {
    return DelimitedReader(path, layout, {column}).next(&value);
  } catch (const core::Error&) {
    return false;
  }
}

/// Which columns of a table of events hold times and names.
struct EventTable {
  bool are_events = false;
  size_t time = 0, id = 0;
};
EventTable event_table(const DelimitedLayout& layout) {
  EventTable out;
  const ColumnRoles roles = roles_of(layout.names);
  out.are_events = roles.kind == TableKind::event && layout.names.size() == layout.columns;
  if (out.are_events) out.time = column_of(roles, "time", layout.names).value(), out.id = column_of(roles, "id", layout.names).value();
  return out;
}

}  // namespace

core::Value describe_csd(const Path& path) {
  CsdReader file(path);
  const CsdHeader& h = file.header();
  CsdFacts out{h, file.pulses()};
  std::vector<CsdPulse> pulses;
  for (std::uint64_t at = 0; at < file.pulses(); at += pulses.size()) {
    file.read(at, static_cast<size_t>(std::min<std::uint64_t>(chunk, file.pulses() - at)), pulses);
    for (const CsdPulse& p : pulses) {
      out.time.add(p.time);
      out.angle.add(core::to_degrees(p.scan_angle));
      out.latitude.add(core::to_degrees(p.latitude));
      out.longitude.add(core::to_degrees(p.longitude));
      out.height.add(p.height);
      ++out.returns[p.return_count];
      for (int k = 0; k < p.return_count; ++k) out.range.add(p.range[static_cast<size_t>(k)]);
    }
  }
  if (out.time.span.low < h.first_time - 1e-3 || out.time.span.high > h.last_time + 1e-3)
    out.warnings.push_back("the header states seconds " + core::format_number(h.first_time) + " to " + core::format_number(h.last_time) +
                           ", the pulses span others");
  std::uint64_t not_finite = 0;
  for (const Column* c : {&out.time, &out.range, &out.angle, &out.latitude, &out.longitude, &out.height}) not_finite += c->not_finite;
  if (not_finite) out.warnings.push_back("values that are not finite");
  if (out.range.span.low <= 0) out.warnings.push_back("ranges that are not positive");
  return core::reported(out);
}

core::Value describe_npy(const Path& path) {
  const NpyHeader h = read_npy_header(path);
  TableFacts out{"NumPy array"};
  out.rows = h.rows;
  std::vector<size_t> numeric;
  for (size_t i = 0; i < h.fields.size(); ++i) {
    const NpyField& f = h.fields[i];
    out.columns.push_back({f.name.empty() ? std::to_string(i + 1) : f.name, f.type});
    if (std::string("uifb").find(f.kind) != std::string::npos && f.bytes <= 8) numeric.push_back(i);
  }
  NpyReader reader(path, numeric);
  TimeOrder times(out.columns);
  std::vector<std::vector<double>> values;
  for (std::uint64_t at = 0; at < h.rows; at += chunk) {
    reader.read(at, static_cast<size_t>(std::min<std::uint64_t>(chunk, h.rows - at)), values);
    for (size_t c = 0; c < numeric.size(); ++c)
      for (const double v : values[c]) {
        out.columns[numeric[c]].values.add(v);
        if (times.is_of(numeric[c])) times.add(v);
      }
  }
  times.warn(out.warnings);
  return reported(out);
}

/// A word, a date or a time of day. A number with a decimal comma is none: it is a number with a fault.
bool is_word(const std::string& field) {
  double ignored = 0;
  const auto is_of_words = [](unsigned char c) { return std::isalpha(c) || c == ':' || c == '/'; };
  return !read_number(field, ignored) && std::any_of(field.begin(), field.end(), is_of_words);
}

/// Up to two.
std::vector<std::vector<std::string>> first_records(const Path& path, const DelimitedLayout& layout) {
  std::vector<std::vector<std::string>> out;
  LineReader lines(path);
  for (std::string_view line; out.size() < 2 && lines.next(line);)
    if (lines.number() >= layout.data_line && line.find_first_not_of(" \t\r") != line.npos)
      out.push_back(split_delimited(std::string(line), layout.delimiter));
  return out;
}

/// Words in the first records: in one of them alone they are a fault.
bool holds_words(const std::vector<std::vector<std::string>>& records, size_t column) {
  return !records.empty() && std::all_of(records.begin(), records.end(), [column](const std::vector<std::string>& fields) {
    return column < fields.size() && is_word(fields[column]);
  });
}

core::Value describe_text(const Path& path) {
  const DelimitedLayout layout = inspect_delimited(path);
  TableFacts out{"delimited text"};
  out.delimiter = layout.delimiter == '\t' ? "tab" : layout.delimiter == ' ' ? "blanks" : std::string(1, layout.delimiter);
  out.header = !layout.names.empty();
  const EventTable events = event_table(layout);
  const std::vector<std::vector<std::string>> first = first_records(path, layout);
  std::vector<size_t> indices;
  const std::vector<std::string> units = column_units(path);
  for (size_t c = 0; c < layout.columns; ++c) {
    out.columns.push_back({c < layout.names.size() ? layout.names[c] : std::to_string(c + 1)});
    if (c < units.size() && !units[c].empty()) out.columns.back().unit = units[c];
    if (events.are_events && c == events.id && !holds_numbers(path, layout, c)) continue;
    if (holds_words(first, c))
      out.warnings.push_back("column " + out.columns.back().name + " holds text");
    else
      indices.push_back(c);
  }
  if (!layout.names.empty() && layout.names.size() != layout.columns)
    out.warnings.push_back("the header names " + core::counted(layout.names.size(), "column") + ", the first line has " +
                           std::to_string(layout.columns));
  if (layout.cut_line > 0)
    out.warnings.push_back("line " + std::to_string(layout.cut_line) + " is only the end of a record and is left out");
  DelimitedReader reader(path, layout, indices);
  TimeOrder order(out.columns);
  std::vector<double> row(indices.size()), times;
  std::vector<std::uint64_t> lines;
  try {
    for (; reader.next(row.data()); ++out.rows)
      for (size_t c = 0; c < row.size(); ++c) {
        out.columns[indices[c]].values.add(row[c]);
        if (!events.are_events) {
          if (order.is_of(indices[c])) order.add(row[c]);
        } else if (indices[c] == events.time) {
          times.push_back(row[c]);
          lines.push_back(reader.line());
        }
      }
  } catch (const core::Error& e) {
    out.warnings.push_back("reading stopped: " + e.text());
  }
  if (const auto repeated = repeated_times(times); !repeated.empty())
    out.warnings.push_back("events at the time of another one: " + std::to_string(repeated.size()) + " (lines " +
                           std::to_string(lines[repeated[0].first]) + " and " + std::to_string(lines[repeated[0].second]) + ")");
  order.warn(out.warnings);
  return reported(out);
}

}  // namespace swath::io
