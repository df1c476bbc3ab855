// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), tables 7 to 16 and 24 to 25.
// Deviations: scan angles of a Block are rounded to 0.006 deg (1 deg in formats 0 to 5), coordinates to the nearest multiple of the
// scale, extra fields to the nearest multiple of theirs: half a step each. Angles beyond the field's range are cut to it.
#include "io/las_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "io/las_bytes.h"

namespace swath::io {

using las::get;
using las::put;

namespace {

constexpr double extended_angle_step = 0.006;  // deg, R15 2.5.5
constexpr double degree = std::numbers::pi / 180.0;
constexpr std::uint8_t legacy_overlap_class = 12;

/// Places of the optional parts in a record.
struct Places {
  std::size_t gps = 0, rgb = 0, nir = 0, wave = 0, extra = 0;
};

Places places_of(const LasLayout& l) {
  Places p;
  std::size_t at = l.extended ? 22 : 20;
  if (l.gps) p.gps = at, at += 8;
  if (l.rgb) p.rgb = at, at += 6;
  if (l.nir) p.nir = at, at += 2;
  if (l.wave) p.wave = at, at += 29;
  p.extra = at;
  return p;
}

[[noreturn]] void fail(const std::string& what, const std::string& where, std::size_t row, const std::string& hint) {
  throw core::Error(what, where + ": point " + std::to_string(row), hint);
}

/// A number of 1, 2, 4 or 8 bytes or a float, as the type says.
double number_at(const std::uint8_t* at, int type) {
  switch (type) {
    case 1:
      return get<std::uint8_t>(at);
    case 2:
      return get<std::int8_t>(at);
    case 3:
      return get<std::uint16_t>(at);
    case 4:
      return get<std::int16_t>(at);
    case 5:
      return get<std::uint32_t>(at);
    case 6:
      return get<std::int32_t>(at);
    case 7:
      return static_cast<double>(get<std::uint64_t>(at));
    case 8:
      return static_cast<double>(get<std::int64_t>(at));
    case 9:
      return static_cast<double>(get<float>(at));
    default:
      return get<double>(at);
  }
}

/// The same number as the bit pattern that a descriptor's nodata has.
std::uint64_t bits_at(const std::uint8_t* at, int type) {
  switch (type) {
    case 1:
      return get<std::uint8_t>(at);
    case 2:
      return las_integer_bits(get<std::int8_t>(at));
    case 3:
      return get<std::uint16_t>(at);
    case 4:
      return las_integer_bits(get<std::int16_t>(at));
    case 5:
      return get<std::uint32_t>(at);
    case 6:
      return las_integer_bits(get<std::int32_t>(at));
    case 9:
      return std::bit_cast<std::uint64_t>(static_cast<double>(get<float>(at)));
    default:
      return get<std::uint64_t>(at);
  }
}

template <class T>
bool put_whole(std::uint8_t* at, double v) {
  const double r = std::round(v);
  // The highest double below 2^64 or 2^63 is the bound of the widest types, whose own maximum is no double.
  constexpr double low = static_cast<double>(std::numeric_limits<T>::min()), high = static_cast<double>(std::numeric_limits<T>::max());
  if (!(r >= low && (sizeof(T) == 8 ? r < high : r <= high))) return false;
  put(at, static_cast<T>(r));
  return true;
}

bool put_number(std::uint8_t* at, int type, double v) {
  switch (type) {
    case 1:
      return put_whole<std::uint8_t>(at, v);
    case 2:
      return put_whole<std::int8_t>(at, v);
    case 3:
      return put_whole<std::uint16_t>(at, v);
    case 4:
      return put_whole<std::int16_t>(at, v);
    case 5:
      return put_whole<std::uint32_t>(at, v);
    case 6:
      return put_whole<std::int32_t>(at, v);
    case 7:
      return put_whole<std::uint64_t>(at, v);
    case 8:
      return put_whole<std::int64_t>(at, v);
    case 9:
      put(at, static_cast<float>(v));
      return true;
    default:
      put(at, v);
      return true;
  }
}

void put_bits(std::uint8_t* at, int type, int size, std::uint64_t bits) {
  if (type == 9)
    put(at, static_cast<float>(std::bit_cast<double>(bits)));
  else
    std::memcpy(at, &bits, static_cast<std::size_t>(size));
}

const LasExtra* field(const LasHeader& header, const std::string& name) {
  const auto it = std::find_if(header.extras.begin(), header.extras.end(), [&](const LasExtra& e) { return e.name == name; });
  return it == header.extras.end() ? nullptr : &*it;
}

int base_type(const LasExtra& e) { return (e.type - 1) % 10 + 1; }

/// The column's entry, 0 where the column is empty.
template <class T>
T at_or_zero(const std::vector<T>& column, std::size_t i) {
  return column.empty() ? T{} : column[i];
}

}  // namespace

void resize(LasPoints& p, const LasHeader& header, std::size_t n) {
  const LasLayout l = *las_layout(header.point_format);
  const auto set = [n](bool there, auto&... columns) { (columns.resize(there ? n : 0), ...); };
  set(true, p.raw_x, p.raw_y, p.raw_z, p.x, p.y, p.z, p.intensity, p.return_number, p.return_count, p.scan_direction, p.edge_of_line,
      p.classification, p.flags, p.raw_scan_angle, p.scan_angle, p.user_data, p.point_source_id);
  set(l.extended, p.channel);
  set(l.gps, p.gps_time);
  set(l.rgb, p.red, p.green, p.blue);
  set(l.nir, p.nir);
  set(l.wave, p.wave_descriptor, p.wave_offset, p.wave_size, p.wave_location, p.wave_dx, p.wave_dy, p.wave_dz);
  p.extra.resize(n * static_cast<std::size_t>(header.extra_bytes()));
}

void decode_las_points(std::span<const std::uint8_t> records, const LasHeader& header, LasPoints& p) {
  const LasLayout l = *las_layout(header.point_format);
  const Places at = places_of(l);
  const std::size_t n = records.size() / header.record_length, extra = static_cast<std::size_t>(header.extra_bytes());
  resize(p, header, n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t* b = records.data() + i * header.record_length;
    p.raw_x[i] = get<std::int32_t>(b);
    p.raw_y[i] = get<std::int32_t>(b + 4);
    p.raw_z[i] = get<std::int32_t>(b + 8);
    p.x[i] = p.raw_x[i] * header.scale.x() + header.offset.x();
    p.y[i] = p.raw_y[i] * header.scale.y() + header.offset.y();
    p.z[i] = p.raw_z[i] * header.scale.z() + header.offset.z();
    p.intensity[i] = get<std::uint16_t>(b + 12);
    if (l.extended) {
      p.return_number[i] = b[14] & 15;
      p.return_count[i] = b[14] >> 4;
      p.flags[i] = b[15] & 15;
      p.channel[i] = (b[15] >> 4) & 3;
      p.scan_direction[i] = (b[15] >> 6) & 1;
      p.edge_of_line[i] = b[15] >> 7;
      p.classification[i] = b[16];
      p.user_data[i] = b[17];
      p.raw_scan_angle[i] = get<std::int16_t>(b + 18);
      p.scan_angle[i] = static_cast<float>(p.raw_scan_angle[i] * extended_angle_step);
      p.point_source_id[i] = get<std::uint16_t>(b + 20);
    } else {
      p.return_number[i] = b[14] & 7;
      p.return_count[i] = (b[14] >> 3) & 7;
      p.scan_direction[i] = (b[14] >> 6) & 1;
      p.edge_of_line[i] = b[14] >> 7;
      p.classification[i] = b[15] & 31;
      p.flags[i] = b[15] >> 5;
      p.raw_scan_angle[i] = get<std::int8_t>(b + 16);
      p.scan_angle[i] = p.raw_scan_angle[i];
      p.user_data[i] = b[17];
      p.point_source_id[i] = get<std::uint16_t>(b + 18);
    }
    if (l.gps) p.gps_time[i] = get<double>(b + at.gps);
    if (l.rgb) {
      p.red[i] = get<std::uint16_t>(b + at.rgb);
      p.green[i] = get<std::uint16_t>(b + at.rgb + 2);
      p.blue[i] = get<std::uint16_t>(b + at.rgb + 4);
    }
    if (l.nir) p.nir[i] = get<std::uint16_t>(b + at.nir);
    if (l.wave) {
      const std::uint8_t* w = b + at.wave;
      p.wave_descriptor[i] = w[0];
      p.wave_offset[i] = get<std::uint64_t>(w + 1);
      p.wave_size[i] = get<std::uint32_t>(w + 9);
      p.wave_location[i] = get<float>(w + 13);
      p.wave_dx[i] = get<float>(w + 17);
      p.wave_dy[i] = get<float>(w + 21);
      p.wave_dz[i] = get<float>(w + 25);
    }
    if (extra > 0) std::memcpy(p.extra.data() + i * extra, b + at.extra, extra);
  }
}

void encode_las_points(const LasPoints& p, std::size_t begin, std::size_t end, const LasHeader& header, std::span<std::uint8_t> records,
                       const std::string& where) {
  const LasLayout l = *las_layout(header.point_format);
  const Places at = places_of(l);
  const std::size_t extra = static_cast<std::size_t>(header.extra_bytes());
  const unsigned most_returns = l.extended ? 15 : 7, most_class = l.extended ? 255 : 31;
  const std::string format = "point format " + std::to_string(l.format);
  for (std::size_t i = begin; i < end; ++i) {
    std::uint8_t* b = records.data() + (i - begin) * header.record_length;
    const unsigned number = at_or_zero(p.return_number, i), count = at_or_zero(p.return_count, i);
    const unsigned flags = at_or_zero(p.flags, i), cls = at_or_zero(p.classification, i), channel = at_or_zero(p.channel, i);
    const unsigned direction = at_or_zero(p.scan_direction, i) & 1u, edge = at_or_zero(p.edge_of_line, i) & 1u;
    const int angle = at_or_zero(p.raw_scan_angle, i);
    if (number > most_returns || count > most_returns)
      fail("return " + std::to_string(number) + " of " + std::to_string(count) + " does not fit " + format, where, i,
           "point formats 6 to 10 hold 15 returns, 0 to 5 hold 7");
    if (cls > most_class)
      fail("class " + std::to_string(cls) + " does not fit " + format, where, i, "point formats 6 to 10 hold 256 classes");
    if (flags > (l.extended ? 15u : 7u) || channel > (l.extended ? 3u : 0u))
      fail("overlap flag or scanner channel does not fit " + format, where, i, "point formats 6 to 10 have these fields");
    if (!l.extended && (angle < -128 || angle > 127))
      fail("scan angle of " + std::to_string(angle) + " deg does not fit " + format, where, i, "");
    put(b, p.raw_x[i]);
    put(b + 4, p.raw_y[i]);
    put(b + 8, p.raw_z[i]);
    put(b + 12, at_or_zero(p.intensity, i));
    if (l.extended) {
      b[14] = static_cast<std::uint8_t>(number | count << 4);
      b[15] = static_cast<std::uint8_t>(flags | channel << 4 | direction << 6 | edge << 7);
      b[16] = static_cast<std::uint8_t>(cls);
      b[17] = at_or_zero(p.user_data, i);
      put(b + 18, static_cast<std::int16_t>(angle));
      put(b + 20, at_or_zero(p.point_source_id, i));
    } else {
      b[14] = static_cast<std::uint8_t>(number | count << 3 | direction << 6 | edge << 7);
      b[15] = static_cast<std::uint8_t>(cls | flags << 5);
      b[16] = static_cast<std::uint8_t>(static_cast<std::int8_t>(angle));
      b[17] = at_or_zero(p.user_data, i);
      put(b + 18, at_or_zero(p.point_source_id, i));
    }
    if (l.gps) put(b + at.gps, at_or_zero(p.gps_time, i));
    if (l.rgb) {
      put(b + at.rgb, at_or_zero(p.red, i));
      put(b + at.rgb + 2, at_or_zero(p.green, i));
      put(b + at.rgb + 4, at_or_zero(p.blue, i));
    }
    if (l.nir) put(b + at.nir, at_or_zero(p.nir, i));
    if (l.wave) {
      std::uint8_t* w = b + at.wave;
      w[0] = at_or_zero(p.wave_descriptor, i);
      put(w + 1, at_or_zero(p.wave_offset, i));
      put(w + 9, at_or_zero(p.wave_size, i));
      put(w + 13, at_or_zero(p.wave_location, i));
      put(w + 17, at_or_zero(p.wave_dx, i));
      put(w + 21, at_or_zero(p.wave_dy, i));
      put(w + 25, at_or_zero(p.wave_dz, i));
    }
    if (p.extra.empty())
      std::memset(b + at.extra, 0, extra);
    else
      std::memcpy(b + at.extra, p.extra.data() + i * extra, extra);
  }
}

std::vector<double> las_extra_values(const LasPoints& p, const LasHeader& header, const std::string& name, int component) {
  const LasExtra* e = field(header, name);
  if (!e || e->type == 0 || component >= e->components()) return {};
  const int type = base_type(*e), size = e->size() / e->components();
  const auto c = static_cast<std::size_t>(component);
  const std::size_t stride = static_cast<std::size_t>(header.extra_bytes());
  const std::size_t place = static_cast<std::size_t>(*header.extra_offset(name) + component * size);
  const double scale = e->scale ? (*e->scale)[c] : 1.0, offset = e->offset ? (*e->offset)[c] : 0.0;
  std::vector<double> out(p.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint8_t* at = p.extra.data() + i * stride + place;
    out[i] =
        e->nodata && bits_at(at, type) == (*e->nodata)[c] ? std::numeric_limits<double>::quiet_NaN() : number_at(at, type) * scale + offset;
  }
  return out;
}

void set_las_extra_values(LasPoints& p, const LasHeader& header, const std::string& name, std::span<const double> values,
                          const std::string& where) {
  const LasExtra* e = field(header, name);
  if (!e || e->type == 0 || e->components() != 1) throw core::Error("no extra bytes field of numbers is named '" + name + "'", where);
  const std::size_t stride = static_cast<std::size_t>(header.extra_bytes());
  const std::size_t place = static_cast<std::size_t>(*header.extra_offset(name));
  const double scale = e->scale ? (*e->scale)[0] : 1.0, offset = e->offset ? (*e->offset)[0] : 0.0;
  p.extra.resize(p.size() * stride);
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::uint8_t* at = p.extra.data() + i * stride + place;
    if (std::isnan(values[i]) && e->nodata)
      put_bits(at, base_type(*e), e->size(), (*e->nodata)[0]);
    else if (!put_number(at, base_type(*e), (values[i] - offset) / scale) || (e->nodata && bits_at(at, base_type(*e)) == (*e->nodata)[0]))
      fail("'" + name + "' of " + std::to_string(values[i]) + " does not fit its extra bytes field", where, i, "");
  }
}

std::vector<LasExtra> las_extras_of(core::ColumnSet columns) {
  using core::Column;
  std::vector<LasExtra> out;
  const auto add = [&](Column c, const char* name, const char* description, std::uint8_t type, double step, std::uint64_t nodata) {
    if (!columns.has(c)) return;
    LasExtra e;
    e.name = name;
    e.description = description;
    e.type = type;
    e.nodata = {{nodata, 0, 0}};
    e.scale = {{step, 0.0, 0.0}};
    e.offset = {{0.0, 0.0, 0.0}};
    out.push_back(std::move(e));
  };
  constexpr auto no_u32 = std::uint64_t{std::numeric_limits<std::uint32_t>::max()};
  constexpr auto no_u16 = std::uint64_t{std::numeric_limits<std::uint16_t>::max()};
  constexpr auto no_i32 = las_integer_bits(std::numeric_limits<std::int32_t>::min());
  add(Column::range, las_name::range, "corrected range, m", 5, 0.001, no_u32);
  add(Column::incidence, las_name::incidence, "beam to terrain normal, deg", 3, 0.002, no_u16);
  add(Column::sigma_h, las_name::sigma_h, "horizontal standard deviation, m", 5, 0.0001, no_u32);
  add(Column::sigma_v, las_name::sigma_v, "vertical standard deviation, m", 5, 0.0001, no_u32);
  add(Column::height, las_name::height, "height above ground, m", 6, 0.001, no_i32);
  return out;
}

void las_points_to_block(const LasPoints& p, const LasHeader& header, std::uint64_t first, const LasTime& time, double first_time,
                         const std::string& where, core::Block& block) {
  const LasLayout l = *las_layout(header.point_format);
  const std::size_t n = p.size();
  const Eigen::Vector3d origin = block.origin, shift = header.offset - origin;
  block = core::Block{};
  block.origin = origin;
  using core::Column;
  core::resize(block, n);
  core::add_columns(block, {Column::time, Column::flags, Column::scan_angle, Column::record});
  for (std::size_t i = 0; i < n; ++i) {
    block.x[i] = p.raw_x[i] * header.scale.x() + shift.x();
    block.y[i] = p.raw_y[i] * header.scale.y() + shift.y();
    block.z[i] = p.raw_z[i] * header.scale.z() + shift.z();
  }
  if (l.gps && header.gps_time_is_adjusted()) {
    for (std::size_t i = 0; i < n; ++i) block.time[i] = p.gps_time[i] + core::adjusted_offset;
  } else if (l.gps && time.week) {
    constexpr double half_week = core::seconds_per_week / 2;
    for (std::size_t i = 0; i < n; ++i) {
      const double t = p.gps_time[i];
      if (!(t >= 0.0 && t <= core::seconds_per_week))
        fail("the time " + std::to_string(t) + " s is no second of a week", where, first + i,
             "the file's times are on another scale than its GPS time bit says");
      const double turn = t < first_time - half_week ? core::seconds_per_week : t > first_time + half_week ? -core::seconds_per_week : 0.0;
      block.time[i] = *time.week * core::seconds_per_week + t + turn;
    }
  } else if (l.gps && time.keep_seconds_of_week) {
    block.time = p.gps_time;
  } else if (l.gps && n > 0) {
    throw core::Error("times are seconds of a GPS week that the file does not name", where, "state the GPS week of the first point");
  }
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
    block.scan_angle[i] = static_cast<float>(p.raw_scan_angle[i] * (l.extended ? extended_angle_step : 1.0) * degree);
    block.record[i] = static_cast<std::uint32_t>(first + i);
  }
  const auto take = [&](const char* name, std::vector<float>& column, double unit) {
    const std::vector<double> values = las_extra_values(p, header, name);
    column.resize(values.size());
    std::transform(values.begin(), values.end(), column.begin(), [unit](double v) { return static_cast<float>(v * unit); });
  };
  take(las_name::range, block.range, 1.0);
  take(las_name::incidence, block.incidence, degree);
  take(las_name::sigma_h, block.sigma_h, 1.0);
  take(las_name::sigma_v, block.sigma_v, 1.0);
  take(las_name::height, block.height, 1.0);
}

void block_to_las_points(const core::Block& block, const LasHeader& header, std::uint64_t first, const std::string& where, LasPoints& p) {
  const LasLayout l = *las_layout(header.point_format);
  const std::size_t n = block.size();
  resize(p, header, n);
  const Eigen::Vector3d shift = block.origin - header.offset;
  const auto quantise = [&](const std::vector<double>& from, int axis, std::vector<std::int32_t>& to) {
    for (std::size_t i = 0; i < n; ++i) {
      const double raw = std::round((from[i] + shift[axis]) / header.scale[axis]);
      if (!(raw >= std::numeric_limits<std::int32_t>::min() && raw <= std::numeric_limits<std::int32_t>::max()))
        fail(std::string(1, "xyz"[axis]) + " = " + std::to_string(from[i] + block.origin[axis]) + " does not fit scale " +
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
  const double step = l.extended ? extended_angle_step : 1.0, most = l.extended ? 30000.0 : 90.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (l.gps && !block.time.empty())
      p.gps_time[i] = header.gps_time_is_adjusted()
                          ? block.time[i] - core::adjusted_offset
                          : block.time[i] - core::seconds_per_week * std::floor(block.time[i] / core::seconds_per_week);
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
  const auto give = [&](const char* name, const std::vector<float>& column, double unit) {
    if (column.empty() || !field(header, name)) return;
    std::vector<double> values(column.begin(), column.end());
    for (double& v : values) v *= unit;
    set_las_extra_values(p, header, name, values, where);
  };
  give(las_name::range, block.range, 1.0);
  give(las_name::incidence, block.incidence, 1.0 / degree);
  give(las_name::sigma_h, block.sigma_h, 1.0);
  give(las_name::sigma_v, block.sigma_v, 1.0);
  give(las_name::height, block.height, 1.0);
}

}  // namespace swath::io
