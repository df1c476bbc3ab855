// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/table_start.h"

#include <algorithm>
#include <functional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "core/printable.h"
#include "io/text/decimal_comma.h"
#include "io/text/fields.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

constexpr size_t max_lines = 400;  // a longer description is none of a table

struct Line {
  std::uint64_t number = 0;
  std::string text;
  size_t fields = 0, numbers = 0, empty = 0;
  std::string form{};  ///< a letter for each field: n number, date or time of day; t text; - empty
  char delimiter = ' ';

  bool is_record() const { return fields >= 2 && numbers == fields; }
  /// May be a record with words among its numbers, which the next one has in the same fields.
  bool is_mixed() const { return fields >= 4 && form.front() == 'n' && std::count(form.begin(), form.end(), 'n') >= 3; }
  bool may_be_record() const { return fields >= 2 && numbers > 0 && numbers + empty == fields; }
};

bool is_number(const std::string& field) {
  double ignored = 0;
  return read_number(field, ignored);
}

/// A number, a date or a time of day.
bool is_value(const std::string& field) {
  if (is_number(field)) return true;
  return !field.empty() && field.front() >= '0' && field.front() <= '9' && field.find_first_not_of("0123456789.:/-TZ") == field.npos;
}

/// What counts as a number: alone, or with dates and times of day, where records hold words, too.
enum class Records { of_numbers, mixed };

Line line_of(std::uint64_t number, std::string_view text, const std::string& delimiter, const std::filesystem::path& file,
             Records records) {
  Line out{number, std::string(text)};
  out.delimiter = delimiter.empty() ? delimiter_in(out.text) : delimiter_from(delimiter, file);
  std::vector<std::string> fields = split_delimited(out.text, out.delimiter);
  if (out.delimiter == ';' || out.delimiter == '\t') fields = with_points(std::move(fields));
  out.fields = fields.size();
  out.empty = static_cast<size_t>(std::count(fields.begin(), fields.end(), ""));
  const auto counts = [&](const std::string& f) { return records == Records::mixed ? is_value(f) : is_number(f); };
  for (const std::string& f : fields) out.form += f.empty() ? '-' : counts(f) ? 'n' : 't';
  out.numbers = static_cast<size_t>(std::count(out.form.begin(), out.form.end(), 'n'));
  return out;
}

/// The lines that are neither empty nor comments, up to the first two records of one length, or of one form; the first of these is the last
/// line.
std::vector<Line> lines_above_records(const std::filesystem::path& file, const std::string& delimiter, Records records) {
  std::vector<Line> out;
  LineReader reader(file);
  for (std::string_view text; out.size() < max_lines && reader.next(text);) {
    const size_t begin = text.find_first_not_of(" \t\r");
    if (begin == text.npos || text[begin] == '#' || text[begin] == '%') continue;
    out.push_back(line_of(reader.number(), text, delimiter, file, records));
    if (out.size() < 2) continue;
    const Line &last = out.back(), &before = out[out.size() - 2];
    const bool alike = records == Records::mixed ? last.is_mixed() && last.form == before.form : last.is_record() && before.is_record();
    if (alike && last.fields == before.fields) {
      out.pop_back();
      return out;
    }
  }
  return {};
}

/// The parts of a line between runs of two blanks or more.
std::vector<std::string> split_at_runs(std::string_view line) {
  std::vector<std::string> out;
  for (size_t at = line.find_first_not_of(" \t\r"); at != line.npos;) {
    const size_t end = std::min({line.find("  ", at), line.find('\t', at), line.find('\r', at), line.size()});
    out.emplace_back(line.substr(at, end - at));
    at = line.find_first_not_of(" \t\r", end);
  }
  if (!out.empty() && out.back().ends_with(' ')) out.back().pop_back();
  return out;
}

/// A word for each column of a record.
bool names_of(const Line& line, const Line& record) {
  if (line.numbers > 0) return false;
  return line.fields == record.fields || split_delimited(line.text, record.delimiter).size() == record.fields ||
         (record.delimiter == ' ' && split_at_runs(line.text).size() == record.fields);
}

bool in_brackets(const std::string& field) { return field.starts_with('(') || field.starts_with('['); }

/// In brackets, or a unit as such tables have it: names of columns and words of a description are longer.
bool is_unit(const std::string& field) {
  static const std::set<std::string, std::less<>> units{
      "",       "-",       "%",      "m",       "cm",     "mm",      "km",    "ft",     "usft",  "deg",    "rad",   "mrad",
      "gon",    "arcsec",  "arcmin", "s",       "sec",    "secs",    "ms",    "us",     "ns",    "min",    "h",     "hz",
      "m/s",    "cm/s",    "ft/s",   "km/h",    "kn",     "knots",   "g",     "mg",     "m/s2",  "m/s^2",  "m/s/s", "deg/s",
      "deg/h",  "rad/s",   "dms",    "d-m-s",   "m2",     "m^2",     "count", "counts", "num",   "weeks",  "week",  "sow",
      "gpst",   "utc",     "hms",    "degc",    "nt",     "v",       "d",     "none",   "metre", "metres", "meter", "meters",
      "degree", "degrees", "radian", "radians", "second", "seconds", "feet",  "foot"};
  return in_brackets(field) || units.contains(core::lower_case(field));
}

/// A line below the names with nothing but units, one of them in brackets where blanks part them.
bool are_units(const Line& units, const Line& record) {
  if (units.numbers > 0 || units.delimiter != record.delimiter) return false;
  const std::vector<std::string> fields = split_delimited(units.text, units.delimiter);
  return fields.size() > 1 && std::all_of(fields.begin(), fields.end(), is_unit) &&
         (record.delimiter != ' ' || std::any_of(fields.begin(), fields.end(), in_brackets));
}

/// "(deg)" and "[Deg]" are "deg".
std::string bare_unit(const std::string& field) {
  const size_t from = in_brackets(field) ? 1 : 0;
  const size_t end = field.find_last_not_of(")] ");
  return end == field.npos || end < from ? std::string() : core::lower_case(field.substr(from, end + 1 - from));
}

/// Where each of the words, in their order, ends in the line.
std::vector<size_t> ends_of(const std::string& line, const std::vector<std::string>& words) {
  std::vector<size_t> out;
  size_t at = 0;
  for (const std::string& word : words) out.push_back(at = line.find(word, at) + word.size());
  return out;
}

/// Units for each column below its name: blanks part descriptions, too, so that of units between them one at least is in brackets.
bool units_below(const Line& names, const Line& units, const Line& record) {
  if (!names_of(names, record) || names.delimiter != record.delimiter || units.delimiter != record.delimiter) return false;
  const std::vector<std::string> fields = split_delimited(units.text, units.delimiter);
  const bool by_blanks = record.delimiter == ' ';
  return std::all_of(fields.begin(), fields.end(), is_unit) && (!by_blanks || std::any_of(fields.begin(), fields.end(), in_brackets));
}

}  // namespace

TableStart table_start(const std::filesystem::path& file, const std::string& delimiter) {
  std::vector<Line> lines = lines_above_records(file, delimiter, Records::of_numbers);
  const bool are_mixed = lines.empty();
  if (are_mixed) lines = lines_above_records(file, delimiter, Records::mixed);
  if (lines.size() < 3 || lines[1].is_record()) return {};
  const Line& record = lines.back();
  if (lines[0].may_be_record() && lines[0].fields == record.fields) return {};
  if (names_of(lines[0], record) && (lines[1].numbers > 0 || lines[1].fields == 1)) return {};
  size_t data = lines.size() - 1;  // records with empty fields belong to the table
  while (data > 0 && lines[data - 1].may_be_record() && lines[data - 1].fields == record.fields) --data;
  size_t names = data;
  while (names > 0 && !names_of(lines[names - 1], record)) --names;
  if (names > 1 && units_below(lines[names - 2], lines[names - 1], record)) --names;
  if (names == 0) return are_mixed ? TableStart{} : TableStart{0, lines[data].number};  // records of other forms may be above
  const auto first =
      std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(names), lines.end(), [](const Line& l) { return l.numbers > 0; });
  const bool has_units = names < data && are_units(lines[names], record);
  return {lines[names - 1].number, first->number, has_units ? lines[names].number : 0};
}

std::vector<std::string> header_names(const std::string& header, char delimiter, size_t columns, bool below_description) {
  std::vector<std::string> out = split_delimited(header, delimiter);
  if (below_description && out.size() != columns) out = split_delimited(header, delimiter_in(header));
  if (delimiter != ' ' || out.size() <= columns) return out;
  std::vector<std::string> by_runs = split_at_runs(header);
  return by_runs.size() == columns ? by_runs : out;
}

std::vector<std::string> column_units(const std::filesystem::path& file, const std::string& delimiter) {
  const TableStart table = table_start(file, delimiter);
  if (table.units == 0) return {};
  std::string names, units, record;
  LineReader lines(file);
  for (std::string_view text; record.empty() && lines.next(text);)
    if (lines.number() == table.names)
      names = text;
    else if (lines.number() == table.units)
      units = text;
    else if (lines.number() == table.data)
      record = text;
  const char by = delimiter.empty() ? delimiter_in(record) : delimiter_from(delimiter, file);
  const size_t columns = split_delimited(record, by).size();
  const std::vector<std::string> of_names = header_names(names, by, columns, true);
  std::vector<std::string> fields = split_delimited(units, by), out(columns);
  for (std::string& unit : fields) unit = bare_unit(unit);
  if (fields.size() == columns) return fields;
  if (by != ' ' || fields.size() > columns || of_names.size() != columns) return {};
  const std::vector<size_t> name_ends = ends_of(names, of_names), unit_ends = ends_of(units, split_delimited(units, by));
  for (size_t u = 0, c = 0; u < fields.size(); ++u, ++c) {
    const auto distance = [&](size_t k) { return std::max(name_ends[k], unit_ends[u]) - std::min(name_ends[k], unit_ends[u]); };
    while (c + fields.size() - u < columns && distance(c + 1) < distance(c)) ++c;
    out[c] = fields[u];
  }
  return out;
}

}  // namespace swath::io
