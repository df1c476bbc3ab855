// SPDX-License-Identifier: GPL-3.0-or-later
// The least of the readers that tests with reference data need, so that calib's tests stand without io: SBET, NumPy records, LAS points.
#pragma once

#include <cstring>
#include <filesystem>
#include <string>

#include "core/geo/frames.h"
#include "core/records/trajectory_data.h"
#include "tests/world/support.h"

namespace swath::calib::test {

/// Fixed-size little-endian records after a header.
struct Records {
  std::string bytes;
  size_t first = 0, size = 1;
  size_t count() const { return (bytes.size() - first) / size; }
  template <class T>
  T get(size_t record, size_t offset) const {
    T v;
    std::memcpy(&v, bytes.data() + first + record * size + offset, sizeof v);
    return v;
  }
};

inline Records npy(const std::filesystem::path& file, size_t size) {
  Records r{swath::test::read_bytes(file), 0, size};
  std::uint16_t header = 0;
  std::memcpy(&header, r.bytes.data() + 8, 2);
  r.first = 10u + header;
  return r;
}

/// 17 doubles: time, latitude, longitude, height, 3 velocities, roll, pitch, platform heading, wander ...; true heading = platform -
/// wander.
inline core::TrajectoryData sbet(const std::filesystem::path& file) {
  const Records r{swath::test::read_bytes(file), 0, 136};
  core::TrajectoryData d;
  for (size_t i = 0; i < r.count(); ++i) {
    const auto field = [&](size_t k) { return r.get<double>(i, 8 * k); };
    d.time.push_back(field(0));
    d.latitude.push_back(field(1)), d.longitude.push_back(field(2)), d.height.push_back(field(3));
    d.roll.push_back(field(7)), d.pitch.push_back(field(8));
    d.heading.push_back(core::wrap_two_pi(field(9) - field(10)));
  }
  return d;
}

/// Points of a LAS 1.2 file of format 3.
struct Las {
  Records records;
  double scale[3], offset[3];
  double coordinate(size_t i, size_t axis) const { return scale[axis] * records.get<std::int32_t>(i, 4 * axis) + offset[axis]; }
  double time(size_t i) const { return records.get<double>(i, 20); }
};

inline Las las(const std::filesystem::path& file) {
  Las l;
  l.records.bytes = swath::test::read_bytes(file);
  const char* b = l.records.bytes.data();
  std::uint32_t first = 0;
  std::uint16_t size = 0;
  std::memcpy(&first, b + 96, 4);
  std::memcpy(&size, b + 105, 2);
  std::memcpy(l.scale, b + 131, 24);
  std::memcpy(l.offset, b + 155, 24);
  l.records.first = first;
  l.records.size = size;
  return l;
}

}  // namespace swath::calib::test
