// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/pdal_pipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/las/cloud_crs.h"
#include "io/survey/read_survey.h"
#include "io/text/toml_text.h"
#include "pipeline/jobs/clouds.h"
#include "pipeline/jobs/pdal_options.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;

class Translation {
 public:
  Translation(const Value& tree, const fs::path& file) : file_(file) {
    const Value* list = tree.is_array() ? &tree : tree.find("pipeline");
    if (!list->is_array() || list->items().empty()) throw core::usage_error("the PDAL pipeline has no stages", place(tree));
    for (size_t k = 0; k < list->items().size(); ++k) stages_.push_back(with_type(list->items()[k], k + 1 == list->items().size()));
  }

  PdalPipeline done() && {
    read_sources();
    for (; next_ < stages_.size(); ++next_) take(stages_[next_]);
    if (config_["run"].find("output") == nullptr) throw core::usage_error("the PDAL pipeline has no writer", file_.string());
    if (limited_) refuse(*limited_, "points of other classes would be deleted, and here filters flag and never delete");
    return {std::move(config_), std::move(survey_), std::move(runs_as_)};
  }

 private:
  std::string place(const Value& v) const { return v.where.line > 0 ? v.where.text() : file_.string(); }
  [[noreturn]] void refuse(const Value& v, const std::string& what, const std::string& hint = {}) const {
    throw core::usage_error(what, place(v), hint);
  }

  /// A stage as a table: PDAL takes a bare file name for a reader, or at the end for a writer, and finds the type by the file's ending.
  Value with_type(const Value& given, bool is_last) const {
    Value stage = Value::object();
    stage.where = given.where;
    if (given.is_object())
      stage = given;
    else if (given.is_text())
      stage["filename"] = given;
    else
      refuse(given, "a stage of a PDAL pipeline is a table or the name of a file");
    if (const Value* type = stage.find("type"); type && !type->is_text()) refuse(*type, "'type' is not text");
    if (stage.find("type")) return stage;
    const Value* name = stage.find("filename");
    if (!name || !name->is_text()) refuse(given, "the stage has neither 'type' nor 'filename'");
    const std::string text = name->as_text();
    const auto ends = [&](std::string_view e) { return text.ends_with(e); };
    if (ends(".copc.laz"))
      stage["type"] = is_last ? "writers.copc" : "readers.copc";
    else if (ends(".las") || ends(".laz"))
      stage["type"] = is_last ? "writers.las" : "readers.las";
    else if (ends("ept.json"))
      stage["type"] = "readers.ept";
    else if (ends(".tif") || ends(".tiff"))
      stage["type"] = "writers.gdal";
    else
      refuse(*name, "no stage is known for '" + text + "'", "state its type");
    return stage;
  }

  static const std::string& type_of(const Value& stage) { return stage.find("type")->as_text(); }
  const std::string& text(const Value& v, const std::string& name) const {
    if (!v.is_text()) refuse(v, "'" + name + "' is not text");
    return v.as_text();
  }

  /// PDAL takes numbers as text, too.
  double number(const Value& v, const std::string& name) const {
    if (v.is_number()) return v.as_number();
    std::istringstream in(text(v, name));
    double out = 0.0;
    if (!(in >> out) || in.peek() != std::istringstream::traits_type::eof()) refuse(v, "'" + name + "' is not a number");
    return out;
  }

  /// Each option of the stage but those that are the case anyway; what `take` does not know is refused.
  template <class F>
  void each_option(const Value& stage, F&& take) const {
    for (const auto& [name, value] : stage.members())
      if (!is_the_case(type_of(stage), name, value) && !take(name, value))
        refuse(value,
               type_of(stage) + ": '" + name + "' = " + (value.is_text() ? value.as_text() : io::toml_scalar(value)) +
                   " has no counterpart here",
               "leave it out, or write the pipeline as a config (docs/cli.md)");
  }

  /// The readers at the beginning, and the CRS of the products where the pipeline names one: lengths need its units.
  void read_sources() {
    std::vector<fs::path> files;
    std::vector<std::string> stated;  // CRS of each of the files by their readers; empty: its own
    Value reader = Value::object();
    reader["type"] = "readers.las";
    while (next_ < stages_.size() && type_of(stages_[next_]).starts_with("readers.")) {
      const Value& s = stages_[next_++];
      const std::string& type = type_of(s);
      if (type != "readers.las" && type != "readers.copc" && type != "readers.ept")
        refuse(s, "'" + type + "' has no counterpart here", "readers.las, readers.copc and readers.ept have");
      std::string name_given, override_srs, default_srs;
      each_option(s, [&](const std::string& name, const Value& v) {
        if (name == "filename") return name_given = text(v, name), true;
        if (name == "override_srs" || name == "spatialreference") return override_srs = text(v, name), true;
        if (name == "default_srs") return default_srs = text(v, name), true;
        if (type != "readers.las" && name == "bounds") return reader["bounds"] = bounds(v), true;
        if (type != "readers.las" && name == "resolution") return resolution_ = number(v, name), true;
        return false;
      });
      if (!name_given.empty())
        for (fs::path& file : cloud_files({name_given})) {
          if (std::any_of(files.begin(), files.end(), [&](const fs::path& f) { return fs::equivalent(f, file); })) continue;
          stated.push_back(!override_srs.empty() || default_srs.empty() || lack_of_crs(file).empty() ? override_srs : default_srs);
          files.push_back(std::move(file));
        }
      runs_as_.push_back(type + " " + name_given + ": readers.las");
    }
    if (files.empty())
      throw core::usage_error("the PDAL pipeline does not begin with a reader of a file", file_.string(), "readers come first");
    make_survey(files, std::move(stated));
    if (resolution_) reader["resolution"] = length(*resolution_, PdalUnit::across);
    config_["stage"].push(std::move(reader));
  }

  /// The clouds with the CRS that each has by its reader, and that of the products.
  void make_survey(const std::vector<fs::path>& files, std::vector<std::string> stated) {
    std::string target;
    for (const Value& s : stages_)
      if (type_of(s) == "filters.reprojection") target = reprojection(s, stated);
    for (size_t k = 0; k < stated.size(); ++k)  // neither another reader's CRS nor that of the products is its own
      if (const std::string why = stated[k].empty() ? lack_of_crs(files[k]) : ""; !why.empty())
        throw core::usage_error(why, files[k].string(), "name its CRS as 'override_srs' of its reader, for example \"EPSG:25832\"");
    const auto first = std::find_if(stated.begin(), stated.end(), [](const std::string& one) { return !one.empty(); });
    survey_ = cloud_survey(files, !target.empty() ? target : first != stated.end() ? *first : "", CrsNamed::in_pdal_pipeline);
    for (size_t k = 0; k < stated.size(); ++k)
      if (!stated[k].empty()) survey_["points"].items()[k]["crs"] = stated[k];
    const io::Survey survey = io::read_survey(survey_, fs::path());
    crs_ = survey.crs.empty() ? io::cloud_crs(survey, survey.points.front()) : core::Crs(survey.crs);
    if (!target.empty()) return;
    for (const io::PointFile& cloud : survey.points)
      if (const core::Crs crs = io::cloud_crs(survey, cloud); !core::is_same_crs(crs, crs_))
        throw core::usage_error("the clouds are in different CRSs: this one in " + crs.name() + ", the products would be in " + crs_.name(),
                                cloud.file.string(),
                                "filters.reprojection with 'out_srs' right behind the readers names that of the products");
  }

  std::string reprojection(const Value& s, std::vector<std::string>& stated) const {
    std::string target;
    each_option(s, [&](const std::string& name, const Value& v) {
      if (name == "out_srs") return target = text(v, name), true;
      if (name == "in_srs") return std::fill(stated.begin(), stated.end(), text(v, name)), true;
      return false;
    });
    if (target.empty()) refuse(s, "filters.reprojection names no 'out_srs'");
    return target;
  }

  /// "([west, east], [south, north])".
  Value bounds(const Value& v) const {
    std::string plain = text(v, "bounds");
    for (char& c : plain)
      if (std::string_view("([,])").find(c) != std::string_view::npos) c = ' ';
    std::istringstream in(plain);
    std::array<double, 4> b{};
    for (double& one : b) in >> one;
    std::string rest;
    if (!in || in >> rest)
      refuse(v, "'bounds' is not ([west, east], [south, north])", "bounds in height or in another CRS have no counterpart");
    return Value(Value::Array{b[0], b[2], b[1], b[3]});
  }

  Value length(double units, PdalUnit unit) const {
    const double metres = unit == PdalUnit::across ? crs_.metres_per_unit()
                          : crs_.has_height_unit() ? crs_.vertical_metres_per_unit()
                                                   : crs_.metres_per_unit();
    return core::format_quantity(core::Dimension::length, units * metres);
  }
  Value converted(const Value& v, const PdalOption& o) const {
    if (v.is_bool()) return v;
    if (v.is_text() && (v.as_text() == "true" || v.as_text() == "false")) return v.as_text() == "true";
    const double n = number(v, o.name);
    // SMRF's scalar is a height per unit of slope, and a plain number here.
    if (std::string_view(o.ours) == "scalar")
      return n * (crs_.has_height_unit() ? crs_.vertical_metres_per_unit() : crs_.metres_per_unit());
    if (o.unit != PdalUnit::none) return length(n, o.unit);
    return n == std::floor(n) && std::abs(n) < 1e9 ? Value(static_cast<std::int64_t>(n)) : Value(n);
  }

  void add(Value stage, const std::string& from, const std::string& differs = {}) {
    std::string line = from + ": " + type_of(stage);
    for (const auto& [key, value] : stage.members())
      if (key != "type") line += (line.ends_with(type_of(stage)) ? " with " : ", ") + key + " = " + io::toml_scalar(value);
    runs_as_.push_back(line + (differs.empty() ? "" : "; differs: " + differs));
    config_["stage"].push(std::move(stage));
  }

  static Value stage_of(const char* type) {
    Value out = Value::object();
    out["type"] = type;
    return out;
  }

  void take(const Value& s) {
    const std::string& type = type_of(s);
    if (s.find("inputs"))
      refuse(*s.find("inputs"), "a pipeline with branches has no counterpart here", "one chain from readers to writers");
    if (limited_ && !type.starts_with("writers.gdal"))
      refuse(*limited_, "points of other classes would be deleted before " + type + ", and here filters flag and never delete",
             type.starts_with("writers.") ? "leave filters.range out: every point is written with its class, by which readers choose"
                                          : "filters.range goes right before writers.gdal");
    if (const PdalFilter* f = filter_of(s)) return filter(s, *f);
    if (type == "filters.range") return range(s);
    if (type == "filters.hag_delaunay") return heights(s);
    if (type == "filters.reprojection") {
      if (config_["stage"].items().size() > 1)
        refuse(s, "points are transformed as they are read, and no stage works in the CRS before",
               "filters.reprojection goes right behind the readers");
      return runs_as_.push_back(type + ": the CRS of the products, from the reader on"), void();
    }
    if (type == "filters.merge")
      return each_option(s, [](auto&, auto&) { return false; }), runs_as_.push_back(type + ": the clouds of a survey are one"), void();
    if (type == "writers.las" || type == "writers.copc") return points(s);
    if (type == "writers.gdal") return grid(s);
    if (type.starts_with("readers.")) refuse(s, "a reader behind other stages has no counterpart here", "readers come first");
    const std::string nearest = pdal_nearest(type);
    refuse(s, "'" + type + "' has no counterpart here",
           !nearest.empty()
               ? nearest
               : "filters.smrf, pmf, csf, elm, outlier, range, hag_delaunay, reprojection and merge have, writers.las, gdal and copc");
  }

  /// The filter of the stage's type and method; of its type alone where the method is unknown, which filter() then refuses.
  static const PdalFilter* filter_of(const Value& s) {
    const Value* method = s.find("method");
    const PdalFilter* found = nullptr;
    for (const PdalFilter& f : pdal_filters()) {
      if (type_of(s) != f.type) continue;
      if (!method || (method->is_text() && method->as_text() == f.method)) return &f;
      if (!found) found = &f;
    }
    return found;
  }

  void filter(const Value& s, const PdalFilter& f) {
    Value stage = stage_of(f.ours);
    for (const PdalOption& o : f.options)
      if (o.set) stage[o.ours] = converted(*o.set, o);
    for (const auto& [key, value] : f.fixed) stage[key] = value;
    each_option(s, [&](const std::string& name, const Value& v) {
      if (name == "method" && v.is_text() && v.as_text() == f.method) return true;
      const auto at = std::find_if(f.options.begin(), f.options.end(), [&](const PdalOption& o) { return name == o.name; });
      if (at == f.options.end()) return false;
      stage[at->ours] = converted(v, *at);
      return true;
    });
    add(std::move(stage), f.type, f.differs);
  }

  /// Which classes a terrain model is made of: "Classification[2:2]", or several such ranges.
  void range(const Value& s) {
    const Value* limits = s.find("limits");
    if (!limits) refuse(s, "filters.range has no 'limits'");
    each_option(s, [](const std::string& name, auto&) { return name == "limits"; });
    std::string why;
    classes_ = Value::array();
    for (const int c : classes_of_limits(text(*limits, "limits"), why)) classes_.push(c);
    if (!why.empty())
      refuse(*limits, "'" + limits->as_text() + "' has no counterpart here, filters flag points and never delete them: " + why,
             "Classification[2:2],Classification[9:9] before writers.gdal chooses the terrain model's classes");
    limited_ = s;
    runs_as_.push_back("filters.range: the classes of terrain.dtm");
  }

  Value terrain(double cell) const {
    Value stage = stage_of("terrain.dtm");
    stage["cell"] = length(cell, PdalUnit::across);
    if (!classes_.is_null()) stage["classes"] = classes_;
    return stage;
  }

  void heights(const Value& s) {
    each_option(s, [](auto&, auto&) { return false; });
    add(stage_of("terrain.dtm"), "filters.hag_delaunay",
        "one triangulation of all ground points in place of one of each point's neighbours");
    add(stage_of("filters.hag_dem"), "filters.hag_delaunay");
    modelled_ = true;
  }

  /// Products lie in a folder named by the first writer's file.
  void name_output(const Value& s) {
    const Value* name = s.find("filename");
    if (!name) refuse(s, type_of(s) + " has no 'filename'");
    Value& run = config_["run"];
    if (run.find("output")) return;
    fs::path folder = fs::path(text(*name, "filename")).replace_extension();
    if (folder.extension() == ".copc") folder.replace_extension();
    if (folder.empty() || !folder.has_filename()) refuse(*name, "'filename' names no file");
    run["output"] = folder.string();
  }

  void points(const Value& s) {
    const bool is_copc = type_of(s) == "writers.copc";
    name_output(s);
    Value stage = stage_of(is_copc ? "writers.copc" : "writers.las");
    const fs::path file = text(*s.find("filename"), "filename");
    if (is_copc)
      stage["file"] = file.filename().string();
    else
      stage["compress"] = file.extension() == ".laz" || s.find("compression") != nullptr;
    each_option(s, [&](const std::string& name, const Value& v) {
      if (name == "filename") return true;
      if (!is_copc && name == "dataformat_id") return stage["point_format"] = static_cast<std::int64_t>(number(v, name)), true;
      if (name == "scale_x" || name == "scale_y" || name == "scale_z") {
        if (v.is_text() && v.as_text() == "auto") return true;
        if (const Value* other = stage.find("scale"); other && other->as_number() != number(v, name))
          refuse(v, "scales of the axes differ, and have one value here");
        return stage["scale"] = number(v, name), true;
      }
      return false;
    });
    add(std::move(stage), type_of(s), is_copc ? "every field as it was read" : "tiles in points/, every field as it was read");
  }

  void grid(const Value& s) {
    name_output(s);
    const Value *kind = s.find("output_type"), *cell = s.find("resolution");
    const std::string output = kind ? text(*kind, "output_type") : "all";
    if (!cell) refuse(s, "writers.gdal has no 'resolution'");
    each_option(s, [](const std::string& name, auto&) { return name == "filename" || name == "resolution" || name == "output_type"; });
    if (output == "idw" || output == "mean") {
      if (classes_.is_null())
        refuse(s, "a grid of the mean of all points has no counterpart here",
               "filters.range with Classification[2:2] before it makes a terrain model");
      if (modelled_) refuse(s, "a terrain model beside filters.hag_delaunay is made twice", "leave one of them out");
      add(terrain(number(*cell, "resolution")), "writers.gdal",
          "triangulation, smoothed as its errors ask for, in place of " + output + " of the points around");
    } else if (output == "max") {
      if (!classes_.is_null()) refuse(s, "the highest point of some classes has no counterpart here", "terrain.dsm takes first returns");
      if (!modelled_) add(terrain(number(*cell, "resolution")), "writers.gdal", "writers.gdal writes the terrain model, too");
      Value stage = stage_of("terrain.dsm");
      stage["cell"] = length(number(*cell, "resolution"), PdalUnit::across);
      add(std::move(stage), "writers.gdal", "first returns alone");
    } else {
      refuse(kind ? *kind : s, "output_type '" + output + "' has no counterpart here", "idw and mean behind filters.range, and max have");
    }
    modelled_ = true;
    limited_.reset();
    classes_ = {};
    add(stage_of("writers.gdal"), "writers.gdal", "tiles in dtm/ or dsm/ with one index (.vrt)");
  }

  fs::path file_;
  std::vector<Value> stages_;
  size_t next_ = 0;
  core::Crs crs_;
  std::optional<double> resolution_;
  std::optional<Value> limited_;  ///< a filters.range that no writer has used yet
  Value classes_;
  bool modelled_ = false;
  Value config_ = Value::object(), survey_;
  std::vector<std::string> runs_as_;
};

}  // namespace

bool is_pdal_pipeline(const Value& tree) { return tree.is_array() || (tree.is_object() && tree.find("pipeline")); }

PdalPipeline read_pdal_pipeline(const Value& tree, const fs::path& file) { return Translation(tree, file).done(); }

}  // namespace swath::pipeline
