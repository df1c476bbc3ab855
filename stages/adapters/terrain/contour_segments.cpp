// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/terrain/contour_segments.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>

#include "io/raster/grid_file.h"
#include "io/text/output_file.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using terrain::Segment;

constexpr size_t segments_per_byte = size_t{1} << 15;  ///< more than are packed into one

fs::path segment_file(const fs::path& folder, TileKey key) {
  return folder / (std::to_string(key.ix) + "_" + std::to_string(key.iy) + ".segments");
}

}  // namespace

void write_segments(const fs::path& folder, TileKey key, const std::vector<Segment>& segments) {
  const auto* rows = reinterpret_cast<const std::uint8_t*>(segments.data());
  const std::vector<std::uint8_t> fields = io::fields_of_rows(rows, segments.size(), sizeof(Segment));
  std::string out;
  for (size_t first = 0, end = 0; first < segments.size(); first = end) {
    while (end < segments.size() && segments[end].level == segments[first].level) ++end;
    std::string packed;
    io::pack_rows(rows + first * sizeof(Segment), end - first, sizeof(Segment), fields, packed);
    LevelSegments::Head head{segments[first].level, end - first, {}};
    std::memcpy(&head.packed, packed.data(), sizeof head.packed);
    out.append(reinterpret_cast<const char*>(&head), sizeof head).append(packed, sizeof head.packed);
  }
  io::write_text_file(segment_file(folder, key), out);
}

LevelSegments::LevelSegments(fs::path folder, const std::vector<TileKey>& tiles) : folder_(std::move(folder)) {
  for (const TileKey key : tiles) {
    const fs::path file = segment_file(folder_, key);
    std::error_code absent;
    const std::uint64_t size = fs::file_size(file, absent);
    if (absent) io::cut_short(file);
    std::ifstream in(file, std::ios::binary);
    for (std::uint64_t at = 0; at < size;) {
      Stretch s{key, at + sizeof(Head), {}};
      in.seekg(static_cast<std::streamoff>(at));
      if (!in.read(reinterpret_cast<char*>(&s.head), sizeof s.head)) io::cut_short(file);
      at = s.first_byte + s.head.packed.bytes;
      if (at > size || s.head.count / segments_per_byte > s.head.packed.bytes) io::cut_short(file);
      stretches_[s.head.level].push_back(s);
    }
  }
  next_ = stretches_.begin();
}

std::vector<size_t> LevelSegments::bytes() const {
  std::vector<size_t> out;
  for (const auto& [level, stretches] : stretches_) {
    out.push_back(0);
    for (const Stretch& s : stretches) out.back() += s.head.count * sizeof(Segment);
  }
  std::sort(out.begin(), out.end(), std::greater<>());
  return out;
}

std::vector<Segment> LevelSegments::next() {
  std::vector<Segment> segments;
  for (const Stretch& s : (next_++)->second) {
    const fs::path file = segment_file(folder_, s.key);
    std::ifstream in(file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(s.first_byte));
    std::string packed(s.head.packed.bytes, '\0');
    if (!in.read(packed.data(), static_cast<std::streamsize>(packed.size()))) io::cut_short(file);
    const size_t before = segments.size();
    segments.resize(before + s.head.count);
    if (!io::unpack(s.head.packed, packed.data(), segments.data() + before, s.head.count, sizeof(Segment))) io::cut_short(file);
  }
  return segments;
}

}  // namespace swath::stages
