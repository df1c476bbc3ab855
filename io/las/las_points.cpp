// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), tables 7 to 16 and 24 to 25.
// Deviation: numbers of an extra field are rounded to the nearest multiple of its scale, half a step at most.
#include "io/las/las_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/las/las_bytes.h"

namespace swath::io {

using las::get;
using las::put;

namespace {

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
      p.scan_angle[i] = static_cast<float>(p.raw_scan_angle[i] * las_angle_step);
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

void decode_las_lines(std::span<const std::uint8_t> records, const LasHeader& header, std::vector<double>& gps_time,
                      std::vector<double>& point_source_id) {
  const LasLayout l = *las_layout(header.point_format);
  const std::size_t n = records.size() / header.record_length, time_at = places_of(l).gps, source_at = l.extended ? 20 : 18;
  gps_time.resize(n);
  point_source_id.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t* b = records.data() + i * header.record_length;
    gps_time[i] = get<double>(b + time_at);
    point_source_id[i] = get<std::uint16_t>(b + source_at);
  }
}

namespace {

void put_colours_and_waves(const LasPoints& p, std::size_t i, const LasLayout& l, const Places& at, std::uint8_t* b) {
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
}

}  // namespace

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
      fail("scan angle of " + std::to_string(angle) + " deg does not fit " + format, where, i,
           "are the angles in another unit than stated?");
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
    put_colours_and_waves(p, i, l, at, b);
    if (p.extra.empty())
      std::memset(b + at.extra, 0, extra);
    else
      std::memcpy(b + at.extra, p.extra.data() + i * extra, extra);
  }
}

std::vector<double> las_extra_values(const LasPoints& p, const LasHeader& header, const std::string& name, int component) {
  const LasExtra* e = field(header, name);
  if (!e || e->type == 0 || component >= e->components() || p.extra.empty()) return {};
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
      fail("'" + name + "' of " + std::to_string(values[i]) + " does not fit its extra bytes field", where, i,
           "the value is absurd: are the records damaged?");
  }
}

}  // namespace swath::io
