// SPDX-License-Identifier: GPL-3.0-or-later
// GeoPackage 1.2 (OGC 12-128r15) through GDAL; DXF as vector_dxf.cpp writes it: a 3D polyline has flag 8, and 32 on its vertices
// (Autodesk, DXF Reference, POLYLINE and VERTEX).
#include "io/vector/feature_file.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>

#include "core/error.h"
#include "core/printable.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"
#include "io/vector/height_statement.h"
#include "io/vector/vector_sink.h"

namespace swath::io {
namespace {

void check_features(const std::filesystem::path& file, const SpatialLayer& layer) {
  for (size_t k = 0; k < layer.features.size(); ++k) {
    const SpatialFeature& f = layer.features[k];
    const std::string at = file.string() + ": " + layer.name + " " + std::to_string(k + 1);
    const size_t least = layer.shape == SpatialShape::point ? 1 : layer.shape == SpatialShape::line ? 2 : 3;
    const auto check = [&](const std::vector<Eigen::Vector3d>& places) {
      if (places.size() < least) throw core::Error("a feature has too few places", at);
      for (const Eigen::Vector3d& p : places)
        if (!p.allFinite()) throw core::Error("a feature holds a coordinate that is not finite", at);
    };
    check(f.places);
    for (const auto& hole : f.holes) {
      if (layer.shape != SpatialShape::polygon) throw core::Error("a feature that is not an area has a hole", at);
      check(hole);
    }
    bool same = f.values.size() == layer.fields.size();
    for (size_t i = 0; same && i < f.values.size(); ++i) same = f.values[i].index() == layer.fields[i].kind.index();
    if (!same) throw core::Error("a feature's values are not those of the layer's fields", at);
  }
}

std::unique_ptr<OGRGeometry> geometry_of(const SpatialLayer& layer, const SpatialFeature& f) {
  const auto place = [&](OGRSimpleCurve& line, const Eigen::Vector3d& p) {
    layer.flat ? line.addPoint(p.x(), p.y()) : line.addPoint(p.x(), p.y(), p.z());
  };
  if (layer.shape == SpatialShape::point) {
    const Eigen::Vector3d& p = f.places[0];
    return layer.flat ? std::make_unique<OGRPoint>(p.x(), p.y()) : std::make_unique<OGRPoint>(p.x(), p.y(), p.z());
  }
  if (layer.shape == SpatialShape::line) {
    auto line = std::make_unique<OGRLineString>();
    for (const Eigen::Vector3d& p : f.places) place(*line, p);
    return line;
  }
  auto area = std::make_unique<OGRPolygon>();
  const auto add = [&](const std::vector<Eigen::Vector3d>& places) {
    OGRLinearRing ring;
    for (const Eigen::Vector3d& p : places) place(ring, p);
    ring.closeRings();
    area->addRing(&ring);
  };
  add(f.places);
  for (const auto& hole : f.holes) add(hole);
  return area;
}

OGRwkbGeometryType type_of(const SpatialLayer& layer) {
  const OGRwkbGeometryType flat = layer.shape == SpatialShape::point  ? wkbPoint
                                  : layer.shape == SpatialShape::line ? wkbLineString
                                                                      : wkbPolygon;
  return layer.flat ? flat : wkbSetZ(flat);
}

void add_layer(GDALDataset& set, const SpatialLayer& what, const CrsFacts& facts, const GdalMessages& messages,
               const std::filesystem::path& file) {
  OGRSpatialReference srs;
  const bool compound = what.vertical && (facts.geographic || !facts.ellipsoidal);  // it has no projection with three axes
  if (!facts.empty) srs.SetFromUserInput(compound ? facts.wkt.c_str() : facts.horizontal_wkt.c_str());
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::string description = "DESCRIPTION=" + what.about + (what.flat ? "" : heights_statement(facts));
  const char* const options[] = {"GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=YES", what.about.empty() ? nullptr : description.c_str(),
                                 nullptr};
  OGRLayer* layer = set.CreateLayer(what.name.c_str(), facts.empty ? nullptr : &srs, type_of(what), const_cast<char**>(options));
  if (!layer) messages.fail_writing(file);
  for (const SpatialField& f : what.fields) {
    const bool real = std::holds_alternative<double>(f.kind), text = std::holds_alternative<std::string>(f.kind);
    OGRFieldDefn field(f.name.c_str(), real ? OFTReal : text ? OFTString : OFTInteger64);
    if (layer->CreateField(&field) != OGRERR_NONE) messages.fail_writing(file);
  }
  if (set.StartTransaction() != OGRERR_NONE) messages.fail_writing(file);
  for (const SpatialFeature& f : what.features) {
    OGRFeature feature(layer->GetLayerDefn());
    for (int k = 0; k < static_cast<int>(f.values.size()); ++k) {
      const FieldValue& v = f.values[static_cast<size_t>(k)];
      if (const double* number = std::get_if<double>(&v)) {
        if (std::isfinite(*number)) feature.SetField(k, *number);
      } else if (const std::int64_t* whole = std::get_if<std::int64_t>(&v)) {
        feature.SetField(k, static_cast<GIntBig>(*whole));
      } else {
        feature.SetField(k, std::get<std::string>(v).c_str());
      }
    }
    feature.SetGeometryDirectly(geometry_of(what, f).release());
    if (layer->CreateFeature(&feature) != OGRERR_NONE) messages.fail_writing(file);
  }
  if (set.CommitTransaction() != OGRERR_NONE) messages.fail_writing(file);
}

}  // namespace

void write_gpkg(const std::filesystem::path& file, const std::vector<SpatialLayer>& layers, const std::string& crs) {
  for (const SpatialLayer& layer : layers) check_features(file, layer);
  const CrsFacts facts = crs_facts(crs);
  OutputFile out(file);
  const GdalMessages messages;
  const GdalSetting date{"OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"};
  Dataset set = new_geopackage(out.temporary(), file, messages);
  for (const SpatialLayer& layer : layers) add_layer(*set, layer, facts, messages, file);
  set.reset();
  messages.check_written(file);
  out.commit();
}

void write_dxf(const std::filesystem::path& file, const std::vector<SpatialLayer>& layers, const std::string& crs) {
  for (const SpatialLayer& layer : layers) check_features(file, layer);
  const CrsFacts facts = crs_facts(crs);
  const int decimals = facts.geographic ? 9 : 4;
  TextStream text(file);
  const auto name_of = [](const SpatialLayer& layer) {
    std::string upper = layer.name;
    for (char& c : upper) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    return upper;
  };
  const auto place = [&](const Eigen::Vector3d& p) {
    text << "10\n";
    text.fixed(p.x(), decimals) << "\n20\n";
    text.fixed(p.y(), decimals) << "\n30\n";
    text.fixed(p.z(), decimals) << "\n";
  };
  const auto polyline = [&](const SpatialLayer& layer, const std::vector<Eigen::Vector3d>& places) {
    text << "0\nPOLYLINE\n8\n"
         << name_of(layer) << "\n66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n70\n"
         << (layer.shape == SpatialShape::polygon ? "9" : "8") << "\n";
    for (const Eigen::Vector3d& p : places) {
      text << "0\nVERTEX\n8\n" << name_of(layer) << "\n";
      place(p);
      text << "70\n32\n";
    }
    text << "0\nSEQEND\n8\n" << name_of(layer) << "\n";
  };
  text << "999\nCRS: " << (facts.empty ? std::string("not stated") : core::printable(facts.name)) << "\n999\nCoordinates in " << facts.unit
       << ", heights in " << facts.vertical_unit << ", " << core::printable(facts.vertical_name) << "\n";
  text << "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nTABLES\n";
  text << "0\nTABLE\n2\nLTYPE\n70\n1\n0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0.0\n0\nENDTAB\n";
  text << "0\nTABLE\n2\nLAYER\n70\n" << std::to_string(layers.size()) << "\n";
  for (size_t k = 0; k < layers.size(); ++k)
    text << "0\nLAYER\n2\n" << name_of(layers[k]) << "\n70\n0\n62\n" << std::to_string(1 + k % 7) << "\n6\nCONTINUOUS\n";
  text << "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  for (const SpatialLayer& layer : layers)
    for (const SpatialFeature& f : layer.features) {
      if (layer.shape == SpatialShape::point) {
        text << "0\nPOINT\n8\n" << name_of(layer) << "\n";
        place(f.places[0]);
        continue;
      }
      polyline(layer, f.places);
      for (const auto& hole : f.holes) polyline(layer, hole);
    }
  text << "0\nENDSEC\n0\nEOF\n";
  text.close();
}

void write_feature_csv(const std::filesystem::path& file, const SpatialLayer& layer) {
  check_features(file, layer);
  const auto row_of = [](const std::vector<std::string>& cells) {
    std::string row;
    for (size_t k = 0; k < cells.size(); ++k) row += (k > 0 ? "," : "") + core::csv_field(cells[k]);
    return row + "\n";
  };
  std::vector<std::string> cells;
  if (layer.shape == SpatialShape::point) cells = {"x", "y", "z"};
  for (const SpatialField& f : layer.fields) cells.push_back(f.name);
  std::string out = row_of(cells);
  for (const SpatialFeature& f : layer.features) {
    cells.clear();
    if (layer.shape == SpatialShape::point)
      for (int k = 0; k < 3; ++k) cells.push_back(fixed_text(f.places[0](k), 3));
    for (const FieldValue& v : f.values) {
      if (const double* number = std::get_if<double>(&v)) cells.push_back(std::isfinite(*number) ? fixed_text(*number, 4) : "");
      if (const std::int64_t* whole = std::get_if<std::int64_t>(&v)) cells.push_back(std::to_string(*whole));
      if (const std::string* words = std::get_if<std::string>(&v)) cells.push_back(*words);
    }
    out += row_of(cells);
  }
  write_text_file(file, out);
}

}  // namespace swath::io
