// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/hangar_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/survey/tree_kind.h"
#include "io/text/text_table.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::pi;

constexpr double farthest = 1000.0;         // m; no hangar is larger, but a distance in millimetres is
constexpr double steepest = 89.0;           // deg; a sight straight up has no horizontal angle
constexpr double narrowest_triangle = 0.1;  // deg, at the point

std::string degrees_text(double rad) { return core::format_number(std::round(core::to_degrees(rad) * 1e4) / 1e4) + " deg"; }

/// Where each entry of a list of tables stands.
template <class T>
void note_places(const core::Value& tree, const char* key, std::vector<T>& list) {
  const core::Value* tables = tree.find(key);
  for (size_t i = 0; i < list.size(); ++i) list[i].place = tables->items()[i].where.text();
}

class Tables {
 public:
  Tables(HangarSurvey& hangar) : h_(hangar) {}

  void read() {
    if (h_.targets_file) {
      const TextTable t(resolved(*h_.targets_file));
      const size_t name = t.column("name"), x = t.column("x"), y = t.column("y"), z = t.column("z");
      for (size_t r = 0; r < t.rows(); ++r)
        h_.targets.push_back({t.text(r, name), {length(t.number(r, x)), length(t.number(r, y)), length(t.number(r, z))}});
    }
    if (h_.distances_file) {
      const TextTable t(resolved(*h_.distances_file));
      const size_t from = t.column("from"), to = t.column("to"), distance = t.column("distance");
      const auto sigma = t.column_if_there("sigma", "sigma");
      for (size_t r = 0; r < t.rows(); ++r) {
        HangarDistance d{t.text(r, from), t.text(r, to), length(t.number(r, distance)), {}, t.place(r)};
        if (sigma && !t.text(r, *sigma).empty()) d.sigma = length(above_zero(t, r, *sigma));
        h_.distances.push_back(std::move(d));
      }
    }
    if (h_.angles_file) {
      const TextTable t(resolved(*h_.angles_file));
      const size_t at = t.column("at"), from = t.column("from"), to = t.column("to"), angle = t.column("angle");
      const auto sigma = t.column_if_there("sigma", "sigma");
      for (size_t r = 0; r < t.rows(); ++r) {
        HangarAngle a{t.text(r, at), t.text(r, from), t.text(r, to), radians(t, t.number(r, angle)), {}, t.place(r)};
        if (sigma && !t.text(r, *sigma).empty()) a.sigma = radians(t, above_zero(t, r, *sigma));
        h_.angles.push_back(std::move(a));
      }
    }
    if (h_.verticals_file) {
      const TextTable t(resolved(*h_.verticals_file));
      const size_t at = t.column("at"), to = t.column("to"), angle = t.column("angle");
      const auto sigma = t.column_if_there("sigma", "sigma");
      for (size_t r = 0; r < t.rows(); ++r) {
        HangarVertical a{t.text(r, at), t.text(r, to), radians(t, t.number(r, angle)), {}, t.place(r)};
        if (sigma && !t.text(r, *sigma).empty()) a.sigma = radians(t, above_zero(t, r, *sigma));
        h_.verticals.push_back(std::move(a));
      }
    }
  }

 private:
  fs::path resolved(const fs::path& table) const { return h_.file.parent_path() / table; }
  core::Metres length(double v) const { return h_.length_unit * v; }
  core::Radians radians(const TextTable& table, double v) const {
    if (h_.angle_unit == AngleUnit::unstated)
      throw core::usage_error("the unit of its angles is not stated", table.place(0), "state angle_unit in " + h_.file.string());
    return core::Radians(v * radians_per(h_.angle_unit));
  }
  static double above_zero(const TextTable& table, size_t row, size_t column) {
    const double v = table.number(row, column);
    if (!(v > 0)) throw Error("the sigma is " + core::format_number(v) + ", which is not above zero", table.place(row), "correct the line");
    return v;
  }

  HangarSurvey& h_;
};

/// Holds names and observations to their rules, and fills in what they leave to the instrument.
class HangarChecks {
 public:
  HangarChecks(HangarSurvey& hangar) : h_(hangar), file_(hangar.file.string()) {}

  void run() {
    for (const HangarTarget& t : h_.targets) add(t.name, "target");
    for (const HangarStation& s : h_.stations) add(s.name, "station");
    for (const HangarPoint& p : h_.points) add(p.name, "point");
    check_roles();
    for (HangarDistance& d : h_.distances) check(d);
    for (HangarAngle& a : h_.angles) check(a);
    for (HangarVertical& v : h_.verticals) check(v);
    check_triangles();
  }

 private:
  void add(const std::string& name, const std::string& kind) {
    if (name.empty()) throw Error("a " + kind + " has no name", file_, "name every target, station and point");
    const auto [it, fresh] = kinds_.try_emplace(name, kind);
    if (!fresh)
      throw Error("the name '" + name + "' stands twice, as " + it->second + " and as " + kind, file_, "give each a name of its own");
  }

  void check_roles() const {
    for (const HangarRole role : {HangarRole::imu, HangarRole::scanner, HangarRole::antenna}) {
      int n = 0;
      for (const HangarPoint& p : h_.points) n += p.role == role ? 1 : 0;
      if (n > 1)
        throw Error("more than one point has the role " + std::string(core::Choices<HangarRole>::names[static_cast<size_t>(role)]), file_,
                    "one point per role; further ones are marks");
    }
  }

  /// Is the name there, and of one of these kinds?
  void need(const std::string& name, const std::vector<std::string>& kinds, const std::string& place) const {
    const auto it = kinds_.find(name);
    if (it != kinds_.end() && std::find(kinds.begin(), kinds.end(), it->second) != kinds.end()) return;
    std::string wanted;
    for (const std::string& k : kinds) wanted += (wanted.empty() ? "" : " or ") + k;
    if (it != kinds_.end())
      throw Error("'" + name + "' is a " + it->second + ", a " + wanted + " is needed", place, "check the columns or keys");
    std::vector<std::string> names;
    for (const auto& [known, kind] : kinds_)
      if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) names.push_back(known);
    const std::string near = core::nearest(name, names);
    throw Error("no " + wanted + " '" + name + "'", place,
                near.empty() ? "names are told apart by letter case and blanks" : "did you mean '" + near + "'?");
  }

  void once(const std::string& a, const std::string& b, const std::string& c, const std::string& place) {
    const auto [it, fresh] = seen_.try_emplace({a, b, c}, place);
    if (!fresh)
      throw Error("the observation was stated before, as " + it->second, place, "state the mean of repeated ones, with its sigma");
  }

  void check(HangarDistance& d) {
    need(d.from, {"station"}, d.place);
    need(d.to, {"target", "point"}, d.place);
    if (!(d.distance.value > 0) || d.distance.value > farthest)
      throw Error("the distance is " + core::format_number(d.distance.value) + " m, which is none above 0 and up to " +
                      core::format_number(farthest) + " m",
                  d.place, "is the unit right? tables have length_unit");
    once("distance", d.from, d.to, d.place);
    if (!d.sigma) d.sigma = core::Metres(h_.instrument.distance_sigma(d.distance.value));
  }

  void check(HangarAngle& a) {
    need(a.at, {"station"}, a.place);
    need(a.from, {"station"}, a.place);
    need(a.to, {"point"}, a.place);
    if (a.at == a.from) throw Error("the angle at '" + a.at + "' counts from the station itself", a.place, "`from` is the other station");
    if (a.angle.value > pi && a.angle.value < 2 * pi) a.angle = core::Radians(2 * pi - a.angle.value);  // counted the other way round
    if (!(a.angle.value > 0 && a.angle.value < pi))
      throw Error("the angle is " + degrees_text(a.angle.value) + ", which is none between 0 and 180 deg", a.place,
                  "is the unit right? 200 gon are 180 deg; tables have angle_unit");
    once(a.at, a.from, a.to, a.place);
    if (!a.sigma) a.sigma = h_.instrument.angle;
  }

  void check(HangarVertical& v) {
    need(v.at, {"station"}, v.place);
    need(v.to, {"point"}, v.place);
    const double stated = v.angle.value;
    if (h_.vertical_from == VerticalFrom::zenith) v.angle = core::Radians(pi / 2 - stated);
    if (!(std::abs(v.angle.value) < steepest * core::degree))
      throw Error("the vertical angle is " + degrees_text(stated) + ", which is none within " + core::format_number(steepest) +
                      " deg of the horizon",
                  v.place,
                  h_.vertical_from == VerticalFrom::zenith ? "does it count from the horizon? then leave vertical_from out"
                                                           : "does it count from the zenith? then state vertical_from = \"zenith\"");
    once("vertical", v.at, v.to, v.place);
    if (!v.sigma) v.sigma = h_.instrument.angle;
  }

  void check_triangles() const {
    std::map<std::tuple<std::string, std::string, std::string>, const HangarAngle*> angles;
    for (const HangarAngle& a : h_.angles) angles[{a.at, a.from, a.to}] = &a;
    for (const HangarAngle& a : h_.angles) {
      const auto other = angles.find({a.from, a.at, a.to});
      if (other == angles.end()) continue;
      const double sum = a.angle.value + other->second->angle.value;
      if (sum < pi - narrowest_triangle * core::degree) continue;
      throw Error(
          "the angles at '" + a.at + "' and '" + a.from + "' to '" + a.to + "' make " + degrees_text(sum) + ": their sights do not meet",
          a.place, "check both angles and their units; a point on the line of two stations needs another pair");
    }
  }

  HangarSurvey& h_;
  std::string file_;
  std::map<std::string, std::string> kinds_;
  std::map<std::tuple<std::string, std::string, std::string>, std::string> seen_;
};

}  // namespace

std::vector<fs::path> hangar_tables(const HangarSurvey& h) {
  std::vector<fs::path> out;
  for (const auto& table : {h.targets_file, h.distances_file, h.angles_file, h.verticals_file})
    if (table) out.push_back(h.file.parent_path() / *table);
  return out;
}

HangarSurvey read_hangar(const fs::path& file) {
  const core::Value tree = read_value_file(file);
  if (!tree.is_object()) throw core::usage_error("a hangar survey is a table", file.string());
  require_kind(tree, TreeKind::hangar, file);
  HangarSurvey h;
  h.file = file;
  std::vector<core::Fault> faults;
  core::read_options(core::described(h), tree, "", faults);
  core::throw_if_any(faults);
  note_places(tree, "distance", h.distances);
  note_places(tree, "angle", h.angles);
  note_places(tree, "vertical", h.verticals);
  Tables(h).read();
  HangarChecks(h).run();
  return h;
}

}  // namespace swath::io
