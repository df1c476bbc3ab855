// SPDX-License-Identifier: GPL-3.0-or-later
// Source: COPC Specification 1.0, "info VLR" and "hierarchy VLR".
// Deviation: none. All pages are in one extended record.
#include "io/copc/copc_hierarchy.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "io/las/las_bytes.h"
#include "io/store/input_file.h"
#include "io/text/output_file.h"

namespace swath::io {

using las::get;
using las::put;

namespace {

constexpr std::size_t info_bytes = 160, entry_bytes = 32;
constexpr int highest_level = 30;       // cubes along a side are counted in 32 bits
constexpr std::size_t one_page = 8192;  // entries
constexpr int page_levels = 4;
constexpr std::int32_t is_page = -1;

[[noreturn]] void broken(const std::string& what, const std::filesystem::path& file, std::uint64_t byte) {
  throw core::Error("the COPC hierarchy is broken: " + what, file.string() + ": byte " + std::to_string(byte),
                    "the file is damaged or its writer was stopped: fetch it again, or write it again from its points");
}

void put_entry(std::vector<std::uint8_t>& out, const OctreeKey& k, std::uint64_t offset, std::int32_t bytes, std::int32_t points) {
  out.resize(out.size() + entry_bytes);
  std::uint8_t* at = out.data() + out.size() - entry_bytes;
  put(at, k.level), put(at + 4, k.x), put(at + 8, k.y), put(at + 12, k.z);
  put(at + 16, offset), put(at + 24, bytes), put(at + 28, points);
}

/// Writes the page of a node and, before it, those below.
class PageWriter {
 public:
  PageWriter(const std::vector<CopcNode>& nodes, std::uint64_t place)
      : place_(place), levels_(nodes.size() > one_page ? page_levels : highest_level) {
    for (const CopcNode& n : nodes) nodes_.emplace(n.key, n);
  }
  /// Its place and size in the file.
  std::pair<std::uint64_t, std::uint64_t> page(const OctreeKey& top) {
    std::vector<std::uint8_t> entries;
    add(top, top.level + levels_, entries);
    const std::uint64_t at = place_ + bytes.size();
    bytes.insert(bytes.end(), entries.begin(), entries.end());
    return {at, entries.size()};
  }
  std::vector<std::uint8_t> bytes;

 private:
  void add(const OctreeKey& key, int deepest, std::vector<std::uint8_t>& entries) {
    const auto found = nodes_.find(key);
    if (found == nodes_.end()) return;
    if (key.level == deepest) {
      const auto [at, size] = page(key);
      return put_entry(entries, key, at, static_cast<std::int32_t>(size), is_page);
    }
    const CopcNode& n = found->second;
    put_entry(entries, key, n.offset, n.bytes, n.points);
    for (int octant = 0; octant < 8; ++octant) add(key.child(octant), deepest, entries);
  }

  std::uint64_t place_;
  int levels_;
  std::map<OctreeKey, CopcNode> nodes_;
};

class PageReader {
 public:
  PageReader(const std::filesystem::path& file, const LasHeader& header) : file_(file), header_(header), in_(file), size_(in_.size()) {}

  void read(std::uint64_t at, std::uint64_t size) {
    if (at < header_.offset_to_points || at > size_ || size > size_ - at || size == 0 || size % entry_bytes != 0)
      broken("a page of " + std::to_string(size) + " bytes at byte " + std::to_string(at) + " does not fit the file of " +
                 std::to_string(size_) + " bytes",
             file_, at);
    if (!pages_.insert(at).second) broken("a page is listed twice", file_, at);
    std::vector<std::uint8_t> page(size);
    if (in_.read_some(at, page.data(), size) < size) throw_system_error("cannot read", file_, EIO);
    for (std::size_t i = 0; i < size; i += entry_bytes) entry(&page[i], at + i);
  }

  std::vector<CopcNode> nodes() {
    std::set<OctreeKey> keys;
    for (const auto& [key, byte] : keys_) keys.insert(key);
    for (const auto& [key, byte] : keys_)
      if (key.level > 0 && !keys.contains(key.parent())) broken("the node " + key.text() + " has no parent", file_, byte);
    std::sort(nodes_.begin(), nodes_.end(), [](const CopcNode& a, const CopcNode& b) { return a.offset < b.offset; });
    std::uint64_t end = header_.offset_to_points + 8, points = 0;
    for (CopcNode& n : nodes_) {
      if (n.offset < end) broken("the node " + n.key.text() + " begins within another or before the points", file_, n.offset);
      end = n.offset + static_cast<std::uint64_t>(n.bytes);
      n.first_record = points;
      points += static_cast<std::uint64_t>(n.points);
    }
    if (points != header_.point_count)
      broken("its nodes hold " + std::to_string(points) + " points, the header says " + std::to_string(header_.point_count), file_,
             pages_.empty() ? 0 : *pages_.begin());
    return std::move(nodes_);
  }

 private:
  void entry(const std::uint8_t* at, std::uint64_t byte) {
    CopcNode n{{get<std::int32_t>(at), get<std::int32_t>(at + 4), get<std::int32_t>(at + 8), get<std::int32_t>(at + 12)},
               get<std::uint64_t>(at + 16),
               get<std::int32_t>(at + 24),
               get<std::int32_t>(at + 28)};
    const OctreeKey& k = n.key;
    if (k.level < 0 || k.level > highest_level || std::min({k.x, k.y, k.z}) < 0 || std::max({k.x, k.y, k.z}) >= 1 << k.level)
      broken("'" + k.text() + "' is not a node", file_, byte);
    if (n.points == is_page) return read(n.offset, static_cast<std::uint64_t>(std::max(n.bytes, 0)));
    if (!keys_.emplace(k, byte).second) broken("the node " + k.text() + " is listed twice", file_, byte);
    if (n.points == 0) return;
    if (n.points < 0 || n.bytes <= 0 || n.offset > size_ || static_cast<std::uint64_t>(n.bytes) > size_ - n.offset)
      broken("the node " + k.text() + " of " + std::to_string(n.points) + " points in " + std::to_string(n.bytes) + " bytes at byte " +
                 std::to_string(n.offset) + " does not fit the file of " + std::to_string(size_) + " bytes",
             file_, byte);
    nodes_.push_back(n);
  }

  std::filesystem::path file_;
  const LasHeader& header_;
  InputFile in_;
  std::uint64_t size_;
  std::set<std::uint64_t> pages_;
  std::map<OctreeKey, std::uint64_t> keys_;  ///< with the byte that lists them
  std::vector<CopcNode> nodes_;
};

}  // namespace

LasVlr copc_info_record(const CopcInfo& info) {
  LasVlr v{"copc", 1, "COPC info", std::vector<std::uint8_t>(info_bytes), 0, 0};
  std::uint8_t* at = v.data.data();
  for (int k = 0; k < 3; ++k) put(at + 8 * k, info.cube.centre[k]);
  put(at + 24, info.cube.half_side), put(at + 32, info.spacing);
  put(at + 40, info.page), put(at + 48, info.page_bytes);
  put(at + 56, info.first_time), put(at + 64, info.last_time);
  return v;
}

std::optional<CopcInfo> copc_info(const LasHeader& header, const std::filesystem::path& file) {
  if (header.vlrs.empty() || header.vlrs[0].user_id != "copc" || header.vlrs[0].record_id != 1) return std::nullopt;
  const LasVlr& v = header.vlrs[0];
  if (v.data.size() < info_bytes) broken("the info record has " + std::to_string(v.data.size()) + " of 160 bytes", file, v.offset);
  const std::uint8_t* at = v.data.data();
  CopcInfo info;
  for (int k = 0; k < 3; ++k) info.cube.centre[k] = get<double>(at + 8 * k);
  info.cube.half_side = get<double>(at + 24);
  info.spacing = get<double>(at + 32);
  info.page = get<std::uint64_t>(at + 40);
  info.page_bytes = get<std::uint64_t>(at + 48);
  info.first_time = get<double>(at + 56);
  info.last_time = get<double>(at + 64);
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  if (!info.cube.centre.allFinite() || !positive(info.cube.half_side) || !positive(info.spacing))
    broken("the info record has no cube or no spacing", file, v.offset);
  return info;
}

std::vector<std::uint8_t> copc_pages(const std::vector<CopcNode>& nodes, std::uint64_t place, CopcInfo& info) {
  PageWriter writer(nodes, place);
  std::tie(info.page, info.page_bytes) = writer.page({});
  return std::move(writer.bytes);
}

std::vector<CopcNode> read_copc_nodes(const std::filesystem::path& file, const LasHeader& header, const CopcInfo& info) {
  PageReader reader(file, header);
  reader.read(info.page, info.page_bytes);
  return reader.nodes();
}

}  // namespace swath::io
