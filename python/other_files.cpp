// SPDX-License-Identifier: GPL-3.0-or-later
// Grids, contours and trajectories as files; simulated surveys; what a file holds.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <cmath>

#include "core/config/result_visitors.h"
#include "core/geo/proj_grids.h"
#include "io/raster/geotiff.h"
#include "io/survey/info.h"
#include "io/text/value_file.h"
#include "io/vector/vector.h"
#include "pipeline/progress.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/watched.h"
#include "simulate/files/earlier_survey.h"
#include "simulate/simulate.h"

namespace swath::python {
namespace {

using Rows = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Line = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// A band from the north as core::Grid holds it.
std::vector<float> from_the_south(const Rows& rows) {
  std::vector<float> out;
  out.reserve(rows.size());
  for (size_t j = rows.shape(0); j-- > 0;) out.insert(out.end(), rows.data() + j * rows.shape(1), rows.data() + (j + 1) * rows.shape(1));
  return out;
}

void write_raster(const std::string& file, const std::vector<std::string>& names, const std::vector<Rows>& bands, double cell, double west,
                  double north, const std::string& unit, const std::string& crs) {
  const auto ny = static_cast<int>(bands.front().shape(0)), nx = static_cast<int>(bands.front().shape(1));
  const core::Lattice lattice{cell, std::llround(west / cell), std::llround(north / cell) - ny, nx, ny};
  std::vector<std::vector<float>> values;
  for (const Rows& b : bands) values.push_back(from_the_south(b));
  std::vector<io::RasterBand> list;
  for (size_t i = 0; i < names.size(); ++i) list.push_back({names[i], i == 0 ? unit : std::string(), &values[i]});
  const nb::gil_scoped_release without_lock;
  io::write_raster(file, lattice, list, crs, true);
}

/// (values from the north, geotransform, CRS, name, unit, bands)
nb::tuple read_raster(const std::string& file, int band) {
  io::Raster r;
  {
    const nb::gil_scoped_release without_lock;
    r = io::read_raster(file, band);
  }
  const std::vector<size_t> shape{static_cast<size_t>(r.ny), static_cast<size_t>(r.nx)};
  nb::list transform;
  for (const double v : r.geotransform) transform.append(v);
  return nb::make_tuple(array_of(std::move(r.values), shape), transform, r.crs_wkt, r.name, r.unit, r.bands);
}

/// Lines as (x, y, height, index, closed, depression).
void write_contours(const std::string& file, const nb::list& lines, const std::string& crs) {
  io::ContourWriter writer(file, crs);
  for (const nb::handle h : lines) {
    const auto t = nb::cast<nb::tuple>(h);
    const auto x = nb::cast<Line>(t[0]), y = nb::cast<Line>(t[1]);
    writer.add(core::ContourLine{{x.data(), x.data() + x.size()},
                                 {y.data(), y.data() + y.size()},
                                 nb::cast<double>(t[2]),
                                 nb::cast<bool>(t[3]),
                                 nb::cast<bool>(t[4]),
                                 nb::cast<bool>(t[5])});
  }
  writer.close();
}

std::string simulate_survey(const std::string& folder, const std::string& options) {
  const simulate::Options read = simulate::read_options(io::parse_json(options, "swath.simulate"));
  const simulate::EarlierSurvey earlier(folder);
  std::atomic<bool> stop = false;
  core::Value made;
  run_watched(
      [&] {
        made = core::reported(simulate::run(read, folder, [&](double) {
          if (stop) throw pipeline::Interrupted();
        }));
      },
      [&] { stop = true; });
  return io::to_json(made);
}

}  // namespace

void bind_other_files(nb::module_& m) {
  m.def("write_raster", &write_raster);
  m.def("read_raster", &read_raster);
  m.def("write_contours", &write_contours);
  m.def("simulate", &simulate_survey);
  m.def("use_proj_folders", [](const std::vector<std::string>& folders) { core::use_proj_folders({folders.begin(), folders.end()}); });
  m.def("describe_file", [](const std::string& file) { return io::to_json(io::describe_file(file)); });
}

}  // namespace swath::python
