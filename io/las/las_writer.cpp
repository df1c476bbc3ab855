// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS 1.4 R15; compressed points through the LASzip streams of io/laz.
// Deviation: none of the specification; chunks hold 50 000 points, the size that LASzip itself writes.
#include "io/las/las_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "io/laz/swath_laz.h"
#include "io/text/output_file.h"

namespace swath::io {

namespace {

constexpr std::uint32_t chunk_points = 50000;
constexpr std::size_t records_at_once = 1u << 16;

struct CloseLazWriter {
  void operator()(swath_laz_writer* w) const { swath_laz_writer_close(w); }
};
struct CloseFile {
  void operator()(std::FILE* f) const { std::fclose(f); }
};

bool ends_in_laz(const std::filesystem::path& file) {
  std::string e = file.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
  return e == ".laz";
}

}  // namespace

struct LasRawWriter::State {
  std::filesystem::path file;
  LasHeader header;
  OutputFile output;
  unsigned threads;
  std::unique_ptr<std::FILE, CloseFile> out;
  std::unique_ptr<swath_laz_writer, CloseLazWriter> laz;
  std::array<std::int32_t, 3> low{}, high{};
  std::vector<std::uint8_t> records;

  State(std::filesystem::path f, LasHeader h, unsigned n) : file(std::move(f)), header(std::move(h)), output(file), threads(n) {}

  void put(const std::vector<std::uint8_t>& bytes) {
    if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), out.get()) != bytes.size())
      throw_system_error("cannot write", file, errno);
  }

  void laz_check(int code, const std::array<char, 512>& message) const {
    if (code == SWATH_LAZ_OK) return;
    const std::string what = "cannot write compressed points: " + std::string(message.data());
    if (code == SWATH_LAZ_FILE) throw_write_error(what, file);
    throw core::Error(what, file.string());
  }

  void open() {
    header.point_count = 0;
    header.by_return = {};
    header.min.setZero();
    header.max.setZero();
    header.compressed = ends_in_laz(file);
    std::array<char, 512> message{};
    if (header.compressed) {
      if (!las_layout(header.point_format)) las_header_bytes(header, 0, file.string());
      header.laszip.resize(256);
      std::size_t size = 0;
      laz_check(swath_laz_vlr(static_cast<std::uint8_t>(header.point_format), static_cast<std::uint16_t>(header.extra_bytes()),
                              chunk_points, header.laszip.data(), header.laszip.size(), &size, message.data(), message.size()),
                message);
      header.laszip.resize(size);
    }
    const std::vector<std::uint8_t> head = las_header_bytes(header, 0, file.string());
    out.reset(std::fopen(output.temporary().c_str(), "r+b"));
    if (!out) throw_system_error("cannot write", file, errno);
    put(head);
    if (header.compressed) {
      if (std::fflush(out.get())) throw_system_error("cannot write", file, errno);
      swath_laz_writer* opened = nullptr;
      const int code = swath_laz_writer_open(output.temporary().c_str(), header.offset_to_points, header.laszip.data(),
                                             header.laszip.size(), threads, &opened, message.data(), message.size());
      laz.reset(opened);
      laz_check(code, message);
    }
  }

  void count(const LasPoints& p) {
    const std::array<const std::vector<std::int32_t>*, 3> raw{&p.raw_x, &p.raw_y, &p.raw_z};
    for (std::size_t k = 0; k < 3 && p.size() > 0; ++k) {
      const auto [lowest, highest] = std::minmax_element(raw[k]->begin(), raw[k]->end());
      low[k] = header.point_count == 0 ? *lowest : std::min(low[k], *lowest);
      high[k] = header.point_count == 0 ? *highest : std::max(high[k], *highest);
    }
    header.point_count += p.size();
    const std::size_t bins = header.version_minor >= 4 ? 15 : 5;
    for (const std::uint8_t number : p.return_number)
      if (number >= 1 && number <= bins) ++header.by_return[number - 1u];
    if (header.point_count == 0) return;
    for (int k = 0; k < 3; ++k) {  // a negative scale turns the bounds around
      const double a = low[static_cast<std::size_t>(k)] * header.scale[k] + header.offset[k];
      const double b = high[static_cast<std::size_t>(k)] * header.scale[k] + header.offset[k];
      header.min[k] = std::min(a, b);
      header.max[k] = std::max(a, b);
    }
  }
};

LasRawWriter::LasRawWriter(std::filesystem::path file, LasHeader header, unsigned threads)
    : state_(std::make_unique<State>(std::move(file), std::move(header), threads)) {
  state_->open();
}
LasRawWriter::~LasRawWriter() = default;
LasRawWriter::LasRawWriter(LasRawWriter&&) noexcept = default;
LasRawWriter& LasRawWriter::operator=(LasRawWriter&&) noexcept = default;

const LasHeader& LasRawWriter::header() const { return state_->header; }

void LasRawWriter::write(const LasPoints& points) {
  State& s = *state_;
  const std::string where = s.file.string() + ": from point " + std::to_string(s.header.point_count);
  for (std::size_t begin = 0; begin < points.size(); begin += records_at_once) {
    const std::size_t end = std::min(points.size(), begin + records_at_once);
    s.records.resize((end - begin) * s.header.record_length);
    encode_las_points(points, begin, end, s.header, s.records, where);
    if (s.laz) {
      std::array<char, 512> message{};
      s.laz_check(swath_laz_writer_write(s.laz.get(), s.records.data(), end - begin, message.data(), message.size()), message);
    } else {
      s.put(s.records);
    }
  }
  s.count(points);
}

void LasRawWriter::finish() {
  State& s = *state_;
  std::uint64_t evlr_start = s.header.offset_to_points + s.header.point_count * s.header.record_length;
  if (s.laz) {
    std::array<char, 512> message{};
    s.laz_check(swath_laz_writer_finish(s.laz.get(), &evlr_start, message.data(), message.size()), message);
    s.laz.reset();
  }
  if (std::fseek(s.out.get(), static_cast<long>(evlr_start), SEEK_SET)) throw_system_error("cannot write", s.file, errno);
  s.put(las_evlr_bytes(s.header));
  s.header.waveform_start = 0;
  for (std::uint64_t at = evlr_start; const LasVlr& v : s.header.evlrs) {
    if (v.user_id == "LASF_Spec" && v.record_id == 65535) s.header.waveform_start = at;
    at += las_evlr_head + v.data.size();
  }
  const std::vector<std::uint8_t> head = las_header_bytes(s.header, evlr_start, s.file.string());
  if (std::fseek(s.out.get(), 0, SEEK_SET)) throw_system_error("cannot write", s.file, errno);
  s.put(head);
  if (std::fclose(s.out.release())) throw_system_error("cannot write", s.file, errno);
  s.output.commit();
}

struct LasWriter::State {
  std::filesystem::path file;
  LasWriteOptions options;
  std::optional<LasRawWriter> raw;
  core::ColumnSet extras, carried;
  std::optional<core::ColumnSet> unchanged;  ///< of the blocks looked at
  bool has_sources = false;
  std::uint64_t overlap_lost = 0;
  LasPoints points;

  static core::ColumnSet extra_columns(const core::Block& b) {
    using core::Column;
    const core::ColumnSet there = core::columns_of(b);
    core::ColumnSet out;
    for_each_extra_column([&](Column c, const char*, auto) {
      if (there.has(c)) out.add(c);
    });
    return out;
  }

  /// The first block decides format, offset and extra bytes.
  void open(const core::Block& first) {
    extras = extra_columns(first);
    has_sources = options.sources && !first.source.empty();
    raw.emplace(file, has_sources ? header_of_sources(first) : own_header(first), options.threads);
  }

  /// The sources' header, with the extra fields that the block's columns need besides; columns that are as read keep their fields.
  LasHeader header_of_sources(const core::Block& first) {
    LasHeader h = options.header;
    carried = unchanged.value_or(options.sources->unchanged(first));
    core::ColumnSet added = extras;
    for_each_extra_column([&](core::Column c, const char* name, auto) {
      for (LasExtra& e : h.extras) {
        if (e.name != name || !added.has(c)) continue;
        if (!carried.has(c)) e = las_extras_of({c}).front(), h.version_minor = 4;
        added = added - core::ColumnSet{c};
      }
    });
    carried = carried - added;
    for (LasExtra& e : las_extras_of(options.extra_bytes ? added : core::ColumnSet{})) {
      h.extras.push_back(std::move(e));
      h.version_minor = 4;
    }
    return h;
  }

  LasHeader own_header(const core::Block& first) const {
    constexpr double offset_step = 1e5;  // with 0.001 the 32 bits reach 2147 km to either side
    LasHeader h;
    h.version_minor = options.version_minor;
    h.point_format = options.format.value_or(first.red.empty() ? 6 : 7);
    h.file_source_id = options.file_source_id;
    if (!options.times_as_they_are && las_layout(h.point_format) && las_layout(h.point_format)->gps)
      h.global_encoding |= las_encoding::adjusted_gps_time;
    if (h.point_format >= 6) h.global_encoding |= las_encoding::wkt;
    h.system_identifier = options.system_identifier;
    h.generating_software = options.generating_software;
    h.creation_day = options.creation_day;
    h.creation_year = options.creation_year;
    h.guid = options.guid;
    h.scale = options.scale;
    for (int k = 0; k < 3; ++k)
      if (!(std::isfinite(h.scale[k]) && h.scale[k] > 0.0))
        throw core::Error("the scale of " + std::string(1, "xyz"[k]) + " must be above 0", file.string());
    if (options.offset)
      h.offset = *options.offset;
    else if (first.size() > 0)
      h.offset = {std::round((first.x[0] + first.origin.x()) / offset_step) * offset_step,
                  std::round((first.y[0] + first.origin.y()) / offset_step) * offset_step, 0.0};
    if (!h.offset.allFinite()) throw core::Error("the offset is not finite", file.string(), "the first point's coordinates are not finite");
    add_las_wkt(h, options.crs_wkt);
    if (options.extra_bytes) h.extras = las_extras_of(extras);
    return h;
  }
};

LasWriter::LasWriter(std::filesystem::path file, LasWriteOptions options) : state_(std::make_unique<State>()) {
  state_->file = std::move(file);
  state_->options = std::move(options);
}
LasWriter::~LasWriter() = default;
LasWriter::LasWriter(LasWriter&&) noexcept = default;
LasWriter& LasWriter::operator=(LasWriter&&) noexcept = default;

void LasWriter::look_at(const core::Block& block) {
  State& s = *state_;
  if (!s.options.sources || block.source.empty()) return;
  const core::ColumnSet here = s.options.sources->unchanged(block);
  s.unchanged = s.unchanged ? *s.unchanged - (*s.unchanged - here) : here;
}

void LasWriter::write(const core::Block& block) {
  State& s = *state_;
  if (block.size() == 0) return;
  if (!s.raw) s.open(block);
  if (s.options.extra_bytes && !(State::extra_columns(block) == s.extras))
    throw core::Error("a block has other columns than the first one", s.file.string() + ": from point " + std::to_string(count()));
  block_to_las_points(block, s.raw->header(), count(), s.file.string(), s.points, s.carried);
  if (s.has_sources) s.overlap_lost += s.options.sources->restore(block, s.raw->header(), s.carried, s.points);
  s.raw->write(s.points);
}

void LasWriter::finish() {
  if (!state_->raw) state_->open({});
  state_->raw->finish();
}

std::uint64_t LasWriter::overlap_lost() const { return state_->overlap_lost; }

std::uint64_t LasWriter::count() const { return state_->raw ? state_->raw->header().point_count : 0; }

}  // namespace swath::io
