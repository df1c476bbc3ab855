// SPDX-License-Identifier: GPL-3.0-or-later
// fuzz_seeds FOLDER: small files of the binary formats, FOLDER/TARGET/NAME, by this program's own writers. Those of text are in seeds/.
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/raster/geotiff.h"
#include "io/records/sbet.h"
#include "io/text/npy.h"
#include "io/vector/vector.h"
#include "pipeline/work/store_file.h"
#include "tests/io/las_sample.h"
#include "tests/io/vector/write_contours.h"

namespace {

using namespace swath;
using Path = std::filesystem::path;

constexpr const char* utm = "EPSG:32632";

void put(std::string& to, std::uint64_t value, int bytes, bool big_endian = false) {
  for (int k = 0; k < bytes; ++k) {
    const int byte = big_endian ? bytes - 1 - k : k;
    to.push_back(static_cast<char>(byte < 8 ? value >> (8 * byte) : 0));
  }
}

std::string bytes_of(const Path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const Path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

void clouds(const Path& folder) {
  for (const int format : {0, 1, 3, 4, 6, 7, 8, 10})
    for (const char* ending : {".las", ".laz"}) {
      const io::LasHeader header = test::sample_header(format, format == 3 ? 4 : -1, format == 1 || format == 7);
      test::write_sample(folder / ("format" + std::to_string(format) + ending), header, test::sample_points(header, 20), 1);
    }
  io::LasWriteOptions options;
  options.crs_wkt = core::Crs(utm).wkt();
  core::Block block;
  core::resize(block, 3);
  block.origin = {500000, 5400000, 0};
  io::LasWriter writer(folder / "crs.laz", options);
  writer.write(block);
  writer.finish();
}

void csd(const Path& file) {
  std::string out(2048, '\0');
  auto* b = reinterpret_cast<unsigned char*>(out.data());
  std::memcpy(b, "CSD\0Optech Incorporated", 23);
  io::store<std::uint16_t>(b + 104, 2048);
  io::store<std::uint16_t>(b + 106, 1660);
  io::store<std::uint32_t>(b + 124, 12);
  for (int i = 0; i < 6; ++i) io::store(b + 1154 + 8 * i, 0.01 * (i + 1));
  io::store(b + 1202, 21.5);
  io::store(b + 1210, 950.0);
  for (int i = 0; i < 12; ++i) {
    unsigned char p[69] = {};
    io::store(p, 100.0 + 0.01 * i);
    p[8] = static_cast<unsigned char>(i % 5);
    for (int k = 0; k < 4; ++k) io::store(p + 9 + 4 * k, 500.0f + static_cast<float>(k));
    for (int k = 0; k < 4; ++k) io::store(p + 25 + 2 * k, static_cast<std::uint16_t>(10 * k));
    io::store(p + 33, 0.125f);
    io::store(p + 37, 0.01f);
    io::store(p + 41, 0.02f);
    io::store(p + 45, 0.75f);
    io::store(p + 49, 0.8 + 1e-7 * i);
    io::store(p + 57, 0.2);
    io::store(p + 65, 1000.5f);
    out.append(reinterpret_cast<const char*>(p), sizeof p);
  }
  write(file, out);
}

core::TrajectoryData level_flight() {
  core::TrajectoryData t;
  for (int i = 0; i < 8; ++i) {
    t.time.push_back(1401735600.0 + 0.005 * i);
    t.latitude.push_back(0.8361 + 4e-8 * i);
    t.longitude.push_back(0.1834);
    t.height.push_back(851);
    for (auto* column : {&t.roll, &t.pitch, &t.heading}) column->push_back(0.01);
    for (auto* column : {&t.sigma_north, &t.sigma_east, &t.sigma_down, &t.sigma_roll, &t.sigma_pitch, &t.sigma_heading})
      column->push_back(0.02f);
  }
  return t;
}

void sbet(const Path& folder) {
  io::write_sbet(folder / "a", level_flight());
  io::write_smrmsg(folder / "b", level_flight());
  const std::string records = bytes_of(folder / "a"), sigmas = bytes_of(folder / "b");
  write(folder / "both", "\5" + records + sigmas);  // 8 records of 136 and 80 bytes: 5 eighths of 1728 less 8
  write(folder / "alone", "\10" + records);
  std::filesystem::remove(folder / "a");
  std::filesystem::remove(folder / "b");
}

void npy(const Path& folder) {
  const std::vector<double> rising{474000.0, 474000.005, 474000.01, 474000.015, 474000.02}, small{0.1, 0.2, 0.1, 0.2, 0.1},
      ranges{500, 501, 502, 503, 504}, ones{1, 1, 1, 1, 1};
  io::NpyWriter laser(folder / "laser.npy",
                      {{"time", "f8"}, {"scan_angle", "f4"}, {"range", "f4"}, {"line", "u2"}, {"return_number", "u1"}});
  laser.append({rising.data(), small.data(), ranges.data(), ones.data(), ones.data()}, rising.size());
  laser.commit();
  io::NpyWriter places(
      folder / "places.npy",
      {{"time", "f8"}, {"line", "i4"}, {"x", "f8"}, {"y", "f4"}, {"z", "f4"}, {"intensity", "u4"}, {"return_number", "i1"}});
  places.append({rising.data(), ones.data(), small.data(), small.data(), ranges.data(), ones.data(), ones.data()}, rising.size());
  places.commit();
  for (const char* order : {"False", "True"}) {
    std::string header = std::string("{'descr': '<f8', 'fortran_order': ") + order + ", 'shape': (5, 7), }";
    header.resize(117, ' ');
    std::string out = "\x93NUMPY\1" + std::string(1, '\0');
    put(out, header.size() + 1, 2);
    out += header + "\n";
    for (int i = 0; i < 35; ++i) put(out, std::bit_cast<std::uint64_t>(*order == 'F' ? rising[i / 7] : rising[i % 5]), 8);
    write(folder / (std::string("plain_") + order), out);
  }
}

std::string udp_frame(int port, std::size_t payload) {
  std::string p(12, '\0');
  put(p, 0x0800, 2, true);
  p += '\x45';
  p.resize(14 + 9, '\0');
  p += '\x11';
  p.resize(14 + 20, '\0');
  put(p, 1, 2, true), put(p, static_cast<std::uint64_t>(port), 2, true), put(p, payload + 8, 2, true), put(p, 0, 2);
  return p + std::string(payload, 'd');
}

void pcap(const Path& folder) {
  for (const bool big : {false, true}) {
    std::string out;
    put(out, 0xa1b2c3d4, 4, big), put(out, 2, 2, big), put(out, 4, 2, big), put(out, 0, 8, big), put(out, 65535, 4, big),
        put(out, 1, 4, big);
    for (const std::string& f : {udp_frame(2368, 30), udp_frame(8308, 12)})
      put(out, 1700000000, 4, big), put(out, 500000, 4, big), put(out, f.size(), 4, big), put(out, f.size(), 4, big), out += f;
    write(folder / (big ? "big.pcap" : "small.pcap"), out);
  }
  std::string next;
  put(next, 0x0a0d0d0a, 4), put(next, 28, 4), put(next, 0x1a2b3c4d, 4), put(next, 1, 4), put(next, ~0ull, 8), put(next, 28, 4);
  const std::string f = udp_frame(2368, 30);
  put(next, 6, 4), put(next, 32 + f.size(), 4), put(next, 0, 12), put(next, f.size(), 4), put(next, f.size(), 4), next += f,
      put(next, 32 + f.size(), 4);
  write(folder / "next.pcapng", next);
}

void rasters(const Path& folder) {
  core::Grid grid(core::lattice_of(1, 500000, 5400000, 500006, 5400005));
  for (std::size_t i = 0; i < grid.height.size(); ++i) grid.height[i] = i % 7 == 0 ? NAN : 500.0f + static_cast<float>(i);
  io::write_grid(folder / "dtm.tif", grid, utm);
  write(folder / "dtm.asc", "ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 5400000\ncellsize 1\nNODATA_value -9999\n1 2 3\n4 -9999 6\n");
}

void vectors(const Path& folder) {
  core::ContourLine line;
  line.x = {500000, 500010, 500010, 500000};
  line.y = {5400000, 5400000, 5400010, 5400000};
  line.height = 501;
  line.closed = true;
  io::write_contours({folder / "lines.gpkg", folder / "lines.dxf", folder / "lines.geojson"}, {line}, utm);
}

void work(const Path& folder) {
  core::Block block;
  core::resize(block, 4);
  core::add_columns(block, {core::Column::classification, core::Column::intensity});
  block.source.resize(4, 6);
  core::ColumnSet columns = core::columns_of(block);
  columns.add(core::Column::source);
  pipeline::StoreFile file(folder / "points.cols", pipeline::StoreFile::Mode::append);
  pipeline::write_chunks(file, block, 0, 3, columns);
  pipeline::write_chunks(file, block, 3, 1, columns);
  file.close();
  write(folder / "record", R"({"piece": "a/b/piece.json", "files": [["points.cols", 3, "0123456789abcdef"]], "note": {"points": 3}})");
}

/// Two UBX-TIM-TM2 messages.
void time_marks(const Path& file) {
  std::string out;
  for (unsigned k = 0; k < 2; ++k) {
    std::string body("\x0d\x03", 2);
    put(body, 28, 2), put(body, 0, 1), put(body, 0xcc, 1), put(body, k, 2), put(body, 2300, 2), put(body, 2300, 2);
    put(body, 1000u * k, 4), put(body, 5, 4), put(body, 1000u * k + 20, 4), put(body, 5, 4), put(body, 30, 4);
    std::uint8_t a = 0, b = 0;
    for (const char c : body) a = static_cast<std::uint8_t>(a + static_cast<std::uint8_t>(c)), b = static_cast<std::uint8_t>(b + a);
    out += "\xb5\x62" + body;
    put(out, a, 1), put(out, b, 1);
  }
  write(file, out);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "fuzz_seeds FOLDER\n";
    return 2;
  }
  const Path into = argv[1];
  for (const char* target : {"las", "csd", "sbet", "npy", "pcap", "raster", "vector", "work", "events"})
    std::filesystem::create_directories(into / target);
  clouds(into / "las");
  csd(into / "csd" / "flight.csd");
  sbet(into / "sbet");
  npy(into / "npy");
  pcap(into / "pcap");
  time_marks(into / "events" / "marks.ubx");
  rasters(into / "raster");
  vectors(into / "vector");
  work(into / "work");
  return 0;
} catch (const core::Error& e) {
  std::cerr << e.text() << "\n";
  return 1;
}
