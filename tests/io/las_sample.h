// SPDX-License-Identifier: GPL-3.0-or-later
// Made points with something in every field, for the tests of LAS files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <random>

#include "io/las/las_points.h"
#include "io/las/las_reader.h"
#include "io/las/las_writer.h"

namespace swath::test {

inline io::LasExtra extra_field(std::string name, std::uint8_t type) {
  io::LasExtra e;
  e.name = std::move(name);
  e.description = "made for a test";
  e.type = type;
  return e;
}

/// A header of the format in the lowest version that holds it, or 1.4; with extras of all types where asked.
inline io::LasHeader sample_header(int format, int minor = -1, bool extras = false) {
  io::LasHeader h;
  h.point_format = format;
  h.version_minor = minor >= 0 ? minor : format >= 6 ? 4 : format >= 4 ? 3 : 2;
  h.scale = {0.01, 0.001, 0.0025};
  h.offset = {500000.0, 5400000.0, -100.0};
  h.global_encoding = static_cast<std::uint16_t>(io::las_encoding::adjusted_gps_time | (format >= 6 ? io::las_encoding::wkt : 0));
  h.system_identifier = "test";
  h.generating_software = "swath tests";
  h.file_source_id = 7;
  if (extras) {
    for (std::uint8_t type = 1; type <= 10; ++type) h.extras.push_back(extra_field("type" + std::to_string(type), type));
    h.extras[3].scale = {{0.01, 0, 0}};
    h.extras[3].offset = {{5.0, 0, 0}};
    h.extras[3].nodata = {{io::las_integer_bits(-32768), 0, 0}};
    io::LasExtra raw = extra_field("bytes", 0);
    raw.bytes = 5;
    h.extras.push_back(raw);
  }
  return h;
}

inline io::LasPoints sample_points(const io::LasHeader& h, std::size_t n, unsigned seed = 1) {
  std::mt19937 random(seed);  // its sequence is fixed by the standard
  const auto below = [&](std::uint32_t m) { return static_cast<std::uint32_t>(random() % m); };
  const io::LasLayout l = *io::las_layout(h.point_format);
  io::LasPoints p;
  resize(p, h, n);
  const std::uint32_t returns = l.extended ? 15 : 7;
  for (std::size_t i = 0; i < n; ++i) {
    p.raw_x[i] = static_cast<std::int32_t>(i * 7 + below(1000)) - 50000;
    p.raw_y[i] = static_cast<std::int32_t>(below(2000000)) - 1000000;
    p.raw_z[i] = i % 977 == 0 ? static_cast<std::int32_t>(random()) : static_cast<std::int32_t>(below(500));
    p.x[i] = p.raw_x[i] * h.scale.x() + h.offset.x();
    p.y[i] = p.raw_y[i] * h.scale.y() + h.offset.y();
    p.z[i] = p.raw_z[i] * h.scale.z() + h.offset.z();
    p.intensity[i] = static_cast<std::uint16_t>(below(65536));
    p.return_count[i] = static_cast<std::uint8_t>(1 + below(returns));
    p.return_number[i] = static_cast<std::uint8_t>(1 + below(p.return_count[i]));
    p.scan_direction[i] = static_cast<std::uint8_t>(below(2));
    p.edge_of_line[i] = static_cast<std::uint8_t>(below(50) == 0);
    p.classification[i] = static_cast<std::uint8_t>(below(l.extended ? 256 : 32));
    p.flags[i] = static_cast<std::uint8_t>(below(l.extended ? 16 : 8));
    p.raw_scan_angle[i] =
        static_cast<std::int16_t>(l.extended ? static_cast<int>(below(60001)) - 30000 : static_cast<int>(below(181)) - 90);
    p.scan_angle[i] = static_cast<float>(p.raw_scan_angle[i] * (l.extended ? 0.006 : 1.0));
    p.user_data[i] = static_cast<std::uint8_t>(below(256));
    p.point_source_id[i] = static_cast<std::uint16_t>(1 + i / 1000);
    if (l.extended) p.channel[i] = static_cast<std::uint8_t>(below(4));
    if (l.gps) p.gps_time[i] = 3.0e8 + static_cast<double>(i) * 1e-5 + below(100) * 1e-7;
    if (l.rgb) {
      p.red[i] = static_cast<std::uint16_t>(below(65536));
      p.green[i] = static_cast<std::uint16_t>(below(65536));
      p.blue[i] = static_cast<std::uint16_t>(below(256) * 256);
    }
    if (l.nir) p.nir[i] = static_cast<std::uint16_t>(below(65536));
    if (l.wave) {
      p.wave_descriptor[i] = static_cast<std::uint8_t>(1 + below(3));
      p.wave_offset[i] = 60 + i * 256 + (i % 5 == 0 ? 0x500000000ull : 0ull);
      p.wave_size[i] = 256 + below(4) * 16;
      p.wave_location[i] = static_cast<float>(below(1000));
      p.wave_dx[i] = static_cast<float>(below(100)) * 1e-6f;
      p.wave_dy[i] = -p.wave_dx[i];
      p.wave_dz[i] = static_cast<float>(below(100)) * 1e-4f;
    }
  }
  for (std::uint8_t& b : p.extra) b = static_cast<std::uint8_t>(random());
  // Floats made of arbitrary bytes may be NaN, which never equals itself: numbers there.
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<double>(below(100000)) / 64.0 - 300.0;
  for (const io::LasExtra& e : h.extras)
    if (e.type == 9 || e.type == 10) set_las_extra_values(p, h, e.name, values, "sample");
  return p;
}

inline void write_sample(const std::filesystem::path& file, const io::LasHeader& h, const io::LasPoints& p, unsigned threads = 0) {
  io::LasRawWriter w(file, h, threads);
  w.write(p);
  w.finish();
}

inline io::LasPoints read_all(const std::filesystem::path& file, unsigned threads = 0) {
  io::LasReader r(file, threads);
  io::LasPoints p;
  r.read(p, static_cast<std::size_t>(r.header().point_count));
  return p;
}

}  // namespace swath::test
