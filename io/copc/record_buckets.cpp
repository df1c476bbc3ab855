// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/record_buckets.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <unordered_map>

#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::io {

namespace {

constexpr int cube_shift = 3 * (octree::depth_bits - octree::cell_bits);
using Cubes = std::span<const std::pair<std::uint64_t, std::uint64_t>>;

std::vector<std::pair<std::uint64_t, std::uint64_t>> count_cubes(std::size_t length, const RecordStream& records, const CodeOf& code_of) {
  std::unordered_map<std::uint64_t, std::uint64_t> counts;
  records([&](std::span<const std::uint8_t> some) {
    for (std::size_t at = 0; at < some.size(); at += length) ++counts[code_of(&some[at]) >> cube_shift];
  });
  std::vector<std::pair<std::uint64_t, std::uint64_t>> cubes(counts.begin(), counts.end());
  std::sort(cubes.begin(), cubes.end());
  return cubes;
}

}  // namespace

RecordBuckets::RecordBuckets(const std::filesystem::path& folder, std::size_t record_length, std::uint64_t most, double memory,
                             const RecordStream& records, const CodeOf& code_of)
    : file_(folder / "records.tmp"), record_length_(record_length) {
  const auto cubes = count_cubes(record_length, records, code_of);
  choose({}, cubes, most);
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    buckets_[i].first = first;
    first += buckets_[i].points;
  }
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (descriptor_ < 0) throw_system_error("cannot write", file_, errno);
  try {
    distribute(memory, records, code_of);
  } catch (...) {  // without an object there is no destructor
    ::close(descriptor_);
    ::unlink(file_.c_str());
    throw;
  }
}

RecordBuckets::~RecordBuckets() {
  ::close(descriptor_);
  ::unlink(file_.c_str());
}

void RecordBuckets::choose(const OctreeKey& key, Cubes cubes, std::uint64_t most) {
  std::uint64_t points = 0;
  for (const auto& [code, n] : cubes) points += n;
  if (points == 0) return;
  if (points <= most || key.level == octree::cell_bits) {
    bucket_from_[cubes.front().first] = buckets_.size();
    buckets_.push_back({key, points, 0});
    return;
  }
  const int shift = 3 * (octree::cell_bits - key.level - 1);
  for (int octant = 0; octant < 8; ++octant) {
    const auto next =
        std::partition_point(cubes.begin(), cubes.end(), [&](const auto& c) { return static_cast<int>(c.first >> shift & 7u) <= octant; });
    const auto n = static_cast<std::size_t>(next - cubes.begin());
    choose(key.child(octant), cubes.first(n), most);
    cubes = cubes.subspan(n);
  }
}

void RecordBuckets::distribute(double memory, const RecordStream& records, const CodeOf& code_of) {
  if (buckets_.empty()) return;
  const auto share = static_cast<std::size_t>(memory / static_cast<double>(buckets_.size()) / static_cast<double>(record_length_));
  const std::size_t room = std::clamp<std::size_t>(share, 16, 1u << 14) * record_length_;
  std::vector<std::vector<std::uint8_t>> waiting(buckets_.size());
  std::vector<std::uint64_t> written(buckets_.size());
  const auto flush = [&](std::size_t b) {
    for (std::size_t done = 0; done < waiting[b].size();) {
      const auto at = static_cast<off_t>(buckets_[b].first * record_length_ + written[b]);
      const ssize_t n = ::pwrite(descriptor_, waiting[b].data() + done, waiting[b].size() - done, at);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) throw_system_error("cannot write", file_, n < 0 ? errno : ENOSPC);
      done += static_cast<std::size_t>(n);
      written[b] += static_cast<std::uint64_t>(n);
    }
    waiting[b].clear();
  };
  records([&](std::span<const std::uint8_t> some) {
    for (std::size_t at = 0; at < some.size(); at += record_length_) {
      const auto behind = bucket_from_.upper_bound(code_of(&some[at]) >> cube_shift);
      const std::size_t b = std::prev(behind)->second;
      if (waiting[b].empty()) waiting[b].reserve(room);
      waiting[b].insert(waiting[b].end(), &some[at], &some[at] + record_length_);
      if (waiting[b].size() >= room) flush(b);
    }
  });
  for (std::size_t b = 0; b < buckets_.size(); ++b) flush(b);
}

void RecordBuckets::read(const RecordBucket& bucket, std::vector<std::uint8_t>& records) const {
  records.resize(bucket.points * record_length_);
  for (std::size_t done = 0; done < records.size();) {
    const auto at = static_cast<off_t>(bucket.first * record_length_ + done);
    const ssize_t n = ::pread(descriptor_, records.data() + done, records.size() - done, at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw_system_error("cannot read", file_, n < 0 ? errno : EIO);
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace swath::io
