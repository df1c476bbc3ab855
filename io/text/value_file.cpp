// SPDX-License-Identifier: GPL-3.0-or-later
// TOML by toml++; JSON by RapidJSON's event reader, whose stream position gives line and column of each value.
#include "io/text/value_file.h"

#include <rapidjson/error/en.h>
#include <rapidjson/memorystream.h>
#include <rapidjson/prettywriter.h>
#include <rapidjson/reader.h>
#include <rapidjson/stringbuffer.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/config/units.h"
#include "core/error.h"
#include "core/printable.h"
#include "io/text/binary_file.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

constexpr int deepest = 200;  // levels of tables and lists in a file

using core::Location;
using core::Value;

Value from_toml(const toml::node& node, const std::string& file) {
  Value out;
  if (const auto* table = node.as_table()) {
    out = Value::object();
    // toml++ keeps keys sorted; the order of the file is the order of the places.
    std::vector<std::pair<toml::source_position, Value::Member>> members;
    for (const auto& [key, value] : *table) members.push_back({key.source().begin, {std::string(key.str()), from_toml(value, file)}});
    std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& m : members) out.members().push_back(std::move(m.second));
  } else if (const auto* array = node.as_array()) {
    out = Value::array();
    for (const toml::node& item : *array) out.push(from_toml(item, file));
  } else if (const auto* text = node.as_string()) {
    out = Value(text->get());
  } else if (const auto* integer = node.as_integer()) {
    out = Value(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    out = Value(number->get());
  } else if (const auto* boolean = node.as_boolean()) {
    out = Value(boolean->get());
  } else {
    std::ostringstream date;
    if (const auto* d = node.as_date())
      date << d->get();
    else if (const auto* t = node.as_time())
      date << t->get();
    else if (const auto* dt = node.as_date_time())
      date << dt->get();
    out = Value(date.str());
  }
  out.where = {file, static_cast<int>(node.source().begin.line), static_cast<int>(node.source().begin.column)};
  return out;
}

/// Line and column of a byte offset; asked in rising order, so each byte is passed once.
class Places {
 public:
  Places(const std::string& text, const std::string& file) : text_(text), file_(file) {}
  Location at(size_t offset) {
    for (; done_ < offset && done_ < text_.size(); ++done_) {
      if (text_[done_] == '\n') {
        ++line_;
        column_ = 1;
      } else {
        ++column_;
      }
    }
    return {file_, line_, column_};
  }

 private:
  const std::string& text_;
  const std::string& file_;
  size_t done_ = 0;
  int line_ = 1, column_ = 1;
};

class TreeBuilder {
 public:
  TreeBuilder(const std::string& text, const std::string& file, rapidjson::MemoryStream& stream)
      : text_(text), places_(text, file), stream_(stream) {}

  Value root;

  bool Null() { return put({}); }
  bool Bool(bool b) { return put(b); }
  // Numbers come as they stand: RapidJSON's own conversion is undefined for a zero with a large exponent.
  bool Int(int) { return false; }
  bool Uint(unsigned) { return false; }
  bool Int64(std::int64_t) { return false; }
  bool Uint64(std::uint64_t) { return false; }
  bool Double(double) { return false; }
  bool RawNumber(const char* s, rapidjson::SizeType n, bool) { return put(number({s, n})); }
  bool String(const char* s, rapidjson::SizeType n, bool) { return put(std::string(s, n)); }
  bool StartObject() { return open(Value::object()); }
  bool Key(const char* s, rapidjson::SizeType n, bool) {
    open_.back()->members().emplace_back(std::string(s, n), Value{});
    return true;
  }
  bool EndObject(rapidjson::SizeType) {
    std::vector<std::string_view> keys;
    for (const auto& [key, value] : open_.back()->members()) keys.push_back(key);
    std::sort(keys.begin(), keys.end());
    if (const auto twice = std::adjacent_find(keys.begin(), keys.end()); twice != keys.end())
      throw core::usage_error("the key '" + std::string(*twice) + "' is stated twice", here().text());
    return close();
  }
  bool StartArray() { return open(Value::array()); }
  bool EndArray(rapidjson::SizeType) { return close(); }

 private:
  // The stream stands just behind the value; for scalars this is near enough to point a person to the line.
  Location here() { return places_.at(stream_.Tell() > 0 ? stream_.Tell() - 1 : 0); }
  /// A whole number that fits into 64 bits, or the nearest double.
  Value number(std::string_view text) {
    const char *begin = text.data(), *end = begin + text.size();
    std::int64_t whole = 0;
    if (const auto read = std::from_chars(begin, end, whole); read.ec == std::errc() && read.ptr == end) return whole;
    double value = 0.0;
    if (std::from_chars(begin, end, value).ec != std::errc::result_out_of_range) return value;
    const size_t exponent = text.find_first_of("eE");
    const bool is_tiny = exponent == std::string_view::npos ? text.starts_with("0.") || text.starts_with("-0.") : text[exponent + 1] == '-';
    if (!is_tiny) throw core::usage_error("a number too large to be stored", here().text());
    return 0.0;
  }
  Value& place(Value v) {
    v.where = here();
    if (open_.empty()) return root = std::move(v);
    Value& parent = *open_.back();
    if (parent.is_array()) return parent.push(std::move(v));
    return parent.members().back().second = std::move(v);
  }
  bool put(Value v) {
    place(std::move(v));
    return true;
  }
  bool open(Value v) {
    if (open_.size() >= size_t{deepest})
      throw core::usage_error("more than " + std::to_string(deepest) + " levels of nesting", here().text());
    open_.push_back(&place(std::move(v)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& text_;
  Places places_;
  rapidjson::MemoryStream& stream_;
  std::vector<Value*> open_;
};

using JsonWriter = rapidjson::PrettyWriter<rapidjson::StringBuffer>;

void write_text(const std::string& text, JsonWriter& out) {
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  const std::string s = plain ? text : core::utf8(text);  // JSON is UTF-8
  out.String(s.data(), static_cast<rapidjson::SizeType>(s.size()));
}

/// Numbers as the program prints them everywhere; a list of single values takes one line.
void write(const Value& v, JsonWriter& out) {
  const auto raw = [&](const std::string& number) { out.RawValue(number.data(), number.size(), rapidjson::kNumberType); };
  if (v.is_null())
    out.Null();
  else if (v.is_bool())
    out.Bool(v.as_bool());
  else if (v.is_int())
    out.Int64(v.as_int());
  else if (v.is_number())
    std::isfinite(v.as_number()) ? raw(core::format_number(v.as_number())) : static_cast<void>(out.Null());
  else if (v.is_text())
    write_text(v.as_text(), out);
  else if (v.is_array()) {
    const bool flat = std::all_of(v.items().begin(), v.items().end(), [](const Value& i) { return !i.is_array() && !i.is_object(); });
    out.SetFormatOptions(flat ? rapidjson::kFormatSingleLineArray : rapidjson::kFormatDefault);
    out.StartArray();
    for (const Value& item : v.items()) write(item, out);
    out.SetFormatOptions(flat ? rapidjson::kFormatSingleLineArray : rapidjson::kFormatDefault);
    out.EndArray();
    out.SetFormatOptions(rapidjson::kFormatDefault);
  } else {
    out.StartObject();
    for (const auto& [key, member] : v.members()) {
      write_text(key, out);
      write(member, out);
    }
    out.EndObject();
  }
}

/// The parser bounds nested values, but not the tables that one dotted key opens.
void refuse_deep_keys(const std::string& text, const std::string& name) {
  int line = 1, dots = 0;
  char quote = 0;
  bool comment = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line, dots = 0, comment = false;
    if (comment) continue;
    if (quote) {
      if (c == '\\' && quote == '"') ++i;
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      comment = true;
    } else if (c == '=' || c == ',' || c == '{') {
      dots = 0;
    } else if (c == '.' && ++dots > deepest) {
      throw core::usage_error("a key of more than " + std::to_string(deepest) + " levels", Location{name, line, 1}.text());
    }
  }
}

/// Point clouds begin with "LASF", whatever their name.
void refuse_cloud(const std::filesystem::path& file) {
  char begin[4] = {};
  std::error_code ec;
  if (!std::filesystem::is_regular_file(file, ec) || !std::ifstream(file, std::ios::binary).read(begin, sizeof begin)) return;
  if (std::string_view(begin, sizeof begin) == "LASF")
    throw core::usage_error("is a point cloud, not a survey or a config", file.string(),
                            "name it as the file of a [[points]] in survey.toml, or use `swath dtm " + file.string() + "`");
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file) {
  std::error_code ec;
  if (std::filesystem::is_directory(file, ec)) throw core::Error("is a folder, not a file", file.string(), hint_of_folder(file));
  if (std::filesystem::exists(file, ec) && !std::filesystem::is_regular_file(file, ec))
    throw core::Error("is not a regular file", file.string());
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw_system_error("cannot open", file, errno);
  std::ostringstream out;
  out << in.rdbuf();
  return std::move(out).str();
}

core::Value parse_toml(const std::string& text, const std::string& name) {
  refuse_deep_keys(text, name);
  try {
    return from_toml(toml::parse(text, name), name);
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    throw core::usage_error(std::string(e.description()), Location{name, static_cast<int>(at.line), static_cast<int>(at.column)}.text());
  }
}

core::Value parse_json(const std::string& text, const std::string& name) {
  rapidjson::MemoryStream stream(text.data(), text.size());
  rapidjson::Reader reader;
  TreeBuilder builder(text, name, stream);
  const rapidjson::ParseResult result =
      reader.Parse<rapidjson::kParseNumbersAsStringsFlag | rapidjson::kParseIterativeFlag>(stream, builder);
  if (!result) {
    Places places(text, name);
    throw core::usage_error(rapidjson::GetParseError_En(result.Code()), places.at(result.Offset()).text());
  }
  return std::move(builder.root);
}

core::Value read_value_file(const std::filesystem::path& file) {
  refuse_cloud(file);
  const std::string text = read_text_file(file);
  return file.extension() == ".json" ? parse_json(text, file.string()) : parse_toml(text, file.string());
}

std::string to_json(const core::Value& v) {
  rapidjson::StringBuffer text;
  JsonWriter out(text);
  out.SetIndent(' ', 2);
  write(v, out);
  return std::string(text.GetString(), text.GetSize()) + '\n';
}

}  // namespace swath::io
