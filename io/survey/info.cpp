// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/info.h"

#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "core/time.h"
#include "io/gnss/describe_gnss.h"
#include "io/gnss/nmea.h"
#include "io/gnss/rinex_header.h"
#include "io/gnss/rtklib_pos.h"
#include "io/las/describe_las.h"
#include "io/raster/geotiff.h"
#include "io/records/csd.h"
#include "io/records/describe_pcap.h"
#include "io/records/describe_trajectory.h"
#include "io/survey/read_survey.h"
#include "io/text/delimited.h"
#include "io/text/npy.h"
#include "io/text/value_file.h"
#include "io/vector/describe_vector.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using core::Value;
using Path = std::filesystem::path;

constexpr size_t chunk = 16384;

struct Column {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  std::uint64_t not_finite = 0;
  void add(double v) {
    if (!std::isfinite(v)) {
      ++not_finite;
      return;
    }
    low = std::min(low, v);
    high = std::max(high, v);
  }
  Value value() const { return low <= high ? Value(Value::Array{low, high}) : Value("no finite value"); }
};

void put_columns(const std::vector<std::string>& names, const std::vector<Column>& columns, Value& out, Value& warnings) {
  Value& list = out["columns"] = Value::object();
  for (size_t c = 0; c < names.size(); ++c) {
    list[names[c]] = columns[c].value();
    if (columns[c].not_finite)
      warnings.push("column " + names[c] + " holds " + std::to_string(columns[c].not_finite) + " values that are empty or not finite");
  }
}

Value describe_csd(const Path& path) {
  CsdReader file(path);
  const CsdHeader& h = file.header();
  Value out = Value::object(), warnings = Value::array();
  Column time, range, angle, latitude, longitude, height;
  std::map<int, std::uint64_t> returns;
  std::vector<CsdPulse> pulses;
  for (std::uint64_t at = 0; at < file.pulses(); at += pulses.size()) {
    file.read(at, static_cast<size_t>(std::min<std::uint64_t>(chunk, file.pulses() - at)), pulses);
    for (const CsdPulse& p : pulses) {
      time.add(p.time);
      angle.add(core::to_degrees(p.scan_angle));
      latitude.add(core::to_degrees(p.latitude));
      longitude.add(core::to_degrees(p.longitude));
      height.add(p.height);
      ++returns[p.return_count];
      for (int k = 0; k < p.return_count; ++k) range.add(p.range[static_cast<size_t>(k)]);
    }
  }
  const core::Calibration boresight = calibration_of(h);
  out["format"] = "Optech CSD";
  out["vendor"] = h.vendor;
  out["software"] = h.software;
  out["pulses"] = file.pulses();
  out["gps_week"] = h.gps_week;
  out["seconds_of_week"] = time.value();
  if (file.pulses()) out["from"] = core::utc_text(core::from_week(h.gps_week, time.low));
  Value& by = out["pulses_by_returns"] = Value::object();
  for (const auto& [n, count] : returns) by[std::to_string(n)] = count;
  out["range_m"] = range.value();
  out["scan_angle_deg"] = angle.value();
  out["carrier_latitude_deg"] = latitude.value();
  out["carrier_longitude_deg"] = longitude.value();
  out["carrier_height_m"] = height.value();
  out["boresight_roll_pitch_heading_deg"] =
      Value(Value::Array{core::to_degrees(boresight.roll), core::to_degrees(boresight.pitch), core::to_degrees(boresight.heading)});
  out["temperature_c"] = h.temperature;
  out["pressure_mbar"] = h.pressure;
  if (time.low < h.first_time - 1e-3 || time.high > h.last_time + 1e-3)
    warnings.push("the header states seconds " + core::format_number(h.first_time) + " to " + core::format_number(h.last_time) +
                  ", the pulses span others");
  if (time.not_finite + range.not_finite + angle.not_finite + latitude.not_finite + longitude.not_finite + height.not_finite)
    warnings.push("values that are not finite");
  if (range.low <= 0) warnings.push("ranges that are not positive");
  out["warnings"] = std::move(warnings);
  return out;
}

Value describe_npy(const Path& path) {
  const NpyHeader h = read_npy_header(path);
  Value out = Value::object(), warnings = Value::array();
  out["format"] = "NumPy array";
  out["rows"] = h.rows;
  std::vector<std::string> names;
  std::vector<size_t> numeric;
  Value& types = out["types"] = Value::object();
  for (size_t i = 0; i < h.fields.size(); ++i) {
    const NpyField& f = h.fields[i];
    const std::string name = f.name.empty() ? std::to_string(i + 1) : f.name;
    types[name] = f.type;
    if (std::string("uifb").find(f.kind) == std::string::npos || f.bytes > 8) continue;
    names.push_back(name);
    numeric.push_back(i);
  }
  NpyReader reader(path, numeric);
  std::vector<Column> columns(numeric.size());
  std::vector<std::vector<double>> values;
  for (std::uint64_t at = 0; at < h.rows; at += chunk) {
    reader.read(at, static_cast<size_t>(std::min<std::uint64_t>(chunk, h.rows - at)), values);
    for (size_t c = 0; c < columns.size(); ++c)
      for (const double v : values[c]) columns[c].add(v);
  }
  put_columns(names, columns, out, warnings);
  out["warnings"] = std::move(warnings);
  return out;
}

Value describe_text(const Path& path) {
  const DelimitedLayout layout = inspect_delimited(path);
  Value out = Value::object(), warnings = Value::array();
  out["format"] = "delimited text";
  out["delimiter"] = layout.delimiter == '\t' ? "tab" : layout.delimiter == ' ' ? "blanks" : std::string(1, layout.delimiter);
  out["header"] = !layout.names.empty();
  std::vector<std::string> names;
  std::vector<size_t> indices;
  for (size_t c = 0; c < layout.columns; ++c) {
    names.push_back(c < layout.names.size() ? layout.names[c] : std::to_string(c + 1));
    indices.push_back(c);
  }
  if (!layout.names.empty() && layout.names.size() != layout.columns)
    warnings.push("the header names " + std::to_string(layout.names.size()) + " columns, the first line has " +
                  std::to_string(layout.columns));
  if (layout.cut_line > 0) warnings.push("line " + std::to_string(layout.cut_line) + " is only the end of a record and is left out");
  DelimitedReader reader(path, layout, indices);
  std::vector<Column> columns(indices.size());
  std::vector<double> row(indices.size());
  std::uint64_t rows = 0;
  try {
    for (; reader.next(row.data()); ++rows)
      for (size_t c = 0; c < row.size(); ++c) columns[c].add(row[c]);
  } catch (const core::Error& e) {
    warnings.push("reading stopped: " + e.text());
  }
  out["rows"] = rows;
  put_columns(names, columns, out, warnings);
  out["warnings"] = std::move(warnings);
  return out;
}

Value describe_survey(const Path& path) {
  Value out = Value::object(), warnings = Value::array();
  out["format"] = "survey";
  Survey s;
  std::vector<core::Fault> ignored;
  core::read_options(core::described(s), read_value_file(path), "", ignored);
  out["name"] = s.name;
  out["crs"] = s.crs;
  const auto files = [&](const char* key, const auto& list) {
    if (list.empty()) return;
    Value& names = out[key] = Value::array();
    for (const auto& f : list) names.push(f.file.generic_string());
  };
  files("laser", s.laser);
  files("trajectory", s.trajectory);
  files("imu", s.imu);
  files("gnss", s.gnss);
  files("points", s.points);
  out["lines"] = static_cast<std::uint64_t>(s.lines.size());
  out["scanner"] = core::Codec<core::ScannerModel>::get(s.scanner.model);
  try {
    read_survey(path);
  } catch (const core::Error& e) {
    warnings.push(e.text());
  }
  out["warnings"] = std::move(warnings);
  return out;
}

/// JSON and TOML: a survey, a pipeline, or what this program writes.
Value describe_tree(const Path& path) {
  const Value tree = read_value_file(path);
  const auto has = [&](const char* key) { return tree.is_object() && tree.find(key); };
  if (has("type") && tree.find("type")->is_text() && (has("features") || has("coordinates") || has("geometry")))
    if (Value vector = describe_vector(path); !vector.is_null()) return vector;
  const bool report = has("program") && has("stages"), pipeline = has("stage");
  const bool calibration = has("calibration") && has("sigma") && !has("laser") && !has("imu");
  if (!report && !pipeline && !calibration && tree.is_object()) {
    for (const char* key : {"laser", "trajectory", "imu", "gnss", "points", "event", "hangar", "rinex", "crs", "scanner"})
      if (has(key)) return describe_survey(path);
  }
  Value out = Value::object();
  out["format"] = report ? "report of a run" : pipeline ? "pipeline" : calibration ? "calibration" : "JSON or TOML";
  if (report)
    for (const char* key : {"program", "command", "survey", "crs", "seconds"})
      if (const Value* v = tree.find(key)) out[key] = *v;
  if (report || pipeline) {
    const Value* list = tree.find(report ? "stages" : "stage");
    Value& names = out["stages"] = Value::array();
    if (list->is_array())
      for (const Value& s : list->items())
        if (const Value* type = s.is_object() ? s.find("type") : nullptr; type && type->is_text()) names.push(*type);
  }
  if (calibration) out["calibration"] = *tree.find("calibration");
  if (tree.is_array()) out["items"] = static_cast<std::uint64_t>(tree.items().size());
  if (tree.is_object() && !report) {
    Value& keys = out["keys"] = Value::array();
    for (const auto& [key, value] : tree.members()) keys.push(key);
  }
  out["warnings"] = Value::array();
  return out;
}

/// What GDAL sees in a raster; nothing where it is none.
Value describe_raster(const Path& path) {
  const GdalMessages quiet;
  const Dataset data = open_raster(path);
  Value out;
  if (data) {
    Value warnings = Value::array();
    out = Value::object();
    out["format"] = data->GetDriverName();
    out["size"] = Value(Value::Array{data->GetRasterXSize(), data->GetRasterYSize()});
    double t[6];
    if (data->GetGeoTransform(t) == CE_None) {
      out["cell"] = Value(Value::Array{t[1], -t[5]});
      out["x"] = Value(Value::Array{t[0], t[0] + t[1] * data->GetRasterXSize()});
      out["y"] = Value(Value::Array{t[3] + t[5] * data->GetRasterYSize(), t[3]});
      if (t[2] != 0 || t[4] != 0) warnings.push("the grid is rotated");
    } else {
      warnings.push("the file is not georeferenced");
    }
    const char* wkt = data->GetProjectionRef();
    if (wkt && *wkt) {
      const core::Crs crs{std::string(wkt)};
      out["crs"] = crs.name();
      const char* heights = data->GetMetadataItem(height_system_item);
      out["heights"] = heights ? std::string(heights) : crs.vertical_name();
    } else {
      warnings.push("the file states no CRS");
    }
    Value& bands = out["bands"] = Value::array();
    for (int b = 1; b <= data->GetRasterCount(); ++b) {
      GDALRasterBand* band = data->GetRasterBand(b);
      Value one = Value::object();
      one["type"] = GDALGetDataTypeName(band->GetRasterDataType());
      if (*band->GetDescription()) one["name"] = band->GetDescription();
      if (*band->GetUnitType()) one["unit"] = band->GetUnitType();
      int has_nodata = 0;
      const double nodata = band->GetNoDataValue(&has_nodata);
      if (has_nodata) one["nodata"] = std::isnan(nodata) ? Value("nan") : Value(nodata);
      double range[2];
      if (band->ComputeRasterMinMax(FALSE, range) == CE_None)
        one["values"] = Value(Value::Array{range[0], range[1]});
      else
        warnings.push("band " + std::to_string(b) + " has no valid cell or cannot be read");
      if (!has_nodata && GDALDataTypeIsFloating(band->GetRasterDataType()))
        warnings.push("band " + std::to_string(b) + " states no nodata value: voids cannot be told from heights");
      bands.push(std::move(one));
    }
    out["warnings"] = std::move(warnings);
  }
  return out;
}

Value describe_content(const Path& path) {
  const BinaryFile file(path);
  std::string start(4096, '\0');
  start.resize(file.read_some(0, start.data(), start.size()));
  if (start.empty()) throw core::Error("the file is empty", path.string());
  const auto begins = [&](std::string_view magic) { return start.compare(0, magic.size(), magic) == 0; };
  if (begins("LASF")) return describe_las(path);
  if (begins(std::string_view("CSD\0", 4))) return describe_csd(path);
  if (begins("\x93NUMPY")) return describe_npy(path);
  if (looks_like_tag(path)) return describe_tag(path);
  if (looks_like_pos(path)) return describe_pos(path);
  if (looks_like_nmea(path)) return describe_nmea(path);
  if (looks_like_pcap(start)) return describe_pcap(path);
  const bool binary = start.find('\0') != std::string::npos;
  if (!binary && rinex_kind(path) != RinexKind::other) return describe_rinex(path);
  if (path.extension() == ".toml" || path.extension() == ".json") return describe_tree(path);
  if (binary && looks_like_sbet(path)) return describe_sbet(path);
  if (binary && looks_like_smrmsg(path)) return describe_smrmsg(path);
  if (Value raster = describe_raster(path); !raster.is_null()) return raster;
  if (Value vector = describe_vector(path); !vector.is_null()) return vector;
  if (!binary) return describe_text(path);
  throw core::Error("is of no kind that is known here", path.string(),
                    "LAS, LAZ, SBET, smrmsg, CSD, NumPy, RTKLIB solutions, NMEA, RINEX, PCAP, text, survey.toml, JSON, rasters and vector "
                    "files are known");
}

std::string scalar(const Value& v) {
  if (v.is_text()) return v.as_text();
  if (v.is_bool()) return v.as_bool() ? "yes" : "no";
  if (v.is_int()) return std::to_string(v.as_int());
  if (!v.is_number()) return "-";
  // Ten digits: a millimetre of a northing, a microsecond of a week; the JSON form has them all.
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.10g", v.as_number());
  return text.data();
}

/// `names`: the keys are names of the file's own (columns), and are reported as they are written there.
void render(const Value& table, const std::string& indent, std::string& out, bool names = false) {
  size_t width = 0;
  for (const auto& [key, value] : table.members())
    if (!value.is_object()) width = std::max(width, key.size());
  for (const auto& [key, value] : table.members()) {
    if (key == "warnings") continue;
    std::string name = key;
    if (!names) std::replace(name.begin(), name.end(), '_', ' ');
    if (value.is_object()) {
      out += indent + name + "\n";
      render(value, indent + "  ", out, key == "columns" || key == "types");
      continue;
    }
    if (value.is_array() && !value.items().empty() && value.items()[0].is_object()) {
      for (size_t i = 0; i < value.items().size(); ++i) {
        out += indent + name + " " + std::to_string(i + 1) + "\n";
        render(value.items()[i], indent + "  ", out);
      }
      continue;
    }
    out += indent + name + std::string(width - name.size() + 2, ' ');
    if (value.is_array()) {
      const auto& items = value.items();
      const bool interval = items.size() == 2 && items[0].is_number() && key != "size" && key != "cell";
      for (size_t i = 0; i < items.size(); ++i) out += (i == 0 ? "" : interval ? " to " : ", ") + scalar(items[i]);
    } else {
      out += scalar(value);
    }
    out += "\n";
  }
}

}  // namespace

core::Value describe_file(const std::filesystem::path& file) {
  const Value told = describe_content(file);
  Value out = Value::object();
  out["file"] = file.string();
  out["bytes"] = static_cast<std::uint64_t>(std::filesystem::file_size(file));
  for (const auto& [key, value] : told.members()) out[key] = value;
  return out;
}

std::string info_text(const core::Value& told) {
  std::string out;
  render(told, "", out);
  if (const Value* warnings = told.find("warnings"))
    for (const Value& w : warnings->items()) out += "warning: " + w.as_text() + "\n";
  return out;
}

}  // namespace swath::io
