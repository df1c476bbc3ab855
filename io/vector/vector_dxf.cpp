// SPDX-License-Identifier: GPL-3.0-or-later
// AutoCAD R12 (AC1009) text: the oldest form with layers and polylines, which every CAD and GIS reads and which needs no handles.
// A contour is a 2D POLYLINE whose elevation stands in group 30 (Autodesk, DXF Reference, POLYLINE and VERTEX).
// GDAL's driver was weighed: it writes R2000 with handles from template files that must be found at run time, states neither CRS nor units,
// and takes layers' colours and justified texts from style strings only.
#include <algorithm>
#include <array>
#include <limits>

#include "core/config/units.h"
#include "io/vector/vector_sink.h"

namespace swath::io {
namespace {

constexpr std::string_view ordinary_layer = "CONTOUR", index_layer = "CONTOUR_INDEX", depression_layer = "CONTOUR_DEPRESSION",
                           label_layer = "CONTOUR_LABEL", spot_layer = "SPOT_HEIGHT";
// AutoCAD colour index: grey, white on black or black on white, blue, red
constexpr int colour_ordinary = 8, colour_index = 7, colour_depression = 5, colour_spot = 1;
constexpr size_t patch_width = 24;  // of each number of the header's extent, which is known only at the end

std::string padded(double value, int decimals) {
  std::string text = fixed_text(value, decimals);
  return text.size() < patch_width ? std::string(patch_width - text.size(), ' ') + text : text.substr(0, patch_width);
}

class DxfSink : public ContourSink {
 public:
  DxfSink(const std::filesystem::path& file, const CrsFacts& crs) : text_(file), decimals_(crs.geographic ? 9 : 4) {
    comment("Contours. CRS: " + (crs.empty ? "not stated" : crs.name));
    comment("Coordinates in " + crs.unit + ", elevations in " + crs.vertical_unit + ", " + crs.vertical_name);
    text_ << "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n";
    extent("$EXTMIN", low_at_);
    extent("$EXTMAX", high_at_);
    text_ << "0\nENDSEC\n0\nSECTION\n2\nTABLES\n";
    text_ << "0\nTABLE\n2\nLTYPE\n70\n1\n0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0.0\n0\nENDTAB\n";
    text_ << "0\nTABLE\n2\nLAYER\n70\n6\n";
    layer("0", colour_index);
    layer(ordinary_layer, colour_ordinary);
    layer(index_layer, colour_index);
    layer(depression_layer, colour_depression);
    layer(label_layer, colour_index);
    layer(spot_layer, colour_spot);
    text_ << "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  }

  void add(const core::ContourLine& line) override {
    const std::string_view name = line.depression ? depression_layer : line.index ? index_layer : ordinary_layer;
    const std::string elevation = fixed_text(line.height, decimals_);
    text_ << "0\nPOLYLINE\n8\n" << name << "\n66\n1\n10\n0.0\n20\n0.0\n30\n" << elevation << "\n70\n" << (line.closed ? "1" : "0") << "\n";
    const size_t n = line.x.size() - (line.closed ? 1 : 0);  // the closing flag stands for the repeated vertex
    for (size_t k = 0; k < n; ++k) {
      text_ << "0\nVERTEX\n8\n" << name << "\n10\n";
      text_.fixed(line.x[k], decimals_) << "\n20\n";
      text_.fixed(line.y[k], decimals_) << "\n30\n" << elevation << "\n";
      note({line.x[k], line.y[k], line.height});
    }
    text_ << "0\nSEQEND\n8\n" << name << "\n";
  }

  void add(const core::ContourLabel& l) override {
    text(label_layer, l.x, l.y, l.height, l.text_height, l.rotation, 1, 2, l.text);  // centred, middle
  }

  void add(const core::SpotHeight& s) override {
    text_ << "0\nPOINT\n8\n" << spot_layer << "\n";
    place(10, s.x, s.y, s.height);
    text(spot_layer, s.x + 0.5 * s.text_height, s.y + 0.5 * s.text_height, s.height, s.text_height, 0.0, 0, 0, s.text);
  }

  void close() override {
    text_ << "0\nENDSEC\n0\nEOF\n";
    for (size_t axis = 0; axis < 3 && low_[0] <= high_[0]; ++axis) {
      text_.patch(low_at_[axis], padded(low_[axis], decimals_));
      text_.patch(high_at_[axis], padded(high_[axis], decimals_));
    }
    text_.close();
  }

 private:
  void place(int group, double x, double y, double z) {
    text_ << std::to_string(group) << "\n";
    text_.fixed(x, decimals_) << "\n" << std::to_string(group + 10) << "\n";
    text_.fixed(y, decimals_) << "\n" << std::to_string(group + 20) << "\n";
    text_.fixed(z, decimals_) << "\n";
    note({x, y, z});
  }
  /// Groups 40 height, 50 rotation in degrees, 72 and 73 justification, which goes by the second point (11, 21, 31).
  void text(std::string_view name, double x, double y, double z, double size, double rotation, int across, int up,
            const std::string& words) {
    text_ << "0\nTEXT\n8\n" << name << "\n";
    place(10, x, y, z);
    text_ << "40\n";
    text_.fixed(size, decimals_) << "\n1\n" << words << "\n50\n";
    text_.fixed(core::to_degrees(rotation), 4) << "\n72\n" << std::to_string(across) << "\n";
    place(11, x, y, z);
    text_ << "73\n" << std::to_string(up) << "\n";
  }
  void comment(const std::string& words) {
    std::string one_line = words;
    std::replace(one_line.begin(), one_line.end(), '\n', ' ');
    text_ << "999\n" << one_line << "\n";
  }
  void extent(std::string_view name, std::array<std::uint64_t, 3>& at) {
    text_ << "9\n" << name << "\n";
    for (size_t axis = 0; axis < 3; ++axis) {
      text_ << std::to_string(10 * (axis + 1)) << "\n";
      at[axis] = text_.bytes();
      text_ << padded(0.0, decimals_) << "\n";
    }
  }
  void layer(std::string_view name, int colour) {
    text_ << "0\nLAYER\n2\n" << name << "\n70\n0\n62\n" << std::to_string(colour) << "\n6\nCONTINUOUS\n";
  }
  void note(const std::array<double, 3>& p) {
    for (size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], p[axis]);
      high_[axis] = std::max(high_[axis], p[axis]);
    }
  }

  static constexpr double huge = std::numeric_limits<double>::infinity();
  TextStream text_;
  int decimals_;
  std::array<std::uint64_t, 3> low_at_{}, high_at_{};
  std::array<double, 3> low_{huge, huge, huge}, high_{-huge, -huge, -huge};
};

}  // namespace

std::unique_ptr<ContourSink> make_dxf_sink(const std::filesystem::path& file, const CrsFacts& crs) {
  return std::make_unique<DxfSink>(file, crs);
}

}  // namespace swath::io
