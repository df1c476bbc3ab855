// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/image_table.h"

#include <limits>
#include <unordered_map>

#include "core/config/units.h"
#include "core/error.h"
#include "io/text/text_table.h"

namespace swath::calib {
namespace {

std::array<const char*, 3> angle_columns(ImageAngles kind) {
  if (kind == ImageAngles::roll_pitch_heading) return {"roll", "pitch", "heading"};
  return {"omega", "phi", "kappa"};
}

void add_control_table(const BlockControlFile& f, std::vector<SurveyedPoint>& out) {
  const io::TextTable table(f.file);
  const size_t name = table.column(f.name), x = table.column(f.x), y = table.column(f.y), z = table.column(f.z);
  const auto h = table.column_if_there(f.sigma_h, "sigma_h"), v = table.column_if_there(f.sigma_v, "sigma_v");
  for (size_t r = 0; r < table.rows(); ++r) {
    SurveyedPoint p;
    p.name = table.name(r, name, "the point");
    const bool is_blank = table.text(r, x).empty() && table.text(r, y).empty() && table.text(r, z).empty();
    p.map.setConstant(std::numeric_limits<double>::quiet_NaN());  // planned, not surveyed
    if (!is_blank) p.map = {table.number(r, x), table.number(r, y), table.number(r, z)};
    p.sigma_h = h ? table.number(r, *h) : f.sigma_horizontal.value, p.sigma_v = v ? table.number(r, *v) : f.sigma_vertical.value;
    if (!(p.sigma_h > 0.0 && p.sigma_v > 0.0)) throw core::Error("a sigma is not above 0", table.place(r));
    p.kind = f.kind, p.check = f.use == io::ControlUse::check, p.place = table.place(r);
    out.push_back(std::move(p));
  }
}

}  // namespace

std::uint32_t camera_number(const BlockConfig& c, const std::string& name, const std::string& place) {
  for (size_t k = 0; k < c.cameras.size(); ++k)
    if (c.cameras[k].name == name) return static_cast<std::uint32_t>(k);
  throw core::Error("camera " + name + " is not in the config", place, "add a [[camera]] of that name");
}

std::vector<ImageRow> read_image_table(const BlockConfig& config) {
  const ImagesConfig& c = config.images;
  const io::TextTable table(c.file);
  const size_t name = table.column(c.name), x = table.column(c.x), y = table.column(c.y), z = table.column(c.z),
               strip = table.column(c.strip), time = table.column(c.time);
  const auto camera = table.column_if_there(c.camera, "camera"), h = table.column_if_there(c.sigma_h, "sigma_h"),
             v = table.column_if_there(c.sigma_v, "sigma_v");
  if (!camera && config.cameras.size() > 1)
    throw core::Error("several cameras, and the table of images has no column \"" + c.camera + "\"", c.file.string());
  std::array<size_t, 3> angle{};
  if (c.angles != ImageAngles::none)
    for (size_t k = 0; k < 3; ++k) angle[k] = table.column(angle_columns(c.angles)[k]);
  std::vector<ImageRow> out;
  std::unordered_map<std::string, std::string> known;
  for (size_t r = 0; r < table.rows(); ++r) {
    ImageRow row;
    BlockImage& image = row.image;
    image.name = table.name(r, name, "the image");
    image.camera = camera ? camera_number(config, table.text(r, *camera), table.place(r)) : 0;
    image.strip = table.whole_number(r, strip, "the strip");
    image.time = table.number(r, time);
    const auto [it, is_new] = known.try_emplace(image.name, table.place(r));
    if (!is_new) throw core::Error("image " + image.name + " is there twice, first in " + it->second, table.place(r));
    row.map = {table.number(r, x), table.number(r, y), table.number(r, z)};
    row.sigma_h = h ? table.number(r, *h) : c.sigma_station_h.value;
    row.sigma_v = v ? table.number(r, *v) : c.sigma_station_v.value;
    if (!(row.sigma_h > 0.0 && row.sigma_v > 0.0)) throw core::Error("a sigma of the station is not above 0", table.place(r));
    if (c.angles != ImageAngles::none)
      for (size_t k = 0; k < 3; ++k) row.angles[k] = table.number(r, angle[k]) * core::degree;
    out.push_back(std::move(row));
  }
  return out;
}

std::vector<SurveyedPoint> read_control_tables(const BlockConfig& config) {
  std::vector<SurveyedPoint> out;
  for (const BlockControlFile& f : config.control) add_control_table(f, out);
  return out;
}

}  // namespace swath::calib
