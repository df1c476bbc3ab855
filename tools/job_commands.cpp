// SPDX-License-Identifier: GPL-3.0-or-later
// One command for one job on point clouds: each is a config that comes with the program, and options of its stages under short names.
#include <algorithm>

#include "core/error.h"
#include "pipeline/jobs/check_columns.h"
#include "pipeline/jobs/clouds.h"
#include "pipeline/jobs/config_folder.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

using core::Dimension;

/// An option of a stage under a short name.
struct JobOption {
  std::string flag;    ///< "--cell"
  std::string option;  ///< as for --set: "dtm.cell"
  Dimension dimension;
  std::string example;
  std::string help;
};

struct Job {
  std::string name;
  std::string config;
  std::string help;
  std::vector<JobOption> options{};
  std::string classified{};  ///< config for clouds whose classes are taken as they are; empty: the job has none
  bool judges = false;       ///< takes check points, a reference and a quality level
  bool photos = false;       ///< takes oriented photographs
};

const std::vector<Job>& jobs() {
  static const std::vector<Job> list{
      {"dtm",
       "dtm",
       "Examples\n  swath dtm flight.laz\n  swath dtm tiles/ --cell 50cm --contours 1m --output terrain\n  swath dtm 'tiles/*.laz' "
       "--classes 2 "
       "--classes 9\n\nMake a terrain model, contours and their picture of point clouds.",
       {{"--cell", "dtm.cell", Dimension::length, "50cm", "Side of the terrain model's cells"},
        {"--contours", "contours.interval", Dimension::length, "1m", "Height between contours"}},
       "terrain"},
      {"classify", "classes",
       "Examples\n  swath classify flight.laz\n  swath classify tiles/ --output classified\n\nClassify point clouds: ground, vegetation, "
       "buildings, bridges, wires, water, noise."},
      {"qc",
       "qc",
       "Examples\n  swath qc tiles/\n  swath qc delivery/ --level QL2 --check marks.csv --reference dtm.tif --output qc\n\nJudge the "
       "quality of point clouds: density, voids, flight lines against one another, check points, a reference model.",
       {},
       {},
       true},
      {"colour",
       "colour",
       "Examples\n  swath colour flight.laz --photos photos --orientation block/orientation.csv --camera block/camera.toml\n\nGive point "
       "clouds the colours of oriented photographs; points that no camera sees keep theirs.",
       {},
       {},
       false,
       true},
      {"orthophoto",
       "orthophoto",
       "Examples\n  swath orthophoto flight.laz --photos photos --orientation block/orientation.csv --camera block/camera.toml\n  swath "
       "orthophoto tiles/ --photos photos --orientation block/orientation.csv --camera block/camera.toml --pixel 10cm\n\nMake a terrain "
       "model, an orthophoto on it and a true orthophoto on the surface model of point clouds and oriented photographs.",
       {{"--cell", "dtm.cell", Dimension::length, "50cm", "Side of the terrain model's cells"},
        {"--pixel", "orthophoto.cell", Dimension::length, "10cm", "Side of the orthophoto's cells"}},
       {},
       false,
       true},
      {"copc", "copc", "Examples\n  swath copc tiles/\n\nWrite point clouds as COPC, the form of LAZ that viewers stream."},
  };
  return list;
}

struct Given {
  std::vector<std::string> clouds, classes;
  std::string crs;
  std::vector<std::string> values;  ///< of the job's options, in their order; empty: not given
  std::vector<std::filesystem::path> check;
  std::string check_crs, check_columns, level = "none";
  std::filesystem::path reference;
  std::filesystem::path photos, orientation, camera;
  std::string orientation_crs;
  pipeline::Request request;
  std::filesystem::path save;
  Loudness loudness;
};

/// "dtm.classes=[2, 9]". Throws core::Error (usage) for what is no class.
std::string class_list(const std::vector<std::string>& classes) {
  std::string list;
  for (const std::string& one : classes) {
    const bool digits = !one.empty() && one.size() <= 3 && one.find_first_not_of("0123456789") == std::string::npos;
    if (!digits || std::stoi(one) > 255)
      throw core::usage_error("'" + one + "' is not a class", "--classes",
                              "ASPRS classes are numbers from 0 to 255: 2 ground, 9 water; `swath info FILE` lists those of a cloud");
    list += (list.empty() ? "" : ", ") + std::to_string(std::stoi(one));
  }
  return "dtm.classes=[" + list + "]";
}

void add_columns(const pipeline::CheckColumns& columns, const Loudness& loudness, core::Value& control) {
  if (!columns.are_stated()) return;
  control["name"] = columns.name;
  control["x"] = columns.x;
  control["y"] = columns.y;
  control["z"] = columns.z;
  if (!columns.note.empty() && loudness.voice() == pipeline::Voice::bar) print(columns.note + "\n");
}

/// What a job that judges is given beside its clouds.
void add_judgement(const Given& a, const std::vector<std::filesystem::path>& clouds, pipeline::Request& out) {
  if (a.check.empty() && !a.check_crs.empty())
    throw core::usage_error("there are no check points that it is the CRS of", "--check-crs", "name them by --check FILE");
  if (a.check.empty() && !a.check_columns.empty())
    throw core::usage_error("there are no check points that these are columns of", "--check-columns", "name them by --check FILE");
  std::vector<std::string> sets{"swath.quality_level=" + a.level};
  if (!a.reference.empty()) sets.push_back("surface.reference=" + std::filesystem::absolute(a.reference).string());
  out.sets.insert(out.sets.begin(), sets.begin(), sets.end());
  if (a.check.empty()) return;
  core::Value control = core::Value::array();
  for (const std::filesystem::path& file : a.check) {
    core::Value one = core::Value::object();
    one["file"] = core::Value(std::filesystem::absolute(file).string());
    one["use"] = core::Value(std::string("check"));
    if (!a.check_crs.empty()) one["crs"] = core::Value(a.check_crs);
    add_columns(pipeline::check_columns(file, a.check_columns, {clouds, a.crs, a.check_crs}), a.loudness, one);
    control.push(std::move(one));
  }
  (*out.survey_tree)["control"] = std::move(control);
}

void add_photos(const Given& a, core::Value& survey) {
  core::Value one = core::Value::object();
  one["folder"] = core::Value(std::filesystem::absolute(a.photos).string());
  one["orientation"] = core::Value(std::filesystem::absolute(a.orientation).string());
  one["camera"] = core::Value(std::filesystem::absolute(a.camera).string());
  if (!a.orientation_crs.empty()) one["crs"] = core::Value(a.orientation_crs);
  core::Value list = core::Value::array();
  list.push(std::move(one));
  survey["photos"] = std::move(list);
}

/// Tiles of at most max_cells a side, for cells finer than the usual tile is made for. `--set run.tile`, which comes later, decides.
void fit_tile(const std::string& cell, const JobOption& o, pipeline::Request& out) {
  constexpr double usual_tile = 500.0, least_tile = 10.0, max_cells = 2000.0;  // m, m; along a side
  const double side = max_cells * quantity(o.dimension, cell, o.flag, o.example);
  const bool decides = std::any_of(out.sets.begin(), out.sets.end(), [](const std::string& s) { return s.starts_with("run.tile"); });
  if (side > 0.0 && side < least_tile && !decides)
    throw core::usage_error("the cell is too small", o.flag + " " + cell,
                            "the smallest is " + core::format_quantity(Dimension::length, least_tile / max_cells) +
                                (o.option == "dtm.cell" ? "; returns of a survey from the air lie decimetres apart" : ""));
  if (side > 0.0 && side < usual_tile) out.sets.insert(out.sets.begin(), "run.tile=" + core::format_quantity(Dimension::length, side));
}

/// By the finest cells of the rasters that the job makes.
void fit_tile_to_finest(const Job& job, const Given& a, pipeline::Request& out) {
  const JobOption* finest = nullptr;
  std::string cell;
  for (size_t k = 0; k < job.options.size(); ++k) {
    const JobOption& o = job.options[k];
    if (a.values[k].empty() || (o.option != "dtm.cell" && o.option != "orthophoto.cell")) continue;
    if (finest && quantity(o.dimension, a.values[k], o.flag, o.example) >= quantity(finest->dimension, cell, finest->flag, finest->example))
      continue;
    finest = &o, cell = a.values[k];
  }
  if (finest) fit_tile(cell, *finest, out);
}

/// For intervals below 1 m shorter lines are kept than the config has it: 20 times the interval, or a small plot would have none. `--set
/// contours.min_length`, which comes later, decides.
void fit_lines(const std::string& interval, const JobOption& o, pipeline::Request& out) {
  constexpr double usual_length = 20.0, intervals = 20.0;  // m
  const double length = intervals * quantity(o.dimension, interval, o.flag, o.example);
  if (length > 0.0 && length < usual_length)
    out.sets.insert(out.sets.begin(), "contours.min_length=" + core::format_quantity(Dimension::length, length));
}

/// Terrain, flight lines and check points are judged by the cloud's own ground.
void require_ground(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& sets) {
  const bool others = std::any_of(sets.begin(), sets.end(), [](const std::string& s) { return s.starts_with("dtm.classes"); });
  if (others || pipeline::has_class(files, 2)) return;
  throw core::Error(
      "no point is classified as ground (class 2), and quality is judged by the cloud's own ground", files.front().string(),
      "run `swath classify` first, and judge the points that it writes; or name the classes of the ground: --set dtm.classes=[2,8]");
}

pipeline::Request request_of(const Job& job, const Given& a) {
  pipeline::Request out = a.request;
  const auto files = pipeline::cloud_files(a.clouds);
  out.config = a.classes.empty() ? job.config : job.classified;
  if (!a.classes.empty()) out.sets.push_back(class_list(a.classes));
  for (size_t k = 0; k < job.options.size(); ++k) {
    const JobOption& o = job.options[k];
    if (a.values[k].empty()) continue;
    quantity(o.dimension, a.values[k], o.flag, o.example);
    out.sets.push_back(o.option + "=" + a.values[k]);
    if (o.option == "orthophoto.cell") out.sets.push_back("true_orthophoto.cell=" + a.values[k]);
    if (o.option == "contours.interval") fit_lines(a.values[k], o, out);
  }
  fit_tile_to_finest(job, a, out);
  out.survey_tree = pipeline::cloud_survey(files, a.crs);
  if (job.judges) add_judgement(a, files, out), require_ground(files, a.request.sets);
  if (job.photos) add_photos(a, *out.survey_tree);
  if (out.output.empty()) out.output = pipeline::proposed_output(files, job.name);
  return out;
}

/// What to do about an option that a short name sets.
std::string hint_of(const Job& job, const JobOption& o, const std::string& value, const core::Error& e) {
  if (!e.hint().empty()) return e.hint();
  const std::string sets = "it sets " + o.option + ", see `swath explain " + job.config + "`";
  const bool too_wide = std::string_view(e.what()).find("max_edge") != std::string_view::npos;
  return too_wide ? "name a smaller cell, or have wider gaps bridged, too: --set dtm.max_edge=" + value + "; " + sets : sets;
}

/// The keys of survey.toml that a hint names are options of a job, or keys of a survey to be written.
std::string of_options(std::string hint, const Job& job) {
  const std::pair<std::string_view, std::string_view> keys[]{
      {"the columns and the CRS of this [[control]]", "the columns (--check-columns) and the CRS (--check-crs)"},
      {"crs in this [[control]]", "--check-crs"}};
  for (const auto& [key, option] : keys)
    if (const size_t at = hint.find(key); at != hint.npos) hint.replace(at, key.size(), option);
  if (hint.find("points.") != hint.npos && hint.find("`swath run`") == hint.npos)
    hint += "; " + job.name + " has no option for it: name the clouds as [[points]] in a survey.toml, and `swath run " + job.config +
            " --survey survey.toml`";
  return hint;
}

/// A fault of an option that a short name set is that one's, and not the config's.
int run_job(const Job& job, const Given& a, const std::string& typed) {
  try {
    return run_pipeline(request_of(job, a), a.loudness, typed, a.save);
  } catch (const core::Error& e) {
    if (const std::string hint = of_options(e.hint(), job); hint != e.hint()) throw core::Error(e.what(), e.where(), hint, e.code());
    if (e.code() != core::Exit::bad_usage || e.where().starts_with("--")) throw;
    for (size_t k = 0; k < job.options.size(); ++k) {
      const std::string& key = job.options[k].option;
      const std::string option = key.substr(key.find('.') + 1), said = e.where() + " " + e.what();
      if (!a.values[k].empty() && said.find(option) != std::string::npos)
        throw core::usage_error(e.what(), job.options[k].flag + " " + a.values[k], hint_of(job, job.options[k], a.values[k], e));
    }
    throw;
  }
}

void add_job(Commands& commands, const Job& job) {
  const auto a = std::make_shared<Given>();
  a->values.resize(job.options.size());
  auto* c = commands.add(job.name, job.help, [a, &job, &commands] { return run_job(job, *a, commands.typed()); });
  c->add_option("CLOUD", a->clouds, "LAS, LAZ, COPC, EPT or .vpc files, folders of them, or patterns")->required();
  add_output(*c, a->request.output, "Folder of the products; without it NAME_" + job.name + " in the working folder");
  for (size_t k = 0; k < job.options.size(); ++k) {
    const JobOption& o = job.options[k];
    c->add_option(o.flag, a->values[k], o.help + ", for example " + o.example);
  }
  if (!job.classified.empty())
    c->add_option("--classes", a->classes, "Class of the clouds that is terrain, such as 2; without it ground is found anew")
        ->allow_extra_args(false);
  if (job.judges) {
    c->add_option("--check", a->check, "Check points: CSV with name,x,y,z or GeoPackage")->allow_extra_args(false);
    c->add_option("--check-columns", a->check_columns, "Their columns NAME,X,Y,Z or X,Y,Z, by names or numbers from 1: 1,3,2,4");
    c->add_option("--check-crs", a->check_crs, "Their CRS, where it is not the survey's");
    c->add_option("--reference", a->reference, "Terrain model to compare with, GeoTIFF or VRT");
    c->add_option("--level", a->level, "Quality level of the USGS, QL0 to QL3; none: figures without a verdict")->capture_default_str();
  }
  if (job.photos) {
    c->add_option("--photos", a->photos, "Folder of the photographs, as the camera took them")->required();
    c->add_option("--orientation", a->orientation, "Table of their orientations: orientation.csv of `swath block`")->required();
    c->add_option("--camera", a->camera, "Table of the camera: camera.toml of `swath block`")->required();
    c->add_option("--orientation-crs", a->orientation_crs,
                  "CRS of the orientations, if their table states none; default: that of the clouds");
  }
  c->add_option("--crs", a->crs, "CRS of the products, and of clouds that state none: EPSG:25832");
  c->add_option("--set", a->request.sets, "One option of one stage of the config " + job.config)->allow_extra_args(false);
  add_run_options(*c, a->request, a->loudness, a->save);
}

}  // namespace

void add_job_commands(Commands& commands) {
  const auto known = pipeline::config_names();
  for (const Job& job : jobs())
    if (std::find(known.begin(), known.end(), job.config) != known.end()) add_job(commands, job);
}

}  // namespace swath::tools
