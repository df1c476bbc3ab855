// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/drawing_file.h"

#include "core/error.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"

namespace swath::stages {

bool names_drawing(std::string_view file) {
  const auto ending = std::filesystem::path(file).extension();
  return ending == ".png" || ending == ".svg" || ending == ".pdf";
}

void write_drawing(const std::filesystem::path& file, const report::Drawing& drawing) {
  const auto ending = file.extension();
  if (ending == ".png")
    io::write_png(file, report::draw(drawing));
  else if (ending == ".svg")
    io::write_text_file(file, report::svg(drawing));
  else if (ending == ".pdf")
    io::write_text_file(file, report::pdf(drawing));
  else
    throw core::Error("a drawing is written as .png, .svg or .pdf", file.string());
}

}  // namespace swath::stages
