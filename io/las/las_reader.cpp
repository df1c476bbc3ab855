// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS 1.4 R15; compressed points through the LASzip streams of io/laz.
#include "io/las/las_reader.h"

#include <algorithm>
#include <array>
#include <exception>

#include "core/error.h"
#include "io/las/las_source.h"
#include "io/laz/swath_laz.h"
#include "io/store/address.h"
#include "io/store/input_file.h"

namespace swath::io {

namespace {

/// Fields of compressed records that the columns are made of.
std::uint32_t fields_without(core::ColumnSet unused) {
  using core::Column;
  std::uint32_t fields = ~std::uint32_t{0};
  const auto leave = [&](std::uint32_t field, core::ColumnSet columns) {
    if (unused.contains(columns)) fields &= ~field;
  };
  if (!unused.has(Column::source)) return fields;  // the whole record
  leave(SWATH_LAZ_FIELD_INTENSITY, {Column::intensity});
  leave(SWATH_LAZ_FIELD_SCAN_ANGLE, {Column::scan_angle});
  leave(SWATH_LAZ_FIELD_USER_DATA, {Column::user_data});
  leave(SWATH_LAZ_FIELD_GPS_TIME, {Column::time});
  leave(SWATH_LAZ_FIELD_RGB, {Column::red, Column::green, Column::blue});
  leave(SWATH_LAZ_FIELD_EXTRA,
        {Column::range, Column::incidence, Column::sigma_h, Column::sigma_v, Column::height, Column::ground_probability});
  return fields & ~static_cast<std::uint32_t>(SWATH_LAZ_FIELD_NIR | SWATH_LAZ_FIELD_WAVES);
}

/// Empties the columns of the fields that hold no values of their points.
void clear_unread(std::uint32_t fields, LasPoints& p) {
  const auto without = [&](std::uint32_t field, auto&... columns) {
    if (!(fields & field)) (columns.clear(), ...);
  };
  without(SWATH_LAZ_FIELD_INTENSITY, p.intensity);
  without(SWATH_LAZ_FIELD_SCAN_ANGLE, p.raw_scan_angle, p.scan_angle);
  without(SWATH_LAZ_FIELD_USER_DATA, p.user_data);
  without(SWATH_LAZ_FIELD_GPS_TIME, p.gps_time);
  without(SWATH_LAZ_FIELD_RGB, p.red, p.green, p.blue);
  without(SWATH_LAZ_FIELD_NIR, p.nir);
  without(SWATH_LAZ_FIELD_WAVES, p.wave_descriptor, p.wave_offset, p.wave_size, p.wave_location, p.wave_dx, p.wave_dy, p.wave_dz);
  without(SWATH_LAZ_FIELD_EXTRA, p.extra);
}

/// Gives the LASzip streams the bytes of an object, and keeps why it could not.
struct LazBytes {
  explicit LazBytes(const std::filesystem::path& address) : in(address) {}
  static int read(void* self, std::uint64_t at, std::uint8_t* to, std::size_t n) {
    auto& bytes = *static_cast<LazBytes*>(self);
    try {
      return bytes.in.read_some(at, to, n) == n ? 0 : 1;
    } catch (...) {  // no exception may cross the border
      bytes.fault = std::current_exception();
      return 1;
    }
  }
  swath_laz_source source() { return {this, in.size(), &LazBytes::read}; }

  InputFile in;
  std::exception_ptr fault;
};

struct CloseLaz {
  void operator()(swath_laz_reader* r) const { swath_laz_reader_close(r); }
};

}  // namespace

struct LasReader::State {
  std::filesystem::path file;
  LasHeader header;
  std::vector<std::string> warnings;
  std::optional<InputFile> in;      ///< of records that are not compressed
  std::unique_ptr<LazBytes> bytes;  ///< of an object with compressed ones
  std::unique_ptr<swath_laz_reader, CloseLaz> laz;
  std::uint64_t position = 0;
  LasBox box;
  LasTimesRead times_read;
  LasTimeCheck times;
  std::vector<std::uint8_t> records;
  LasPoints points;
  bool ended = false;
  std::uint32_t fields = ~std::uint32_t{0};
  std::vector<LasChunk> runs;  ///< what is read: chunks that follow each other in the file are one
  std::size_t run = 0;         ///< that the next point is in
  std::uint64_t in_run = 0;    ///< points of it that have been read
  std::uint64_t total = 0;

  void laz_check(int code, const std::array<char, 512>& message, std::uint64_t byte) const {
    if (code == SWATH_LAZ_OK) return;
    if (bytes && bytes->fault) std::rethrow_exception(bytes->fault);
    const std::string place = code == SWATH_LAZ_DATA || code == SWATH_LAZ_PANIC
                                  ? ": point data from byte " + std::to_string(byte) + ", points " + std::to_string(position) + " and on"
                                  : "";
    throw core::Error("compressed points cannot be read: " + std::string(message.data()), file.string() + place,
                      "the file is truncated or damaged: fetch or export it again");
  }

  void choose(const LasPart& part) {
    if (!part.chunks) {
      runs.push_back({0, 0, header.point_count, 0});
    } else {
      for (const LasChunk& c : *part.chunks)
        if (!runs.empty() && runs.back().first_record + runs.back().points == c.first_record)
          runs.back().points += c.points;
        else
          runs.push_back(c);
    }
    for (const LasChunk& r : runs) total += r.points;
    times_read.points = total;
  }

  void open(const LasPart& part, unsigned threads) {
    if (!header.compressed) {
      in.emplace(file);
      return;
    }
    std::array<char, 512> message{};
    swath_laz_reader* opened = nullptr;
    const auto format = static_cast<std::uint8_t>(header.point_format);
    if (is_address(file)) bytes = std::make_unique<LazBytes>(file);
    const swath_laz_source source = bytes ? bytes->source() : swath_laz_source{};
    const swath_laz_source* from = bytes ? &source : nullptr;
    int code = 0;
    if (part.chunks) {
      std::vector<std::uint64_t> offsets, bytes, counts;
      for (const LasChunk& c : *part.chunks) offsets.push_back(c.offset), bytes.push_back(c.bytes), counts.push_back(c.points);
      code = swath_laz_reader_open_chunks(file.c_str(), from, header.laszip.data(), header.laszip.size(), format, header.record_length,
                                          offsets.data(), bytes.data(), counts.data(), offsets.size(), threads, &opened, message.data(),
                                          message.size());
    } else {
      code = swath_laz_reader_open(file.c_str(), from, header.offset_to_points, header.laszip.data(), header.laszip.size(), format,
                                   header.record_length, header.point_count, threads, &opened, message.data(), message.size());
    }
    laz.reset(opened);
    laz_check(code, message, header.offset_to_points);
    if (header.point_format < 6) return;  // one stream of whole records
    fields = fields_without(part.unused);
    swath_laz_reader_select(laz.get(), fields);
  }

  void read_records(std::size_t n) {
    records.resize(n * header.record_length);
    if (laz) {
      std::array<char, 512> message{};
      laz_check(swath_laz_reader_read(laz.get(), records.data(), n, message.data(), message.size()), message, header.offset_to_points);
    } else if (in->read_some(header.offset_to_points + record() * header.record_length, records.data(), records.size()) < records.size()) {
      throw core::Error("the points are cut off", file.string() + ": point " + std::to_string(position),
                        "the file changed while it was read, or its disk fails");
    }
  }

  /// Number in the file of the next point.
  std::uint64_t record() const { return run < runs.size() ? runs[run].first_record + in_run : header.point_count; }

  /// The next points into `points`: their numbers follow each other.
  std::size_t next(std::size_t most) {
    const std::uint64_t left = run < runs.size() ? runs[run].points - in_run : 0;
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(most, left));
    read_records(n);
    decode_las_points(records, header, points);
    clear_unread(fields, points);
    box.add(points, header, record());
    times.add(points.gps_time);
    position += n;
    in_run += n;
    if (run < runs.size() && in_run == runs[run].points) ++run, in_run = 0;
    if (position == total && !ended) {
      ended = true;
      if (box.is_wrong()) warnings.push_back(box.fault());
    }
    return n;
  }
};

LasReader::LasReader(std::filesystem::path file, unsigned threads, const LasPart& part) : state_(std::make_unique<State>()) {
  state_->file = std::move(file);
  state_->header = read_las_header(state_->file, state_->warnings);
  state_->choose(part);
  state_->open(part, threads);
}
LasReader::~LasReader() = default;
LasReader::LasReader(LasReader&&) noexcept = default;
LasReader& LasReader::operator=(LasReader&&) noexcept = default;

const LasHeader& LasReader::header() const { return state_->header; }
LasCrs LasReader::crs() const { return las_crs(state_->header); }
const std::vector<std::string>& LasReader::warnings() const { return state_->warnings; }
const LasBox& LasReader::box() const { return state_->box; }
std::uint64_t LasReader::position() const { return state_->position; }
std::uint64_t LasReader::count() const { return state_->total; }

std::size_t LasReader::read(LasPoints& out, std::size_t most) {
  const std::size_t n = state_->next(most);
  std::swap(out, state_->points);
  return n;
}

std::size_t LasReader::read(core::Block& out, std::size_t most, const LasTime& time, std::uint32_t number) {
  const std::uint64_t first = state_->record();
  const std::size_t n = state_->next(most);
  las_points_to_block(state_->points, state_->header, first, time, state_->times_read, state_->file.string(), out);
  if (number > 0) keep_source(state_->records, state_->header.record_length, number, out.source);
  return n;
}

std::string LasReader::time_fault(core::TimeScale stated) const { return state_->times.fault(state_->header, stated); }

}  // namespace swath::io
