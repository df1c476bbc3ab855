// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS 1.4 R15; compressed points through the LASzip streams of io/laz.
#include "io/las/las_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>

#include "core/error.h"
#include "io/las/las_source.h"
#include "io/laz/swath_laz.h"
#include "io/text/output_file.h"

namespace swath::io {

namespace {

struct CloseLaz {
  void operator()(swath_laz_reader* r) const { swath_laz_reader_close(r); }
};

}  // namespace

struct LasReader::State {
  std::filesystem::path file;
  LasHeader header;
  std::vector<std::string> warnings;
  std::ifstream in;
  std::unique_ptr<swath_laz_reader, CloseLaz> laz;
  std::uint64_t position = 0;
  LasBox box;
  LasTimesRead times_read;
  LasTimeCheck times;
  std::vector<std::uint8_t> records;
  LasPoints points;
  bool ended = false;

  void laz_check(int code, const std::array<char, 512>& message, std::uint64_t byte) const {
    if (code == SWATH_LAZ_OK) return;
    const std::string place = code == SWATH_LAZ_DATA || code == SWATH_LAZ_PANIC
                                  ? ": point data from byte " + std::to_string(byte) + ", points " + std::to_string(position) + " and on"
                                  : "";
    throw core::Error("compressed points cannot be read: " + std::string(message.data()), file.string() + place,
                      "the file is truncated or damaged: fetch or export it again");
  }

  void open(unsigned threads) {
    if (!header.compressed) {
      in.open(file, std::ios::binary);
      in.seekg(header.offset_to_points);
      if (!in) throw_system_error("cannot read", file, errno);
      return;
    }
    std::array<char, 512> message{};
    swath_laz_reader* opened = nullptr;
    const int code = swath_laz_reader_open(file.c_str(), header.offset_to_points, header.laszip.data(), header.laszip.size(),
                                           static_cast<std::uint8_t>(header.point_format), header.record_length, header.point_count,
                                           threads, &opened, message.data(), message.size());
    laz.reset(opened);
    laz_check(code, message, header.offset_to_points);
  }

  void read_records(std::size_t n) {
    records.resize(n * header.record_length);
    if (laz) {
      std::array<char, 512> message{};
      laz_check(swath_laz_reader_read(laz.get(), records.data(), n, message.data(), message.size()), message, header.offset_to_points);
    } else if (!in.read(reinterpret_cast<char*>(records.data()), static_cast<std::streamsize>(records.size()))) {
      throw core::Error("the points are cut off", file.string() + ": point " + std::to_string(position),
                        "the file changed while it was read, or its disk fails");
    }
  }

  /// The next points into `points`.
  std::size_t next(std::size_t most) {
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(most, header.point_count - position));
    read_records(n);
    decode_las_points(records, header, points);
    box.add(points, header, position);
    times.add(points.gps_time);
    position += n;
    if (position == header.point_count && !ended) {
      ended = true;
      if (box.is_wrong()) warnings.push_back(box.fault());
    }
    return n;
  }
};

LasReader::LasReader(std::filesystem::path file, unsigned threads) : state_(std::make_unique<State>()) {
  state_->file = std::move(file);
  state_->header = read_las_header(state_->file, state_->warnings);
  state_->times_read.points = state_->header.point_count;
  state_->open(threads);
}
LasReader::~LasReader() = default;
LasReader::LasReader(LasReader&&) noexcept = default;
LasReader& LasReader::operator=(LasReader&&) noexcept = default;

const LasHeader& LasReader::header() const { return state_->header; }
LasCrs LasReader::crs() const { return las_crs(state_->header); }
const std::vector<std::string>& LasReader::warnings() const { return state_->warnings; }
const LasBox& LasReader::box() const { return state_->box; }
std::uint64_t LasReader::position() const { return state_->position; }

std::size_t LasReader::read(LasPoints& out, std::size_t most) {
  const std::size_t n = state_->next(most);
  std::swap(out, state_->points);
  return n;
}

std::size_t LasReader::read(core::Block& out, std::size_t most, const LasTime& time, std::uint32_t number) {
  const std::uint64_t first = state_->position;
  const std::size_t n = state_->next(most);
  las_points_to_block(state_->points, state_->header, first, time, state_->times_read, state_->file.string(), out);
  if (number > 0) keep_source(state_->records, state_->header.record_length, number, out.source);
  return n;
}

std::string LasReader::time_fault(core::TimeScale stated) const { return state_->times.fault(state_->header, stated); }

}  // namespace swath::io
