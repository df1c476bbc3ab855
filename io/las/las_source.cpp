// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), sections 2.4 to 2.7.
// Deviation: where files differ in scale or offset, coordinates are rounded to the finest scale, half a step at most.
#include "io/las/las_source.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/error.h"
#include "io/las/las_block.h"
#include "io/las/las_bytes.h"
#include "io/las/las_recode.h"
#include "io/store/input_file.h"

namespace swath::io {

using las::get;
using las::put;

namespace {

constexpr std::size_t number_bytes = 4, place_bytes = 12;
constexpr std::uint64_t largest_packets = 64u << 20;

bool is(const LasVlr& v, const char* user, int id) { return v.user_id == user && v.record_id == id; }
bool is_packets(const LasVlr& v) { return is(v, "LASF_Spec", 65535); }
bool is_crs(const LasVlr& v) {
  return v.user_id == "LASF_Projection" && (v.record_id == 2111 || v.record_id == 2112 || (v.record_id >= 34735 && v.record_id <= 34737));
}
/// Records that describe the bytes of the file they are in.
bool is_of_the_file(const LasVlr& v) { return v.user_id == "copc" || is(v, "LAStools", 30) || is(v, "LAStools", 20); }

/// The smallest point format that has every field of all.
int common_format(const std::vector<LasSource>& files) {
  bool extended = false, gps = false, rgb = false, nir = false, wave = false;
  for (const LasSource& f : files) {
    const LasLayout l = *las_layout(f.header.point_format);
    extended |= l.extended, gps |= l.gps, rgb |= l.rgb, nir |= l.nir, wave |= l.wave;
  }
  for (int format = extended ? 6 : 0; format <= 10; ++format) {
    const LasLayout l = *las_layout(format);
    if (l.gps >= gps && l.rgb >= rgb && l.nir >= nir && l.wave >= wave) return format;
  }
  return 10;
}

/// What a field holds where its file does not have it: nodata, NaN or 0.
std::vector<std::uint8_t> nothing_of(const LasExtra& e) {
  const auto size = static_cast<std::size_t>(e.size());
  std::vector<std::uint8_t> out(size);
  if (e.type == 0) return out;
  const auto parts = static_cast<std::size_t>(e.components());
  const std::size_t each = size / parts;
  const int type = (e.type - 1) % 10 + 1;
  for (std::size_t k = 0; k < parts; ++k) {
    std::uint8_t* at = out.data() + k * each;
    if (type == 9)
      put(at, e.nodata ? static_cast<float>(std::bit_cast<double>((*e.nodata)[k])) : std::numeric_limits<float>::quiet_NaN());
    else if (type == 10)
      put(at, e.nodata ? std::bit_cast<double>((*e.nodata)[k]) : std::numeric_limits<double>::quiet_NaN());
    else if (e.nodata)
      std::memcpy(at, &(*e.nodata)[k], each);
  }
  return out;
}

/// Columns of held_by_source that points of the file have.
core::ColumnSet columns_in(const LasHeader& h) {
  using core::Column;
  core::ColumnSet out = held_by_source;
  if (!las_layout(h.point_format)->rgb) out = out - core::ColumnSet{Column::red, Column::green, Column::blue};
  for_each_extra_column([&](Column c, const char* name, auto) {
    if (!h.extra_offset(name)) out = out - core::ColumnSet{c};
  });
  return out;
}

/// Data that read_las_header() left in the file.
void load(LasVlr& v, const std::filesystem::path& file) {
  if (v.data.size() == v.size) return;
  InputFile in(file);
  v.data.resize(v.size);
  if (in.read_some(v.offset, v.data.data(), v.size) < v.size)
    throw core::Error("the record " + v.user_id + " " + std::to_string(v.record_id) + " is cut off",
                      file.string() + ": byte " + std::to_string(v.offset), "the file changed while it was read, or its disk fails");
}

/// The waveform packets of LAS 1.3, which are not counted among the extended records.
void find_packets(LasHeader& h, const std::filesystem::path& file) {
  constexpr std::size_t head = 60;
  if (h.version_minor != 3 || h.waveform_start == 0 || !(h.global_encoding & las_encoding::waveform_internal)) return;
  LasVlr v{"", 0, "", {}, h.waveform_start, head};
  load(v, file);
  v.size = get<std::uint64_t>(&v.data[20]);
  v.data.clear();
  v.user_id = "LASF_Spec";
  v.record_id = 65535;
  v.offset = h.waveform_start + head;
  h.evlrs.push_back(std::move(v));
}

/// A file's records without those that are not to be carried.
void thin_out(std::vector<LasVlr>& records, bool keep_crs, bool keep_packets) {
  std::erase_if(records, [&](const LasVlr& v) {
    return is_of_the_file(v) || (!keep_crs && is_crs(v)) || (is_packets(v) ? !keep_packets : v.size > largest_packets);
  });
}

}  // namespace

void keep_source(std::span<const std::uint8_t> records, std::size_t record_length, std::uint32_t number, core::ByteRows& rows) {
  const std::size_t n = records.size() / record_length;
  rows = {};
  rows.resize(n, number_bytes + record_length);
  for (std::size_t i = 0; i < n; ++i) {
    put(rows.row(i), number);
    std::copy_n(records.data() + i * record_length + place_bytes, record_length - place_bytes, rows.row(i) + number_bytes + place_bytes);
  }
}

/// The points of one file within a block.
struct LasSources::Part {
  const LasSource& source;
  std::size_t number;  ///< of the file, from 0
  std::vector<std::uint32_t> rows;
  LasPoints points;
  core::Block block;  ///< as it was read
};

template <class F>
void LasSources::each_part(const core::Block& block, F&& f) const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> rows;
  if (block.source.empty()) return;
  for (std::uint32_t i = 0; i < block.size(); ++i)
    if (const auto number = get<std::uint32_t>(block.source.row(i)); number > 0 && number <= files_.size()) rows[number - 1].push_back(i);
  std::vector<std::uint8_t> records;
  for (auto& [number, mine] : rows) {
    Part part{files_[number], number, std::move(mine), {}, {}};
    const std::size_t length = part.source.header.record_length;
    records.resize(part.rows.size() * length);
    for (std::size_t k = 0; k < part.rows.size(); ++k)
      std::copy_n(block.source.row(part.rows[k]) + number_bytes, length, records.data() + k * length);
    decode_las_points(records, part.source.header, part.points);
    LasTime any;
    any.keep_unknown = true;
    LasTimesRead none;
    las_points_to_block(part.points, part.source.header, 0, any, none, part.source.file.string(), part.block);
    f(part);
  }
}

LasSources::LasSources(std::vector<LasSource> files, bool record_times) : files_(std::move(files)) {
  std::set<core::TimeScale> scales;
  for (LasSource& f : files_) {
    find_packets(f.header, f.file);
    held_ = held_ | columns_in(f.header);
    std::vector<std::size_t>& where = where_.emplace_back();
    for (const LasExtra& e : f.header.extras) {
      std::size_t at = 0;
      const auto is_taken = [&](std::size_t k) { return std::find(where.begin(), where.end(), k) != where.end(); };
      while (at < extras_.size() && (is_taken(at) || !is_same_field(extras_[at], e))) ++at;
      if (at == extras_.size()) {
        LasExtra added = e;
        for (int again = 2;
             !added.name.empty() && std::any_of(extras_.begin(), extras_.end(), [&](const LasExtra& x) { return x.name == added.name; }) &&
             files_.size() > 1;
             ++again) {
          added.name = e.name + "_" + std::to_string(again);
          added.as_read.clear();
        }
        extras_.push_back(std::move(added));
      }
      where.push_back(at);
    }
    if (las_layout(f.header.point_format)->gps) scales.insert(las_time_scale(f.header, f.time));
  }
  const auto only = [&](std::initializer_list<core::TimeScale> these) {
    return std::all_of(scales.begin(), scales.end(),
                       [&](core::TimeScale s) { return std::find(these.begin(), these.end(), s) != these.end(); });
  };
  using core::TimeScale;
  keeps_times_ =
      only({TimeScale::gps_adjusted}) || only({TimeScale::unstated}) || (record_times && only({TimeScale::unstated, TimeScale::gps_week}));
}

LasHeader LasSources::header(bool keep_crs) const {
  LasHeader h = files_.front().header;
  constexpr std::array<int, 5> highest_format{1, 1, 3, 5, 10};
  h.extras = extras_;
  h.point_format = common_format(files_);
  const bool keep_packets = files_.size() == 1;
  bool adjusted = true;
  for (const LasSource& f : files_) {
    const LasHeader& o = f.header;
    h.version_minor = std::max(h.version_minor, o.version_minor);
    h.scale = h.scale.cwiseAbs().cwiseMin(o.scale.cwiseAbs());
    h.global_encoding = static_cast<std::uint16_t>(h.global_encoding | (o.global_encoding & las_encoding::synthetic_returns));
    if (o.creation_day != h.creation_day || o.creation_year != h.creation_year) h.creation_day = h.creation_year = 0;
    if (o.system_identifier != h.system_identifier) h.system_identifier = "MERGE";
    if (o.file_source_id != h.file_source_id) h.file_source_id = 0;
    if (las_layout(o.point_format)->gps) adjusted = adjusted && las_time_scale(o, f.time) == core::TimeScale::gps_adjusted;
  }
  if (files_.size() == 1) h.scale = files_.front().header.scale;
  if (las_layout(h.point_format)->gps) {
    constexpr unsigned bit = las_encoding::adjusted_gps_time;
    h.global_encoding = static_cast<std::uint16_t>(adjusted || !keeps_times_ ? h.global_encoding | bit : h.global_encoding & ~bit);
  }
  // Records of further files: those that the first does not have.
  for (std::size_t k = 1; k < files_.size(); ++k)
    for (const auto list : {&LasHeader::vlrs, &LasHeader::evlrs})
      for (const LasVlr& v : files_[k].header.*list)
        if (std::none_of((h.*list).begin(), (h.*list).end(),
                         [&](const LasVlr& mine) { return mine.user_id == v.user_id && mine.record_id == v.record_id; }))
          (h.*list).push_back(v);
  thin_out(h.vlrs, keep_crs, keep_packets);
  thin_out(h.evlrs, keep_crs, keep_packets);
  std::erase_if(h.evlrs, [](const LasVlr& v) { return is(v, "LASF_Spec", 4) || (is_packets(v) && v.size > largest_packets); });
  for (LasVlr& v : h.evlrs) load(v, files_.front().file);
  if (std::none_of(h.evlrs.begin(), h.evlrs.end(), is_packets))
    h.global_encoding = static_cast<std::uint16_t>(h.global_encoding & ~static_cast<unsigned>(las_encoding::waveform_internal));
  if (!keep_crs) h.global_encoding = static_cast<std::uint16_t>(h.global_encoding & ~static_cast<unsigned>(las_encoding::wkt));
  while (h.version_minor < 4 && (!h.evlrs.empty() || h.point_format > highest_format[static_cast<std::size_t>(h.version_minor)]))
    ++h.version_minor;
  h.waveform_start = 0;
  h.generating_software = "swath";
  return h;
}

bool LasSources::same_project() const {
  return std::all_of(files_.begin(), files_.end(), [&](const LasSource& f) { return f.header.guid == files_.front().header.guid; });
}

std::vector<std::string> LasSources::left_out() const {
  std::vector<std::string> out;
  for (const LasSource& f : files_) {
    const auto encoding = f.header.global_encoding;
    if (encoding & las_encoding::waveform_external)
      out.push_back("waveform packets stay in the .wdp file beside " + f.file.string() + "; the points keep their references");
    for (const auto list : {&LasHeader::vlrs, &LasHeader::evlrs})
      for (const LasVlr& v : f.header.*list) {
        const std::string name = v.user_id + " " + std::to_string(v.record_id);
        if (is_packets(v) && (files_.size() > 1 || v.size > largest_packets))
          out.push_back("waveform packets stay in " + f.file.string() + "; the points keep their references");
        else if (is_of_the_file(v))
          out.push_back("the record " + name + " of " + f.file.string() + " describes that file's own bytes and is left out");
        else if (!is_packets(v) && v.size > largest_packets)
          out.push_back("the record " + name + " of " + f.file.string() + " is larger than 64 MB and is left out");
      }
  }
  return out;
}

void LasSources::complete(core::Block& block) const {
  const core::ColumnSet missing = held_ - core::columns_of(block);
  if (missing.empty() || block.source.empty()) return;
  core::add_columns(block, missing);
  each_part(block, [&](const Part& part) {
    core::for_each_column([&](core::Column c, std::string_view, auto member) {
      const auto& read = part.block.*member;
      if (!missing.has(c) || read.empty()) return;
      for (std::size_t k = 0; k < part.rows.size(); ++k) (block.*member)[part.rows[k]] = read[k];
    });
  });
}

core::ColumnSet LasSources::unchanged(const core::Block& block) const {
  core::ColumnSet out;
  for_each_extra_column([&](core::Column c, const char*, auto member) {
    if (!(block.*member).empty() || held_.has(c)) out.add(c);
  });
  each_part(block, [&](const Part& part) {
    for_each_extra_column([&](core::Column c, const char*, auto member) {
      if (!out.has(c) || (block.*member).empty()) return;
      const std::vector<float>&now = block.*member, &read = part.block.*member;
      for (std::size_t k = 0; k < part.rows.size(); ++k) {
        const float a = now[part.rows[k]], b = read.empty() ? 0.0F : read[k];
        if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b))) continue;
        out = out - core::ColumnSet{c};
        return;
      }
    });
  });
  return out;
}

std::uint64_t LasSources::restore(const core::Block& block, const LasHeader& out, core::ColumnSet unchanged, LasPoints& p) const {
  const LasLayout to = *las_layout(out.point_format);
  const auto stride = static_cast<std::size_t>(out.extra_bytes());
  std::vector<std::size_t> place(out.extras.size());
  for (std::size_t k = 0, at = 0; k < out.extras.size(); at += static_cast<std::size_t>(out.extras[k++].size())) place[k] = at;
  const auto from_block = [&](std::size_t k) {
    bool taken = false;
    for_each_extra_column([&](core::Column c, const char* name, auto member) {
      taken |= out.extras[k].name == name && !(block.*member).empty() && !unchanged.has(c);
    });
    return taken;
  };
  each_part(block, [&](const Part& part) {
    const LasPoints& s = part.points;
    const LasLayout from = *las_layout(part.source.header.point_format);
    const auto copy = [&](bool there, const auto& recorded, auto& written) {
      if (!there || recorded.empty() || written.empty()) return;
      for (std::size_t k = 0; k < part.rows.size(); ++k) written[part.rows[k]] = recorded[k];
    };
    copy(true, s.channel, p.channel);
    copy(true, s.nir, p.nir);
    copy(true, s.wave_descriptor, p.wave_descriptor);
    copy(true, s.wave_offset, p.wave_offset);
    copy(true, s.wave_size, p.wave_size);
    copy(true, s.wave_location, p.wave_location);
    copy(true, s.wave_dx, p.wave_dx);
    copy(true, s.wave_dy, p.wave_dy);
    copy(true, s.wave_dz, p.wave_dz);
    copy(keeps_times_, s.gps_time, p.gps_time);
    for (std::size_t k = 0; k < part.rows.size() && !from.gps && to.gps; ++k) p.gps_time[part.rows[k]] = 0.0;
    for (std::size_t k = 0; k < part.rows.size() && from.extended == to.extended; ++k) {
      const std::uint32_t i = part.rows[k];
      if (!block.scan_angle.empty() && block.scan_angle[i] == part.block.scan_angle[k]) p.raw_scan_angle[i] = s.raw_scan_angle[k];
      if (!to.extended && block.classification[i] == part.block.classification[k] && block.flags[i] == part.block.flags[k])
        p.classification[i] = s.classification[k];
    }
    const auto source_stride = static_cast<std::size_t>(part.source.header.extra_bytes());
    std::vector<bool> given(extras_.size());
    std::size_t at = 0;
    for (std::size_t e = 0; e < where_[part.number].size(); ++e) {
      const std::size_t k = where_[part.number][e], size = static_cast<std::size_t>(part.source.header.extras[e].size());
      given[k] = true;
      if (!from_block(k))
        for (std::size_t row = 0; row < part.rows.size(); ++row)
          std::copy_n(s.extra.data() + row * source_stride + at, size, p.extra.data() + part.rows[row] * stride + place[k]);
      at += size;
    }
    for (std::size_t k = 0; k < extras_.size(); ++k) {
      if (given[k] || from_block(k)) continue;
      const std::vector<std::uint8_t> nothing = nothing_of(extras_[k]);
      for (const std::uint32_t i : part.rows) std::copy(nothing.begin(), nothing.end(), p.extra.data() + i * stride + place[k]);
    }
  });
  std::uint64_t lost = 0;
  for (std::size_t i = 0; i < block.size() && !to.extended && !block.flags.empty(); ++i)
    lost += (block.flags[i] & core::flag::overlap) && p.classification[i] != legacy_overlap_class;
  return lost;
}

}  // namespace swath::io
