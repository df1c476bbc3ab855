// SPDX-License-Identifier: GPL-3.0-or-later
// Source: NumPy Enhancement Proposal 1 and numpy.lib.format (versions 1.0, 2.0, 3.0). The header is a Python literal: a dict with
// `descr`, `fortran_order`, `shape`. Deviations: no object, sub-array or nested fields, no long doubles (refused, not guessed).
#include "io/text/npy.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "core/config/value.h"
#include "core/error.h"

namespace swath::io {
namespace {

using core::Value;

constexpr size_t longest_header = 1 << 16;     // NumPy writes a few hundred bytes
constexpr size_t longest_record = 1 << 20;     // bytes
constexpr size_t most_read_at_once = 1 << 24;  // bytes

/// Reads the part of Python's literals that .npy headers use: texts, integers, True, False, None, lists, tuples, dicts.
class PythonLiteral {
 public:
  PythonLiteral(const std::string& text, const std::string& where) : text_(text), where_(where) {}

  Value value() {
    blanks();
    const char c = peek();
    if (c == '{') return dict();
    if (c == '(' || c == '[') return list(c == '(' ? ')' : ']');
    if (c == '\'' || c == '"') return quoted();
    if (c == '-' || (c >= '0' && c <= '9')) return integer();
    for (const auto& [word, v] : {std::pair{"True", Value(true)}, std::pair{"False", Value(false)}, std::pair{"None", Value{}}})
      if (text_.compare(at_, std::char_traits<char>::length(word), word) == 0) {
        at_ += std::char_traits<char>::length(word);
        return v;
      }
    fail();
  }

 private:
  [[noreturn]] void fail() const { throw core::Error("the header of the .npy file is not understood", where_); }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void blanks() {
    while (peek() == ' ' || peek() == '\n' || peek() == '\t') ++at_;
  }
  bool take(char c) {
    blanks();
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  Value dict() {
    nested();
    Value out = Value::object();
    take('{');
    while (!take('}')) {
      blanks();
      if (peek() != '\'' && peek() != '"') fail();
      const std::string key = quoted().as_text();
      if (!take(':')) fail();
      out[key] = value();
      if (!take(',')) {
        if (!take('}')) fail();
        break;
      }
    }
    --depth_;
    return out;
  }
  Value list(char close) {
    nested();
    ++at_;
    Value out = Value::array();
    while (!take(close)) {
      out.push(value());
      if (!take(',')) {
        if (!take(close)) fail();
        break;
      }
    }
    --depth_;
    return out;
  }
  Value quoted() {
    const char q = text_[at_++];
    std::string out;
    for (; peek() != q; ++at_) {
      if (at_ >= text_.size()) fail();
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      out += text_[at_];
    }
    ++at_;
    return out;
  }
  Value integer() {
    std::int64_t v = 0;
    const auto [p, ec] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), v);
    if (ec != std::errc()) fail();
    at_ = static_cast<size_t>(p - text_.data());
    if (peek() == 'L') ++at_;
    return v;
  }
  void nested() {
    if (++depth_ > 20) fail();
  }

  const std::string& text_;
  const std::string& where_;
  size_t at_ = 0;
  int depth_ = 0;
};

/// "<f8" as a field; Error for types that have no place in records.
NpyField field_from(const std::string& type, const std::string& name, const std::string& where) {
  NpyField f;
  f.name = name;
  f.type = type;
  const char order = type.empty() ? '\0' : type[0];
  const std::string rest = std::string("<>|=").find(order) != std::string::npos ? type.substr(1) : type;
  f.big_endian = order == '>';
  f.kind = rest.empty() ? '\0' : rest[0];
  size_t n = 0;
  if (rest.size() > 1) std::from_chars(rest.data() + 1, rest.data() + rest.size(), n);
  if (f.kind == 'O') throw core::Error("field '" + name + "' holds Python objects", where, "save the array with numeric types only");
  if (n == 0 || n > (1u << 20) || std::string("uifbcSUVmMa").find(f.kind) == std::string::npos)
    throw core::Error("field '" + name + "' has type '" + type + "', which is not read", where);
  f.bytes = f.kind == 'U' ? 4 * n : (f.kind == 'm' || f.kind == 'M') ? 8 : n;
  return f;
}

/// The fields of a structured dtype, as the list of tuples that NumPy writes (padding is nameless void), or as the dict
/// {'names', 'formats', 'offsets', 'itemsize'}.
void read_fields(const Value& descr, NpyHeader& out, const std::string& where) {
  const auto bad = [&](const std::string& what) { return core::Error("the dtype of the .npy file " + what, where); };
  if (descr.is_object()) {
    const Value *names = descr.find("names"), *formats = descr.find("formats"), *offsets = descr.find("offsets"),
                *size = descr.find("itemsize");
    if (!names || !formats || !names->is_array() || !formats->is_array() || names->items().size() != formats->items().size())
      throw bad("is not understood");
    std::uint64_t at = 0;
    for (size_t i = 0; i < names->items().size(); ++i) {
      if (!names->items()[i].is_text() || !formats->items()[i].is_text()) throw bad("holds nested fields");
      NpyField f = field_from(formats->items()[i].as_text(), names->items()[i].as_text(), where);
      f.offset = at;
      if (offsets && offsets->is_array() && i < offsets->items().size() && offsets->items()[i].is_int()) {
        const std::int64_t stated = offsets->items()[i].as_int();
        if (stated < 0 || stated > static_cast<std::int64_t>(longest_record))
          throw bad("places the field '" + f.name + "' outside the record");
        f.offset = static_cast<std::uint64_t>(stated);
      }
      at = f.offset + f.bytes;
      out.row_stride = std::max<std::uint64_t>(out.row_stride, at);
      out.fields.push_back(std::move(f));
    }
    if (size && size->is_int()) {
      if (static_cast<std::uint64_t>(size->as_int()) < out.row_stride) throw bad("has fields beyond its item size");
      out.row_stride = static_cast<std::uint64_t>(size->as_int());
    }
    return;
  }
  for (const Value& item : descr.items()) {
    if (!item.is_array() || item.items().size() < 2) throw bad("is not understood");
    const Value& name = item.items()[0];
    const Value& plain = name.is_array() && name.items().size() == 2 ? name.items()[1] : name;  // (title, name)
    if (!plain.is_text() || !item.items()[1].is_text()) throw bad("holds nested fields");
    if (item.items().size() > 2) throw bad("holds a field of several values, '" + plain.as_text() + "'");
    NpyField f = field_from(item.items()[1].as_text(), plain.as_text(), where);
    f.offset = out.row_stride;
    out.row_stride += f.bytes;
    if (!(f.name.empty() && f.kind == 'V')) out.fields.push_back(std::move(f));
  }
}

double half(std::uint16_t h) {
  const int exponent = (h >> 10) & 31;
  const double fraction = h & 1023;
  double v = exponent == 31 ? (fraction > 0 ? std::nan("") : std::numeric_limits<double>::infinity())
                            : (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
  return h & 0x8000 ? -v : v;
}

template <class T>
void convert(const unsigned char* from, std::uint64_t stride, bool big, size_t n, double* to) {
  for (size_t i = 0; i < n; ++i) to[i] = static_cast<double>(load<T>(from + i * stride, big));
}

bool is_numeric(const NpyField& f) {
  if (f.kind == 'f') return f.bytes == 2 || f.bytes == 4 || f.bytes == 8;
  if (f.kind == 'b') return f.bytes == 1;
  return (f.kind == 'u' || f.kind == 'i') && (f.bytes == 1 || f.bytes == 2 || f.bytes == 4 || f.bytes == 8);
}

void convert_field(const NpyField& f, const unsigned char* from, std::uint64_t stride, size_t n, double* to) {
  const bool big = f.big_endian, is_signed = f.kind == 'i';
  if (f.kind == 'f') {
    if (f.bytes == 8) return convert<double>(from, stride, big, n, to);
    if (f.bytes == 4) return convert<float>(from, stride, big, n, to);
    for (size_t i = 0; i < n; ++i) to[i] = half(load<std::uint16_t>(from + i * stride, big));
    return;
  }
  if (f.bytes == 1) return is_signed ? convert<std::int8_t>(from, stride, big, n, to) : convert<std::uint8_t>(from, stride, big, n, to);
  if (f.bytes == 2) return is_signed ? convert<std::int16_t>(from, stride, big, n, to) : convert<std::uint16_t>(from, stride, big, n, to);
  if (f.bytes == 4) return is_signed ? convert<std::int32_t>(from, stride, big, n, to) : convert<std::uint32_t>(from, stride, big, n, to);
  return is_signed ? convert<std::int64_t>(from, stride, big, n, to) : convert<std::uint64_t>(from, stride, big, n, to);
}

template <class T>
bool put_integer(double v, unsigned char* to) {
  const double r = std::nearbyint(v);
  // 2^digits itself is exact in a double, the largest T need not be.
  const double top = std::ldexp(1.0, std::numeric_limits<T>::digits);
  if (!(r >= static_cast<double>(std::numeric_limits<T>::min()) && r < top)) return false;
  store(to, static_cast<T>(r));
  return true;
}

bool put(const std::string& type, double v, unsigned char* to) {
  if (type == "f8") return store(to, v), true;
  if (type == "f4") return store(to, static_cast<float>(v)), true;
  if (type == "u1") return put_integer<std::uint8_t>(v, to);
  if (type == "u2") return put_integer<std::uint16_t>(v, to);
  if (type == "u4") return put_integer<std::uint32_t>(v, to);
  if (type == "u8") return put_integer<std::uint64_t>(v, to);
  if (type == "i1") return put_integer<std::int8_t>(v, to);
  if (type == "i2") return put_integer<std::int16_t>(v, to);
  if (type == "i4") return put_integer<std::int32_t>(v, to);
  return put_integer<std::int64_t>(v, to);
}

/// The header's dictionary; `data_begin`: where it ends.
Value read_dictionary(const BinaryFile& file, const std::string& where, std::uint64_t& data_begin) {
  unsigned char start[12] = {};
  const size_t got = file.read_some(0, start, sizeof start);
  if (got < 6 || std::string(reinterpret_cast<const char*>(start), 6) != "\x93NUMPY")
    throw core::Error("is no .npy file: it does not begin with \\x93NUMPY", where + ": byte 0", "check the name, or state the format");
  if (got < 10)
    throw core::Error("the header of the .npy file is cut", where + ": byte " + std::to_string(got),
                      "the file is truncated: copy or export it again");
  const int version = start[6];
  if (version < 1 || version > 3) throw core::Error("version " + std::to_string(version) + " of the .npy format is not known", where);
  const size_t before = version == 1 ? 10 : 12;
  const size_t length = version == 1 ? load<std::uint16_t>(start + 8) : load<std::uint32_t>(start + 8);
  if (length > longest_header)
    throw core::Error("the header of the .npy file is longer than 64 kB", where, "save the array with fewer or shorter field names");
  std::string text(length, ' ');
  file.read(before, text.data(), length);
  data_begin = before + length;
  return PythonLiteral(text, where).value();
}

}  // namespace

NpyHeader read_npy_header(const std::filesystem::path& path) {
  const BinaryFile file(path);
  const std::string where = path.string();
  NpyHeader out;
  const Value tree = read_dictionary(file, where, out.data_begin);
  const Value *descr = tree.find("descr"), *fortran = tree.find("fortran_order"), *shape = tree.find("shape");
  if (!descr || !fortran || !fortran->is_bool() || !shape || !shape->is_array())
    throw core::Error("the header of the .npy file lacks descr, fortran_order or shape", where);
  std::vector<std::uint64_t> sides;
  for (const Value& side : shape->items()) {
    if (!side.is_int() || side.as_int() < 0) throw core::Error("the shape of the .npy file is not understood", where);
    sides.push_back(static_cast<std::uint64_t>(side.as_int()));
  }
  const bool plain = descr->is_text();
  if (sides.empty() || sides.size() > (plain ? 2 : 1))
    throw core::Error("the array has " + std::to_string(sides.size()) + " dimensions; " + (plain ? "1 or 2" : "1") + " can be read", where);
  out.rows = sides[0];
  std::uint64_t data_bytes = 0;
  constexpr std::uint64_t most = std::uint64_t{1} << 62;
  if (plain) {
    const std::uint64_t columns = sides.size() == 2 ? sides[1] : 1;
    if (columns == 0 || columns > 4096) throw core::Error("the array has " + std::to_string(columns) + " columns", where);
    const NpyField one = field_from(descr->as_text(), "", where);
    out.by_column = fortran->as_bool() && columns > 1;
    if (out.rows > most / (columns * one.bytes)) throw core::Error("the shape of the .npy file is not possible", where);
    out.row_stride = out.by_column ? one.bytes : columns * one.bytes;
    for (std::uint64_t c = 0; c < columns; ++c) {
      out.fields.push_back(one);
      out.fields.back().offset = c * one.bytes * (out.by_column ? out.rows : 1);
    }
    data_bytes = out.rows * columns * one.bytes;
  } else {
    if (!descr->is_array() && !descr->is_object()) throw core::Error("the dtype of the .npy file is not understood", where);
    read_fields(*descr, out, where);
    if (out.fields.empty() || out.row_stride == 0) throw core::Error("the dtype of the .npy file has no fields", where);
    if (out.row_stride > longest_record)
      throw core::Error("a record of the .npy file has " + std::to_string(out.row_stride) + " bytes; at most 1 MB are read", where);
    if (out.rows > most / out.row_stride) throw core::Error("the shape of the .npy file is not possible", where);
    data_bytes = out.rows * out.row_stride;
  }
  const std::uint64_t end = out.data_begin + data_bytes;
  if (file.size() < end)
    throw core::Error("the file ends early: " + std::to_string(out.rows) + " rows need " + std::to_string(end) + " bytes",
                      where + ": byte " + std::to_string(file.size()), "the file is truncated: copy or export it again");
  if (file.size() > end)
    throw core::Error("the header counts " + std::to_string(out.rows) + " rows, but " + std::to_string(file.size() - end) +
                          " bytes follow the last of them",
                      where + ": byte " + std::to_string(end), "the header is damaged: save the array again");
  return out;
}

size_t field_of(const NpyHeader& header, const std::string& field, const std::filesystem::path& file) {
  std::vector<std::string> names;
  std::string list;
  constexpr size_t listed = 30;
  for (const NpyField& f : header.fields) {
    if (f.name == field) return names.size();
    names.push_back(f.name);
    if (names.size() <= listed) list += (list.empty() ? "" : ", ") + f.name;
  }
  if (names.size() > listed) list += " and " + std::to_string(names.size() - listed) + " more";
  size_t number = 0;
  const auto [at, ec] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (ec == std::errc() && at == field.data() + field.size() && number >= 1 && number <= names.size()) return number - 1;
  if (header.fields[0].name.empty())
    throw core::Error("no column '" + field + "'; the array is plain, its columns are numbered 1 to " + std::to_string(names.size()),
                      file.string());
  const std::string near = core::nearest(field, names);
  throw core::Error("no field '" + field + "'; fields: " + list, file.string(), near.empty() ? "" : "did you mean '" + near + "'?");
}

NpyReader::NpyReader(const std::filesystem::path& file, std::vector<size_t> fields)
    : file_(file), header_(read_npy_header(file)), fields_(std::move(fields)) {
  for (const size_t i : fields_)
    if (!is_numeric(header_.fields.at(i)))
      throw core::Error("field '" + header_.fields[i].name + "' (type " + header_.fields[i].type + ") holds no numbers", file.string());
}

void NpyReader::read(std::uint64_t first, size_t n, std::vector<std::vector<double>>& columns) {
  columns.resize(fields_.size());
  for (std::vector<double>& column : columns) column.resize(n);
  const std::uint64_t stride = header_.row_stride;
  const size_t step = std::max<size_t>(1, most_read_at_once / stride);
  for (size_t done = 0; done < n; done += step) {
    const size_t some = std::min(step, n - done);
    bytes_.resize(some * stride);
    const std::uint64_t begin = header_.data_begin + (first + done) * stride;
    if (!header_.by_column) file_.read(begin, bytes_.data(), bytes_.size());
    for (size_t i = 0; i < fields_.size(); ++i) {
      const NpyField& f = header_.fields[fields_[i]];
      if (header_.by_column) file_.read(begin + f.offset, bytes_.data(), bytes_.size());
      convert_field(f, bytes_.data() + (header_.by_column ? 0 : f.offset), stride, some, columns[i].data() + done);
    }
  }
}

NpyWriter::NpyWriter(const std::filesystem::path& file, std::vector<NpyColumn> columns)
    : output_(file), name_(file), out_(output_.temporary(), file), columns_(std::move(columns)) {
  static const std::vector<std::string> known{"f8", "f4", "u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8"};
  for (const NpyColumn& c : columns_) {
    if (std::find(known.begin(), known.end(), c.type) == known.end())
      throw core::Error("type '" + c.type + "' of field '" + c.name + "' cannot be written", file.string());
    row_bytes_ += static_cast<size_t>(c.type[1] - '0');
  }
  const std::string text = header();
  out_.append(text.data(), text.size());
}

std::string NpyWriter::header() const {
  std::string dict = "{'descr': [";
  for (const NpyColumn& c : columns_) dict += "('" + c.name + "', '" + (c.type[1] == '1' ? "|" : "<") + c.type + "'), ";
  dict.erase(dict.size() - 2);
  dict += "], 'fortran_order': False, 'shape': (" + std::to_string(rows_) + ",), }";
  // Room for the final count of rows (20 digits), then up to a multiple of 64 bytes as NumPy aligns its data.
  const size_t longest = dict.size() - std::to_string(rows_).size() + 20;
  const size_t after = (10 + longest + 1 + 63) / 64 * 64 - 10;
  dict.resize(after - 1, ' ');
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(after & 255) + static_cast<char>(after >> 8) + dict + '\n';
}

void NpyWriter::append(const std::vector<const double*>& values, size_t n) {
  bytes_.resize(n * row_bytes_);
  size_t offset = 0;
  for (size_t c = 0; c < columns_.size(); ++c) {
    for (size_t i = 0; i < n; ++i)
      if (!put(columns_[c].type, values.at(c)[i], bytes_.data() + i * row_bytes_ + offset))
        throw core::Error("value " + core::format_number(values[c][i]) + " does not fit type " + columns_[c].type + " of field '" +
                              columns_[c].name + "'",
                          name_.string() + ": record " + std::to_string(rows_ + i));
    offset += static_cast<size_t>(columns_[c].type[1] - '0');
  }
  out_.append(bytes_.data(), bytes_.size());
  rows_ += n;
}

void NpyWriter::commit() {
  const std::string text = header();
  out_.rewrite(0, text.data(), text.size());
  out_.close();
  output_.commit();
}

}  // namespace swath::io
