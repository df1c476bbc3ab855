// SPDX-License-Identifier: GPL-3.0-or-later
// A cloud larger than memory, sorted into the cubes of an octree on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "io/copc/octree.h"

namespace swath::io {

/// Calls a function with all records of a cloud, some at a time; every call gives the same ones.
using RecordStream = std::function<void(const std::function<void(std::span<const std::uint8_t>)>&)>;
/// Place of a record on the octree's curve.
using CodeOf = std::function<std::uint64_t(const std::uint8_t*)>;

/// A cube with all of its points.
struct RecordBucket {
  OctreeKey key;                        ///< on level `octree::cell_bits` or above
  std::uint64_t points = 0, first = 0;  ///< number of its first record in the file
};

/// Goes through the records twice: counts them by cubes and writes those of one cube after the other into a file in `folder`, which goes
/// with this object. Cubes hold `most` points or fewer where those of level `octree::cell_bits` do; they come in the order of the curve.
class RecordBuckets {
 public:
  RecordBuckets(const std::filesystem::path& folder, std::size_t record_length, std::uint64_t most, double memory,
                const RecordStream& records, const CodeOf& code_of);
  ~RecordBuckets();
  RecordBuckets(const RecordBuckets&) = delete;
  RecordBuckets& operator=(const RecordBuckets&) = delete;

  const std::vector<RecordBucket>& buckets() const { return buckets_; }
  /// The records of one.
  void read(const RecordBucket& bucket, std::vector<std::uint8_t>& records) const;

 private:
  void choose(const OctreeKey& key, std::span<const std::pair<std::uint64_t, std::uint64_t>> cubes, std::uint64_t most);
  void distribute(double memory, const RecordStream& records, const CodeOf& code_of);

  std::filesystem::path file_;
  std::size_t record_length_;
  int descriptor_ = -1;
  std::vector<RecordBucket> buckets_;
  std::map<std::uint64_t, std::size_t> bucket_from_;  ///< first code of each bucket, shifted to level `octree::cell_bits`
};

}  // namespace swath::io
