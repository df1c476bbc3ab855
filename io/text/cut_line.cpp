// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/cut_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/text/decimal_comma.h"
#include "io/text/fields.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

constexpr size_t few = 3;      // lines of as many fields, to miss some in the first
constexpr size_t enough = 10;  // lines that are written alike, to hold the first to it

/// How a number without an exponent is written.
struct Form {
  bool plain = false;            // digits, a sign and a point at most
  size_t before = 0, after = 0;  // digits of the point
  bool point = false;
};

Form form_of(const std::string& text) {
  Form out;
  size_t at = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  const auto digits = [&] {
    size_t n = 0;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9'; ++at) ++n;
    return n;
  };
  out.before = digits();
  if (at < text.size() && text[at] == '.') {
    out.point = true;
    ++at;
    out.after = digits();
  }
  out.plain = at == text.size() && out.before + out.after > 0;
  return out;
}

/// A number that rises evenly, and of which the first line has only the last digits.
bool lacks_leading_digits(const std::vector<double>& values, const Form& first, const Form& next) {
  const double step = values[2] - values[1];
  for (size_t i = 2; i < values.size(); ++i)
    if (!(step > 0) || std::abs(values[i] - values[i - 1] - step) > step) return false;
  const double missing = values[1] - step - values[0], unit = std::pow(10.0, static_cast<double>(first.before));
  return first.before < next.before && missing > 0.5 * unit && std::abs(missing - unit * std::round(missing / unit)) < step;
}

}  // namespace

bool first_line_is_cut(const std::vector<std::vector<std::string>>& lines, bool opens_file) {
  if (lines.size() < few + 1) return false;
  const auto& first = lines[0];
  const size_t usual = lines[1].size();
  if (std::any_of(lines.begin() + 1, lines.end(), [&](const auto& l) { return l.size() != usual; })) return false;
  if (first.size() < usual) return true;
  if (!opens_file || lines.size() < enough + 1 || first.size() > usual) return false;

  std::vector<double> values;
  std::vector<Form> forms;
  bool whole = true;  // the first field is a number
  for (const auto& l : lines) {
    double v = 0;
    const bool number = read_number(l[0], v);
    if (values.empty()) whole = number;
    if (!number && !values.empty()) return false;
    values.push_back(v);
    forms.push_back(form_of(l[0]));
  }
  if (!whole) return first[0].find_first_not_of("0123456789+-.eE") == std::string::npos;
  const Form &is = forms[0], &next = forms[1];
  if (!is.plain || std::any_of(forms.begin() + 1, forms.end(),
                               [&](const Form& f) { return !f.plain || f.after != next.after || f.point != next.point; }))
    return false;
  // A cut takes leading characters: a number that still has its point has all of its decimals.
  if (is.point != next.point) return !is.point && is.before <= next.after;
  if (is.after != next.after) return false;
  if (is.before == 0 && std::all_of(forms.begin() + 1, forms.end(), [](const Form& f) { return f.before > 0; })) return true;
  return lacks_leading_digits(values, is, next);
}

bool last_line_is_cut(const BinaryFile& file, std::uint64_t begin, char delimiter) {
  constexpr std::uint64_t tail = 1 << 14;  // bytes before the line: thirty records of 500 bytes
  const std::uint64_t from = begin > tail ? begin - tail : 0;
  std::string text(static_cast<size_t>(file.size() - from), '\0');
  text.resize(file.read_some(from, text.data(), text.size()));
  const size_t start = static_cast<size_t>(begin - from);
  if (start >= text.size()) return false;
  const auto fields_of = [delimiter](const std::string& line) {
    std::vector<std::string> fields = split_delimited(line, delimiter);
    return delimiter == ';' || delimiter == '\t' ? with_points(std::move(fields)) : fields;
  };
  const auto is_number = [](const std::string& field) { return form_of(field).plain; };
  std::vector<std::vector<std::string>> before;
  size_t end = start;  // behind the line end of the line before
  while (before.size() < cut_line_context && end > 1) {
    const size_t line_end = end - 1, line_begin = text.rfind('\n', line_end - 1);
    if (line_begin == text.npos && from > 0) break;  // its beginning is not there
    end = line_begin == text.npos ? 0 : line_begin + 1;
    const std::string line = text.substr(end, line_end - end);
    const size_t first = line.find_first_not_of(" \t\r");
    if (first != line.npos && line[first] != '#' && line[first] != '%') before.push_back(fields_of(line));
  }
  if (end == 0)  // names and descriptions at the beginning of the file
    while (!before.empty() && std::none_of(before.back().begin(), before.back().end(), is_number)) before.pop_back();
  if (before.size() < enough) return false;
  const std::vector<std::string> last = fields_of(text.substr(start));
  const size_t usual = before.front().size();
  const auto has_usual = [&](const auto& fields) { return fields.size() == usual; };
  if (!std::all_of(before.begin(), before.end(), has_usual)) return false;
  if (last.size() != usual) return last.size() < usual;
  const Form is = form_of(last.back()), of = form_of(before.front().back());
  const auto alike = [&](const auto& fields) {
    const Form f = form_of(fields.back());
    return f.plain && f.point && f.after == of.after;
  };
  return of.after > 0 && std::all_of(before.begin(), before.end(), alike) && is.after < of.after &&
         (is.plain || last.back().find_first_not_of("+-") == std::string::npos);
}

void count_cut_line(std::uint64_t line, const std::filesystem::path& file, const std::string& kind, core::Tally& tally) {
  if (line == 0) return;
  tally.read(kind, 1);
  tally.count(kind + " cut off at the beginning of a file, left out", file.string() + ":" + std::to_string(line));
}

}  // namespace swath::io
