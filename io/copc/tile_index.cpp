// SPDX-License-Identifier: GPL-3.0-or-later
// Source: STAC Specification 1.0.0 (Item), STAC extensions pointcloud 1.0.0 and projection 1.1.0, laid out as QGIS and PDAL wrench read
// .vpc files. Deviation: the footprint in WGS84 is the box's outline with 8 points a side, whose sides are straight there.
#include "io/copc/tile_index.h"

#include <algorithm>
#include <cmath>

#include "core/geo/crs.h"
#include "core/time.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/line_layer.h"

namespace swath::io {
namespace {

using core::Value;

/// Corners of a box in map units, closed, with `steps` parts a side.
void outline(const TileFacts& f, double unit, int steps, std::vector<double>& x, std::vector<double>& y) {
  const double x0 = f.low[0] / unit, y0 = f.low[1] / unit, x1 = f.high[0] / unit, y1 = f.high[1] / unit;
  const double corner[5][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}};
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      x.push_back(corner[side][0] + t * (corner[side + 1][0] - corner[side][0]));
      y.push_back(corner[side][1] + t * (corner[side + 1][1] - corner[side][1]));
    }
  x.push_back(x0);
  y.push_back(y0);
}

Value array_of(std::initializer_list<Value> values) {
  Value out = Value::array();
  for (const Value& v : values) out.push(v);
  return out;
}

Value schema_of(const LasHeader& h) {
  Value out = Value::array();
  const auto add = [&](const std::string& name, int size, const char* type) {
    Value one = Value::object();
    one["name"] = name, one["size"] = size, one["type"] = type;
    out.push(one);
  };
  const LasLayout l = *las_layout(h.point_format);
  for (const char* axis : {"X", "Y", "Z"}) add(axis, 8, "floating");
  add("Intensity", 2, "unsigned");
  for (const char* name : {"ReturnNumber", "NumberOfReturns", "ScanDirectionFlag", "EdgeOfFlightLine", "Classification"})
    add(name, 1, "unsigned");
  add("ScanAngleRank", 4, "floating");
  add("UserData", 1, "unsigned");
  add("PointSourceId", 2, "unsigned");
  if (l.gps) add("GpsTime", 8, "floating");
  if (l.extended) add("ScanChannel", 1, "unsigned");
  if (l.rgb)
    for (const char* name : {"Red", "Green", "Blue"}) add(name, 2, "unsigned");
  if (l.nir) add("Infrared", 2, "unsigned");
  for (const LasExtra& e : h.extras) {
    if (e.type < 1 || e.type > 10) continue;
    const bool is_floating = e.type >= 9 || e.scale || e.offset;
    add(e.name, e.scale || e.offset ? 8 : e.size(), is_floating ? "floating" : e.type % 2 == 1 ? "unsigned" : "signed");
  }
  return out;
}

Value classes_of(const TileFacts& f) {
  Value counts = Value::array();
  for (int c = 0; c < 256; ++c)
    if (f.classes[c] > 0) {
      Value one = Value::object();
      one["value"] = c, one["count"] = f.classes[c];
      counts.push(one);
    }
  return counts;
}

bool has_times(const TileFacts& f) { return f.first_time <= f.last_time; }

Value item_of(const IndexedTile& tile, const TileIndex& index, const core::Crs& crs, const core::Transform& to_wgs84,
              const LasHeader& header) {
  constexpr int steps = 8;
  const TileFacts& f = tile.facts;
  Value item = Value::object();
  item["type"] = "Feature";
  item["stac_version"] = "1.0.0";
  item["stac_extensions"] = array_of({"https://stac-extensions.github.io/pointcloud/v1.0.0/schema.json",
                                      "https://stac-extensions.github.io/projection/v1.1.0/schema.json"});
  item["id"] = std::filesystem::path(tile.name).stem().string();
  std::vector<double> x, y;
  outline(f, index.unit, steps, x, y);
  std::vector<double> z(x.size(), 0.5 * (f.low[2] + f.high[2]) / index.vertical_unit);
  to_wgs84.apply(x.data(), y.data(), z.data(), x.size());
  Value ring = Value::array();
  for (std::size_t i = 0; i < x.size(); ++i) ring.push(array_of({x[i], y[i]}));
  item["geometry"]["type"] = "Polygon";
  item["geometry"]["coordinates"] = array_of({ring});
  const auto [west, east] = std::minmax_element(x.begin(), x.end());
  const auto [south, north] = std::minmax_element(y.begin(), y.end());
  item["bbox"] = array_of({*west, *south, *east, *north});
  Value& p = item["properties"];
  p["datetime"] = has_times(f) ? core::utc_text(core::GpsTime(f.first_time)) : index.date;
  if (has_times(f))
    p["start_datetime"] = core::utc_text(core::GpsTime(f.first_time)), p["end_datetime"] = core::utc_text(core::GpsTime(f.last_time));
  p["pc:count"] = f.points;
  p["pc:type"] = "lidar";
  p["pc:encoding"] = header.compressed ? "application/vnd.laszip" : "application/vnd.las";
  p["pc:density"] = f.density();
  p["pc:schemas"] = schema_of(header);
  Value heights = Value::object(), classes = Value::object();
  heights["name"] = "Z", heights["minimum"] = f.low[2] / index.vertical_unit, heights["maximum"] = f.high[2] / index.vertical_unit;
  classes["name"] = "Classification", classes["count"] = f.points;
  p["pc:statistics"] = array_of({heights, classes});
  p["swath:classes"] = classes_of(f);
  p["proj:epsg"] = crs.epsg() && !crs.has_vertical() ? Value(crs.epsg()) : Value();
  p["proj:wkt2"] = crs.wkt();
  p["proj:bbox"] = array_of({f.low[0] / index.unit, f.low[1] / index.unit, f.low[2] / index.vertical_unit, f.high[0] / index.unit,
                             f.high[1] / index.unit, f.high[2] / index.vertical_unit});
  const Value encoding = p["pc:encoding"];
  item["links"] = Value::array();
  Value& data = item["assets"]["data"];
  data["href"] = "./" + tile.name;
  data["type"] = encoding;
  data["roles"] = array_of({"data"});
  return item;
}

}  // namespace

void TileFactsOf::add(const core::Block& b) {
  TileFacts& f = facts_;
  f.points += b.size();
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double at[3] = {b.x[i] + b.origin.x(), b.y[i] + b.origin.y(), b.z[i] + b.origin.z()};
    for (int k = 0; k < 3; ++k) f.low[k] = std::min(f.low[k], at[k]), f.high[k] = std::max(f.high[k], at[k]);
    const auto cell = [&](int k) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(at[k] / TileFacts::cell))); };
    cells_.insert(cell(0) << 32 | (cell(1) & 0xffffffffu));
    if (!b.classification.empty()) ++f.classes[b.classification[i]];
    if (!b.return_number.empty()) f.first_returns += b.return_number[i] == 1;
    if (!b.time.empty() && b.time[i] > 0.0)
      f.first_time = std::min(f.first_time, b.time[i]), f.last_time = std::max(f.last_time, b.time[i]);
  }
}

TileFacts TileFactsOf::facts() const {
  TileFacts f = facts_;
  f.cells = cells_.size();
  return f;
}

void write_vpc(const std::filesystem::path& file, const TileIndex& index, const LasHeader& header) {
  const core::Crs crs(index.crs);
  const core::Transform to_wgs84(crs.horizontal(), core::Crs("EPSG:4326"));
  Value list = Value::object();
  list["type"] = "FeatureCollection";
  Value& features = list["features"];
  features = Value::array();
  for (const IndexedTile& tile : index.tiles)
    if (tile.facts.points > 0) features.push(item_of(tile, index, crs, to_wgs84, header));
  write_text_file(file, to_json(list));
}

void write_tile_layer(const std::filesystem::path& file, const TileIndex& index) {
  LineLayer layer{"tiles",
                  "Tiles of the point cloud",
                  {"points", "first_returns", "points_per_m2", "lowest", "highest"},
                  {},
                  {"first_time", "last_time", "classes"},
                  true};
  for (const IndexedTile& tile : index.tiles) {
    const TileFacts& f = tile.facts;
    if (f.points == 0) continue;
    std::vector<double> x, y;
    outline(f, index.unit, 1, x, y);
    std::string classes;
    for (int c = 0; c < 256; ++c)
      if (f.classes[c] > 0) classes += (classes.empty() ? "" : ", ") + std::to_string(c) + ": " + std::to_string(f.classes[c]);
    const auto time = [&](double t) { return has_times(f) ? core::utc_text(core::GpsTime(t)) : std::string(); };
    layer.lines.push_back({tile.name,
                           x,
                           y,
                           {static_cast<double>(f.points), static_cast<double>(f.first_returns), f.density(),
                            f.low[2] / index.vertical_unit, f.high[2] / index.vertical_unit},
                           {time(f.first_time), time(f.last_time), classes}});
  }
  write_line_layer(file, layer, index.crs);
}

}  // namespace swath::io
