// SPDX-License-Identifier: GPL-3.0-or-later
// For tests/io/laspy_check.py and copc_check.py:
//   las_samples write FOLDER       writes files of every point format and, beside each, its columns as bare arrays
//   las_samples copc FOLDER        writes COPC files of their point formats, with extra bytes as recorded and as floats, likewise
//   las_samples vpc FOLDER         writes two tiles and a virtual point cloud of them (vpc_check.py)
//   las_samples dump FILE FOLDER   writes the columns of a file as LasReader sees them
#include <cstdio>
#include <fstream>
#include <iostream>

#include "core/error.h"
#include "io/copc/tile_index.h"
#include "io/las/las_recode.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/io/las_sample.h"

namespace {

using namespace swath;

/// A column as FOLDER/NAME.TYPE, little-endian, TYPE as NumPy names it.
template <class T>
void dump(const std::filesystem::path& folder, const std::string& name, const std::string& type, const std::vector<T>& values) {
  std::ofstream out(folder / (name + "." + type), std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

void dump_columns(const std::filesystem::path& folder, const io::LasHeader& h, const io::LasPoints& p) {
  std::filesystem::create_directories(folder);
  const io::LasLayout l = *io::las_layout(h.point_format);
  dump(folder, "X", "i4", p.raw_x), dump(folder, "Y", "i4", p.raw_y), dump(folder, "Z", "i4", p.raw_z);
  dump(folder, "x", "f8", p.x), dump(folder, "y", "f8", p.y), dump(folder, "z", "f8", p.z);
  dump(folder, "intensity", "u2", p.intensity);
  dump(folder, "return_number", "u1", p.return_number), dump(folder, "number_of_returns", "u1", p.return_count);
  dump(folder, "scan_direction_flag", "u1", p.scan_direction), dump(folder, "edge_of_flight_line", "u1", p.edge_of_line);
  dump(folder, "classification", "u1", p.classification);
  const auto flag = [&](const char* name, unsigned bit) {
    std::vector<std::uint8_t> column(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) column[i] = (p.flags[i] >> bit) & 1;
    dump(folder, name, "u1", column);
  };
  flag("synthetic", 0), flag("key_point", 1), flag("withheld", 2);
  if (l.extended) flag("overlap", 3), dump(folder, "scanner_channel", "u1", p.channel);
  dump(folder, l.extended ? "scan_angle" : "scan_angle_rank", "i2", p.raw_scan_angle);
  dump(folder, "user_data", "u1", p.user_data), dump(folder, "point_source_id", "u2", p.point_source_id);
  if (l.gps) dump(folder, "gps_time", "f8", p.gps_time);
  if (l.rgb) dump(folder, "red", "u2", p.red), dump(folder, "green", "u2", p.green), dump(folder, "blue", "u2", p.blue);
  if (l.nir) dump(folder, "nir", "u2", p.nir);
  if (l.wave) {
    dump(folder, "wavepacket_index", "u1", p.wave_descriptor), dump(folder, "wavepacket_offset", "u8", p.wave_offset);
    dump(folder, "wavepacket_size", "u4", p.wave_size), dump(folder, "return_point_wave_location", "f4", p.wave_location);
    dump(folder, "x_t", "f4", p.wave_dx), dump(folder, "y_t", "f4", p.wave_dy), dump(folder, "z_t", "f4", p.wave_dz);
  }
  for (const io::LasExtra& e : h.extras)
    if (e.type != 0) dump(folder, "extra_" + e.name, "f8", io::las_extra_values(p, h, e.name));
  dump(folder, "extra", "u1", p.extra);
}

void write_samples(const std::filesystem::path& folder) {
  constexpr std::size_t many = (1u << 20) + 1;
  for (int format = 0; format <= 10; ++format)
    for (const char* ending : {".las", ".laz"})
      for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{3000}, many}) {
        if (n == many && format != 6) continue;
        const io::LasHeader h = test::sample_header(format, format % 2 == 1 ? 4 : -1, n != many);
        const io::LasPoints p = test::sample_points(h, n);
        const std::string name = "format" + std::to_string(format) + "_" + std::to_string(n) + ending;
        test::write_sample(folder / name, h, p);
        dump_columns(folder / (name + ".columns"), h, p);
      }
}

void write_copc_samples(const std::filesystem::path& folder) {
  for (const int format : {6, 7, 8})
    for (const bool floats : {false, true}) {
      io::LasHeader h = test::sample_header(format, 4, true), to = h;
      io::LasPoints p = test::copc_points(h, 150000);
      std::vector<double> whole(p.size());  // of 64 bits copc.js takes what a double holds
      for (std::size_t i = 0; i < whole.size(); ++i) whole[i] = 1e9 * static_cast<double>(i % 4001);
      for (const char* name : {"type7", "type8"}) set_las_extra_values(p, h, name, whole, "sample");
      const std::vector<std::uint8_t> records = test::records_of(p, h);
      if (floats) to.extras = io::float_extras(h.extras);
      io::LasRecoder recode(h, to, "sample");
      const io::RecordStream stream = [&](const auto& f) { f(recode(records)); };
      const std::string name = "format" + std::to_string(format) + (floats ? "_float" : "") + ".copc.laz";
      io::write_copc(folder / name, to, stream, {folder, 1e9, 0});
      dump_columns(folder / (name + ".columns"), h, p);
    }
}

void write_virtual_cloud(const std::filesystem::path& folder) {
  io::LasHeader h = test::sample_header(7, 4, true);
  io::TileIndex index{{}, "EPSG:25832+7837", 1.0, 1.0, "2026-01-02T00:00:00Z"};
  for (const char* name : {"a.laz", "b.laz"}) {
    h.offset.x() += 1000.0;
    test::write_sample(folder / name, h, test::copc_points(h, 1000));
    io::LasReader reader(folder / name);
    h = reader.header();
    core::Block block;
    reader.read(block, 1000);
    io::TileFactsOf facts;
    facts.add(block);
    index.tiles.push_back({name, facts.facts()});
  }
  io::write_vpc(folder / "a.vpc", index, h);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string verb = argc > 1 ? argv[1] : "";
  if (verb == "write" && argc == 3) {
    write_samples(argv[2]);
  } else if (verb == "copc" && argc == 3) {
    write_copc_samples(argv[2]);
  } else if (verb == "vpc" && argc == 3) {
    write_virtual_cloud(argv[2]);
  } else if (verb == "dump" && argc == 4) {
    io::LasReader reader(argv[2]);
    io::LasPoints p;
    reader.read(p, static_cast<std::size_t>(reader.header().point_count));
    dump_columns(argv[3], reader.header(), p);
  } else {
    std::cerr << "las_samples write FOLDER | copc FOLDER | vpc FOLDER | dump FILE FOLDER\n";
    return 2;
  }
  return 0;
} catch (const swath::core::Error& e) {
  std::cerr << e.text() << "\n";
  return 1;
}
