// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/image_raster.h"

#include <gdal_priv.h>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

constexpr double most_samples = 1e9;

CPLErr transfer(GDALDataset& d, GDALRWFlag way, const ImageWindow& w, std::vector<std::uint16_t>& values, int bands) {
  const auto number = static_cast<GSpacing>(sizeof(std::uint16_t));
  return d.RasterIO(way, w.column, w.row, w.columns, w.rows, values.data(), w.columns, w.rows, GDT_UInt16, bands, nullptr, number * bands,
                    number * bands * w.columns, number, nullptr);
}

Dataset open_image(const std::filesystem::path& file, const GdalMessages& messages) {
  Dataset d(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
  if (!d) messages.fail("cannot read the image", file, "GDAL reads TIFF, JPEG, PNG and others");
  return d;
}

/// Bands and bits of a photograph, without values.
ImageRaster facts_of(GDALDataset& d, const std::filesystem::path& file) {
  ImageRaster out{d.GetRasterXSize(), d.GetRasterYSize(), d.GetRasterCount(), 8, {}};
  if (out.bands == 0) throw core::Error("the image has no band", file.string());
  for (int b = 1; b <= out.bands; ++b) {
    const GDALDataType type = d.GetRasterBand(b)->GetRasterDataType();
    if (type != GDT_Byte && type != GDT_UInt16)
      throw core::Error(std::string("the image's values are ") + GDALGetDataTypeName(type), file.string(),
                        "convert it to 8 or 16 bits (gdal_translate -ot UInt16)");
    if (type == GDT_UInt16) out.bits = 16;
    if (d.GetRasterBand(b)->GetColorTable())
      throw core::Error("the image's values are numbers of colours in a palette", file.string(),
                        "convert it to colours (gdal_translate -expand rgb)");
  }
  return out;
}

ImageRaster read_part(GDALDataset& d, const ImageWindow& w, const std::filesystem::path& file, const GdalMessages& messages) {
  ImageRaster out = facts_of(d, file);
  if (static_cast<double>(w.columns) * w.rows * out.bands > most_samples)
    throw core::Error("the image has more than a thousand million values", file.string());
  out.columns = w.columns, out.rows = w.rows;
  out.values.resize(out.at(0, out.rows));
  if (transfer(d, GF_Read, w, out.values, out.bands) != CE_None) messages.fail("cannot read the image", file);
  messages.check("cannot read the image", file);
  return out;
}

}  // namespace

ImageRaster read_image_raster(const std::filesystem::path& file) {
  const GdalMessages messages;
  const Dataset d = open_image(file, messages);
  return read_part(*d, {0, 0, d->GetRasterXSize(), d->GetRasterYSize()}, file, messages);
}

ImageRaster read_image_window(const std::filesystem::path& file, const ImageWindow& window) {
  const GdalMessages messages;
  const Dataset d = open_image(file, messages);
  return read_part(*d, window, file, messages);
}

ImageRaster read_image_facts(const std::filesystem::path& file) {
  const GdalMessages messages;
  const Dataset d = open_image(file, messages);
  return facts_of(*d, file);
}

void write_image_raster(const std::filesystem::path& file, const ImageRaster& image) {
  OutputFile out(file);
  const GdalMessages messages;
  const GdalSetting no_side_files("GDAL_PAM_ENABLED", "NO");
  const char* const options[] = {"COMPRESS=DEFLATE",
                                 "PREDICTOR=2",
                                 "TILED=YES",
                                 "BIGTIFF=IF_SAFER",
                                 "INTERLEAVE=PIXEL",
                                 "NUM_THREADS=1",
                                 image.bands >= 3 ? "PHOTOMETRIC=RGB" : "PHOTOMETRIC=MINISBLACK",
                                 nullptr};
  {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    if (!driver) throw core::Error("this GDAL has no GTiff driver", file.string());
    const Dataset made(driver->Create(out.temporary().c_str(), image.columns, image.rows, image.bands,
                                      image.bits == 16 ? GDT_UInt16 : GDT_Byte, const_cast<char**>(options)));
    if (!made) messages.fail_writing(file);
    std::vector<std::uint16_t> values = image.values;  // GDAL's writing takes no constant
    if (transfer(*made, GF_Write, {0, 0, image.columns, image.rows}, values, image.bands) != CE_None) messages.fail_writing(file);
  }
  messages.check_written(file);
  out.commit();
}

}  // namespace swath::io
