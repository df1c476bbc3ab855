// SPDX-License-Identifier: GPL-3.0-or-later
// Source: COPC Specification 1.0; ASPRS LAS Specification 1.4 R15.
// Deviation: none. The crate copc_converter is not used: it needs rustc 1.88 where Ubuntu 24.04 has 1.75, and LAS files of all points as
// input.
#include "io/copc/copc_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>

#include "core/config/units.h"
#include "core/error.h"
#include "io/copc/copc_hierarchy.h"
#include "io/las/las_bytes.h"
#include "io/laz/swath_laz.h"
#include "io/text/output_file.h"

namespace swath::io {

using las::get;

namespace {

constexpr std::size_t time_at = 22, returns_at = 14;  // in records of point formats 6 to 10
constexpr std::uint64_t largest_chunk = 1u << 30;     // bytes of its records, which readers may hold at once
constexpr double working_bytes = 64.0;                // per point of a bucket, beside its record
constexpr std::uint64_t most_at_once = 1u << 22;      // points: more make sorting slower, not better

double time_of(const std::uint8_t* record) { return get<double>(record + time_at); }

Eigen::Vector3d place_of(const std::uint8_t* record, const LasHeader& h) {
  const Eigen::Vector3d raw(get<std::int32_t>(record), get<std::int32_t>(record + 4), get<std::int32_t>(record + 8));
  return raw.cwiseProduct(h.scale) + h.offset;
}

/// A number that says nothing about place or time (the finalizer of SplitMix64).
std::uint64_t mixed(std::uint64_t v) {
  v = (v ^ v >> 30) * 0xbf58476d1ce4e5b9u;
  v = (v ^ v >> 27) * 0x94d049bb133111ebu;
  return v ^ v >> 31;
}
/// Of place and time alone: another class leaves the point on its level.
std::uint64_t priority_of(const std::uint8_t* record) {
  return mixed(mixed(get<std::uint64_t>(record)) ^ mixed(get<std::uint32_t>(record + 8)) ^ get<std::uint64_t>(record + time_at));
}

/// Counts, bounds and times of all records.
void look_through(const RecordStream& records, LasHeader& h, CopcInfo& info) {
  constexpr double none = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(none), high = -low;
  info.first_time = none, info.last_time = -none;
  h.point_count = 0;
  h.by_return = {};
  records([&](std::span<const std::uint8_t> some) {
    for (std::size_t at = 0; at < some.size(); at += h.record_length) {
      const std::uint8_t* r = &some[at];
      const Eigen::Vector3d place = place_of(r, h);
      low = low.cwiseMin(place), high = high.cwiseMax(place);
      info.first_time = std::min(info.first_time, time_of(r)), info.last_time = std::max(info.last_time, time_of(r));
      if (const int number = r[returns_at] & 15; number > 0) ++h.by_return[static_cast<std::size_t>(number - 1)];
    }
    h.point_count += some.size() / h.record_length;
  });
  if (h.point_count == 0) low.setZero(), high.setZero(), info.first_time = info.last_time = 0.0;
  h.min = low, h.max = high;
  info.cube = OctreeCube::around(low, high);
  info.spacing = info.cube.side() / (1 << octree::cell_bits);
}

struct CloseChunks {
  void operator()(swath_laz_writer* w) const { swath_laz_writer_close(w); }
};
struct CloseCopc {
  void operator()(std::FILE* f) const { std::fclose(f); }
};

/// The file: chunks as they come, then the pages.
class CopcFile {
 public:
  CopcFile(const std::filesystem::path& file, LasHeader& header, CopcInfo& info, unsigned threads, double memory)
      : file_(file), header_(header), info_(info), output_(file), batch_(static_cast<std::size_t>(std::clamp(memory, 4e6, 64e6))) {
    std::array<char, 512> message{};
    header.laszip.resize(256);
    std::size_t size = 0;
    check(swath_laz_vlr(static_cast<std::uint8_t>(header.point_format), static_cast<std::uint16_t>(header.extra_bytes()), 0,
                        header.laszip.data(), header.laszip.size(), &size, message.data(), message.size()),
          message);
    header.laszip.resize(size);
    out_.reset(std::fopen(output_.temporary().c_str(), "r+b"));
    if (!out_) throw_system_error("cannot write", file_, errno);
    put_header(0);
    swath_laz_writer* opened = nullptr;
    const int code = swath_laz_writer_open(output_.temporary().c_str(), header.offset_to_points, header.laszip.data(), header.laszip.size(),
                                           threads, &opened, message.data(), message.size());
    laz_.reset(opened);
    check(code, message);
  }

  /// A node of these records, in any order.
  void add(const OctreeKey& key, std::vector<const std::uint8_t*>& rows) {
    const std::size_t length = header_.record_length;
    if (rows.size() > largest_chunk / length)
      throw core::Error(std::to_string(rows.size()) + " points lie within " + core::format_number(info_.cube.of(key).side()) +
                            " of each other, more than a node of COPC can hold",
                        file_.string(), "thin the cloud, or repair points that lie at one place");
    std::sort(rows.begin(), rows.end(), [&](const std::uint8_t* a, const std::uint8_t* b) {
      const double s = time_of(a), t = time_of(b);
      return s < t || (!(t < s) && std::memcmp(a, b, length) < 0);
    });
    for (const std::uint8_t* r : rows) waiting_.insert(waiting_.end(), r, r + length);
    nodes_.push_back({key, 0, 0, static_cast<std::int32_t>(rows.size()), 0});
    if (waiting_.size() >= batch_) flush();
  }

  CopcWritten finish() {
    flush();
    std::array<char, 512> message{};
    std::uint64_t end = 0;
    check(swath_laz_writer_finish(laz_.get(), &end, message.data(), message.size()), message);
    laz_.reset();
    if (nodes_.empty()) nodes_.push_back({});
    LasVlr pages{"copc", 1000, "EPT hierarchy", copc_pages(nodes_, end + las_evlr_head, info_), 0, 0};
    header_.evlrs.insert(header_.evlrs.begin(), std::move(pages));
    header_.vlrs[0] = copc_info_record(info_);
    if (std::fseek(out_.get(), static_cast<long>(end), SEEK_SET)) throw_system_error("cannot write", file_, errno);
    put(las_evlr_bytes(header_));
    put_header(end);
    if (std::fclose(out_.release())) throw_system_error("cannot write", file_, errno);
    output_.commit();
    CopcWritten written{header_.point_count, 0, 0, info_.spacing};
    for (const CopcNode& n : nodes_) {
      written.nodes += n.points > 0;
      written.levels = std::max(written.levels, n.key.level + 1);
    }
    return written;
  }

 private:
  void check(int code, const std::array<char, 512>& message) const {
    if (code == SWATH_LAZ_OK) return;
    const std::string what = "cannot write compressed points: " + std::string(message.data());
    if (code == SWATH_LAZ_FILE) throw_write_error(what, file_);
    throw core::Error(what, file_.string());
  }
  void put(const std::vector<std::uint8_t>& bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), out_.get()) != bytes.size()) throw_system_error("cannot write", file_, errno);
  }
  void put_header(std::uint64_t evlr_start) {
    if (std::fseek(out_.get(), 0, SEEK_SET)) throw_system_error("cannot write", file_, errno);
    put(las_header_bytes(header_, evlr_start, file_.string()));
    if (std::fflush(out_.get())) throw_system_error("cannot write", file_, errno);
  }
  /// Compresses what waits, several nodes at once; a node without points has no chunk.
  void flush() {
    std::vector<std::size_t> which;
    std::vector<std::uint64_t> counts;
    for (; flushed_ < nodes_.size(); ++flushed_)
      if (nodes_[flushed_].points > 0) which.push_back(flushed_), counts.push_back(static_cast<std::uint64_t>(nodes_[flushed_].points));
    if (which.empty()) return;
    std::vector<std::uint64_t> offsets(which.size()), bytes(which.size());
    std::array<char, 512> message{};
    check(swath_laz_writer_write_chunks(laz_.get(), waiting_.data(), counts.data(), counts.size(), offsets.data(), bytes.data(),
                                        message.data(), message.size()),
          message);
    for (std::size_t i = 0; i < which.size(); ++i) {
      nodes_[which[i]].offset = offsets[i];
      nodes_[which[i]].bytes = static_cast<std::int32_t>(bytes[i]);
    }
    waiting_.clear();
  }

  std::filesystem::path file_;
  LasHeader& header_;
  CopcInfo& info_;
  OutputFile output_;
  std::unique_ptr<std::FILE, CloseCopc> out_;
  std::unique_ptr<swath_laz_writer, CloseChunks> laz_;
  std::size_t batch_, flushed_ = 0;
  std::vector<std::uint8_t> waiting_;  ///< records of the nodes from `flushed_` on
  std::vector<CopcNode> nodes_;
};

/// The nodes above the buckets, which get points from several: those that the present one is in.
class UpperNodes {
 public:
  UpperNodes(CopcFile& out, std::size_t length) : out_(out), length_(length) {}
  /// Writes the nodes that `next` is not in and begins those that it is.
  void move_to(const OctreeKey& next) {
    std::vector<OctreeKey> above(static_cast<std::size_t>(next.level));
    OctreeKey key = next;
    for (std::size_t i = above.size(); i-- > 0;) above[i] = key = key.parent();
    while (!open_.empty() && (open_.size() > above.size() || open_.back().key != above[open_.size() - 1])) close();
    while (open_.size() < above.size()) open_.push_back({above[open_.size()], {}});
  }
  void add(int level, const std::uint8_t* record) {
    std::vector<std::uint8_t>& to = open_[static_cast<std::size_t>(level)].records;
    to.insert(to.end(), record, record + length_);
  }
  void finish() {
    while (!open_.empty()) close();
  }

 private:
  struct Open {
    OctreeKey key;
    std::vector<std::uint8_t> records;
  };
  void close() {
    std::vector<const std::uint8_t*> rows;
    const Open& node = open_.back();
    for (std::size_t at = 0; at < node.records.size(); at += length_) rows.push_back(&node.records[at]);
    out_.add(node.key, rows);
    open_.pop_back();
  }

  CopcFile& out_;
  std::size_t length_;
  std::vector<Open> open_;
};

/// Adds the nodes of one bucket.
void add_bucket(const RecordBucket& bucket, const std::vector<std::uint8_t>& records, const LasHeader& h, const CodeOf& code_of,
                CopcFile& out, UpperNodes& above) {
  struct Place {
    std::uint64_t code, priority;
    std::uint32_t row;
  };
  const std::size_t length = h.record_length;
  std::vector<Place> places(bucket.points);
  for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = {code_of(&records[i * length]), priority_of(&records[i * length]), i};
  std::sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    if (a.code != b.code) return a.code < b.code;
    if (a.priority != b.priority) return a.priority < b.priority;
    return std::memcmp(&records[a.row * length], &records[b.row * length], length) < 0;
  });
  std::vector<std::uint64_t> codes(places.size()), priorities(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) codes[i] = places[i].code, priorities[i] = places[i].priority;
  const std::vector<std::uint8_t> levels = octree_levels(codes, priorities);
  const auto row = [&](std::size_t i) { return &records[places[i].row * length]; };
  above.move_to(bucket.key);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (levels[i] < bucket.key.level) above.add(levels[i], row(i));
  std::vector<const std::uint8_t*> rows;
  visit_octree(bucket.key, codes, levels, [&](const OctreeKey& key, const std::vector<std::uint32_t>& mine) {
    rows.clear();
    for (const std::uint32_t i : mine) rows.push_back(row(i));
    out.add(key, rows);
  });
}

/// The header as COPC wants it: its own record first, that of the CRS in front of the points.
void prepare(LasHeader& h, const std::filesystem::path& file) {
  if (h.point_format < 6 || h.point_format > 8)
    throw core::Error("COPC has no point format " + std::to_string(h.point_format), file.string(), "point formats 6, 7 and 8 are possible");
  h.version_minor = 4;
  h.compressed = true;
  h.waveform_start = 0;
  std::erase_if(h.vlrs, [](const LasVlr& v) { return v.user_id == "copc"; });
  std::erase_if(h.evlrs, [](const LasVlr& v) { return v.user_id == "copc"; });
  h.vlrs.insert(h.vlrs.begin(), copc_info_record({}));
  std::erase_if(h.evlrs, [&](LasVlr& v) {
    if (v.user_id != "LASF_Projection" || v.data.size() > std::numeric_limits<std::uint16_t>::max()) return false;
    h.vlrs.push_back(std::move(v));
    return true;
  });
  h.record_length = static_cast<std::uint16_t>(las_layout(h.point_format)->size + h.extra_bytes());
}

}  // namespace

CopcWritten write_copc(const std::filesystem::path& file, LasHeader header, const RecordStream& records, const CopcWriteOptions& options,
                       const core::OnProgress& progress) {
  constexpr double share_of_sorting = 0.3;  // of the time: reading three times, writing once
  prepare(header, file);
  CopcInfo info;
  progress(0.0, "bounds");
  look_through(records, header, info);
  progress(share_of_sorting / 3.0, "sorting");
  const CodeOf code_of = [&](const std::uint8_t* r) { return octree_code(info.cube, place_of(r, header)); };
  const double room = 0.5 * options.memory / (header.record_length + working_bytes);
  const auto most = std::clamp(static_cast<std::uint64_t>(room), octree::leaf_points, most_at_once);
  const RecordBuckets buckets(options.folder, header.record_length, most, options.memory / 4.0, records, code_of);

  CopcFile out(file, header, info, options.threads, options.memory / 8.0);
  UpperNodes above(out, header.record_length);
  std::vector<std::uint8_t> some;
  std::uint64_t done = 0;
  for (const RecordBucket& b : buckets.buckets()) {
    progress(share_of_sorting + (1.0 - share_of_sorting) * static_cast<double>(done) / static_cast<double>(header.point_count), "nodes");
    buckets.read(b, some);
    add_bucket(b, some, header, code_of, out, above);
    done += b.points;
  }
  above.finish();
  return out.finish();
}

}  // namespace swath::io
