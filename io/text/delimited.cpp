// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/delimited.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/config/units.h"
#include "core/config/value.h"
#include "core/error.h"
#include "core/printable.h"
#include "io/text/cut_line.h"
#include "io/text/decimal_comma.h"
#include "io/text/table_start.h"

namespace swath::io {
namespace {

using fields::field_end;
using fields::is_blank;
using fields::parse_number;
using fields::trim;
using fields::trim_line;

constexpr size_t buffer_bytes = 1 << 18;
constexpr size_t longest_line = 1 << 20;  // a longer one is no text table

bool all_numbers(const std::vector<std::string>& fields) {
  bool any = false;
  for (const std::string& f : fields) {
    double ignored;
    if (!parse_number(f.data(), f.data() + f.size(), ignored)) return false;
    any = any || !f.empty();
  }
  return any;
}

bool begins_comment(char c) { return c == '#' || c == '%'; }
bool is_comment(const std::string& line) {
  const size_t first = line.find_first_not_of(" \t");
  return first != line.npos && begins_comment(line[first]);
}

std::string list_of(const DelimitedLayout& layout) {
  if (layout.names.empty()) return "the file has no header; columns are numbered 1 to " + std::to_string(layout.columns);
  std::string list;
  for (const std::string& n : layout.names) list += (list.empty() ? "" : ", ") + n;
  return "columns: " + list;
}

/// The lines at the beginning of a file.
class FirstLines {
 public:
  explicit FirstLines(const std::filesystem::path& path) : file_(path), chunk_(1 << 14) {}

  /// The next line without its end; false at the end of the file and before a stretch that is no text, which `broken` reports.
  bool next(std::string& line) {
    line.clear();
    begin_ = loaded_ - (fill_ - used_);
    for (;;) {
      if (used_ == fill_) {
        fill_ = file_.read_some(loaded_, chunk_.data(), chunk_.size());
        loaded_ += fill_;
        used_ = 0;
        if (fill_ == 0) break;
      }
      const char* nl = static_cast<const char*>(std::memchr(chunk_.data() + used_, '\n', fill_ - used_));
      const size_t stop = nl ? static_cast<size_t>(nl - chunk_.data()) : fill_;
      line.append(chunk_.data() + used_, stop - used_);
      used_ = stop + (nl ? 1 : 0);
      broken_ = line.size() > longest_line || line.find('\0') != std::string::npos;
      if (broken_) return false;
      if (nl) break;
    }
    if (line.empty() && fill_ == 0) return false;
    ++number_;
    if (number_ == 1 && line.rfind("\xEF\xBB\xBF", 0) == 0) {
      line.erase(0, 3);
      begin_ += 3;
    }
    const char *b = line.data(), *e = b + line.size();
    trim_line(b, e, '\t');
    line = std::string(b, e);
    return true;
  }
  std::uint64_t begin() const { return begin_; }    ///< byte of the line
  std::uint64_t number() const { return number_; }  ///< of the line, from 1
  bool broken() const { return broken_; }

 private:
  BinaryFile file_;
  std::vector<char> chunk_;
  size_t fill_ = 0, used_ = 0;
  std::uint64_t loaded_ = 0, begin_ = 0, number_ = 0;
  bool broken_ = false;
};

/// A line of data with its place.
struct NumberedLine {
  std::vector<std::string> fields;
  std::uint64_t begin = 0, number = 0;
};

void require_not_utf16(const std::filesystem::path& path) {
  const BinaryFile file(path);
  std::array<char, 4> begin{};
  const size_t got = file.read_some(0, begin.data(), std::min<std::uint64_t>(begin.size(), file.size()));
  const std::string_view text(begin.data(), got);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") || is_packed(text)) require_text(text, path);
}

/// Which fields are numbers.
std::vector<bool> form_of(const std::vector<std::string>& fields) {
  std::vector<bool> out;
  double ignored;
  for (const std::string& f : fields) out.push_back(!f.empty() && parse_number(f.data(), f.data() + f.size(), ignored));
  return out;
}

/// Is the line above a record one itself, with texts in the same fields? A name is no number.
bool is_record_above(const std::vector<std::string>& line, const std::vector<std::string>& record) {
  const std::vector<bool> form = form_of(line);
  return std::find(form.begin(), form.end(), true) != form.end() && form == form_of(record);
}

/// Fields of all first lines of data where the names are none of theirs; 0 where they fit. Of lines parted by a character those with more
/// fields are found as they are read.
size_t misfit_of(DelimitedLayout& layout, const std::vector<std::vector<std::string>>& lines) {
  size_t widest = 0, narrowest = std::numeric_limits<size_t>::max();
  for (const std::vector<std::string>& line : lines) widest = std::max(widest, line.size()), narrowest = std::min(narrowest, line.size());
  std::vector<std::string>& names = layout.names;
  while (names.size() > widest && names.back().empty()) names.pop_back();  // the header alone ends with its delimiter
  if (widest < names.size()) return widest;
  return layout.delimiter == ' ' && narrowest > names.size() ? narrowest : 0;
}

/// Where all lines end with their delimiter, nothing is a column behind it.
void drop_last_column(DelimitedLayout& layout, const std::vector<std::vector<std::string>>& lines) {
  if (!std::all_of(lines.begin(), lines.end(), [](const auto& fields) { return fields.size() > 1 && fields.back().empty(); })) return;
  std::vector<std::string>& names = layout.names;
  if (names.size() == layout.columns && names.back().empty()) names.pop_back();
  if (names.size() + 1 == layout.columns) --layout.columns;
}

/// A record whose first number is cut off counts as a header no more than one that is whole.
bool is_header(const std::vector<std::string>& fields) {
  if (all_numbers(fields)) return false;
  const bool rest = fields.size() > 1 && all_numbers({fields.begin() + 1, fields.end()});
  return !rest || fields[0].find_first_not_of("0123456789+-.eE") != std::string::npos;
}

}  // namespace

DelimitedLayout inspect_delimited(const std::filesystem::path& path, const std::string& delimiter) {
  require_not_utf16(path);
  const TableStart table = table_start(path, delimiter);
  FirstLines lines(path);
  DelimitedLayout out;
  std::string comment, header, line;
  bool have_header = false, anything = table.data > 0;
  std::vector<NumberedLine> data;
  NumberedLine above;                             // what was taken for the header
  std::vector<std::vector<std::string>> written;  // as they are, with decimal commas
  while (data.size() <= cut_line_context && lines.next(line)) {
    if (line.find_first_not_of('\t') == line.npos) continue;
    if (is_comment(line)) {
      anything = true;
      if (data.empty()) comment = line.substr(std::min(line.find_first_not_of("#% \t"), line.size()));
      continue;
    }
    if (lines.number() < table.data && lines.number() != table.names) continue;
    if (data.empty()) out.delimiter = delimiter.empty() ? delimiter_in(line) : delimiter_from(delimiter, path);
    if (data.size() == 1 && data[0].fields.size() == 1 && delimiter.empty()) out.delimiter = delimiter_in(line);  // a cut line has none
    std::vector<std::string> fields = split_delimited(line, out.delimiter);
    if (out.delimiter == ';' || out.delimiter == '\t') written.push_back(fields), fields = with_points(std::move(fields));
    if (data.empty() && !have_header && is_header(fields)) {
      above = {std::move(fields), lines.begin(), lines.number()};
      have_header = true;
      header = line;
      continue;
    }
    if (data.empty() && have_header && lines.number() != table.data && is_record_above(above.fields, fields)) {
      have_header = false;
      data.push_back(above);
    }
    data.push_back({std::move(fields), lines.begin(), lines.number()});
  }
  if (lines.broken() && data.empty()) throw core::Error("is not delimited text", path.string() + ":" + std::to_string(lines.number() + 1));
  if (data.empty())
    throw core::Error("no line of numbers", path.string(),
                      lines.number() == 0 ? "the file is empty" : "the file holds a header or comments only");
  anything = anything || have_header;
  std::vector<std::vector<std::string>> fields;
  for (const NumberedLine& d : data) fields.push_back(d.fields);
  const bool cut = first_line_is_cut(fields, !anything);
  const NumberedLine& first = data[cut ? 1 : 0];
  if (cut) out.cut_line = data[0].number;
  out.decimal_comma = are_decimal_commas(written, out.delimiter);
  out.columns = first.fields.size();
  out.data_begin = first.begin;
  out.data_line = first.number;
  if (have_header) {
    out.names = header_names(header, out.delimiter, out.columns, table.names > 0);
    out.misfit = misfit_of(out, {fields.begin() + (cut ? 1 : 0), fields.end()});
    drop_last_column(out, {fields.begin() + (cut ? 1 : 0), fields.end()});
  } else if (!comment.empty()) {
    const std::vector<std::string> words = split_delimited(comment, out.delimiter);
    if (words.size() == out.columns && !all_numbers(words)) out.names = words;
  }
  return out;
}

size_t column_of(const DelimitedLayout& layout, const std::string& column, const std::filesystem::path& file) {
  const auto count = [&](const auto& same) { return std::count_if(layout.names.begin(), layout.names.end(), same); };
  const auto place = [&](const auto& same) {
    return static_cast<size_t>(std::find_if(layout.names.begin(), layout.names.end(), same) - layout.names.begin());
  };
  const auto exact = [&](const std::string& n) { return n == column; };
  const auto folded = [&](const std::string& n) { return core::lower_case(n) == core::lower_case(column); };
  const auto same = count(exact);
  if (same > 1) throw core::Error("column '" + column + "' stands more than once in the header", file.string(), "name it by number");
  const bool is_name = same == 1 || count(folded) == 1;
  if (is_name && layout.misfit > 0)
    throw core::Error(fields_and_columns(layout.misfit, layout.names.size(), true), file.string() + ":" + std::to_string(layout.data_line),
                      "a name that holds the delimiter, or none for a column? Quote it, or state the columns by number");
  if (is_name) return same == 1 ? place(exact) : place(folded);
  size_t number = 0;
  const auto [at, ec] = std::from_chars(column.data(), column.data() + column.size(), number);
  if (ec == std::errc() && at == column.data() + column.size() && number >= 1) {
    if (number <= std::max(layout.columns, layout.names.size())) return number - 1;
    throw core::Error("no column " + column + "; " + list_of(layout), file.string());
  }
  const std::string near = column.size() < 3 ? std::string() : core::nearest(column, layout.names);  // any letter is near another
  throw core::Error("no column '" + column + "'; " + list_of(layout), file.string(),
                    near.empty() ? "name one of the columns, or its number from 1" : "did you mean '" + near + "'?");
}

DelimitedReader::DelimitedReader(const std::filesystem::path& file, const DelimitedLayout& layout, std::vector<size_t> columns)
    : DelimitedReader(file, layout, std::move(columns), layout.data_begin, layout.data_line) {}

DelimitedReader::DelimitedReader(const std::filesystem::path& file, const DelimitedLayout& layout, std::vector<size_t> columns,
                                 std::uint64_t begin, std::uint64_t line, std::uint64_t end)
    : file_(file),
      names_(layout.names),
      delimiter_(layout.delimiter),
      decimal_comma_(layout.decimal_comma),
      fields_needed_(columns.empty() ? 0 : *std::max_element(columns.begin(), columns.end()) + 1),
      columns_(layout.names.empty() ? layout.columns : layout.names.size()),
      fields_of_all_(std::min(columns_, layout.columns)),
      slots_(fields_needed_),
      buffer_(buffer_bytes),
      file_at_(begin),
      end_(std::min(end, file_.size())),
      next_offset_(begin),
      next_line_(line) {
  for (size_t i = 0; i < columns.size(); ++i) slots_[columns[i]].push_back(i);
}

bool DelimitedReader::next_line(const char*& begin, const char*& end) {
  for (size_t searched = 0;;) {
    const char* from = buffer_.data() + begin_;
    const auto* nl = static_cast<const char*>(std::memchr(from + searched, '\n', fill_ - begin_ - searched));
    const bool last = file_at_ >= end_;
    if (nl || (last && fill_ > begin_)) {
      begin = from;
      end = nl ? nl : buffer_.data() + fill_;
      const size_t taken = static_cast<size_t>(end - begin) + (nl ? 1 : 0);
      begin_ += taken;
      is_open_ = !nl;
      offset_ = next_offset_;
      line_ = next_line_++;
      next_offset_ += taken;
      return true;
    }
    if (last) return false;
    searched = fill_ - begin_;
    std::memmove(buffer_.data(), from, searched);
    begin_ = 0;
    fill_ = searched;
    if (fill_ == buffer_.size()) {
      if (fill_ > longest_line)
        throw core::Error("the line is longer than " + std::to_string(longest_line) + " bytes",
                          file_.path().string() + ":" + std::to_string(next_line_));
      buffer_.resize(2 * buffer_.size());
    }
    const size_t room = static_cast<size_t>(std::min<std::uint64_t>(buffer_.size() - fill_, end_ - file_at_));
    const size_t got = file_.read_some(file_at_, buffer_.data() + fill_, room);
    if (got == 0) end_ = file_at_;  // the file shrank while it was read
    fill_ += got;
    file_at_ += got;
  }
}

bool DelimitedReader::next(double* values) {
  const char *at, *end;
  bool is_data = false;
  do {
    if (!next_line(at, end)) return false;
    const char* first = at;
    while (first < end && is_blank(*first)) ++first;
    is_data = first < end && *first != '\r' && !begins_comment(*first);
  } while (!is_data);
  if (is_open_) expect_whole(at, end);
  trim_line(at, end, delimiter_);
  for (size_t field = 0; field < fields_needed_; ++field) {
    if (delimiter_ == ' ')
      while (at < end && is_blank(*at)) ++at;
    if (at > end || (at == end && (delimiter_ == ' ' || field == 0))) short_line(field);
    const char* stop;
    if (slots_[field].empty()) {
      stop = field_end(at, end, delimiter_);
    } else {
      double value;
      const auto [p, ec] = std::from_chars(at, end, value);
      if (ec == std::errc() && !decimal_comma_ && (p == end || *p == delimiter_ || (delimiter_ == ' ' && *p == '\t'))) {
        stop = p;
      } else {
        stop = field_end(at, end, delimiter_);
        if (!parse_field(at, stop, value)) bad_number(at, stop, field);
      }
      for (const size_t slot : slots_[field]) values[slot] = value;
    }
    at = stop + 1;
  }
  if (delimiter_ == ' ')
    expect_all(at, end);
  else
    expect_no_more(at, end);
  return true;
}

void DelimitedReader::expect_all(const char* at, const char* end) const {
  for (size_t fields = fields_needed_; fields < fields_of_all_; ++fields) {
    while (at < end && is_blank(*at)) ++at;
    if (at >= end)
      throw core::Error(fields_and_columns(fields, fields_of_all_, !names_.empty()), file_.path().string() + ":" + std::to_string(line_),
                        "blanks do not show which field is empty: export with commas");
    at = field_end(at, end, ' ') + 1;
  }
}

void DelimitedReader::expect_no_more(const char* at, const char* end) const {
  if (at > end) return;  // the last field that is needed was the line's last
  // A line may end with its delimiter.
  if (fields_needed_ + 1 + static_cast<size_t>(std::count(at, end, delimiter_)) <= columns_) return;
  size_t fields = fields_needed_;
  for (; at <= end && !(at == end && fields >= columns_); at = field_end(at, end, delimiter_) + 1) ++fields;
  if (fields > columns_)
    throw core::Error(fields_and_columns(fields, columns_, !names_.empty()), file_.path().string() + ":" + std::to_string(line_),
                      more_fields_hint);
}

void DelimitedReader::expect_whole(const char* at, const char* end) const {
  if (end_ < file_.size() || !last_line_is_cut(file_, offset_, delimiter_)) return;
  constexpr std::ptrdiff_t longest = 60;  // bytes shown
  throw core::Error("the file ends within the line '" + core::printable({at, std::min(end, at + longest)}) + "'",
                    file_.path().string() + ":" + std::to_string(line_), cut_hint);
}

void DelimitedReader::short_line(size_t fields) const {
  throw core::Error("the line has " + core::counted(fields, "field") + ", at least " + std::to_string(fields_needed_) + " are needed",
                    file_.path().string() + ":" + std::to_string(line_),
                    is_open_ ? cut_hint : "the line is cut off or has another delimiter: export the file again");
}

bool DelimitedReader::parse_field(const char* begin, const char* end, double& value) const {
  if (!decimal_comma_) return parse_number(begin, end, value);
  std::string text(begin, end);
  if (text.find('.') != text.npos) return false;
  std::replace(text.begin(), text.end(), ',', '.');
  return parse_number(text.data(), text.data() + text.size(), value);
}

void DelimitedReader::bad_number(const char* begin, const char* end, size_t column) const {
  trim(begin, end);
  constexpr std::ptrdiff_t longest = 40, longest_of_zeros = 8;  // bytes shown
  const bool holds_zeros = std::find(begin, end, '\0') != end;
  const std::string text = core::printable({begin, std::min(end, begin + (holds_zeros ? longest_of_zeros : longest))});
  const std::string name = column < names_.size() ? "'" + names_[column] + "'" : std::to_string(column + 1);
  if (holds_zeros)
    throw core::Error("the line holds zero bytes: '" + text + "...' in column " + name + " is no number",
                      file_.path().string() + ":" + std::to_string(line_),
                      "the file was not written or copied to its end: copy it again, or take the line out");
  throw core::Error("'" + text + "' in column " + name + " is no number", file_.path().string() + ":" + std::to_string(line_),
                    decimal_comma_ && text.find('.') != text.npos ? "the numbers above it have decimal commas: write all of them alike"
                                                                  : number_hint(text, "correct the line, or export the file again"));
}

}  // namespace swath::io
