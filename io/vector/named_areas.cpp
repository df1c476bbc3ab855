// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/named_areas.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>

#include "core/config/units.h"
#include "core/error.h"
#include "core/printable.h"
#include "io/vector/gdal_door.h"

namespace swath::io {

namespace {

void add_rings(const OGRPolygon& p, std::vector<std::vector<double>>& x, std::vector<std::vector<double>>& y) {
  for (const OGRLinearRing* ring : p) {
    std::vector<double>&xs = x.emplace_back(), &ys = y.emplace_back();
    for (int i = 0; i < ring->getNumPoints(); ++i) xs.push_back(ring->getX(i)), ys.push_back(ring->getY(i));
  }
}

void expect_same_crs(const OGRLayer& layer, const std::string& crs, const std::filesystem::path& file) {
  const OGRSpatialReference* stated = const_cast<OGRLayer&>(layer).GetSpatialRef();
  const CrsFacts facts = crs_facts(crs);
  if (stated_wkt(stated).empty() || facts.empty) return;
  OGRSpatialReference wanted;
  wanted.SetFromUserInput(facts.horizontal_wkt.c_str());
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", "CRITERION=EQUIVALENT", nullptr};
  OGRSpatialReference mine(*stated);
  if (mine.IsCompound()) mine.StripVertical();
  if (!mine.IsSame(&wanted, options))
    throw core::Error("its CRS, " + std::string(mine.GetName()) + ", is not that of the products, " + facts.name, file.string(),
                      "transform the file, for example by ogr2ogr -t_srs");
}

/// Names become names of files: none may lead to another folder.
void expect_name(const std::string& name, const std::filesystem::path& file, GIntBig feature) {
  const bool plain = !name.empty() && name.front() != '.' &&
                     std::none_of(name.begin(), name.end(), [](unsigned char c) { return c == '/' || c == '\\' || c < ' ' || c == 0x7f; });
  if (!plain)
    throw core::Error("'" + core::printable(name) + "' cannot be the name of a file",
                      file.string() + ": feature " + std::to_string(feature),
                      "names of areas are not empty, do not begin with a dot and hold no / or \\");
}

}  // namespace

NamedAreas::NamedAreas(const std::filesystem::path& file, const std::string& field, const std::string& crs) : file_(file) {
  const GdalMessages messages;
  const Dataset set = open_vector(file);
  if (!set) messages.fail("cannot read", file, "polygons of any vector format that GDAL reads are possible");
  bool has_field = false;
  for (OGRLayer* layer : set->GetLayers()) {
    const int column = layer->GetLayerDefn()->GetFieldIndex(field.c_str());
    if (column < 0) continue;
    has_field = true;
    expect_same_crs(*layer, crs, file);
    for (const auto& feature : *layer) {
      const OGRGeometry* g = feature->GetGeometryRef();
      if (!g) continue;
      Area area{feature->GetFieldAsString(column), {}, {}};
      const auto type = wkbFlatten(g->getGeometryType());
      if (type == wkbPolygon) add_rings(*g->toPolygon(), area.x, area.y);
      if (type == wkbMultiPolygon)
        for (const OGRPolygon* part : *g->toMultiPolygon()) add_rings(*part, area.x, area.y);
      if (area.x.empty()) continue;
      expect_name(area.name, file, feature->GetFID());
      areas_.push_back(std::move(area));
    }
  }
  if (!has_field) throw core::Error("no layer has a field '" + field + "'", file.string(), "name the field with the areas' names");
  if (areas_.empty()) throw core::Error("no polygon is in the file", file.string());
}

/// Even-odd rule over all rings.
bool NamedAreas::Area::holds(double px, double py) const {
  bool inside = false;
  for (std::size_t r = 0; r < x.size(); ++r)
    for (std::size_t i = 0, j = x[r].size() - 1; i < x[r].size(); j = i++)
      if ((y[r][i] > py) != (y[r][j] > py) && px < (x[r][j] - x[r][i]) * (py - y[r][i]) / (y[r][j] - y[r][i]) + x[r][i]) inside = !inside;
  return inside;
}

const std::string& NamedAreas::at(double x, double y) const {
  const Area* found = nullptr;
  const auto place = [&] { return core::format_number(x) + ", " + core::format_number(y); };
  for (const Area& a : areas_) {
    if (!a.holds(x, y)) continue;
    if (found)
      throw core::Error("the areas '" + found->name + "' and '" + a.name + "' both hold the place " + place(), file_.string(),
                        "areas must not overlap");
    found = &a;
  }
  if (!found) throw core::Error("no area holds the place " + place(), file_.string(), "areas must cover the survey, one per tile");
  return found->name;
}

}  // namespace swath::io
