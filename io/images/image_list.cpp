// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/images/image_list.h"

#include <cmath>

#include "core/error.h"
#include "io/text/text_table.h"

namespace swath::io {
namespace {

int whole_strip(const TextTable& table, size_t row, size_t column) {
  const double strip = table.number(row, column);
  if (strip != std::floor(strip) || std::abs(strip) > 1e9)
    throw core::Error("the strip is not a whole number: " + table.text(row, column), table.place(row));
  return static_cast<int>(strip);
}

}  // namespace

std::vector<ListedImage> read_listed_images(const std::filesystem::path& path, const ImageListFile& f) {
  const ImageListFile usual;
  const TextTable table(path);
  const size_t name = table.column(f.name), event = table.column(f.event);
  const auto camera = table.column_if_there(f.camera, usual.camera), strip = table.column_if_there(f.strip, usual.strip);
  std::vector<ListedImage> out;
  for (size_t r = 0; r < table.rows(); ++r) {
    ListedImage image{table.text(r, name), table.text(r, event), {}, {}, table.place(r)};
    if (image.name.empty() || image.event.empty())
      throw core::Error(image.name.empty() ? "the image has no name" : "image " + image.name + " names no event", image.place,
                        "each image of the list needs its name and the id of its event");
    if (camera) image.camera = table.text(r, *camera);
    if (strip) image.strip = whole_strip(table, r, *strip);
    out.push_back(std::move(image));
  }
  return out;
}

}  // namespace swath::io
