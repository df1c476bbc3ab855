// SPDX-License-Identifier: GPL-3.0-or-later
// The plan of the house, held by a test: which room may know which, and which door each heavy library stays behind.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
const fs::path root = SWATH_SOURCE_DIR;

/// Room -> rooms it may include, itself excepted.
const std::map<std::string, std::set<std::string>> arrows = {
    {"core", {}},
    {"io", {"core"}},
    {"filters", {"core"}},
    {"terrain", {"core"}},
    {"quality", {"core"}},
    {"trajectory", {"core"}},
    {"report", {"core"}},
    {"georef", {"core", "trajectory"}},
    {"calib", {"core", "io", "filters", "terrain", "trajectory", "report", "georef"}},
    {"planning", {"core"}},
    {"simulate", {"core", "io", "planning"}},
    {"stages", {"core", "io", "filters", "terrain", "quality", "trajectory", "report", "georef", "calib"}},
    {"pipeline", {"core", "io", "report", "planning", "terrain", "stages", "calib"}},
    {"tools", {"core", "io", "report", "planning", "pipeline", "simulate", "calib"}},
    {"python", {"core", "io", "trajectory", "stages", "pipeline", "simulate"}},
};

/// Third party (as its includes begin) -> the only files that may include it.
const std::vector<std::pair<std::regex, std::regex>> doors = {
    {std::regex("CGAL/.*"), std::regex("terrain/.*\\.cpp|filters/ground/.*\\.cpp|filters/classes/ground_.*\\.cpp")},
    {std::regex("octomap/.*"), std::regex("filters/noise/visibility\\.cpp")},
    {std::regex("pcl/.*"), std::regex("filters/.*\\.cpp|calib/ties/tie_planes\\.cpp")},
    {std::regex("(gdal|ogr|cpl|vrt).*\\.h"), std::regex("io/.*\\.cpp|io/vector/gdal_door\\.h")},
    {std::regex("proj.*\\.h"), std::regex("core/geo/.*|io/survey/versions\\.cpp")},
    {std::regex("toml\\+\\+/.*|rapidjson/.*|png\\.h"), std::regex("io/.*\\.cpp")},
    {std::regex("cairo.*\\.h"), std::regex("report/canvas\\.cpp")},
    {std::regex("ceres/.*"), std::regex("calib/.*\\.cpp")},
    {std::regex("tbb/.*|oneapi/.*"), std::regex("(pipeline|simulate|io|stages/adapters)/.*\\.cpp|core/parallel\\.cpp")},
    {std::regex("CLI/.*"), std::regex("tools/.*")},
    {std::regex("zlib\\.h"), std::regex("tools/view/packed\\.cpp")},
    {std::regex("httplib\\.h"), std::regex("tools/view/server\\.cpp")},
    {std::regex("nanobind/.*"), std::regex("python/.*")},
};

struct Include {
  fs::path file;
  int line;
  std::string what;
  bool ours;
};

std::vector<fs::path> sources(const std::string& room) {
  std::vector<fs::path> out;
  for (const auto& e : fs::recursive_directory_iterator(root / room))
    if (e.path().extension() == ".h" || e.path().extension() == ".cpp") out.push_back(e.path());
  return out;
}

std::vector<Include> includes(const fs::path& file) {
  static const std::regex pattern("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::vector<Include> out;
  std::ifstream in(file);
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::smatch m;
    if (std::regex_match(text, m, pattern)) out.push_back({fs::relative(file, root), line, m[2], m[1] == "\""});
  }
  return out;
}

TEST(House, ArrowsGoDownOnly) {
  for (const auto& [room, allowed] : arrows) {
    const auto files = sources(room);
    EXPECT_FALSE(files.empty()) << room << " is empty";
    for (const fs::path& file : files)
      for (const Include& i : includes(file)) {
        if (!i.ours) continue;
        const std::string to = i.what.substr(0, i.what.find('/'));
        EXPECT_TRUE(arrows.contains(to)) << i.file << ":" << i.line << " includes \"" << i.what << "\", which is in no room";
        EXPECT_TRUE(to == room || allowed.contains(to))
            << i.file << ":" << i.line << " includes \"" << i.what << "\": " << room << " must not know " << to;
      }
  }
}

/// The unit of a file: its path without the ending, so that a header and its source are one.
std::string unit_of(const std::string& path) { return path.substr(0, path.rfind('.')); }

/// Every unit of the rooms with the units that it includes.
std::map<std::string, std::set<std::string>> units() {
  std::map<std::string, std::set<std::string>> out;
  for (const auto& [room, allowed] : arrows)
    for (const fs::path& file : sources(room)) {
      const std::string from = unit_of(fs::relative(file, root).generic_string());
      out[from];
      for (const Include& i : includes(file))
        if (i.ours && unit_of(i.what) != from) out[from].insert(unit_of(i.what));
    }
  return out;
}

/// The units on a way from `from` back to it; empty where there is none.
std::vector<std::string> circle_through(const std::string& from, const std::map<std::string, std::set<std::string>>& graph) {
  std::map<std::string, std::string> came_from;
  std::vector<std::string> todo{from};
  while (!todo.empty()) {
    const std::string at = todo.back();
    todo.pop_back();
    const auto next = graph.find(at);
    if (next == graph.end()) continue;
    for (const std::string& to : next->second) {
      if (to == from) {
        std::vector<std::string> way{at};
        while (way.back() != from) way.push_back(came_from.at(way.back()));
        return way;
      }
      if (came_from.try_emplace(to, at).second) todo.push_back(to);
    }
  }
  return {};
}

TEST(House, NoUnitsIncludeEachOtherInACircle) {
  const auto graph = units();
  ASSERT_GT(graph.size(), 100u);
  for (const auto& [unit, included] : graph) {
    std::string names;
    for (const std::string& on_the_way : circle_through(unit, graph)) names += " <- " + on_the_way;
    EXPECT_EQ(names, "") << unit;
  }
}

TEST(House, AFolderHoldsFewUnits) {
  constexpr size_t max_units = 26;
  std::map<std::string, size_t> count;
  for (const auto& [unit, included] : units()) ++count[unit.substr(0, unit.rfind('/'))];
  for (const auto& [folder, n] : count) EXPECT_LE(n, max_units) << folder << " wants rooms";
}

TEST(House, HeavyLibrariesStayBehindTheirDoors) {
  for (const auto& [room, allowed] : arrows)
    for (const fs::path& file : sources(room))
      for (const Include& i : includes(file))
        for (const auto& [library, door] : doors)
          if (!i.ours && std::regex_match(i.what, library)) {
            EXPECT_TRUE(std::regex_match(i.file.generic_string(), door))
                << i.file << ":" << i.line << " includes <" << i.what << "> outside its door";
          }
}

/// Stages ask for records by Stage::record or as parameters of a function: both know what the stage declares, by which the engine knows a
/// record's last use.
TEST(House, StagesUseNoRecordThatTheyDoNotDeclare) {
  const std::regex asked("records\\.(get|has|find|take)<");
  const std::set<std::string> allowed{"stages/stage.h", "stages/once.h"};
  for (const fs::path& file : sources("stages")) {
    std::ifstream in(file);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    EXPECT_TRUE(allowed.contains(fs::relative(file, root).generic_string()) || !std::regex_search(text, asked)) << file;
  }
}

TEST(House, EveryFileStatesItsLicenceAndStaysShort) {
  for (const auto& [room, allowed] : arrows)
    for (const fs::path& file : sources(room)) {
      std::ifstream in(file);
      std::string text, opening;
      int lines = 0;
      bool opens = true;
      while (std::getline(in, text)) {
        if (++lines == 1) {
          EXPECT_TRUE(text == "// SPDX-License-Identifier: GPL-3.0-or-later" || text == "/* SPDX-License-Identifier: GPL-3.0-or-later")
              << file;
        }
        opens = opens && text.starts_with("//");
        if (opens) opening += text + "\n";
      }
      EXPECT_TRUE(lines <= 400 || opening.find("ver 400 lines") != std::string::npos)
          << file << " has " << lines << " lines and gives no reason";
    }
}

TEST(House, TheRootBuildFileStaysShort) {
  std::ifstream in(root / "CMakeLists.txt");
  int lines = 0;
  for (std::string text; std::getline(in, text);) ++lines;
  EXPECT_LT(lines, 80);
}

}  // namespace
