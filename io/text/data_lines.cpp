// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/data_lines.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "core/error.h"
#include "io/text/delimited.h"
#include "io/text/line_reader.h"
#include "io/text/value_file.h"

namespace swath::io {

void DataLine::fault(const std::string& what, const std::string& hint) const { throw core::Error(what, place, hint); }

const std::string& DataLine::field(size_t column) const {
  if (column >= fields.size())
    fault("the line has " + core::counted(fields.size(), "field") + ", at least " + std::to_string(column + 1) + " are needed",
          "the line is cut off, has another delimiter, or the file is of another format");
  return fields[column];
}

void DataLine::expect_columns(size_t columns, bool has_header) const {
  const size_t found =
      fields.size() - (fields.size() == columns + 1 && fields.back().empty() ? 1 : 0);  // a line may end with its delimiter
  if (found != columns)
    fault(fields_and_columns(found, columns, has_header), "the line is cut off, or a name holds the delimiter and needs quotes");
}

void DataLine::expect_at_most(size_t columns, bool has_header) const {
  const size_t found = fields.size() - (fields.size() > columns && fields.back().empty() ? 1 : 0);
  if (found > columns) fault(fields_and_columns(found, columns, has_header), more_fields_hint);
}

double DataLine::number(size_t column) const {
  double value = 0;
  if (!read_number(field(column), value) || !std::isfinite(value))
    fault("'" + fields[column] + "' in column " + std::to_string(column + 1) + " is no number",
          number_hint(fields[column], "correct the line, or the columns or format that the survey states"));
  return value;
}

std::string read_lines(const std::filesystem::path& file) {
  std::string text = read_text_file(file);
  require_text(text, file);
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
  return text;
}

void for_each_data_line(const std::filesystem::path& file, const std::function<char(const std::string&)>& delimiter,
                        const std::function<void(DataLine&)>& f, const std::function<void(const std::string&)>& comment) {
  const std::string text = read_lines(file);
  DataLine out;
  char parted_by = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t stop = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, stop - at);
    at = stop + 1;
    ++out.line;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    const size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos) continue;
    if (line[begin] == '#' || line[begin] == '%') {
      const size_t word = line.find_first_not_of("#% \t");
      if (comment && word != std::string::npos) comment(line.substr(word));
      continue;
    }
    if (parted_by == 0) parted_by = delimiter(line);
    out.fields = split_delimited(line, parted_by);
    out.place = file.string() + ":" + std::to_string(out.line);
    f(out);
  }
}

}  // namespace swath::io
