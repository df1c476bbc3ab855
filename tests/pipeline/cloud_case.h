// SPDX-License-Identifier: GPL-3.0-or-later
// Clouds that enter after georeferencing, with the survey and the pipeline that reads them.
#pragma once

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/block.h"
#include "io/las/las_reader.h"
#include "io/las/las_writer.h"
#include "io/text/value_file.h"
#include "pipeline/run.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::pipeline {

namespace fs = std::filesystem;
using core::Block;

inline constexpr double easting = 500000.0, northing = 5300000.0;

/// A survey with its clouds and a pipeline, run in a folder of its own.
struct CloudCase {
  test::TemporaryFolder folder;
  std::string survey = "crs = \"EPSG:32632\"\n";

  void add(const Block& block, const std::string& name, const std::string& crs, double scale = 0.001, const std::string& more = {}) {
    io::LasWriteOptions o;
    o.scale = Eigen::Vector3d(scale, scale, 0.001);
    o.threads = 1;
    io::LasWriter writer(folder / name, o);
    writer.write(block);
    writer.finish();
    survey += "[[points]]\nfile = \"" + name + "\"\ncrs = \"" + crs + "\"\n" + more;
  }
  void add(const io::LasHeader& header, const io::LasPoints& points, const std::string& name, const std::string& more = {}) {
    test::write_sample(folder / name, header, points, 1);
    survey += "[[points]]\nfile = \"" + name + "\"\ncrs = \"EPSG:32632\"\n" + more;
  }
  /// The products' folder.
  fs::path run(const std::string& stages, const std::string& tile) {
    test::write_bytes(folder / "survey.toml", survey);
    test::write_bytes(folder / "p.toml", stages);
    Request r;
    r.config = folder / "p.toml";
    r.survey = folder / "survey.toml";
    r.output = folder / ("out " + tile);
    r.sets = {"run.tile=\"" + tile + "\""};
    r.threads = 2;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    pipeline::run(plan, progress, "test");
    return r.output;
  }
};

inline const std::string copy_stages = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"writers.las\"\ncompress = false\n";

/// The points of all tiles, in order of the tiles' names.
inline Block points_of(const fs::path& out) {
  std::map<std::string, fs::path> files;
  for (const auto& e : fs::directory_iterator(out / "points"))
    if (e.path().extension() == ".las") files[e.path().filename().string()] = e.path();
  Block all;
  for (const auto& [name, file] : files) {
    io::LasReader reader(file, 1);
    Block b;
    while (reader.read(b, 1 << 20) > 0) core::append(all, b);
  }
  return all;
}

inline Block square(size_t n, double x0, double y0, double side, double z) {
  Block b;
  b.origin = {x0, y0, 0};
  for (size_t i = 0; i < n; ++i) {
    b.x.push_back(side * std::fmod(static_cast<double>(i) * 0.618034, 1.0));
    b.y.push_back(side * std::fmod(static_cast<double>(i) * 0.754878, 1.0));
    b.z.push_back(z);
  }
  return b;
}

inline core::Value report_of(const fs::path& out) { return io::read_value_file(out / "report.json"); }

}  // namespace swath::pipeline
