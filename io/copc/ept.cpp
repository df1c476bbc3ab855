// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Entwine Point Tile (entwine.io, "EPT format" 1.1.0); STAC 1.0 ItemCollection as PDAL wrench and QGIS use it for .vpc.
// Deviation: none. Each node is an ordinary LAZ file; overlapping additives ("addon" sets) are not looked at.
#include "io/copc/ept.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <set>

#include "core/error.h"
#include "io/copc/octree.h"
#include "io/store/address.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;
using core::Value;

constexpr const char* damaged = "the index is damaged or incomplete: fetch it again, or build it again from its points";

[[noreturn]] void bad_index(const std::string& what, const fs::path& file) { throw core::Error(what, file.string(), damaged); }

const Value& member(const Value& of, const char* key, const fs::path& file) {
  const Value* v = of.find(key);
  if (!v) bad_index(std::string("the EPT index has no ") + key, file);
  return *v;
}

OctreeKey key_of(const std::string& text, const fs::path& file) {
  OctreeKey key;
  const char *at = text.data(), *end = at + text.size();
  for (std::int32_t* part : {&key.level, &key.x, &key.y, &key.z}) {
    const auto [next, code] = std::from_chars(at, end, *part);
    if (code != std::errc() || *part < 0 || (next != end && *next != '-')) bad_index("'" + text + "' is not a node", file);
    at = next == end ? end : next + 1;
  }
  if (key.text() != text || key.level > 30 || std::max({key.x, key.y, key.z}) >= 1 << key.level)
    bad_index("'" + text + "' is not a node", file);
  return key;
}

/// Nodes with their numbers of points.
class EptHierarchy {
 public:
  explicit EptHierarchy(fs::path folder) : folder_(std::move(folder)) { read({}); }
  std::vector<std::pair<OctreeKey, std::int64_t>> nodes;

 private:
  void read(const OctreeKey& top) {
    const fs::path file = folder_ / (top.text() + ".json");
    if (!fs::exists(file)) throw core::Error("the page of the EPT hierarchy is missing", file.string(), damaged);
    if (!pages_.insert(top).second) bad_index("the page is listed twice", file);
    const Value page = read_value_file(file);
    if (!page.is_object()) bad_index("the page of the EPT hierarchy is not a table of nodes", file);
    for (const auto& [name, points] : page.members()) {
      const OctreeKey key = key_of(name, file);
      if (!points.is_int() || points.as_int() < -1) bad_index("the node " + name + " has no number of points", file);
      if (points.as_int() == -1)
        read(key);
      else if (points.as_int() > 0)
        nodes.emplace_back(key, points.as_int());
    }
  }

  fs::path folder_;
  std::set<OctreeKey> pages_;
};

/// "EPSG:25832+7837", or WKT; empty where the index states none.
std::string crs_of(const Value& index) {
  const Value* srs = index.find("srs");
  if (!srs) return {};
  const auto text = [&](const char* key) {
    const Value* v = srs->find(key);
    return v && v->is_text() ? v->as_text() : std::string();
  };
  if (text("authority").empty() || text("horizontal").empty()) return text("wkt");
  return text("authority") + ":" + text("horizontal") + (text("vertical").empty() ? "" : "+" + text("vertical"));
}

OctreeCube cube_of(const Value& index, const fs::path& file) {
  const Value& bounds = member(index, "bounds", file);
  std::vector<double> b;
  if (bounds.is_array())
    for (const Value& v : bounds.items())
      if (v.is_number()) b.push_back(v.as_number());
  if (b.size() != 6 || !(b[3] > b[0])) bad_index("the bounds of the EPT index are not a cube", file);
  return {{0.5 * (b[0] + b[3]), 0.5 * (b[1] + b[4]), 0.5 * (b[2] + b[5])}, 0.5 * (b[3] - b[0])};
}

/// Cells along a node's side.
double span_of(const Value& index, const fs::path& file) {
  const Value& span = member(index, "span", file);
  if (!span.is_number() || !(span.as_number() > 0.0)) bad_index("the span of the EPT index is not a number above 0", file);
  return span.as_number();
}

bool ends_in(const fs::path& file, const char* ending) { return file.extension() == ending; }

}  // namespace

std::optional<EptNode> ept_node(const fs::path& file) {
  if (file.parent_path().filename() != "ept-data") return std::nullopt;
  const fs::path index = file.parent_path().parent_path() / "ept.json";
  if (!fs::exists(index)) return std::nullopt;
  const Value about = read_value_file(index);
  const OctreeKey key = key_of(file.stem().string(), index);
  const OctreeCube cube = cube_of(about, index).of(key);
  return EptNode{key.level, cube.side() / span_of(about, index), cube.low(), cube.centre.array() + cube.half_side};
}

std::vector<PointFile> ept_files(const fs::path& index, const PointFile& like) {
  const Value about = read_value_file(index);
  const Value& encoding = member(about, "dataType", index);
  if (!encoding.is_text() || encoding.as_text() != "laszip")
    throw core::Error("the EPT nodes are not LAZ files" + (encoding.is_text() ? ": " + encoding.as_text() : std::string()), index.string(),
                      "build the index with the encoding laszip");
  cube_of(about, index), span_of(about, index);
  const Value& points = member(about, "points", index);
  if (!points.is_int()) bad_index("the EPT index has no number of points", index);
  EptHierarchy hierarchy(index.parent_path() / "ept-hierarchy");
  std::sort(hierarchy.nodes.begin(), hierarchy.nodes.end());
  std::int64_t sum = 0;
  std::vector<PointFile> out;
  for (const auto& [key, n] : hierarchy.nodes) {
    PointFile& f = out.emplace_back(like);
    f.file = like.file.parent_path() / "ept-data" / (key.text() + ".laz");
    if (f.crs.empty()) f.crs = crs_of(about);
    const fs::path file = index.parent_path() / "ept-data" / (key.text() + ".laz");
    if (!fs::exists(file))
      throw core::Error("the EPT node " + key.text() + " of " + std::to_string(n) + " points is missing", file.string(), damaged);
    sum += n;
  }
  if (sum != points.as_int())
    bad_index("the nodes of the EPT hierarchy have " + std::to_string(sum) + " points, ept.json says " + std::to_string(points.as_int()),
              index);
  return out;
}

std::vector<PointFile> vpc_files(const fs::path& list, const PointFile& like) {
  const Value tree = parse_json(read_text_file(list), list.string());
  const Value* features = tree.find("features");
  if (!features || !features->is_array())
    throw core::Error("not a virtual point cloud: no list of features", list.string(), "a .vpc is a STAC ItemCollection in JSON");
  std::vector<PointFile> out;
  for (size_t i = 0; i < features->items().size(); ++i) {
    const Value* at = &features->items()[i];
    for (const char* key : {"assets", "data", "href"})
      if (at) at = at->find(key);
    const std::string where = list.string() + ": feature " + std::to_string(i + 1);
    if (!at || !at->is_text()) throw core::Error("names no file (assets.data.href)", where, "a .vpc lists a file in each feature");
    std::string href = at->as_text();
    if (href.starts_with("file://")) href.erase(0, 7);
    if (href.find("://") != std::string::npos)
      throw core::Error("the file is not on this machine: " + href, where, "fetch the files and list them by their local names");
    PointFile& f = out.emplace_back(like);
    const fs::path name = fs::path(href).lexically_normal();
    f.file = name.is_absolute() ? name : (like.file.parent_path() / name).lexically_normal();
    if (is_address(name) || is_address(f.file))
      throw core::Error("a list names local files alone, not " + href, where, "state the addresses in [[points]]");
    const fs::path file = name.is_absolute() ? name : list.parent_path() / name;
    if (!fs::exists(file)) throw core::Error("no such file: " + file.string(), where, "names are relative to the folder of the .vpc");
  }
  if (out.empty()) throw core::Error("the virtual point cloud lists no file", list.string());
  return out;
}

void expand_clouds(Survey& survey) {
  std::vector<PointFile> out;
  bool is_list = false;
  for (const PointFile& f : survey.points) {
    const fs::path file = resolve(survey, f.file);
    const bool is_ept = file.filename() == "ept.json", is_vpc = ends_in(file, ".vpc");
    is_list = is_list || is_ept || is_vpc;
    if (!is_ept && !is_vpc) {
      out.push_back(f);
      continue;
    }
    std::vector<PointFile> listed = is_ept ? ept_files(file, f) : vpc_files(file, f);
    std::move(listed.begin(), listed.end(), std::back_inserter(out));
  }
  if (!is_list) return;
  std::set<fs::path> known;
  for (const PointFile& f : out)
    if (const fs::path file = resolve(survey, f.file).lexically_normal(); !known.insert(file).second)
      throw core::usage_error("the file is listed twice: its points would be read twice", file.string(),
                              "see [[points]] and the lists that it names");
  survey.points = std::move(out);
}

}  // namespace swath::io
