// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/images/image_list.h"

#include "core/error.h"
#include "io/text/text_table.h"

namespace swath::io {

std::vector<ListedImage> read_listed_images(const std::filesystem::path& path, const ImageListFile& f) {
  const ImageListFile usual;
  const TextTable table(path);
  const size_t name = table.column(f.name), event = table.column(f.event);
  const auto camera = table.column_if_there(f.camera, usual.camera), strip = table.column_if_there(f.strip, usual.strip);
  std::vector<ListedImage> out;
  for (size_t r = 0; r < table.rows(); ++r) {
    ListedImage image{table.name(r, name, "the image"), table.text(r, event), {}, {}, table.place(r)};
    if (image.event.empty())
      throw core::Error("image " + image.name + " names no event", image.place,
                        "each image of the list needs its name and the id of its event");
    if (camera && !table.text(r, *camera).empty()) image.camera = table.text(r, *camera);
    if (strip && !table.text(r, *strip).empty()) image.strip = table.whole_number(r, *strip, "the strip");
    out.push_back(std::move(image));
  }
  return out;
}

}  // namespace swath::io
