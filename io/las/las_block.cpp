// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), tables 7 to 17.
// Deviations: scan angles of a Block are rounded to 0.006 deg (1 deg in formats 0 to 5), coordinates to the nearest multiple of the
// scale, heights above ground to 1/1024 m and probabilities to 1/16384: half a step each. Angles beyond the field's range are cut to it,
// NaN becomes 0.
#include "io/las/las_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"

namespace swath::io {

namespace {

constexpr double degree = std::numbers::pi / 180.0;
/// Floats end in zero bits, so that they compress.
double rounded(core::Column c, double v) {
  constexpr double per_metre = 1024.0, per_one = 16384.0;
  if (c == core::Column::height) return std::round(v * per_metre) / per_metre;
  return c == core::Column::ground_probability ? std::round(v * per_one) / per_one : v;
}

[[noreturn]] void fail_at(const std::string& what, const std::string& where, std::uint64_t row, const std::string& hint) {
  throw core::Error(what, where + ": point " + std::to_string(row), hint);
}

}  // namespace

std::vector<LasExtra> las_extras_of(core::ColumnSet columns) {
  using core::Column;
  std::vector<LasExtra> out;
  const auto add = [&](Column c, const char* name, const char* description, std::uint8_t type, std::optional<double> step,
                       std::optional<std::uint64_t> nodata) {
    if (!columns.has(c)) return;
    LasExtra e;
    e.name = name;
    e.description = description;
    e.type = type;
    if (nodata) e.nodata = {{*nodata, 0, 0}};
    if (step) e.scale = {{*step, 0.0, 0.0}}, e.offset = {{0.0, 0.0, 0.0}};
    out.push_back(std::move(e));
  };
  constexpr auto no_u32 = std::uint64_t{std::numeric_limits<std::uint32_t>::max()};
  constexpr auto no_u16 = std::uint64_t{std::numeric_limits<std::uint16_t>::max()};
  add(Column::range, las_name::range, "corrected range, m", 5, 0.001, no_u32);
  add(Column::incidence, las_name::incidence, "beam to the vertical, deg", 3, 0.002, no_u16);
  add(Column::sigma_h, las_name::sigma_h, "horizontal standard deviation, m", 5, 0.0001, no_u32);
  add(Column::sigma_v, las_name::sigma_v, "vertical standard deviation, m", 5, 0.0001, no_u32);
  add(Column::height, las_name::height, "height above ground, m", 9, {}, {});
  add(Column::ground_probability, las_name::ground_probability, "probability of bare ground", 9, {}, {});
  return out;
}

void las_points_to_block(const LasPoints& p, const LasHeader& header, std::uint64_t first, const LasTime& time, LasTimesRead& read,
                         const std::string& where, core::Block& block) {
  const LasLayout l = *las_layout(header.point_format);
  const std::size_t n = p.size();
  const Eigen::Vector3d origin = block.origin, shift = header.offset - origin;
  block = core::Block{};
  block.origin = origin;
  using core::Column;
  core::resize(block, n);
  core::add_columns(block, {Column::time, Column::flags, Column::scan_angle, Column::record});
  const bool has_angles = !p.raw_scan_angle.empty(), has_times = l.gps && !p.gps_time.empty();  // unless they were not read
  for (std::size_t i = 0; i < n; ++i) {
    block.x[i] = p.raw_x[i] * header.scale.x() + shift.x();
    block.y[i] = p.raw_y[i] * header.scale.y() + shift.y();
    block.z[i] = p.raw_z[i] * header.scale.z() + shift.z();
  }
  if (has_times) block.time = las_gps_times(p.gps_time, header, time, read, where, first);
  block.intensity = p.intensity;
  block.return_number = p.return_number;
  block.return_count = p.return_count;
  block.classification = p.classification;
  block.strip = p.point_source_id;
  block.user_data = p.user_data;
  block.red = p.red;
  block.green = p.green;
  block.blue = p.blue;
  for (std::size_t i = 0; i < n; ++i) {
    unsigned flags = p.flags[i];
    if (!l.extended && p.classification[i] == legacy_overlap_class) {
      flags |= core::flag::overlap;
      block.classification[i] = core::point_class::unassigned;
    }
    if (p.scan_direction[i]) flags |= core::flag::scan_direction;
    if (p.edge_of_line[i]) flags |= core::flag::edge_of_line;
    block.flags[i] = static_cast<std::uint16_t>(flags);
    if (has_angles) block.scan_angle[i] = static_cast<float>(p.raw_scan_angle[i] * (l.extended ? las_angle_step : 1.0) * degree);
    block.record[i] = static_cast<std::uint32_t>(first + i);
  }
  for_each_extra_column([&](Column c, const char* name, auto member) {
    const std::vector<double> values = las_extra_values(p, header, name);
    (block.*member).resize(values.size());
    std::transform(values.begin(), values.end(), (block.*member).begin(),
                   [c](double v) { return static_cast<float>(c == Column::incidence ? v * degree : v); });
  });
}

void block_to_las_points(const core::Block& block, const LasHeader& header, std::uint64_t first, const std::string& where, LasPoints& p,
                         core::ColumnSet carried) {
  const LasLayout l = *las_layout(header.point_format);
  const std::size_t n = block.size();
  resize(p, header, n);
  const Eigen::Vector3d shift = block.origin - header.offset;
  const auto quantise = [&](const std::vector<double>& from, int axis, std::vector<std::int32_t>& to) {
    for (std::size_t i = 0; i < n; ++i) {
      const double raw = std::round((from[i] + shift[axis]) / header.scale[axis]);
      if (!(raw >= std::numeric_limits<std::int32_t>::min() && raw <= std::numeric_limits<std::int32_t>::max()))
        fail_at(std::string(1, "xyz"[axis]) + " = " + std::to_string(from[i] + block.origin[axis]) + " does not fit scale " +
                    std::to_string(header.scale[axis]) + " and offset " + std::to_string(header.offset[axis]),
                where, first + i, "choose a coarser scale or an offset near the data");
      to[i] = static_cast<std::int32_t>(raw);
    }
  };
  quantise(block.x, 0, p.raw_x);
  quantise(block.y, 1, p.raw_y);
  quantise(block.z, 2, p.raw_z);
  const auto copy = [](const auto& from, auto& to) {
    if (!from.empty() && !to.empty()) to = from;
  };
  copy(block.intensity, p.intensity);
  copy(block.return_number, p.return_number);
  copy(block.return_count, p.return_count);
  copy(block.classification, p.classification);
  copy(block.strip, p.point_source_id);
  copy(block.user_data, p.user_data);
  copy(block.red, p.red);
  copy(block.green, p.green);
  copy(block.blue, p.blue);
  const double step = l.extended ? las_angle_step : 1.0, most = l.extended ? 30000.0 : 90.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (l.gps && !block.time.empty()) p.gps_time[i] = header.gps_time_is_adjusted() ? block.time[i] - core::adjusted_offset : block.time[i];
    if (!block.flags.empty()) {
      p.flags[i] = static_cast<std::uint8_t>(block.flags[i] & (l.extended ? 15 : 7));
      p.scan_direction[i] = (block.flags[i] & core::flag::scan_direction) != 0;
      p.edge_of_line[i] = (block.flags[i] & core::flag::edge_of_line) != 0;
      if (!l.extended && (block.flags[i] & core::flag::overlap) && p.classification[i] <= core::point_class::unassigned)
        p.classification[i] = legacy_overlap_class;
    }
    if (!block.scan_angle.empty()) {
      const double angle = std::round(static_cast<double>(block.scan_angle[i]) / degree / step);
      p.raw_scan_angle[i] = static_cast<std::int16_t>(std::isnan(angle) ? 0.0 : std::clamp(angle, -most, most));
    }
  }
  for_each_extra_column([&](core::Column c, const char* name, auto member) {
    const std::vector<float>& column = block.*member;
    if (column.empty() || carried.has(c) || !header.extra_offset(name)) return;
    std::vector<double> values(column.begin(), column.end());
    for (double& v : values) v = rounded(c, c == core::Column::incidence ? v / degree : v);
    set_las_extra_values(p, header, name, values, where);
  });
}

}  // namespace swath::io
