// SPDX-License-Identifier: GPL-3.0-or-later
// Format: of each level {Head, packed segments}.
#include "stages/segment_file.h"

#include <cstring>
#include <fstream>

#include "stages/grid_tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using terrain::Segment;

constexpr size_t segments_per_byte = size_t{1} << 15;  // more than are packed into one

struct Head {
  std::int64_t level = 0;
  std::uint64_t count = 0;
  io::PackedHead packed;
};

fs::path segment_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "segments"); }

}  // namespace

void write_segments(const fs::path& folder, TileKey key, const std::vector<Segment>& segments) {
  const auto* rows = reinterpret_cast<const std::uint8_t*>(segments.data());
  const std::vector<std::uint8_t> fields = io::fields_of_rows(rows, segments.size(), sizeof(Segment));
  std::string out;
  for (size_t first = 0, end = 0; first < segments.size(); first = end) {
    while (end < segments.size() && segments[end].level == segments[first].level) ++end;
    std::string packed;
    io::pack_rows(rows + first * sizeof(Segment), end - first, sizeof(Segment), fields, packed);
    Head head{segments[first].level, end - first, {}};
    std::memcpy(&head.packed, packed.data(), sizeof head.packed);
    out.append(reinterpret_cast<const char*>(&head), sizeof head).append(packed, sizeof head.packed);
  }
  io::write_text_file(segment_file(folder, key), out);
}

void add_levels(const fs::path& folder, TileKey key, std::map<std::int64_t, std::vector<LevelSegments>>& levels) {
  const fs::path file = segment_file(folder, key);
  std::error_code absent;
  const std::uint64_t size = fs::file_size(file, absent);
  if (absent) io::cut_short(file);
  std::ifstream in(file, std::ios::binary);
  for (std::uint64_t at = 0; at < size;) {
    Head head;
    in.seekg(static_cast<std::streamoff>(at));
    if (!in.read(reinterpret_cast<char*>(&head), sizeof head)) io::cut_short(file);
    at += sizeof head;
    levels[head.level].push_back({file, at, head.count, head.packed});
    at += head.packed.bytes;
    if (at > size || head.count / segments_per_byte > head.packed.bytes) io::cut_short(file);
  }
}

void read_segments(const LevelSegments& from, std::vector<Segment>& segments) {
  std::ifstream in(from.file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(from.first_byte));
  std::string packed(from.packed.bytes, '\0');
  if (!in.read(packed.data(), static_cast<std::streamsize>(packed.size()))) io::cut_short(from.file);
  const size_t before = segments.size();
  segments.resize(before + from.count);
  if (!io::unpack(from.packed, packed.data(), segments.data() + before, from.count, sizeof(Segment))) io::cut_short(from.file);
}

}  // namespace swath::stages
