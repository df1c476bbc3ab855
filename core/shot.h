// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace swath::core {

/// Raw laser records of one flight line, in the order they were recorded; one entry per return, the returns of a
/// pulse adjacent. Frame `scanner`. The beam of a record is
///   mirror:  (forward, w sin a', w cos a'),  w = sqrt(1 - forward^2),  a' = s_a a + a0
/// (other scanner models make their own vector from `angle`; see core/records/sensor.h).
struct Shots {
  std::vector<double> time;     ///< GPS time of the record, s, before latency
  std::vector<double> angle;    ///< scan angle (or encoder angle of a conical scanner), rad, as recorded
  std::vector<double> forward;  ///< x component of the unit beam vector; empty = 0 everywhere
  std::vector<double> range;    ///< m, as recorded
  std::vector<std::uint16_t> intensity;
  std::vector<std::uint8_t> return_number;  ///< from 1; 0 unknown
  std::vector<std::uint8_t> return_count;   ///< 0 unknown
  std::vector<std::uint16_t> flags;         ///< core::flag bits of the record
  std::vector<std::uint32_t> record;        ///< row in the file, from 0

  size_t size() const { return time.size(); }
  void clear();
};

/// The one list of the columns: calls f(column of a, column of b) for each pair of like columns.
template <class A, class B, class F>
void for_each_column(A& a, B& b, F&& f) {
  f(a.time, b.time);
  f(a.angle, b.angle);
  f(a.forward, b.forward);
  f(a.range, b.range);
  f(a.intensity, b.intensity);
  f(a.return_number, b.return_number);
  f(a.return_count, b.return_count);
  f(a.flags, b.flags);
  f(a.record, b.record);
}

inline void Shots::clear() {
  for_each_column(*this, *this, [](auto& c, auto&) { c.clear(); });
}

}  // namespace swath::core
