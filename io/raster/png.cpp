// SPDX-License-Identifier: GPL-3.0-or-later
// libpng's simplified interface: errors come back as values, so that no longjmp passes over C++ objects.
#include "io/raster/png.h"

#include <png.h>

#include <algorithm>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"

namespace swath::io {

std::string png_bytes(const core::Picture& p, const std::filesystem::path& name) {
  const size_t expected = 3 * static_cast<size_t>(std::max(p.width, 0)) * static_cast<size_t>(std::max(p.height, 0));
  if (expected == 0 || p.rgb.size() != expected) throw core::Error("an empty or ragged picture cannot be written", name.string());
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(p.width);
  image.height = static_cast<png_uint_32>(p.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  const int done = png_image_write_to_memory(&image, bytes.data(), &size, 0, p.rgb.data(), 0, nullptr);
  if (!done) throw core::Error(std::string("cannot make the PNG: ") + image.message, name.string());
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& file, const core::Picture& picture) { write_text_file(file, png_bytes(picture, file)); }

core::Picture read_png(const std::filesystem::path& file) {
  const std::string bytes = read_text_file(file);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()))
    throw core::Error(std::string("is no PNG that can be read: ") + image.message, file.string());
  image.format = PNG_FORMAT_RGB;
  core::Picture p(static_cast<int>(image.width), static_cast<int>(image.height));
  const png_color white{255, 255, 255};
  if (!png_image_finish_read(&image, &white, p.rgb.data(), 0, nullptr))
    throw core::Error(std::string("the PNG is damaged: ") + image.message, file.string());
  return p;
}

}  // namespace swath::io
