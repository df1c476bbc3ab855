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

/// A word for each column of a record.
bool names_of(const Line& line, const Line& record) {
  if (line.numbers > 0) return false;
  return line.fields == record.fields || split_delimited(line.text, record.delimiter).size() == record.fields;
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
  return {lines[names - 1].number, first->number};
}

}  // namespace swath::io
