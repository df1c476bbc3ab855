// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), 2.7.6.
// Deviation: a double holds 53 of the 64 bits of the widest integers.
#include "io/las/las_recode.h"

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "core/error.h"
#include "io/las/las_block.h"
#include "io/text/output_file.h"

namespace swath::io {

namespace {

constexpr std::size_t records_in_turn = 1u << 16;

/// The column of a block that is written under this name, as it is written.
const LasExtra* own_extra(const std::string& name) {
  static const std::vector<LasExtra> all = [] {
    core::ColumnSet columns;
    for_each_extra_column([&](core::Column c, const char*, auto) { columns.add(c); });
    return las_extras_of(columns);
  }();
  const auto found = std::find_if(all.begin(), all.end(), [&](const LasExtra& e) { return e.name == name; });
  return found == all.end() ? nullptr : &*found;
}

bool is_number_of_one_name(const std::vector<LasExtra>& extras, const LasExtra& e) {
  return e.type >= 1 && e.type <= 10 &&
         std::count_if(extras.begin(), extras.end(), [&](const LasExtra& x) { return x.name == e.name; }) == 1;
}

}  // namespace

bool is_same_field(const LasExtra& a, const LasExtra& b) {
  return a.name == b.name && a.type == b.type && a.bytes == b.bytes && a.nodata == b.nodata && a.scale == b.scale && a.offset == b.offset;
}

std::vector<LasExtra> common_extras(const std::vector<LasHeader>& files) {
  std::vector<LasExtra> out = files.front().extras;
  for (const LasHeader& h : files) {
    bool is_same = h.extras.size() == out.size();
    for (std::size_t i = 0; is_same && i < out.size(); ++i) {
      if (is_same_field(h.extras[i], out[i])) continue;
      const LasExtra* own = own_extra(out[i].name);
      is_same = own && h.extras[i].name == out[i].name;
      if (is_same) out[i] = *own;
    }
    if (!is_same) throw core::Error("parts of one cloud have other extra fields", "las_recode", "this is a fault of the program");
  }
  return out;
}

std::vector<LasExtra> float_extras(const std::vector<LasExtra>& extras) {
  constexpr std::uint8_t f32 = 9, f64 = 10, u32 = 5;
  std::vector<LasExtra> out = extras;
  for (LasExtra& e : out) {
    if (!is_number_of_one_name(extras, e) || (!e.scale && !e.offset && !e.nodata)) continue;
    const bool is_narrow = e.type < u32 || e.type == f32 || (own_extra(e.name) && is_same_field(*own_extra(e.name), e));
    LasExtra plain;
    plain.name = e.name;
    plain.description = e.description;
    plain.type = is_narrow ? f32 : f64;
    e = std::move(plain);
  }
  return out;
}

LasRecoder::LasRecoder(const LasHeader& from, const LasHeader& to, std::string where) : from_(from), to_(to), where_(std::move(where)) {
  to_.record_length = static_cast<std::uint16_t>(las_layout(to_.point_format)->size + to_.extra_bytes());
  for (std::size_t i = 0; i < from.extras.size(); ++i)
    if (!is_same_field(from.extras[i], to.extras[i])) other_.push_back(i);
}

std::span<const std::uint8_t> LasRecoder::operator()(std::span<const std::uint8_t> records) {
  if (other_.empty()) return records;
  decode_las_points(records, from_, in_);
  const std::size_t n = in_.size(), wide = static_cast<std::size_t>(from_.extra_bytes()),
                    wide_out = static_cast<std::size_t>(to_.extra_bytes());
  out_ = in_;
  out_.extra.assign(n * wide_out, 0);
  std::size_t at = 0, at_out = 0;
  for (std::size_t k = 0; k < from_.extras.size(); ++k) {
    const auto size = static_cast<std::size_t>(from_.extras[k].size()), size_out = static_cast<std::size_t>(to_.extras[k].size());
    if (std::binary_search(other_.begin(), other_.end(), k))
      set_las_extra_values(out_, to_, to_.extras[k].name, las_extra_values(in_, from_, from_.extras[k].name), where_);
    else
      for (std::size_t i = 0; i < n; ++i) std::copy_n(&in_.extra[i * wide + at], size, &out_.extra[i * wide_out + at_out]);
    at += size, at_out += size_out;
  }
  records_.resize(n * to_.record_length);
  encode_las_points(out_, 0, n, to_, records_, where_);
  return records_;
}

void each_las_records(const std::filesystem::path& file, const LasHeader& header,
                      const std::function<void(std::span<const std::uint8_t>)>& f) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(header.offset_to_points);
  std::vector<std::uint8_t> records;
  for (std::uint64_t left = header.point_count; left > 0;) {
    const std::uint64_t n = std::min<std::uint64_t>(left, records_in_turn);
    records.resize(n * header.record_length);
    if (!in.read(reinterpret_cast<char*>(records.data()), static_cast<std::streamsize>(records.size())))
      throw_system_error("cannot read", file, errno ? errno : EIO);
    f(records);
    left -= n;
  }
}

}  // namespace swath::io
