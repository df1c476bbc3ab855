// SPDX-License-Identifier: GPL-3.0-or-later
// Cloud optimised GeoTIFF as described in OGC 21-026, through GDAL's COG driver; GeoTIFF keys as OGC 19-008r4 (compound CRS: 1.1).
// Grids are shown to its driver as a MEM dataset (io/raster/cog.h) on a copy with north-first rows and numeric nodata.
#include "io/raster/geotiff.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "core/error.h"
#include "io/raster/cog.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

/// Largest distance of a raster's corner from a whole multiple of its cell, in cells.
constexpr double lattice_tolerance = 1e-3;
/// Relative difference of pixel width and height that still counts as square (text formats print few digits).
constexpr double square_tolerance = 1e-6;
// Number of a cell: beyond it a corner could not be distinguished from its neighbour's in a double.
constexpr double farthest_cell = 1e12;
/// A band's values with rows from the north and raster_nodata for NaN.
std::vector<float> north_first(const core::Lattice& l, const std::vector<float>& values) {
  std::vector<float> out(l.size());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const float v = values[l.at(i, j)];
      out[l.at(i, l.ny - 1 - j)] = std::isfinite(v) ? v : static_cast<float>(raster_nodata);
    }
  return out;
}

/// Colours and what covers them as bands of T, rounded to 8 of 16 bits where T has 8.
template <class T>
void write_colours_as(const std::filesystem::path& file, const core::Lattice& l, const ColourBands& colours, GDALDataset& memory,
                      const GdalMessages& messages) {
  struct Named {
    const char* name;
    const std::vector<std::uint16_t>* values;
    GDALColorInterp colour;
  };
  const Named bands[]{{"red", colours.red, GCI_RedBand}, {"green", colours.green, GCI_GreenBand}, {"blue", colours.blue, GCI_BlueBand}};
  const auto narrowed = [](std::uint16_t v) { return sizeof(T) == 1 ? static_cast<T>(std::min(255, (v + 128) / 256)) : static_cast<T>(v); };
  std::vector<std::vector<T>> rows(4, std::vector<T>(l.size()));
  for (size_t b = 0; b < 4; ++b)
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        T& to = rows[b][l.at(i, l.ny - 1 - j)];
        const size_t at = l.at(i, j);
        if (b < 3)
          to = narrowed((*bands[b].values)[at]);
        else
          to = (*colours.is_there)[at] ? std::numeric_limits<T>::max() : T{0};
      }
  for (size_t b = 0; b < 4; ++b) {
    add_memory_band(memory, rows[b], b < 3 ? bands[b].name : "alpha");
    memory.GetRasterBand(static_cast<int>(b) + 1)->SetColorInterpretation(b < 3 ? bands[b].colour : GCI_AlphaBand);
  }
  write_cog(file, memory, Overviews::average, messages);
}

Dataset open(const std::filesystem::path& file, const GdalMessages& messages) {
  Dataset d = open_raster(file);
  if (!d) messages.fail("cannot read the raster", file, std::filesystem::exists(file) ? "" : "check the name");
  return d;
}

RasterInfo info_of(GDALDataset& d) {
  RasterInfo info;
  d.GetGeoTransform(info.geotransform.data());
  info.nx = d.GetRasterXSize();
  info.ny = d.GetRasterYSize();
  for (int b = 1; b <= d.GetRasterCount(); ++b) {
    GDALRasterBand* band = d.GetRasterBand(b);
    info.names.emplace_back(band->GetDescription());
    info.units.emplace_back(band->GetUnitType());
    info.types.emplace_back(GDALGetDataTypeName(band->GetRasterDataType()));
    int has = 0;
    const double nodata = band->GetNoDataValue(&has);
    info.nodata.push_back(has ? std::optional<double>(nodata) : std::nullopt);
  }
  if (const OGRSpatialReference* srs = d.GetSpatialRef()) info.crs_wkt = wkt2(*srs);
  return info;
}

/// Columns [col, col + n) of one row: scale and offset applied, NaN where the band's mask says there is no value.
void read_row(GDALRasterBand& band, int row, int col, int n, std::vector<double>& values, std::vector<unsigned char>& mask,
              const std::filesystem::path& file, const GdalMessages& messages) {
  values.resize(static_cast<size_t>(n));
  mask.assign(static_cast<size_t>(n), 255);
  CPLErr failed = band.RasterIO(GF_Read, col, row, n, 1, values.data(), n, 1, GDT_Float64, 0, 0, nullptr);
  if (!failed && !(band.GetMaskFlags() & GMF_ALL_VALID))
    failed = band.GetMaskBand()->RasterIO(GF_Read, col, row, n, 1, mask.data(), n, 1, GDT_Byte, 0, 0, nullptr);
  if (failed) messages.fail("cannot read row " + std::to_string(row) + " of the raster", file);
  const double scale = band.GetScale(), offset = band.GetOffset();
  for (size_t k = 0; k < values.size(); ++k)
    values[k] = mask[k] && std::isfinite(values[k]) ? values[k] * scale + offset : std::numeric_limits<double>::quiet_NaN();
}

/// Whether the raster, or any of those that a virtual one is made of, is an ASCII grid.
bool is_of_ascii_grids(GDALDataset& d) {
  const CPLStringList files(d.GetFileList());
  for (int i = 0; i < files.size(); ++i) {
    const GDALDriverH driver = GDALIdentifyDriver(files[i], nullptr);
    if (driver && EQUAL(GDALGetDescription(driver), "AAIGrid")) return true;
  }
  return false;
}

}  // namespace

void write_raster(const std::filesystem::path& file, const core::Lattice& lattice, const std::vector<RasterBand>& bands,
                  const std::string& crs, bool average) {
  if (lattice.nx <= 0 || lattice.ny <= 0 || bands.empty()) throw core::Error("an empty grid cannot be written", file.string());
  for (const RasterBand& b : bands)
    if (!b.values || b.values->size() != lattice.size())
      throw core::Error("band '" + b.name + "' does not hold one value per cell", file.string());

  const GdalMessages messages;
  const Dataset memory = memory_raster(lattice, crs_facts(crs), file);
  std::vector<std::vector<float>> rows;
  rows.reserve(bands.size());
  for (const RasterBand& b : bands) {
    rows.push_back(north_first(lattice, *b.values));
    add_memory_band(*memory, rows.back(), b.name);
    GDALRasterBand* band = memory->GetRasterBand(memory->GetRasterCount());
    if (!b.unit.empty()) band->SetUnitType(b.unit.c_str());
    band->SetNoDataValue(raster_nodata);
  }
  write_cog(file, *memory, average ? Overviews::average : Overviews::nearest, messages);
}

void write_colours(const std::filesystem::path& file, const core::Lattice& lattice, const ColourBands& colours, int bits,
                   const std::string& crs) {
  const GdalMessages messages;
  const Dataset memory = memory_raster(lattice, crs_facts(crs), file);
  if (bits == 8)
    write_colours_as<std::uint8_t>(file, lattice, colours, *memory, messages);
  else
    write_colours_as<std::uint16_t>(file, lattice, colours, *memory, messages);
}

void write_grid(const std::filesystem::path& file, const core::Grid& grid, const std::string& crs, GridBands bands) {
  const size_t n = grid.lattice.size();
  if ((bands.sigma && grid.sigma.size() != n) || (bands.count && grid.count.size() != n) || (bands.reason && grid.reason.size() != n) ||
      (bands.height && grid.height.size() != n))
    throw core::Error("the grid does not hold what the file is to show", file.string());
  const std::string unit = crs_facts(crs).vertical_unit;
  std::vector<float> counts, reasons;
  std::vector<RasterBand> columns;
  if (bands.height) columns.push_back({"height", unit, &grid.height});
  if (bands.sigma) columns.push_back({"sigma", unit, &grid.sigma});
  if (bands.count) {
    counts.assign(grid.count.begin(), grid.count.end());
    columns.push_back({"count", "", &counts});
  }
  if (bands.reason) {
    reasons.reserve(n);
    for (const core::Void r : grid.reason) reasons.push_back(static_cast<float>(r));
    columns.push_back({"void reason", "", &reasons});
  }
  write_raster(file, grid.lattice, columns, crs, bands.height);
}

RasterInfo read_raster_info(const std::filesystem::path& file) {
  const GdalMessages messages;
  const Dataset d = open(file, messages);
  return info_of(*d);
}

Raster read_raster(const std::filesystem::path& file, int band_number, const std::optional<PixelWindow>& window) {
  const GdalMessages messages;
  const Dataset d = open(file, messages);
  const RasterInfo info = info_of(*d);
  Raster r{info.geotransform, info.nx, info.ny, d->GetRasterCount(), {}, {}, {}, info.crs_wkt};
  if (band_number < 1 || band_number > r.bands)
    throw core::Error("has no band " + std::to_string(band_number), file.string(), "its bands are 1 to " + std::to_string(r.bands));
  r.name = info.names[static_cast<size_t>(band_number - 1)];
  r.unit = info.units[static_cast<size_t>(band_number - 1)];
  const PixelWindow w = window.value_or(PixelWindow{0, 0, r.nx, r.ny});
  if (w.column < 0 || w.row < 0 || w.columns < 1 || w.rows < 1 || w.columns > r.nx - w.column || w.rows > r.ny - w.row)
    throw core::Error("has no such window of pixels", file.string());
  const std::array<double, 6> g = r.geotransform;
  r.geotransform[0] = g[0] + w.column * g[1] + w.row * g[2];
  r.geotransform[3] = g[3] + w.column * g[4] + w.row * g[5];
  r.nx = w.columns;
  r.ny = w.rows;
  r.values.reserve(static_cast<size_t>(r.nx) * static_cast<size_t>(r.ny));
  std::vector<double> row;
  std::vector<unsigned char> mask;
  for (int j = 0; j < r.ny; ++j) {
    read_row(*d->GetRasterBand(band_number), w.row + j, w.column, r.nx, row, mask, file, messages);
    r.values.insert(r.values.end(), row.begin(), row.end());
  }
  return r;
}

core::Lattice lattice_of(const RasterInfo& info, const std::filesystem::path& file) {
  const auto& g = info.geotransform;
  if (!std::all_of(g.begin(), g.end(), [](double v) { return std::isfinite(v); }))
    throw core::Error("the raster's corner or cell is not finite", file.string(), "the georeference is damaged");
  if (g[2] != 0 || g[4] != 0 || g[1] <= 0 || g[5] >= 0)
    throw core::Error("the raster is not north up", file.string(), "warp it to the survey's CRS first (gdalwarp)");
  if (std::abs(g[1] + g[5]) > square_tolerance * g[1])
    throw core::Error("the raster's pixels are not square (" + std::to_string(g[1]) + " by " + std::to_string(-g[5]) + ")", file.string(),
                      "resample it to square pixels (gdalwarp -tr)");
  const double cell = g[1];
  const double west = g[0] / cell, south = (g[3] + info.ny * g[5]) / cell;
  if (std::max(std::abs(west), std::abs(south)) > farthest_cell)
    throw core::Error("the raster's corner lies " + core::format_number(std::max(std::abs(west), std::abs(south)), 4) +
                          " cells from the origin of its coordinates",
                      file.string(), "the georeference is damaged");
  const double shift = std::max(std::abs(west - std::round(west)), std::abs(south - std::round(south)));
  if (shift > lattice_tolerance)
    throw core::Error("the raster's corner is " + core::format_number(shift, 3) + " cells off the whole multiples of its cell",
                      file.string(), "align it (gdalwarp -tap -tr " + std::to_string(cell) + " " + std::to_string(cell) + ")");
  return {cell, std::llround(west), std::llround(south), info.nx, info.ny};
}

core::Grid read_grid(const std::filesystem::path& file, const std::optional<core::Lattice>& window, const OnImpossible& on_impossible) {
  const GdalMessages messages;
  const Dataset d = open(file, messages);
  const RasterInfo info = info_of(*d);
  const core::Lattice whole = lattice_of(info, file);
  const core::Lattice l = window.value_or(whole);
  if (std::abs(l.cell - whole.cell) > square_tolerance * whole.cell)
    throw core::Error("the raster's cell is " + std::to_string(whole.cell) + ", not " + std::to_string(l.cell), file.string());

  const auto band_named = [&](const char* name) {
    for (size_t b = 0; b < info.names.size(); ++b)
      if (info.names[b] == name) return static_cast<int>(b) + 1;
    return 0;
  };
  const int sigma = band_named("sigma"), count = band_named("count"), reason = band_named("void reason");
  int height = band_named("height");
  if (!height && !sigma && !count && !reason) height = 1;

  core::Grid grid(l);
  if (sigma) grid.sigma.assign(l.size(), std::numeric_limits<float>::quiet_NaN());
  if (count) grid.count.assign(l.size(), 0);
  const auto col0 = static_cast<int>(std::clamp<std::int64_t>(l.i0 - whole.i0, 0, whole.nx));
  const auto col1 = static_cast<int>(std::clamp<std::int64_t>(l.i0 + l.nx - whole.i0, 0, whole.nx));
  std::vector<double> row;
  std::vector<unsigned char> mask;
  // From the north, as the file lies. Of an ASCII grid from its first row on: asked for a row behind a lost one, GDAL tries all above it
  // anew, at twice the cost for each.
  const auto north = std::clamp<std::int64_t>(whole.j0 + whole.ny - (l.j0 + l.ny), 0, whole.ny);
  const auto south = std::clamp<std::int64_t>(whole.j0 + whole.ny - l.j0, 0, whole.ny);
  const std::int64_t first = north > 0 && north < south && is_of_ascii_grids(*d) ? 0 : north;
  const auto each = [&](int band, auto&& put) {
    for (std::int64_t j = first; band && col1 > col0 && north < south && j < south; ++j) {
      read_row(*d->GetRasterBand(band), static_cast<int>(j), col0, col1 - col0, row, mask, file, messages);
      for (int c = col0; j >= north && c < col1; ++c)
        put(l.at(static_cast<int>(whole.i0 + c - l.i0), static_cast<int>(whole.j0 + whole.ny - 1 - j - l.j0)),
            row[static_cast<size_t>(c - col0)]);
    }
  };
  const auto at_height = static_cast<size_t>(std::max(1, height) - 1);
  const HeightRule rule(metres_per_height(info.units[at_height], info.crs_wkt), info.nodata[at_height]);
  each(height, [&](size_t k, double v) {
    if (rule.is_impossible(v)) {
      if (on_impossible) on_impossible(l.centre_x(static_cast<int>(k % l.nx)), l.centre_y(static_cast<int>(k / l.nx)), v);
      v = std::numeric_limits<double>::quiet_NaN();
    }
    grid.height[k] = static_cast<float>(v);
    grid.reason[k] = std::isnan(v) ? core::Void::no_data : core::Void::none;
  });
  each(sigma, [&](size_t k, double v) { grid.sigma[k] = static_cast<float>(v); });
  each(count, [&](size_t k, double v) { grid.count[k] = v > 0 ? static_cast<std::uint32_t>(v) : 0u; });
  each(reason,
       [&](size_t k, double v) { grid.reason[k] = v >= 0 && v <= 4 ? static_cast<core::Void>(std::lround(v)) : core::Void::no_data; });
  return grid;
}

void limit_raster_cache(std::int64_t bytes) { GDALSetCacheMax64(bytes); }

}  // namespace swath::io
