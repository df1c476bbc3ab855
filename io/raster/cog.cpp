// SPDX-License-Identifier: GPL-3.0-or-later
// The COG driver takes a whole dataset, so the values are shown to it as a MEM dataset.
#include "io/raster/cog.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <cstdint>

#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

/// What a truncated file cannot pass: every block lies within the file. Only libraries' final flush could lose data unseen.
void check_blocks(const std::filesystem::path& file, const std::filesystem::path& final_name, const GdalMessages& messages) {
  const Dataset made(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
  if (!made) messages.fail_writing(final_name);
  const auto size = std::filesystem::file_size(file);
  GDALRasterBand* band = made->GetRasterBand(1);
  int bx = 0, by = 0;
  band->GetBlockSize(&bx, &by);
  for (int j = 0; j * by < made->GetRasterYSize(); ++j)
    for (int i = 0; i * bx < made->GetRasterXSize(); ++i) {
      const std::string at = std::to_string(i) + "_" + std::to_string(j);
      const char* offset = band->GetMetadataItem(("BLOCK_OFFSET_" + at).c_str(), "TIFF");
      const char* length = band->GetMetadataItem(("BLOCK_SIZE_" + at).c_str(), "TIFF");
      if (!offset || !length || std::stoull(offset) + std::stoull(length) > size)
        messages.fail_writing(final_name, "the file was cut short");
    }
}

void set_crs(GDALDataset& d, const CrsFacts& facts) {
  if (facts.empty) return;
  OGRSpatialReference srs;
  // GDAL writes no GeoTIFF keys at all for a projection with three axes.
  const bool flat = facts.ellipsoidal && !facts.geographic;
  srs.SetFromUserInput(flat ? facts.horizontal_wkt.c_str() : facts.wkt.c_str());
  if (flat) d.SetMetadataItem(height_system_item, facts.vertical_name.c_str());
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  d.SetSpatialRef(&srs);
}

std::string pointer_text(const void* p) {
  char text[64] = {};
  CPLPrintPointer(text, const_cast<void*>(p), sizeof text - 1);
  return text;
}

template <class T>
constexpr GDALDataType type_of = GDT_Float32;
template <>
constexpr GDALDataType type_of<std::uint8_t> = GDT_Byte;
template <>
constexpr GDALDataType type_of<std::uint16_t> = GDT_UInt16;

}  // namespace

Dataset memory_raster(const core::Lattice& lattice, const CrsFacts& crs, const std::filesystem::path& file) {
  if (lattice.nx <= 0 || lattice.ny <= 0) throw core::Error("an empty grid cannot be written", file.string());
  Dataset memory(GetGDALDriverManager()->GetDriverByName("MEM")->Create("", lattice.nx, lattice.ny, 0, GDT_Byte, nullptr));
  std::array<double, 6> geotransform{lattice.west(), lattice.cell, 0, lattice.north(), 0, -lattice.cell};
  memory->SetGeoTransform(geotransform.data());
  set_crs(*memory, crs);
  memory->SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_AREA);
  return memory;
}

template <class T>
void add_memory_band(GDALDataset& d, std::vector<T>& values, const std::string& name) {
  CPLStringList options;
  options.SetNameValue("DATAPOINTER", pointer_text(values.data()).c_str());
  d.AddBand(type_of<T>, options.List());
  d.GetRasterBand(d.GetRasterCount())->SetDescription(name.c_str());
}
template void add_memory_band(GDALDataset&, std::vector<float>&, const std::string&);
template void add_memory_band(GDALDataset&, std::vector<std::uint8_t>&, const std::string&);
template void add_memory_band(GDALDataset&, std::vector<std::uint16_t>&, const std::string&);

void write_cog(const std::filesystem::path& file, GDALDataset& memory, Overviews overviews, const GdalMessages& messages) {
  OutputFile out(file);
  const char* const options[] = {"COMPRESS=DEFLATE",
                                 "PREDICTOR=YES",
                                 "OVERVIEW_COMPRESS=DEFLATE",
                                 "OVERVIEW_PREDICTOR=YES",
                                 "LEVEL=6",
                                 "BLOCKSIZE=512",
                                 "NUM_THREADS=1",
                                 "BIGTIFF=IF_SAFER",
                                 overviews == Overviews::average ? "OVERVIEW_RESAMPLING=AVERAGE" : "OVERVIEW_RESAMPLING=NEAREST",
                                 nullptr};
  const GdalSetting no_side_files("GDAL_PAM_ENABLED", "NO");
  const GdalSetting one_thread("GDAL_NUM_THREADS", "1");
  GDALDriver* cog = GetGDALDriverManager()->GetDriverByName("COG");
  if (!cog) throw core::Error("this GDAL has no COG driver", file.string(), "GDAL 3.1 or later is needed");
  {
    const Dataset made(cog->CreateCopy(out.temporary().c_str(), &memory, false, const_cast<char**>(options), nullptr, nullptr));
    if (!made) messages.fail_writing(file);
  }
  messages.check_written(file);
  check_blocks(out.temporary(), file, messages);
  out.commit();
}

}  // namespace swath::io
