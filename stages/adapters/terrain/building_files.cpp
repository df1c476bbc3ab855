// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/terrain/building_files.h"

#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "stages/adapters/terrain/on_map.h"
#include "terrain/buildings/roof_solid.h"

namespace swath::stages {
namespace {

using terrain::Building;

std::vector<Eigen::Vector3d> ring_on_map(const terrain::Ring& ring, const OnMap& place, const terrain::RoofPlane* plane) {
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector2d& p : ring) {
    const double z = plane ? plane->height(p) : 0.0;
    out.push_back(place({p.x(), p.y(), z}));
  }
  return out;
}

io::SpatialFeature area_feature(const terrain::Outline& outline, const OnMap& place, const terrain::RoofPlane* plane) {
  io::SpatialFeature out{ring_on_map(outline.outer, place, plane), {}};
  for (const terrain::Ring& hole : outline.holes) out.holes.push_back(ring_on_map(hole, place, plane));
  return out;
}

io::FieldValue number_of(size_t n) { return static_cast<std::int64_t>(n); }

/// The fields of a building; heights in m, those of ground and roof top in the unit of the CRS.
std::vector<std::pair<std::string, io::FieldValue>> fields_of(const Building& b, size_t number, const OnMap& place,
                                                              const HeightChoices& o) {
  const double ground = ground_of(b, o.ground);
  return {{"building", number_of(number)},
          {"area", b.area},
          {"eaves", b.eaves - ground},
          {"ridge", b.ridge - ground},
          {"ground_lowest", place.height(b.lowest_ground)},
          {"ground_mean", place.height(b.mean_ground)},
          {"roof_eaves", place.height(b.eaves)},
          {"roof_middle", place.height(b.middle)},
          {"roof_ridge", place.height(b.ridge)},
          {"roof_top", place.height(b.top)},
          {"planes", number_of(b.planes.size())},
          {"explained", b.explained},
          {"returns", number_of(b.returns)},
          {"courtyards", number_of(b.outline.holes.size())},
          {"squared", std::int64_t{b.squared}},
          {"cut", std::int64_t{b.is_cut}}};
}

double block_top(const Building& b, BlockTop which) {
  const double top = which == BlockTop::eaves ? b.eaves : which == BlockTop::ridge ? b.ridge : b.middle;
  return std::isfinite(top) ? top : b.middle;
}

const char* semantics_of(terrain::Boundary kind) {
  return kind == terrain::Boundary::ground ? "GroundSurface" : kind == terrain::Boundary::roof ? "RoofSurface" : "WallSurface";
}

io::CityGeometry city_geometry(const char* lod, bool is_solid, const terrain::Solid& faces, const OnMap& place) {
  io::CityGeometry out{lod, is_solid, {}};
  for (const terrain::SolidFace& face : faces) {
    io::CitySurface surface{semantics_of(face.kind), face.rings};
    for (auto& ring : surface.rings)
      for (Eigen::Vector3d& p : ring) p = place(p);
    out.surfaces.push_back(std::move(surface));
  }
  return out;
}

}  // namespace

double ground_of(const Building& b, GroundReference from) { return from == GroundReference::mean ? b.mean_ground : b.lowest_ground; }

std::vector<io::SpatialLayer> building_layers(const std::vector<Building>& buildings, const Context& context, const HeightChoices& o) {
  const OnMap place{context};
  io::SpatialLayer outlines{"buildings",
                            std::string("Outlines; area in m2; eaves and ridge in m above the ") +
                                (o.ground == GroundReference::mean ? "mean" : "lowest") +
                                " ground along the outline; ground_ and roof_ are heights in the unit of the CRS",
                            io::SpatialShape::polygon,
                            true,
                            {},
                            {}};
  for (auto& [name, kind] : fields_of({}, 0, place, o)) outlines.fields.push_back({name, kind});
  io::SpatialLayer roofs{"roof_planes",
                         "Pieces of roofs on one plane; slope in deg, aspect in deg clockwise from north, rms in m, areas in m2",
                         io::SpatialShape::polygon,
                         false,
                         {{"building", std::int64_t{}},
                          {"plane", std::int64_t{}},
                          {"slope", 0.0},
                          {"aspect", 0.0},
                          {"rms", 0.0},
                          {"returns", std::int64_t{}},
                          {"area", 0.0},
                          {"area_sloped", 0.0}},
                         {}};
  for (size_t k = 0; k < buildings.size(); ++k) {
    const Building& b = buildings[k];
    outlines.features.push_back(area_feature(b.outline, place, nullptr));
    for (auto& [name, value] : fields_of(b, k + 1, place, o)) outlines.features.back().values.push_back(value);
    for (const terrain::RoofFace& face : b.faces) {
      const terrain::RoofPlane& plane = b.planes[face.plane];
      const double area = face.outline.area();
      roofs.features.push_back(area_feature(face.outline, place, &plane));
      roofs.features.back().values = {number_of(k + 1),
                                      number_of(face.plane + 1),
                                      core::to_degrees(plane.inclination()),
                                      core::to_degrees(plane.aspect()),
                                      plane.rms,
                                      number_of(plane.returns),
                                      area,
                                      area / std::cos(plane.inclination())};
    }
  }
  return {outlines, roofs};
}

CityBuildings city_buildings(const std::vector<Building>& buildings, const Context& context, const HeightChoices& o) {
  const OnMap place{context};
  CityBuildings out;
  for (size_t k = 0; k < buildings.size(); ++k) {
    const Building& b = buildings[k];
    io::CityObject object;
    object.id = "building-" + std::to_string(k + 1);
    object.attributes = fields_of(b, k + 1, place, o);
    object.attributes.emplace_back(
        "height_from", std::string(core::Choices<GroundReference>::names[static_cast<size_t>(o.ground)]) + " ground along the outline");
    object.attributes.emplace_back("block_top", std::string(core::Choices<BlockTop>::names[static_cast<size_t>(o.block)]) + " of the roof");
    if (std::isfinite(b.lowest_ground))
      object.geometries.push_back(
          city_geometry("0", false, {terrain::level_face(b.outline, b.lowest_ground, terrain::Boundary::ground)}, place));
    if (std::isfinite(b.eaves))
      object.geometries.push_back(city_geometry("0", false, {terrain::level_face(b.outline, b.eaves, terrain::Boundary::roof)}, place));
    const terrain::Solid block = terrain::block_over(b.outline, b.lowest_ground, block_top(b, o.block));
    if (!block.empty() && terrain::is_closed(block))
      object.geometries.push_back(city_geometry("1", true, block, place));
    else
      ++out.without_block;
    if (const terrain::Solid with_roof = terrain::roof_solid(b, b.lowest_ground); !with_roof.empty()) {
      object.geometries.push_back(city_geometry("2", true, with_roof, place));
      ++out.with_roof;
    }
    out.objects.push_back(std::move(object));
  }
  return out;
}

}  // namespace swath::stages
