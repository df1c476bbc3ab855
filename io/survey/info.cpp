// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/info.h"

#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "io/gnss/describe_gnss.h"
#include "io/gnss/nmea.h"
#include "io/gnss/rinex_header.h"
#include "io/gnss/rtklib_pos.h"
#include "io/las/describe_las.h"
#include "io/las/other_cloud.h"
#include "io/raster/cog.h"
#include "io/raster/geotiff.h"
#include "io/records/describe_events.h"
#include "io/records/describe_pcap.h"
#include "io/records/describe_trajectory.h"
#include "io/records/event_marks.h"
#include "io/store/address.h"
#include "io/store/input_file.h"
#include "io/survey/describe_products.h"
#include "io/survey/describe_tables.h"
#include "io/survey/file_facts.h"
#include "io/survey/read_survey.h"
#include "io/survey/tree_kind.h"
#include "io/text/binary_file.h"
#include "io/text/delimited.h"
#include "io/text/value_file.h"
#include "io/vector/describe_vector.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using core::Value;
using Path = std::filesystem::path;

struct SurveyFacts {
  Survey s;
  std::vector<std::string> warnings;
};
template <class V>
void describe(const SurveyFacts& r, V& v) {
  const auto files = [&](std::string_view key, const auto& list, std::string_view doc) {
    std::vector<std::string> names;
    for (const auto& f : list) names.push_back(shown_name(f.file));
    v.result(key, names, core::Form{}.only_if(!names.empty()), doc);
  };
  v.result("format", std::string("survey"), "Format.");
  v.result("name", r.s.name, "Name of the survey.");
  v.result("crs", r.s.crs, "CRS of the products.");
  files("laser", r.s.laser, "Files of laser records.");
  files("trajectory", r.s.trajectory, "Trajectory files.");
  files("imu", r.s.imu, "Files of IMU records.");
  files("gnss", r.s.gnss, "Files of GNSS records.");
  files("points", r.s.points, "Point clouds.");
  files("event", r.s.events, "Files of events.");
  std::vector<std::string> cameras;
  for (const SurveyCamera& c : r.s.cameras) cameras.push_back(c.name);
  v.result("camera", cameras, core::Form{}.only_if(!cameras.empty()), "Cameras.");
  files("image", r.s.images, "Tables of images.");
  files("image_points", r.s.image_points, "Files of image points.");
  files("control", r.s.control, "Files of surveyed points.");
  v.result("lines", r.s.lines.size(), "Flight lines that it lists.");
  v.result("scanner", r.s.scanner.model, "Model of the scanner.");
  v.result("warnings", r.warnings, "Faults of the survey.");
}

Value describe_survey(const Path& path) {
  SurveyFacts out;
  std::vector<core::Fault> ignored;
  core::read_options(core::described(out.s), read_value_file(path), "", ignored);
  try {
    read_survey(path);
  } catch (const core::Error& e) {
    out.warnings.push_back(e.text());
  }
  return core::reported(out);
}

/// A tree of JSON or TOML by its keys.
struct TreeFacts {
  std::string format;
  const Value& tree;
  std::string stage_list{};  ///< the key of the list of stages; empty: it has none
};
template <class V>
void describe(const TreeFacts& r, V& v) {
  const bool report = r.stage_list == "stages";
  const auto text = [&](const Value* found) {
    return report && found && found->is_text() ? std::optional(found->as_text()) : std::nullopt;
  };
  const Value *crs = r.tree.find("crs"), *seconds = r.tree.find("seconds");
  std::vector<std::string> stages, keys;
  if (const Value* list = r.stage_list.empty() ? nullptr : r.tree.find(r.stage_list); list && list->is_array())
    for (const Value& s : list->items())
      if (const Value* type = s.is_object() ? s.find("type") : nullptr; type && type->is_text()) stages.push_back(type->as_text());
  if (r.tree.is_object())
    for (const auto& [key, value] : r.tree.members()) keys.push_back(key);
  v.result("format", r.format, "What the file is.");
  v.result("program", text(r.tree.find("program")), "Program that made the report.");
  v.result("command", text(r.tree.find("command")), "Command that it ran.");
  v.result("survey", text(r.tree.find("survey")), "Name of the survey.");
  v.result("crs", text(crs ? crs->find("name") : nullptr), "CRS of the products.");
  v.result("seconds", seconds && seconds->is_number() ? seconds->as_number() : 0.0, core::seconds(1).only_if(report),
           "Time that the run took.");
  v.result("stages", stages, core::Form{}.only_if(!r.stage_list.empty()), "Stages.");
  v.result("items", r.tree.is_array() ? r.tree.items().size() : 0, core::Form{}.only_if(r.tree.is_array()), "Items of a list.");
  v.result("keys", keys, core::Form{}.only_if(r.tree.is_object() && !report), "Keys of a table.");
  v.result("warnings", std::vector<std::string>{}, "What looks wrong.");
}

/// JSON and TOML: a survey, a pipeline, or what this program writes.
Value describe_tree(const Path& path) {
  const Value tree = read_value_file(path);
  const auto has = [&](const char* key) { return tree.is_object() && tree.find(key); };
  if (has("type") && tree.find("type")->is_text() && (has("features") || has("coordinates") || has("geometry")))
    if (Value vector = describe_vector(path); !vector.is_null()) return vector;
  const TreeKind kind = kind_of(tree);
  const std::string format(format_of(kind));
  switch (kind) {
    case TreeKind::hangar:
      return describe_hangar(path);
    case TreeKind::survey:
      return describe_survey(path);
    case TreeKind::planned_flight:
      return describe_planned_flight(tree);
    case TreeKind::report:
      return core::reported(TreeFacts{format, tree, "stages"});
    case TreeKind::pipeline:
      return core::reported(TreeFacts{format, tree, "stage"});
    case TreeKind::calibration: {
      Value out = core::reported(TreeFacts{format, tree});
      out.members().insert(out.members().begin() + 1, {"calibration", *tree.find("calibration")});  // as the file has it
      return out;
    }
    default:
      return core::reported(TreeFacts{format, tree});
  }
}

struct BandFacts {
  std::string type, name, unit;
  std::optional<double> nodata{};
  core::Interval values{};
};
template <class V>
void describe(const BandFacts& r, V& v) {
  v.result("type", r.type, "Type of its numbers.");
  v.result("name", r.name, core::Form{}.only_if(!r.name.empty()), "Description of the band.");
  v.result("unit", r.unit, core::Form{}.only_if(!r.unit.empty()), "Unit of its values.");
  if (r.nodata && std::isnan(*r.nodata))
    v.result("nodata", std::string("nan"), "Value of voids.");
  else
    v.result("nodata", r.nodata, "Value of voids.");
  v.result("values", r.values, "Smallest and largest value.");
}

struct RasterFacts {
  std::string format;
  std::array<int, 2> size{};
  std::optional<Eigen::Vector2d> cell{};
  core::Interval x{}, y{};
  std::optional<std::string> crs{}, heights{};
  std::vector<BandFacts> bands{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const RasterFacts& r, V& v) {
  v.result("format", r.format, "Format.");
  v.result("size", r.size, "Columns and rows.");
  v.result("cell", r.cell, "Sides of a cell.");
  v.result("x", r.x, "Western and eastern border.");
  v.result("y", r.y, "Southern and northern border.");
  v.result("crs", r.crs, "Name of the CRS.");
  v.result("heights", r.heights, "What heights count from.");
  v.tables("bands", r.bands, "Bands.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

BandFacts facts_of(GDALRasterBand& band, const std::string& name, std::vector<std::string>& warnings) {
  BandFacts out{GDALGetDataTypeName(band.GetRasterDataType()), band.GetDescription(), band.GetUnitType()};
  int has_nodata = 0;
  const double nodata = band.GetNoDataValue(&has_nodata);
  if (has_nodata) out.nodata = nodata;
  double range[2];
  if (band.ComputeRasterMinMax(FALSE, range) == CE_None)
    out.values = {range[0], range[1]};
  else
    warnings.push_back(name + " has no valid cell or cannot be read");
  if (!has_nodata && GDALDataTypeIsFloating(band.GetRasterDataType()))
    warnings.push_back(name + " states no nodata value: voids look like heights");
  return out;
}

/// What GDAL sees in a raster; nothing where it is none.
Value describe_raster(const Path& path) {
  const GdalMessages quiet;
  const Dataset data = open_raster(path);
  if (!data) return {};
  RasterFacts out{data->GetDriverName(), {data->GetRasterXSize(), data->GetRasterYSize()}};
  double t[6];
  if (data->GetGeoTransform(t) == CE_None) {
    out.cell.emplace(t[1], -t[5]);
    for (const double x : {t[0], t[0] + t[1] * out.size[0]}) out.x.add(x);
    for (const double y : {t[3], t[3] + t[5] * out.size[1]}) out.y.add(y);  // a south-up raster goes the other way
    if (t[2] != 0 || t[4] != 0) out.warnings.push_back("the grid is rotated");
  } else {
    out.warnings.push_back("the file is not georeferenced");
  }
  const char* wkt = data->GetProjectionRef();
  if (wkt && *wkt) {
    const core::Crs crs{std::string(wkt)};
    const char* heights = data->GetMetadataItem(height_system_item);
    out.crs = crs.name();
    out.heights = heights ? heights : crs.vertical_name();
  } else {
    out.warnings.push_back("the file states no CRS");
  }
  for (int b = 1; b <= data->GetRasterCount(); ++b)
    out.bands.push_back(facts_of(*data->GetRasterBand(b), "band " + std::to_string(b), out.warnings));
  return core::reported(out);
}

/// Whether a line is a log of NovAtel's: "#BESTPOSA,COM1,...;..." or "%RAWIMUSA,...;...".
bool holds_novatel_log(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const size_t stop = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, stop - at);
    const size_t comma = line.find(','), half = line.find(';');
    const auto is_name = [](std::string_view s) { return s.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") == s.npos; };
    constexpr std::ptrdiff_t header = 8;  // commas at least
    if (comma != line.npos && comma > 3 && half != line.npos && half > comma && (line[0] == '#' || line[0] == '%') &&
        line[comma - 1] == 'A' && is_name(line.substr(1, comma - 1)) &&
        std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(half), ',') >= header)
      return true;
    at = stop + 1;
  }
  return false;
}

/// An object of a store: what its first bytes and its format's own index say.
Value describe_object(const Path& address) {
  InputFile file(address);
  std::string start(4, '\0');
  start.resize(file.read_some(0, start.data(), start.size()));
  if (start.empty()) throw core::Error("the object is empty", address.string());
  if (start == "LASF") return describe_las(address);
  const GdalMessages messages;
  if (Value raster = describe_raster(address); !raster.is_null()) return raster;
  throw core::Error("is of no kind that is read from a store", address.string(),
                    "LAS, LAZ, COPC and GeoTIFF are; fetch another file, and `swath info` says what it holds");
}

Value describe_content(const Path& path) {
  if (is_address(path)) return describe_object(path);
  const BinaryFile file(path);
  std::string start(4096, '\0');
  start.resize(file.read_some(0, start.data(), start.size()));
  if (start.empty()) throw core::Error("the file is empty", path.string());
  const auto begins = [&](std::string_view magic) { return start.compare(0, magic.size(), magic) == 0; };
  if (begins("LASF")) return describe_las(path);
  if (const OtherCloud kind = other_cloud(start); kind != OtherCloud::none && kind != OtherCloud::text)
    throw core::Error("is " + name_of(kind) + ", which is not read here", path.string(), conversion_of(kind, path));
  if (begins(std::string_view("CSD\0", 4))) return describe_csd(path);
  if (begins("\x93NUMPY")) return describe_npy(path);
  if (looks_like_tag(path)) return describe_tag(path);
  if (const EventFormat events = event_format(path); events != EventFormat::text && events != EventFormat::rinex)
    return describe_events(path, events);
  if (looks_like_pos(path)) return describe_pos(path);
  if (looks_like_nmea(path)) return describe_nmea(path);
  if (looks_like_pcap(start)) return describe_pcap(path);
  const bool binary = start.find('\0') != std::string::npos;
  if (!binary && rinex_kind(path) != RinexKind::other) return describe_rinex(path);
  if (!binary && looks_like_loopstats(path)) return describe_loopstats(path);
  if (path.extension() == ".toml" || path.extension() == ".json") return describe_tree(path);
  if (!binary && looks_like_quality_xml(start)) return describe_quality_xml(path);
  if (binary && looks_like_sbet(path)) return describe_sbet(path);
  if (binary && looks_like_smrmsg(path)) return describe_smrmsg(path);
  if (Value raster = describe_raster(path); !raster.is_null()) return raster;
  if (Value vector = describe_vector(path); !vector.is_null()) return vector;
  if (begins("\x1F\x8B") || begins("PK\x03\x04")) require_text(start, path);  // compressed: it says so
  if (!binary && holds_novatel_log(start))
    throw core::Error("is a NovAtel log, whose positions and IMU records are not read", path.string(),
                      "export text by Inertial Explorer, or RINEX by NovAtel Convert; event marks in it: [[event]] format = \"novatel\"");
  if (!binary) return describe_text(path);
  throw core::Error(
      "is of no kind that is known here", path.string(),
      "LAS, LAZ, SBET, smrmsg, CSD, NumPy, RTKLIB solutions, NMEA, RINEX, UBX, PCAP, text, survey.toml, JSON, rasters and vector "
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

/// A value on one line; a list of two numbers is from one to the other unless `is_pair`.
std::string on_line(const Value& value, bool is_pair) {
  if (!value.is_array()) return scalar(value);
  const auto& items = value.items();
  const bool interval = items.size() == 2 && items[0].is_number() && !is_pair;
  std::string out;
  for (size_t i = 0; i < items.size(); ++i) out += (i == 0 ? "" : interval ? " to " : ", ") + scalar(items[i]);
  return out;
}

/// Tables of two or three values whose first names them are lines of a list.
bool is_list(const Value& tables) {
  const auto& first = tables.items()[0].members();
  return first.size() <= 3 && (first[0].first == "name" || first[0].first == "number");
}

void render_list(const Value& tables, const std::string& indent, std::string& out) {
  std::vector<std::string> names;
  size_t width = 0;
  for (const Value& one : tables.items()) width = std::max(width, names.emplace_back(scalar(one.members()[0].second)).size());
  for (size_t i = 0; i < names.size(); ++i) {
    out += indent + names[i] + std::string(width - names[i].size(), ' ');
    for (size_t k = 1; k < tables.items()[i].members().size(); ++k) out += "  " + on_line(tables.items()[i].members()[k].second, false);
    out += "\n";
  }
}

void render(const Value& table, const std::string& indent, std::string& out) {
  size_t width = 0;
  for (const auto& [key, value] : table.members())
    if (!value.is_object()) width = std::max(width, key.size());
  for (const auto& [key, value] : table.members()) {
    if (key == "warnings") continue;
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (value.is_object()) {
      out += indent + name + "\n";
      render(value, indent + "  ", out);
    } else if (!value.is_array() || value.items().empty() || !value.items()[0].is_object()) {
      out += indent + name + std::string(width - name.size() + 2, ' ') + on_line(value, key == "size" || key == "cell") + "\n";
    } else if (is_list(value)) {
      out += indent + name + "\n";
      render_list(value, indent + "  ", out);
    } else {
      for (size_t i = 0; i < value.items().size(); ++i) {
        out += indent + name + " " + std::to_string(i + 1) + "\n";
        render(value.items()[i], indent + "  ", out);
      }
    }
  }
}

}  // namespace

core::Value describe_file(const std::filesystem::path& file) {
  Value facts = describe_content(file);
  Value out(
      Value::Object{{"file", shown_name(file)},
                    {"bytes", is_address(file) ? InputFile(file).size() : static_cast<std::uint64_t>(std::filesystem::file_size(file))}});
  std::move(facts.members().begin(), facts.members().end(), std::back_inserter(out.members()));
  return out;
}

std::string info_text(const core::Value& facts) {
  std::string out;
  render(facts, "", out);
  if (const Value* warnings = facts.find("warnings"))
    for (const Value& w : warnings->items()) out += "warning: " + w.as_text() + "\n";
  return out;
}

}  // namespace swath::io
