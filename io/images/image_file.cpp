// SPDX-License-Identifier: GPL-3.0-or-later
// BINGO's image coordinates and PAT-B's are lists by image: a line with the image, lines "point x y", and -99 at the end of the image
// (programs that write BINGO files leave the -99 out: an image's line has no two numbers after its name). Neither format says of itself
// which unit and which sense of y it has.
#include "io/images/image_file.h"

#include "core/error.h"
#include "io/images/image_lines.h"
#include "io/text/line_reader.h"
#include "io/text/text_table.h"

namespace swath::io {
namespace {

bool is_pixel_format(ImageFormat f) { return f == ImageFormat::colmap || f == ImageFormat::opensfm || f == ImageFormat::blocks_exchange; }

ImageData stated(const ImageFile& f) {
  ImageData out;
  out.file = f.file;
  out.unit = *f.unit;
  out.y = *f.y;
  out.origin = *f.origin;
  return out;
}

/// Is the line one of an image, not of a point? `words` is not empty.
bool opens_image(const std::vector<std::string_view>& words, bool expected) {
  double number = 0.0;
  return expected || words.size() < 3 || !read_number(words[1], number) || !read_number(words[2], number);
}

/// `ended`: -99 is needed at the end of each image.
ImageData read_image_list(const ImageFile& f, bool ended) {
  ImageData out = stated(f);
  NumberedNames image_number(out.images), point_number(out.points);
  ImageLines lines(f.file);
  std::string_view line;
  bool expected = true;
  std::uint32_t image = 0;
  while (lines.next_data(line)) {
    const auto words = blank_words(line);
    if (words[0] == "-99" || words[0] == "-999") {
      expected = true;
      continue;
    }
    if (opens_image(words, expected && (ended || words.size() < 3))) {
      if (ended && !expected)
        lines.fail("neither a point nor the end of an image: \"" + std::string(line) + "\"", "an image ends in -99, a point is: name x y");
      image = image_number(words[0]);
      expected = false;
      continue;
    }
    if (out.images.empty()) lines.fail("a point before the first image", "the first line names an image");
    if (words.size() < 3) lines.fail("a point has three fields: name x y");
    out.marks.push_back({image, point_number(words[0]), lines.number_in(words[1], "x"), lines.number_in(words[2], "y"), lines.number()});
  }
  return out;
}

}  // namespace

ImageData read_image_csv(const ImageFile& f) {
  ImageData out = stated(f);
  const TextTable table(f.file);
  const size_t image = table.column(f.image_column), point = table.column(f.point_column), x = table.column(f.x_column),
               y = table.column(f.y_column);
  NumberedNames image_number(out.images), point_number(out.points);
  for (size_t r = 0; r < table.rows(); ++r) {
    const std::string place = table.place(r);
    const std::uint64_t line = std::stoull(place.substr(place.rfind(':') + 1));
    out.marks.push_back({image_number(table.name(r, image, "the image of an image point")),
                         point_number(table.name(r, point, "the image point")), table.number(r, x), table.number(r, y), line});
  }
  return out;
}

ImageData read_bingo(const ImageFile& f) { return read_image_list(f, false); }
ImageData read_patb(const ImageFile& f) { return read_image_list(f, true); }

std::vector<ConventionFault> convention_faults(const ImageFile& f) {
  std::vector<ConventionFault> out;
  if (is_pixel_format(f.format)) {
    const bool unit = f.unit && *f.unit != ImageUnit::pixel, y = f.y && *f.y != ImageY::down;
    if (unit || y || f.origin)
      out.push_back({unit ? "unit"
                     : y  ? "y"
                          : "origin",
                     "unit, y and origin are fixed by the format " +
                         std::string(core::Choices<ImageFormat>::names.at(static_cast<size_t>(f.format))) + " (pixels, y down)",
                     "leave them out"});
    return out;
  }
  if (!f.unit) out.push_back({"unit", "the unit of the image coordinates is not stated", "one of mm, um, pixel"});
  if (!f.y) out.push_back({"y", "the sense of the y axis is not stated", "one of up, down"});
  if (!f.origin) out.push_back({"origin", "the origin of the image coordinates is not stated", "one of middle, corner, pixel_centre"});
  return out;
}

bool needs_pixels(const ImageFile& f) {
  return is_pixel_format(f.format) || f.unit == ImageUnit::pixel || (f.origin && *f.origin != ImageOrigin::middle) || f.sigma_pixels;
}

std::vector<std::filesystem::path> files_of(const ImageFile& f) {
  if (f.format == ImageFormat::colmap) return {f.file / "cameras.txt", f.file / "images.txt"};
  if (f.format == ImageFormat::opensfm) return {f.file, f.file.parent_path() / "reconstruction.json"};
  return {f.file};
}

ImageData read_image_file(const ImageFile& f) {
  for (const ConventionFault& fault : convention_faults(f)) throw core::usage_error(fault.what, f.file.string(), fault.hint);
  switch (f.format) {
    case ImageFormat::csv:
      return read_image_csv(f);
    case ImageFormat::bingo:
      return read_bingo(f);
    case ImageFormat::patb:
      return read_patb(f);
    case ImageFormat::colmap:
      return read_colmap(f.file);
    case ImageFormat::opensfm:
      return read_opensfm(f.file);
    case ImageFormat::blocks_exchange:
      return read_blocks_exchange(f.file);
  }
  return {};
}

}  // namespace swath::io
