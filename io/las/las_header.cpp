// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019) and, for older files, 1.0 (2003), 1.1 (2005), 1.2 (2008), 1.3 (2010).
// Reading and writing are together, so that the place of every byte can be held against its twin.
#include "io/las/las_header.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/config/units.h"
#include "core/error.h"
#include "io/las/las_bytes.h"
#include "io/las/other_cloud.h"
#include "io/store/input_file.h"
#include "io/text/output_file.h"

namespace swath::io {

using las::get;
using las::put;
using las::put_text;
using las::text_of;

namespace {

constexpr std::size_t vlr_head = 54, evlr_head = las_evlr_head;
constexpr std::uint64_t largest_evlr_kept = 64u << 20;

std::size_t header_size(int minor) { return minor >= 4 ? 375 : minor == 3 ? 235 : 227; }

std::string at_byte(const std::filesystem::path& file, std::uint64_t byte) { return file.string() + ": byte " + std::to_string(byte); }

/// Reads parts of one file; a part that is not there is an error that names what is cut.
class Input {
 public:
  explicit Input(const std::filesystem::path& file) : in_(file) {}
  std::uint64_t size() const { return in_.size(); }
  std::vector<std::uint8_t> read(std::uint64_t at, std::uint64_t n, const std::string& what) {
    if (at > size() || n > size() - at)
      throw core::Error(what + " is cut off: the file ends at byte " + std::to_string(size()), at_byte(in_.path(), at),
                        "the file is truncated or damaged: fetch or export it again");
    std::vector<std::uint8_t> out(n);
    if (in_.read_some(at, out.data(), n) < n) throw_system_error("cannot read", in_.path(), EIO);
    return out;
  }

 private:
  InputFile in_;
};

LasVlr parse_vlr_head(const std::uint8_t* b, bool extended) {
  LasVlr v;
  v.user_id = text_of(b + 2, 16);
  v.record_id = get<std::uint16_t>(b + 18);
  v.size = extended ? get<std::uint64_t>(b + 20) : get<std::uint16_t>(b + 20);
  v.description = text_of(b + (extended ? 28 : 22), 32);
  return v;
}

/// Where the first part of the file from byte `at` on begins: extended records, waveforms, or the end.
std::uint64_t next_part(const LasHeader& h, std::uint64_t at, std::uint64_t file_size, std::uint64_t evlr_start) {
  std::uint64_t next = file_size;
  for (const std::uint64_t start : {evlr_start, h.waveform_start})
    if (start >= at) next = std::min(next, start);
  return next;
}

/// Records between the header and what follows them; not known of compressed ones.
std::optional<std::uint64_t> room_for_points(const LasHeader& h, std::uint64_t file_size, std::uint64_t evlr_start) {
  if (h.compressed || h.record_length == 0) return std::nullopt;
  return (next_part(h, h.offset_to_points, file_size, evlr_start) - h.offset_to_points) / h.record_length;
}

/// Of two counts that differ the one that the file bears out: some writers of LAS 1.4 set but one of them, or leave the other as it was.
std::uint64_t chosen_count(std::uint64_t count, std::uint32_t legacy, std::optional<std::uint64_t> holds, const std::filesystem::path& file,
                           std::vector<std::string>& warnings) {
  const std::string contradiction =
      "the legacy point count " + std::to_string(legacy) + " contradicts the point count " + std::to_string(count);
  const bool is_legacy = count == 0 || holds == legacy;
  const bool is_cut = legacy == (count & 0xffffffffu);  // its lower 32 bits
  if (!is_legacy && !is_cut && holds != count)
    throw core::Error(contradiction, at_byte(file, 107), "the header is damaged or its writer is at fault: export the file again");
  warnings.push_back(contradiction + (is_legacy ? ": the legacy one is taken" : ": the legacy one is not used"));
  return is_legacy ? legacy : count;
}

void parse_counts(LasHeader& h, const std::vector<std::uint8_t>& b, std::optional<std::uint64_t> holds, const std::filesystem::path& file,
                  std::vector<std::string>& warnings) {
  h.legacy_point_count = get<std::uint32_t>(&b[107]);
  for (std::size_t i = 0; i < 5; ++i) h.legacy_by_return[i] = get<std::uint32_t>(&b[111 + 4 * i]);
  const std::uint64_t count = h.version_minor >= 4 ? get<std::uint64_t>(&b[247]) : h.legacy_point_count;
  const bool differ = h.legacy_point_count != 0 && h.legacy_point_count != count;
  h.point_count = differ ? chosen_count(count, h.legacy_point_count, holds, file, warnings) : count;
  if (h.point_count != count || h.version_minor < 4)
    std::copy(h.legacy_by_return.begin(), h.legacy_by_return.end(), h.by_return.begin());
  else
    for (std::size_t i = 0; i < 15; ++i) h.by_return[i] = get<std::uint64_t>(&b[255 + 8 * i]);
  if (!differ && h.version_minor >= 4 && h.legacy_point_count != 0 && h.point_format >= 6)
    warnings.push_back("the legacy point count is set, though point format " + std::to_string(h.point_format) + " has none");
  const std::uint64_t sum = std::accumulate(h.by_return.begin(), h.by_return.end(), std::uint64_t{0});
  if (sum > h.point_count)  // fewer is right where returns lie beyond the header's 5 or 15 or have no number
    warnings.push_back("the points by return add up to " + std::to_string(sum) + ", the point count is " + std::to_string(h.point_count));
}

void parse_geometry(LasHeader& h, const std::vector<std::uint8_t>& b, const std::filesystem::path& file) {
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    h.scale[i] = get<double>(&b[131 + 8 * k]);
    h.offset[i] = get<double>(&b[155 + 8 * k]);
    h.max[i] = get<double>(&b[179 + 16 * k]);
    h.min[i] = get<double>(&b[187 + 16 * k]);
    // The largest raw coordinate must stay a number, too.
    if (!std::isfinite(h.scale[i] * 0x1p33) || h.scale[i] == 0.0)
      throw core::Error("the scale factor of " + std::string(1, "xyz"[i]) + " is " + core::format_number(h.scale[i]),
                        at_byte(file, 131 + 8 * k), "the header is damaged: export the file again");
    if (!std::isfinite(h.offset[i] * 2))
      throw core::Error("the offset of " + std::string(1, "xyz"[i]) + " is " + core::format_number(h.offset[i]), at_byte(file, 155 + 8 * k),
                        "the header is damaged: export the file again");
  }
}

void read_vlrs(LasHeader& h, Input& in, std::uint64_t at, std::uint32_t count, const std::filesystem::path& file) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string name = "variable length record " + std::to_string(i);
    const auto check = [&](std::uint64_t end) {
      if (end > h.offset_to_points)
        throw core::Error(name + " reaches beyond the first point at byte " + std::to_string(h.offset_to_points), at_byte(file, at),
                          "the header's number of VLRs or the VLR's length is wrong: export the file again");
    };
    check(at + vlr_head);
    LasVlr v = parse_vlr_head(in.read(at, vlr_head, name).data(), false);
    v.offset = at + vlr_head;
    check(v.offset + v.size);
    v.data = in.read(v.offset, v.size, name);
    at = v.offset + v.size;
    if (v.user_id == "laszip encoded" && v.record_id == 22204)
      h.laszip = std::move(v.data);
    else
      h.vlrs.push_back(std::move(v));
  }
}

void read_evlrs(LasHeader& h, Input& in, std::uint64_t at, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string name = "extended variable length record " + std::to_string(i);
    LasVlr v = parse_vlr_head(in.read(at, evlr_head, name).data(), true);
    v.offset = at + evlr_head;
    if (v.size > in.size() || v.offset > in.size() - v.size) in.read(v.offset, v.size, name);
    const bool waveform = v.user_id == "LASF_Spec" && v.record_id == 65535;
    if (!waveform && v.size <= largest_evlr_kept) v.data = in.read(v.offset, v.size, name);
    at = v.offset + v.size;
    h.evlrs.push_back(std::move(v));
  }
}

void check_records(const LasHeader& h, std::uint64_t file_size, const std::filesystem::path& file, std::vector<std::string>& warnings,
                   std::uint64_t evlr_start) {
  const int least = las_layout(h.point_format)->size;
  if (h.record_length < least)
    throw core::Error("point records of " + std::to_string(h.record_length) + " bytes cannot hold point format " +
                          std::to_string(h.point_format) + " (" + std::to_string(least) + " bytes)",
                      at_byte(file, 105), "the header is damaged or its writer is at fault: export the file again");
  if (h.compressed) {
    if (h.laszip.empty())
      throw core::Error("the points are compressed, but the laszip record is missing", at_byte(file, 104),
                        "export the file again; LAZ by any LASzip-compatible writer is read");
    return;
  }
  const std::uint64_t room = file_size - h.offset_to_points;
  const std::uint64_t holds = room / h.record_length;
  if (h.point_count > holds)
    throw core::Error("the header counts " + core::counted(h.point_count, "point") + ", the file holds " + std::to_string(holds),
                      at_byte(file, h.offset_to_points + holds * h.record_length),
                      "the file is truncated or its header is damaged: fetch or export it again");
  const std::uint64_t end = h.offset_to_points + h.point_count * h.record_length;
  const std::uint64_t next = next_part(h, end, file_size, evlr_start);
  if (next - end >= h.record_length)
    throw core::Error("the header counts " + core::counted(h.point_count, "point") + ", but " + std::to_string(next - end) +
                          " bytes follow the last of them, room for " + std::to_string((next - end) / h.record_length) + " more",
                      at_byte(file, end), "its writer was stopped before the end, or the header is damaged: export the file again");
  if (evlr_start == 0 && h.waveform_start == 0 && file_size > end)
    warnings.push_back(core::counted(file_size - end, "byte after the last point is", "bytes after the last point are") + " not used");
}

[[noreturn]] void refuse_other(const std::vector<std::uint8_t>& first, const std::filesystem::path& file) {
  const OtherCloud kind = other_cloud(std::string(first.begin(), first.end()));
  if (kind != OtherCloud::none)
    throw core::Error("not a LAS file: it is " + name_of(kind), at_byte(file, 0),
                      "LAS 1.0 to 1.4 and LAZ are read here; " + conversion_of(kind, file));
  throw core::Error("not a LAS file: it does not begin with LASF", at_byte(file, 0), "LAS 1.0 to 1.4 and LAZ are read here");
}

}  // namespace

std::optional<LasLayout> las_layout(int format) {
  if (format < 0 || format > 10) return std::nullopt;
  LasLayout l;
  l.format = format;
  l.extended = format >= 6;
  l.gps = l.extended || format == 1 || format >= 3;
  l.rgb = format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
  l.nir = format == 8 || format == 10;
  l.wave = format == 4 || format == 5 || format == 9 || format == 10;
  l.size = (l.extended ? 30 : l.gps ? 28 : 20) + (l.rgb ? 6 : 0) + (l.nir ? 2 : 0) + (l.wave ? 29 : 0);
  return l;
}

int LasHeader::extra_bytes() const {
  int sum = 0;
  for (const LasExtra& e : extras) sum += e.size();
  return sum;
}

std::optional<int> LasHeader::extra_offset(const std::string& name) const {
  int at = 0;
  for (const LasExtra& e : extras) {
    if (e.name == name) return at;
    at += e.size();
  }
  return std::nullopt;
}

LasHeader read_las_header(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  Input in(file);
  const std::vector<std::uint8_t> first = in.read(0, std::min<std::uint64_t>(in.size(), 375), "header");
  if (first.size() < 4 || std::memcmp(first.data(), "LASF", 4) != 0) refuse_other(first, file);
  if (first.size() < 227) in.read(0, 227, "header");
  LasHeader h;
  h.version_major = first[24];
  h.version_minor = first[25];
  if (h.version_major != 1 || h.version_minor > 4)
    throw core::Error("LAS " + std::to_string(h.version_major) + "." + std::to_string(h.version_minor) + " is not known", at_byte(file, 24),
                      "LAS 1.0 to 1.4 are read here");
  const std::vector<std::uint8_t> b = in.read(0, header_size(h.version_minor), "header");
  h.file_source_id = get<std::uint16_t>(&b[4]);
  h.global_encoding = h.version_minor >= 1 ? get<std::uint16_t>(&b[6]) : std::uint16_t{0};
  std::copy_n(&b[8], 16, h.guid.begin());
  h.system_identifier = text_of(&b[26], 32);
  h.generating_software = text_of(&b[58], 32);
  h.creation_day = get<std::uint16_t>(&b[90]);
  h.creation_year = get<std::uint16_t>(&b[92]);
  const std::uint16_t stated_size = get<std::uint16_t>(&b[94]);
  h.offset_to_points = get<std::uint32_t>(&b[96]);
  const std::uint32_t vlr_count = get<std::uint32_t>(&b[100]);
  h.compressed = (b[104] & 0x80) != 0;
  h.point_format = b[104] & 0x7f;
  h.record_length = get<std::uint16_t>(&b[105]);
  if (!las_layout(h.point_format))
    throw core::Error("point format " + std::to_string(h.point_format) + " is not known", at_byte(file, 104),
                      "point formats 0 to 10 are read here");
  if (stated_size < header_size(h.version_minor) || h.offset_to_points < stated_size)
    throw core::Error("header of " + std::to_string(stated_size) + " bytes with points from byte " + std::to_string(h.offset_to_points) +
                          " does not fit LAS 1." + std::to_string(h.version_minor),
                      at_byte(file, 94), "the header is damaged: export the file again");
  if (h.offset_to_points > in.size()) in.read(h.offset_to_points, 0, "point data");
  if (h.version_minor >= 3) h.waveform_start = get<std::uint64_t>(&b[227]);
  const std::uint64_t evlr_start = h.version_minor >= 4 ? get<std::uint64_t>(&b[235]) : 0;
  parse_counts(h, b, room_for_points(h, in.size(), evlr_start), file, warnings);
  parse_geometry(h, b, file);
  read_vlrs(h, in, stated_size, vlr_count, file);
  check_records(h, in.size(), file, warnings, evlr_start);
  if (h.version_minor >= 4) read_evlrs(h, in, evlr_start, get<std::uint32_t>(&b[243]));
  h.extras = extras_of(h.vlrs, h.evlrs, h.record_length - las_layout(h.point_format)->size, warnings);
  if (las_layout(h.point_format)->gps && !h.gps_time_is_adjusted() && h.point_count > 0)
    warnings.push_back("the GPS time bit is not set: times count as seconds of a GPS week that the file does not name");
  if (h.point_format >= 6 && !(h.global_encoding & las_encoding::wkt))
    warnings.push_back("the WKT bit is not set, though point format " + std::to_string(h.point_format) + " demands it");
  return h;
}

namespace {

/// Counts and lengths that the file is to state are possible in its version.
void set_record_length(LasHeader& h, const std::string& file) {
  const auto layout = las_layout(h.point_format);
  constexpr std::array<int, 5> highest_format{1, 1, 3, 5, 10};
  if (h.version_major != 1 || h.version_minor < 0 || h.version_minor > 4 || !layout ||
      h.point_format > highest_format[static_cast<std::size_t>(h.version_minor)])
    throw core::Error("LAS " + std::to_string(h.version_major) + "." + std::to_string(h.version_minor) + " has no point format " +
                          std::to_string(h.point_format),
                      file, "LAS 1.4 holds point formats 0 to 10");
  if (h.version_minor < 4 && (h.point_count > std::numeric_limits<std::uint32_t>::max() || !h.evlrs.empty()))
    throw core::Error("more than 4294967295 points or extended records need LAS 1.4", file, "write LAS 1.4");
  const int record_length = layout->size + h.extra_bytes();
  if (record_length > std::numeric_limits<std::uint16_t>::max()) throw core::Error("the extra bytes do not fit the point record", file);
  h.record_length = static_cast<std::uint16_t>(record_length);
}

void append_vlrs(const std::vector<LasVlr>& vlrs, const std::string& file, std::vector<std::uint8_t>& b) {
  for (const LasVlr& v : vlrs) {
    if (v.data.size() > std::numeric_limits<std::uint16_t>::max())
      throw core::Error("the record " + v.user_id + " " + std::to_string(v.record_id) + " is longer than 65535 bytes", file,
                        "give it as an extended record");
    const std::size_t at = b.size();
    b.resize(at + vlr_head + v.data.size());
    put_text(&b[at + 2], 16, v.user_id);
    put(&b[at + 18], v.record_id);
    put(&b[at + 20], static_cast<std::uint16_t>(v.data.size()));
    put_text(&b[at + 22], 32, v.description);
    std::copy(v.data.begin(), v.data.end(), b.begin() + static_cast<std::ptrdiff_t>(at + vlr_head));
  }
}

}  // namespace

std::vector<std::uint8_t> las_header_bytes(LasHeader& h, std::uint64_t evlr_start, const std::string& file) {
  set_record_length(h, file);
  std::vector<LasVlr> vlrs = with_extras(h.vlrs, h.extras);
  if (h.compressed) vlrs.push_back({"laszip encoded", 22204, "LASzip record", h.laszip, 0, 0});
  const std::size_t head = header_size(h.version_minor);
  std::vector<std::uint8_t> b(head);
  append_vlrs(vlrs, file, b);
  if (h.version_minor == 0) b.insert(b.end(), {0xDD, 0xCC});  // point data start signature of LAS 1.0
  h.offset_to_points = static_cast<std::uint32_t>(b.size());

  const bool legacy = h.point_format < 6 && h.point_count <= std::numeric_limits<std::uint32_t>::max();
  h.legacy_point_count = legacy ? static_cast<std::uint32_t>(h.point_count) : 0;
  for (std::size_t i = 0; i < 5; ++i) h.legacy_by_return[i] = legacy ? static_cast<std::uint32_t>(h.by_return[i]) : 0;
  std::memcpy(b.data(), "LASF", 4);
  put(&b[4], h.file_source_id);
  if (h.version_minor >= 1) put(&b[6], h.global_encoding);
  std::copy(h.guid.begin(), h.guid.end(), &b[8]);
  b[24] = static_cast<std::uint8_t>(h.version_major);
  b[25] = static_cast<std::uint8_t>(h.version_minor);
  put_text(&b[26], 32, h.system_identifier);
  put_text(&b[58], 32, h.generating_software);
  put(&b[90], h.creation_day);
  put(&b[92], h.creation_year);
  put(&b[94], static_cast<std::uint16_t>(head));
  put(&b[96], h.offset_to_points);
  put(&b[100], static_cast<std::uint32_t>(vlrs.size()));
  b[104] = static_cast<std::uint8_t>(h.point_format | (h.compressed ? 0x80 : 0));
  put(&b[105], h.record_length);
  put(&b[107], h.legacy_point_count);
  for (std::size_t i = 0; i < 5; ++i) put(&b[111 + 4 * i], h.legacy_by_return[i]);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    put(&b[131 + 8 * k], h.scale[i]);
    put(&b[155 + 8 * k], h.offset[i]);
    put(&b[179 + 16 * k], h.max[i]);
    put(&b[187 + 16 * k], h.min[i]);
  }
  if (h.version_minor >= 3) put(&b[227], h.waveform_start);
  if (h.version_minor >= 4) {
    put(&b[235], h.evlrs.empty() ? std::uint64_t{0} : evlr_start);
    put(&b[243], static_cast<std::uint32_t>(h.evlrs.size()));
    put(&b[247], h.point_count);
    for (std::size_t i = 0; i < 15; ++i) put(&b[255 + 8 * i], h.by_return[i]);
  }
  return b;
}

std::vector<std::uint8_t> las_evlr_bytes(const LasHeader& h) {
  std::vector<std::uint8_t> b;
  for (const LasVlr& v : h.evlrs) {
    const std::size_t at = b.size();
    b.resize(at + evlr_head + v.data.size());
    put_text(&b[at + 2], 16, v.user_id);
    put(&b[at + 18], v.record_id);
    put(&b[at + 20], static_cast<std::uint64_t>(v.data.size()));
    put_text(&b[at + 28], 32, v.description);
    std::copy(v.data.begin(), v.data.end(), b.begin() + static_cast<std::ptrdiff_t>(at + evlr_head));
  }
  return b;
}

}  // namespace swath::io
