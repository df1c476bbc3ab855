// SPDX-License-Identifier: GPL-3.0-or-later
// A made cloud with something in every field, as a COPC file.
#pragma once

#include <cmath>
#include <random>

#include "io/copc/copc_hierarchy.h"
#include "io/copc/copc_writer.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "tests/io/las_sample.h"

namespace swath::test {

/// A hilly square kilometre, denser in the middle.
inline io::LasPoints copc_points(const io::LasHeader& h, std::size_t n) {
  io::LasPoints p = sample_points(h, n);
  std::mt19937 random(11);
  std::normal_distribution<double> near(0.0, 150.0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto wide = [&] { return static_cast<double>(random() % 1000000) / 1000.0 - 500.0; };
    const double x = i % 3 ? near(random) : wide(), y = i % 3 ? near(random) : wide(), z = 30.0 * std::sin(x / 80.0) + wide() / 50.0;
    p.raw_x[i] = static_cast<std::int32_t>(x / h.scale.x());
    p.raw_y[i] = static_cast<std::int32_t>(y / h.scale.y());
    p.raw_z[i] = static_cast<std::int32_t>(z / h.scale.z());
    p.x[i] = p.raw_x[i] * h.scale.x() + h.offset.x();
    p.y[i] = p.raw_y[i] * h.scale.y() + h.offset.y();
    p.z[i] = p.raw_z[i] * h.scale.z() + h.offset.z();
  }
  return p;
}

/// All points as records; sets the header's record length.
inline std::vector<std::uint8_t> records_of(const io::LasPoints& p, io::LasHeader& h) {
  h.record_length = static_cast<std::uint16_t>(io::las_layout(h.point_format)->size + h.extra_bytes());
  std::vector<std::uint8_t> out(p.size() * h.record_length);
  io::encode_las_points(p, 0, p.size(), h, out, "sample");
  return out;
}

inline io::RecordStream stream_of(const std::vector<std::uint8_t>& records, std::size_t length) {
  return [&records, length](const std::function<void(std::span<const std::uint8_t>)>& f) {
    for (std::size_t at = 0; at < records.size(); at += 5000 * length)
      f(std::span(records).subspan(at, std::min(records.size() - at, 5000 * length)));
  };
}

inline io::CopcWritten write_copc_sample(const std::filesystem::path& file, io::LasHeader h, const io::LasPoints& p, double memory = 1e9,
                                         unsigned threads = 1) {
  const std::vector<std::uint8_t> records = records_of(p, h);
  return io::write_copc(file, h, stream_of(records, h.record_length), {file.parent_path(), memory, threads});
}

/// The points of a COPC file as an EPT index in `folder`, one LAZ file a node.
inline void write_ept(const std::filesystem::path& folder, const std::filesystem::path& copc, const std::string& epsg = "25832") {
  std::filesystem::create_directories(folder / "ept-data");
  std::vector<std::string> warnings;
  const io::LasHeader header = io::read_las_header(copc, warnings);
  const io::CopcInfo info = *io::copc_info(header, copc);
  core::Value pages = core::Value::object(), index = core::Value::object(), bounds = core::Value::array();
  for (const io::CopcNode& n : io::read_copc_nodes(copc, header, info)) {
    const auto points = static_cast<std::uint64_t>(n.points);
    io::LasReader reader(copc, 1, {std::vector<io::LasChunk>{{n.offset, static_cast<std::uint64_t>(n.bytes), points, n.first_record}}});
    io::LasPoints p;
    reader.read(p, points);
    io::LasHeader own = header;
    own.vlrs.clear(), own.evlrs.clear();
    write_sample(folder / "ept-data" / (n.key.text() + ".laz"), own, p, 1);
    pages[n.key.text()] = points;
  }
  for (const double side : {-1.0, 1.0})
    for (int k = 0; k < 3; ++k) bounds.push(info.cube.centre[k] + side * info.cube.half_side);
  index["bounds"] = bounds;
  index["dataType"] = "laszip";
  index["hierarchyType"] = "json";
  index["points"] = header.point_count;
  index["span"] = static_cast<std::int64_t>(1 << io::octree::cell_bits);
  index["srs"]["authority"] = "EPSG";
  index["srs"]["horizontal"] = epsg;
  index["version"] = "1.0.0";
  std::filesystem::create_directories(folder / "ept-hierarchy");
  io::write_text_file(folder / "ept-hierarchy" / "0-0-0-0.json", io::to_json(pages));
  io::write_text_file(folder / "ept.json", io::to_json(index));
}

}  // namespace swath::test
