// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/orthophoto.h"

#include <cmath>
#include <limits>

#include "calib/block/imagery/image_colours.h"
#include "core/config/units.h"
#include "core/grid_units.h"
#include "core/printable.h"
#include "io/text/output_file.h"
#include "stages/adapters/imagery/photos.h"
#include "stages/tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
namespace {

constexpr const char *ortho_name = "images.orthophoto", *true_ortho_name = "images.true_orthophoto", *quality = "_quality",
                     *image_list = "_images.csv";

/// What a tile took from one photograph.
struct Share {
  std::uint32_t image = 0;
  std::uint64_t cells = 0;
  double variance = 0.0;  ///< sum over its cells, m^2
};

struct OrthoFindings : PhotoFindings {
  OrthoFindings() = default;
  std::uint64_t used = 0;
  double sigma = std::numeric_limits<double>::quiet_NaN();
};
template <class V>
void describe(const OrthoFindings& r, V& v) {
  describe(static_cast<const PhotoFindings&>(r), v);
  v.result("images_used", r.used, core::plain().in_summary(), "Photographs that the orthophoto shows.");
  v.result("sigma_plan_m", r.sigma, core::metres().in_summary().only_if(std::isfinite(r.sigma)),
           "Radial standard deviation of a place, root mean square, by orientations and the surface's heights.");
}

template <const Product& surface>
constexpr const char* product_name = surface == Product::dtm ? "orthophoto" : "true_orthophoto";

void write_quality(const TileRasters& out, TileKey key, const calib::Orthophoto& photo) {
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> image(photo.image.size(), unknown), angle(photo.image.size(), unknown);
  for (size_t k = 0; k < image.size(); ++k) {
    if (photo.image[k] == calib::no_image) continue;
    image[k] = static_cast<float>(photo.image[k] + 1);
    angle[k] = photo.off_nadir[k] / static_cast<float>(core::degree);
  }
  const Context& c = out.context;
  io::write_raster(
      out.file(key, quality), core::in_units(c.unit, photo.lattice),
      {{"sigma of place", "m", &photo.sigma}, {"angle to the vertical", "degree", &angle}, {"number of the image", "", &image}},
      c.product_crs, false);
}

/// What the band "number of the image" means, and what is taken from each.
void write_image_list(const std::filesystem::path& file, const calib::OrientedImages& images, const std::vector<Share>& shares) {
  std::string table = "number,image,file,cells,sigma_m\n";
  for (size_t i = 0; i < images.images.size(); ++i) {
    const Share& s = shares[i];
    const double sigma = std::sqrt(s.variance / static_cast<double>(s.cells));
    table += std::to_string(i + 1) + "," + core::csv_field(images.images[i].name) + "," +
             core::csv_field(images.images[i].file.filename().string()) + "," + std::to_string(s.cells) + "," +
             (std::isfinite(sigma) ? core::format_number(sigma, 4) : "") + "\n";
  }
  io::write_text_file(file, table);
}

void write_shares(const TileJob& job, const calib::Orthophoto& photo, size_t images) {
  std::vector<Share> of_image(images), used;
  for (size_t k = 0; k < photo.image.size(); ++k) {
    if (photo.image[k] == calib::no_image) continue;
    Share& s = of_image[photo.image[k]];
    ++s.cells, s.variance += std::pow(static_cast<double>(photo.sigma[k]), 2);
  }
  for (std::uint32_t i = 0; i < images; ++i)
    if (of_image[i].cells > 0) used.push_back({i, of_image[i].cells, of_image[i].variance});
  write_rows(piece_file(job.folder, job.key, "images"), used);
}

template <const Product& surface>
calib::OrthoCounts make_tile(const TileJob& job, const Context& context, const In<surface>& model, const calib::OrthoOptions& o,
                             RunCache& cache) {
  const calib::OrientedImages& images = cache.get([&] { return photos_of(context); });
  const core::Grid heights = model.over(job.box.grown(o.reach.value + 2.0 * model.cell()));
  const calib::Orthophoto photo = calib::make_orthophoto(images, heights, lattice_in(o.cell.value, job.box), o);
  const TileRasters out{context, product_name<surface>};
  std::vector<std::uint8_t> is_there(photo.image.size());
  for (size_t k = 0; k < is_there.size(); ++k) is_there[k] = photo.image[k] != calib::no_image;
  io::write_colours(out.file(job.key), core::in_units(context.unit, photo.lattice), {&photo.red, &photo.green, &photo.blue, &is_there},
                    images.bits, context.product_crs);
  write_quality(out, job.key, photo);
  write_shares(job, photo, images.images.size());
  return photo.counts;
}

template <const Product& surface>
OrthoFindings join_tiles(const MergeJob& job, const Context& context, RunCache& cache) {
  const calib::OrientedImages& images = cache.get([&] { return photos_of(context); });
  OrthoFindings out;
  static_cast<PhotoFindings&>(out) = findings_of(images);
  std::vector<Share> shares;
  for (const TileKey key : job.tiles) read_rows(piece_file(job.folder, key, "images"), shares);
  std::vector<char> used(images.images.size(), 0);
  double variance = 0.0, cells = 0.0;
  for (const Share& s : shares) used.at(s.image) = 1, variance += s.variance, cells += static_cast<double>(s.cells);
  for (const char u : used) out.used += u != 0;
  out.sigma = std::sqrt(variance / cells);
  std::uint64_t seen = 0;
  std::vector<Share> of_image(images.images.size());
  for (const Share& s : shares) of_image[s.image].cells += s.cells, of_image[s.image].variance += s.variance, seen += s.cells;
  expect_seen(images, context, job.tiles, seen, surface == Product::dtm ? ortho_name : true_ortho_name);
  write_image_list(context.output / (std::string(product_name<surface>) + image_list), images, of_image);
  TileRasters{context, product_name<surface>}.finish(job.tiles, {"", quality});
  return out;
}

TileMemory ortho_memory(const calib::OrthoOptions& o, const Context& c, Product surface) {
  constexpr double bytes_per_cell = 80.0;  // place, colour and bands, and the copies that are written
  TileMemory out{0.0, window_of(c, surface, 1)};
  for (Raster& r : out.rasters) r.side += 2.0 * o.reach.value;
  out.rasters.push_back({"cell", o.cell.value, c.tile_side, bytes_per_cell});
  out.rasters.push_back({"", 1.0, 1.0, photo_memory(c)});
  return out;
}

template <const Product& surface>
TileExtras<calib::OrthoOptions> extras() {
  return {.memory = [](const calib::OrthoOptions& o, const Context& c) { return ortho_memory(o, c, surface); },
          .check = [](const Context& c,
                      const calib::OrthoOptions&) { expect_photos(c, surface == Product::dtm ? ortho_name : true_ortho_name); },
          .inputs = photo_inputs,
          .products =
              [](const calib::OrthoOptions&) {
                const std::string name = product_name<surface>;
                return std::vector<std::string>{name, name + ".vrt", name + quality + ".vrt", name + image_list};
              }};
}

}  // namespace

Entry orthophoto_stage() {
  return tile<make_tile<Product::dtm>, join_tiles<Product::dtm>>(
      ortho_name, "Orthophoto on the DTM from oriented photographs, with the standard deviation of each cell's place.",
      extras<Product::dtm>());
}
Entry true_orthophoto_stage() {
  return tile<make_tile<Product::dsm>, join_tiles<Product::dsm>>(
      true_ortho_name, "True orthophoto on the surface model: roofs where they are, what no camera sees left void.",
      extras<Product::dsm>());
}

}  // namespace swath::stages
