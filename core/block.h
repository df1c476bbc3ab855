// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

namespace swath::core {

/// The columns of a Block. x, y, z, time ... are always there; the rest may be empty.
enum class Column : std::uint8_t {
  x,
  y,
  z,
  time,
  intensity,
  return_number,
  return_count,
  classification,
  flags,
  scan_angle,
  strip,
  record,
  range,
  incidence,
  sigma_h,
  sigma_v,
  height,
  ground_probability,
  red,
  green,
  blue,
  user_data,
  source,
};
constexpr int column_count = 23;

/// A set of columns: what a stage needs, what it gives, what a store holds.
class ColumnSet {
 public:
  constexpr ColumnSet() = default;
  constexpr ColumnSet(std::initializer_list<Column> columns) {
    for (Column c : columns) add(c);
  }
  constexpr void add(Column c) { bits_ |= 1u << static_cast<unsigned>(c); }
  constexpr bool has(Column c) const { return (bits_ >> static_cast<unsigned>(c)) & 1u; }
  constexpr bool contains(ColumnSet o) const { return (bits_ & o.bits_) == o.bits_; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr ColumnSet operator|(ColumnSet o) const {
    ColumnSet r;
    r.bits_ = bits_ | o.bits_;
    return r;
  }
  constexpr ColumnSet operator-(ColumnSet o) const {
    ColumnSet r;
    r.bits_ = bits_ & ~o.bits_;
    return r;
  }
  constexpr bool operator==(const ColumnSet&) const = default;

 private:
  std::uint32_t bits_ = 0;
};

/// Bits of Block::flags. LAS bits keep their meaning (ASPRS LAS 1.4 R15); the high ones are ours.
namespace flag {
constexpr std::uint16_t synthetic = 1u << 0;
constexpr std::uint16_t key_point = 1u << 1;
constexpr std::uint16_t withheld = 1u << 2;
constexpr std::uint16_t overlap = 1u << 3;
constexpr std::uint16_t scan_direction = 1u << 4;  ///< mirror moving in the positive direction
constexpr std::uint16_t edge_of_line = 1u << 5;
constexpr std::uint16_t returns_repaired = 1u << 8;      ///< return number or count was repaired
constexpr std::uint16_t returns_inconsistent = 1u << 9;  ///< ... could not be repaired
constexpr std::uint16_t range_gate = 1u << 10;           ///< range outside the gate
constexpr std::uint16_t isolated = 1u << 11;             ///< noise filter: too few neighbours
constexpr std::uint16_t low_point = 1u << 12;            ///< noise filter: far below its neighbours
}  // namespace flag

/// ASPRS classes (LAS 1.4 R15, table 17).
namespace point_class {
constexpr std::uint8_t never_classified = 0, unassigned = 1, ground = 2, low_vegetation = 3, medium_vegetation = 4, high_vegetation = 5,
                       building = 6, low_noise = 7, water = 9, wire = 14, bridge_deck = 17, high_noise = 18;
}

/// A column of rows of bytes, all of one width. Rows of 0 are empty ones.
struct ByteRows {
  size_t width = 0;
  std::vector<std::uint8_t> bytes;

  bool empty() const { return bytes.empty(); }
  size_t size() const { return width > 0 ? bytes.size() / width : 0; }
  const std::uint8_t* row(size_t i) const { return bytes.data() + i * width; }
  std::uint8_t* row(size_t i) { return bytes.data() + i * width; }
  /// `n` rows of at least `least` bytes: narrower ones are filled up with 0, as are new rows.
  void resize(size_t n, size_t least);
  bool operator==(const ByteRows&) const = default;
};

/// Georeferenced returns as columns, one entry per return. Filters add or change columns and never remove rows.
struct Block {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< map frame, CRS units; x, y, z are relative to it
  std::vector<double> x, y, z;                       ///< map frame minus origin, CRS units (metres inside a run)
  std::vector<double> time;                          ///< GPS time, s (core/time.h)
  std::vector<std::uint16_t> intensity;              ///< as recorded
  std::vector<std::uint8_t> return_number;           ///< from 1; 0 unknown
  std::vector<std::uint8_t> return_count;            ///< of the pulse; 0 unknown
  std::vector<std::uint8_t> classification;          ///< point_class
  std::vector<std::uint16_t> flags;                  ///< flag
  std::vector<float> scan_angle;                     ///< rad, positive to starboard
  std::vector<std::uint16_t> strip;                  ///< flight line id (point source id)
  std::vector<std::uint32_t> record;                 ///< row in the strip's source, from 0
  std::vector<float> range;                          ///< m, corrected
  std::vector<float> incidence;                      ///< rad, between beam and the vertical (the ellipsoid's normal)
  std::vector<float> sigma_h, sigma_v;               ///< m, standard deviations (TPU): horizontal radial, vertical
  std::vector<float> height;                         ///< m above ground
  std::vector<float> ground_probability;             ///< 0 to 1: that the return is from the bare ground; NaN: not judged
  std::vector<std::uint16_t> red, green, blue;       ///< as recorded
  std::vector<std::uint8_t> user_data;               ///< as recorded
  ByteRows source;                                   ///< the point in the file it came from (io/las/las_source.h); where it came from one

  size_t size() const { return x.size(); }
};

/// The one list of a Block's columns: calls f(Column, name, pointer to member) for each but `source`, which is no column of numbers, in
/// the order of the enum.
template <class F>
void for_each_column(F&& f) {
  f(Column::x, "x", &Block::x);
  f(Column::y, "y", &Block::y);
  f(Column::z, "z", &Block::z);
  f(Column::time, "time", &Block::time);
  f(Column::intensity, "intensity", &Block::intensity);
  f(Column::return_number, "return_number", &Block::return_number);
  f(Column::return_count, "return_count", &Block::return_count);
  f(Column::classification, "classification", &Block::classification);
  f(Column::flags, "flags", &Block::flags);
  f(Column::scan_angle, "scan_angle", &Block::scan_angle);
  f(Column::strip, "strip", &Block::strip);
  f(Column::record, "record", &Block::record);
  f(Column::range, "range", &Block::range);
  f(Column::incidence, "incidence", &Block::incidence);
  f(Column::sigma_h, "sigma_h", &Block::sigma_h);
  f(Column::sigma_v, "sigma_v", &Block::sigma_v);
  f(Column::height, "height", &Block::height);
  f(Column::ground_probability, "ground_probability", &Block::ground_probability);
  f(Column::red, "red", &Block::red);
  f(Column::green, "green", &Block::green);
  f(Column::blue, "blue", &Block::blue);
  f(Column::user_data, "user_data", &Block::user_data);
}

std::string_view name_of(Column c);

/// The columns that hold one entry per point.
ColumnSet columns_of(const Block& b);

/// Gives every column of the set one entry per point (new entries 0).
void add_columns(Block& b, ColumnSet columns);

/// Changes the number of points; the columns that are there keep pace.
void resize(Block& b, size_t n);

/// Appends all points of `from` (same origin); a column that only one side has is filled with zeros on the other.
void append(Block& to, const Block& from);

/// Appends the points of `from` at `rows`, in that order; otherwise as append().
void append(Block& to, const Block& from, const std::vector<std::uint32_t>& rows);

/// The points at `rows`, in that order, all columns.
Block select(const Block& b, const std::vector<std::uint32_t>& rows);

/// True where the point takes part in filters and surfaces: neither withheld nor noise (classes 7, 18).
inline bool is_usable(const Block& b, size_t i) {
  if (!b.flags.empty() && (b.flags[i] & flag::withheld)) return false;
  if (b.classification.empty()) return true;
  return b.classification[i] != point_class::low_noise && b.classification[i] != point_class::high_noise;
}

/// True where it is the last return of its pulse (unknown numbers count as last).
inline bool is_last_return(const Block& b, size_t i) {
  return b.return_number.empty() || b.return_count.empty() || b.return_number[i] >= b.return_count[i];
}

}  // namespace swath::core
