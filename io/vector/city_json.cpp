// SPDX-License-Identifier: GPL-3.0-or-later
// CityJSON 2.0 (OGC 20-072r5): chapters on the transform, metadata, geometry objects and semantics.
#include "io/vector/city_json.h"

#include <ogr_spatialref.h>
#include <rapidjson/stringbuffer.h>
#include <rapidjson/writer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;
using Writer = rapidjson::Writer<rapidjson::StringBuffer>;
using Vertex = std::array<std::int64_t, 3>;

constexpr double vertex_step = 0.001;  // CRS units

/// EPSG's code of the CRS, of its horizontal part where a compound one has none; empty where neither has one.
std::string epsg_code(const std::string& crs) {
  if (crs.empty()) return {};
  const core::Crs given(crs);
  OGRSpatialReference srs;
  if (srs.SetFromUserInput(given.wkt().c_str()) == OGRERR_NONE)
    if (const char* name = srs.GetAuthorityName(nullptr), *code = srs.GetAuthorityCode(nullptr);
        name && code && std::string(name) == "EPSG")
      return code;
  return given.epsg() > 0 ? std::to_string(given.epsg()) : "";
}

struct Extent {
  Vector3d low{0.0, 0.0, 0.0}, high = low;
  bool any = false;
  void add(const Vector3d& p) {
    low = any ? Vector3d(low.cwiseMin(p)) : p;
    high = any ? Vector3d(high.cwiseMax(p)) : p;
    any = true;
  }
};

template <class F>
void for_each_vertex(const CityObject& object, F&& f) {
  for (const CityGeometry& g : object.geometries)
    for (const CitySurface& s : g.surfaces)
      for (const auto& ring : s.rings)
        for (const Vector3d& p : ring) f(p);
}

class CityWriter {
 public:
  CityWriter(Writer& out, const Extent& extent) : out_(out), extent_(extent) {
    for (int k = 0; k < 3; ++k) origin_(k) = std::floor(extent.low(k));
  }

  void write(const std::vector<CityObject>& objects, const std::string& crs, const std::string& title) {
    out_.StartObject();
    member("type", "CityJSON");
    member("version", "2.0");
    out_.Key("transform");
    out_.StartObject();
    numbers("scale", {vertex_step, vertex_step, vertex_step});
    numbers("translate", {origin_.x(), origin_.y(), origin_.z()});
    out_.EndObject();
    write_metadata(crs, title);
    out_.Key("CityObjects");
    out_.StartObject();
    for (const CityObject& o : objects) write_object(o);
    out_.EndObject();
    out_.Key("vertices");
    out_.StartArray();
    for (const Vertex& v : vertices_) {
      out_.StartArray();
      for (const std::int64_t c : v) out_.Int64(c);
      out_.EndArray();
    }
    out_.EndArray();
    out_.EndObject();
  }

 private:
  void member(const char* key, const std::string& text) {
    out_.Key(key);
    out_.String(text.c_str(), static_cast<rapidjson::SizeType>(text.size()));
  }
  void numbers(const char* key, const std::vector<double>& values) {
    out_.Key(key);
    out_.StartArray();
    for (const double v : values) out_.Double(v);
    out_.EndArray();
  }
  void extent(const Extent& e) {
    if (e.any) numbers("geographicalExtent", {e.low.x(), e.low.y(), e.low.z(), e.high.x(), e.high.y(), e.high.z()});
  }

  void write_metadata(const std::string& crs, const std::string& title) {
    out_.Key("metadata");
    out_.StartObject();
    extent(extent_);
    if (const std::string code = epsg_code(crs); !code.empty()) member("referenceSystem", "https://www.opengis.net/def/crs/EPSG/0/" + code);
    if (!title.empty()) member("title", title);
    out_.EndObject();
  }

  void write_object(const CityObject& o) {
    out_.Key(o.id.c_str());
    out_.StartObject();
    member("type", o.type);
    Extent own;
    for_each_vertex(o, [&](const Vector3d& p) { own.add(p); });
    extent(own);
    out_.Key("attributes");
    out_.StartObject();
    for (const auto& [name, value] : o.attributes) write_attribute(name, value);
    out_.EndObject();
    out_.Key("geometry");
    out_.StartArray();
    for (const CityGeometry& g : o.geometries)
      if (!g.surfaces.empty()) write_geometry(g);
    out_.EndArray();
    out_.EndObject();
  }

  void write_attribute(const std::string& name, const FieldValue& value) {
    if (const std::string* text = std::get_if<std::string>(&value)) return member(name.c_str(), *text);
    const double* number = std::get_if<double>(&value);
    if (number && !std::isfinite(*number)) return;
    out_.Key(name.c_str());
    number ? out_.Double(*number) : out_.Int64(std::get<std::int64_t>(value));
  }

  void write_geometry(const CityGeometry& g) {
    std::vector<std::vector<std::vector<size_t>>> surfaces;
    std::vector<std::string> kinds, of_surface;
    for (const CitySurface& s : g.surfaces) {
      std::vector<std::vector<size_t>> rings;
      for (const auto& ring : s.rings) {
        std::vector<size_t> numbers = numbers_of(ring);
        if (numbers.size() >= 3)
          rings.push_back(std::move(numbers));
        else if (rings.empty())
          break;  // without its outer ring there is no surface
      }
      if (rings.empty()) continue;
      surfaces.push_back(std::move(rings));
      of_surface.push_back(s.semantics);
      if (!s.semantics.empty() && std::find(kinds.begin(), kinds.end(), s.semantics) == kinds.end()) kinds.push_back(s.semantics);
    }
    out_.StartObject();
    member("type", g.is_solid ? "Solid" : "MultiSurface");
    member("lod", g.lod);
    out_.Key("boundaries");
    if (g.is_solid) out_.StartArray();  // the only shell
    out_.StartArray();
    for (const auto& surface : surfaces) {
      out_.StartArray();
      for (const auto& ring : surface) {
        out_.StartArray();
        for (const size_t v : ring) out_.Uint64(v);
        out_.EndArray();
      }
      out_.EndArray();
    }
    out_.EndArray();
    if (g.is_solid) out_.EndArray();
    if (!kinds.empty()) write_semantics(g.is_solid, kinds, of_surface);
    out_.EndObject();
  }

  void write_semantics(bool is_solid, const std::vector<std::string>& kinds, const std::vector<std::string>& of_surface) {
    out_.Key("semantics");
    out_.StartObject();
    out_.Key("surfaces");
    out_.StartArray();
    for (const std::string& kind : kinds) {
      out_.StartObject();
      member("type", kind);
      out_.EndObject();
    }
    out_.EndArray();
    out_.Key("values");
    if (is_solid) out_.StartArray();
    out_.StartArray();
    for (const std::string& kind : of_surface) {
      const auto at = std::find(kinds.begin(), kinds.end(), kind);
      if (at == kinds.end())
        out_.Null();
      else
        out_.Int64(at - kinds.begin());
    }
    out_.EndArray();
    if (is_solid) out_.EndArray();
    out_.EndObject();
  }

  std::vector<size_t> numbers_of(const std::vector<Vector3d>& ring) {
    std::vector<size_t> out;
    for (const Vector3d& p : ring) {
      const Vertex v{std::llround((p.x() - origin_.x()) / vertex_step), std::llround((p.y() - origin_.y()) / vertex_step),
                     std::llround((p.z() - origin_.z()) / vertex_step)};
      const auto [known, is_new] = number_.try_emplace(v, vertices_.size());
      if (is_new) vertices_.push_back(v);
      if (out.empty() || out.back() != known->second) out.push_back(known->second);
    }
    while (out.size() > 1 && out.front() == out.back()) out.pop_back();
    return out;
  }

  Writer& out_;
  const Extent& extent_;
  Vector3d origin_;
  std::vector<Vertex> vertices_;
  std::map<Vertex, size_t> number_;
};

}  // namespace

void write_city_json(const std::filesystem::path& file, const std::vector<CityObject>& objects, const std::string& crs,
                     const std::string& title) {
  Extent extent;
  std::set<std::string> ids;
  for (const CityObject& o : objects) {
    if (!ids.insert(o.id).second) throw core::Error("two objects have the same id", file.string() + ": " + o.id);
    for_each_vertex(o, [&](const Vector3d& p) {
      if (!p.allFinite()) throw core::Error("an object holds a coordinate that is not finite", file.string() + ": " + o.id);
      extent.add(p);
    });
  }
  rapidjson::StringBuffer text;
  Writer writer(text);
  CityWriter(writer, extent).write(objects, crs, title);
  write_text_file(file, std::string_view(text.GetString(), text.GetSize()));
}

}  // namespace swath::io
