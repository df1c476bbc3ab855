// SPDX-License-Identifier: GPL-3.0-or-later
// configs/qc.toml on a delivered cloud with known faults: a void, a pond, a line too high, a reference too low, a bad check point.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

#include "core/error.h"
#include "io/las/las_writer.h"
#include "io/raster/geotiff.h"
#include "io/text/value_file.h"
#include "pipeline/run.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr double east0 = 500000, north0 = 5300000, spacing = 0.5, line_shift = 0.05, noise = 0.015, reference_shift = 0.10;
constexpr double void_side = 22.0, pond_radius = 16.0;

double ground(double x, double y) { return 400.0 + 0.05 * x + 2.0 * std::sin(y / 40.0); }

/// Two lines over 200 m x 200 m, the second higher; line 1 alone sees the west with the void, both see the pond.
core::Block cloud() {
  core::Block b;
  b.origin = {east0, north0, 0};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> shift(-0.3 * spacing, 0.3 * spacing);
  std::normal_distribution<double> error(0.0, noise);
  for (int line = 1; line <= 2; ++line)
    for (double v = 0.25; v < 200; v += spacing)
      for (double u = 0.25; u < 140; u += spacing) {
        const double x = u + (line == 2 ? 60.0 : 0.0) + shift(random), y = v + shift(random);
        const double from_pond = std::hypot(x - 110.0, y - 140.0);
        if ((std::abs(x - 30.0) < 0.5 * void_side && std::abs(y - 50.0) < 0.5 * void_side) || from_pond < pond_radius) continue;
        b.x.push_back(x), b.y.push_back(y);
        b.z.push_back(ground(x, y) + (line == 2 ? line_shift : 0.0) + error(random));
        b.time.push_back(1e-4 * static_cast<double>(b.x.size()));
        b.return_number.push_back(1), b.return_count.push_back(1);
        b.classification.push_back(from_pond < pond_radius + 4.0 ? core::point_class::water : core::point_class::ground);
        b.strip.push_back(static_cast<std::uint16_t>(line));
        b.sigma_v.push_back(0.04F);
      }
  return b;
}

std::string marks(int n, double move = 0.0, bool named = true) {
  std::string out = "name,x,y,z,cover\n";
  for (int k = 0; k < n; ++k) {
    const double x = 8.0 + std::fmod(37.7 * k, 184.0), y = 5.0 + std::fmod(61.3 * k, 80.0);
    out += (named ? "M" + std::to_string(k + 1) : std::string("same")) + "," + std::to_string(east0 + x + move) + "," +
           std::to_string(north0 + y) + "," + std::to_string(ground(x, y) + (k == 6 ? 0.5 : 0.0)) + (k % 4 == 3 ? ",forest\n" : ",open\n");
  }
  return out;
}

class Quality : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    io::LasWriteOptions o;
    o.threads = 1;
    io::LasWriter writer(*folder_ / "a.las", o);
    writer.write(cloud());
    writer.finish();
    core::Grid reference(core::lattice_of(1.0, east0 - 10, north0 - 10, east0 + 150, north0 + 210));
    for (int j = 0; j < reference.lattice.ny; ++j)
      for (int i = 0; i < reference.lattice.nx; ++i) {
        const size_t c = reference.lattice.at(i, j);
        reference.height[c] =
            static_cast<float>(ground(reference.lattice.centre_x(i) - east0, reference.lattice.centre_y(j) - north0) - reference_shift);
        reference.reason[c] = core::Void::none;
      }
    io::write_grid(*folder_ / "reference.tif", reference, "EPSG:32632");
    io::write_grid(*folder_ / "elsewhere.tif", reference, "EPSG:32633");
    test::write_bytes(*folder_ / "control.csv", "name,x,y,z\nC1,500010,5300010,401\n");
    survey("check.csv", marks(32));
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static void survey(const std::string& check, const std::string& rows) {
    test::write_bytes(*folder_ / check, rows);
    test::write_bytes(*folder_ / (check + ".toml"),
                      "name = \"Known\"\ncrs = \"EPSG:32632\"\n[[points]]\nfile = \"a.las\"\ncrs = \"EPSG:32632\"\n"
                      "[[control]]\nfile = \"control.csv\"\n[[control]]\nfile = \"" +
                          check + "\"\nuse = \"check\"\n");
  }
  static Outcome run(const fs::path& output, const std::vector<std::string>& sets, const std::string& check = "check.csv") {
    Request r;
    r.config = test::source_folder() / "configs/qc.toml";
    r.survey = *folder_ / (check + ".toml");
    r.output = output;
    r.sets = sets;
    r.sets.insert(r.sets.begin(), "run.tile=\"100 m\"");
    r.threads = 2;
    Plan plan = make_plan(r);
    Progress progress(Voice::quiet);
    return pipeline::run(plan, progress, "test");
  }
  static const core::Value& findings(const Outcome& o, const std::string& stage) {
    for (const core::Value& s : o.report.find("stages")->items())
      if (s.find("type")->as_text() == stage) return *s.find("findings");
    throw std::runtime_error("no " + stage);
  }
  static std::vector<std::string> codes(const Outcome& o) {
    std::vector<std::string> out;
    for (const core::Value& w : o.report.find("warnings")->items()) out.push_back(w.find("code")->as_text());
    return out;
  }
  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> Quality::folder_;

double number(const core::Value& v, const char* key) { return v.find(key)->as_number(); }

TEST_F(Quality, KnownFaultsAreFound) {
  const test::TemporaryFolder out;
  const Outcome o = run(
      out / "a", {"surface.reference=reference.tif", "swath.quality_level=QL2", "points.map.scale=1000", "points.map.interval=\"0.5 m\""});
  EXPECT_EQ(o.code, core::Exit::quality_missed);  // the void

  const core::Value& density = findings(o, "quality.density");
  EXPECT_NEAR(number(density.find("lines")->items()[0], "density"), 4.0, 0.02);
  EXPECT_NEAR(number(density, "density_95"), 8.0, 0.5);

  const core::Value& swath = findings(o, "quality.swath");
  EXPECT_EQ(number(swath, "voids"), 1);
  EXPECT_NEAR(number(swath, "void_m2"), void_side * void_side, 0.02 * void_side * void_side);
  EXPECT_EQ(number(swath, "water_voids"), 1);
  const double pond = 3.14159 * pond_radius * pond_radius;
  EXPECT_NEAR(number(swath, "water_void_m2"), pond, 0.02 * pond);
  EXPECT_NEAR(number(swath, "even"), 1.0, 1e-3);
  ASSERT_EQ(swath.find("pairs")->items().size(), 1u);
  const core::Value& pair = swath.find("pairs")->items()[0];
  EXPECT_NEAR(number(pair, "median_m"), -line_shift, 0.002);
  EXPECT_NEAR(number(pair, "error_over_sigma"), line_shift / std::hypot(0.0371, 0.0371), 0.1);  // 4 cm less 1.5 cm of white noise, twice
  for (const core::Value& line : swath.find("lines")->items()) EXPECT_NEAR(number(line, "hard_m"), noise, 0.1 * noise);

  const core::Value& surface = findings(o, "quality.surface");
  const core::Value& all = surface.find("classes")->items()[0];
  EXPECT_NEAR(number(all, "median_m"), reference_shift, 0.03);  // and up to 5 cm of line 2
  EXPECT_LT(number(all, "std_m"), 0.04);

  const core::Value& points = findings(o, "quality.points");
  EXPECT_LT(number(points, "vva_95_m"), 0.1);
  for (const core::Value& a : points.find("accuracy")->items()) {
    const bool is_vva = a.find("product")->as_text() == "points" && a.find("cover")->as_text() == "vegetated (VVA)";
    if (is_vva) {
      EXPECT_EQ(number(points, "vva_m"), number(a, "rmse_with_marks_m"));
    }
  }
  EXPECT_EQ(points.find("map")->find("rule")->as_text(), "decree");
  const std::vector<std::string> named = codes(o);
  EXPECT_EQ(std::count(named.begin(), named.end(), "check.mark"), 1);
  EXPECT_EQ(std::count(named.begin(), named.end(), "control.unused"), 1);
  EXPECT_EQ(std::count(named.begin(), named.end(), "limit.quality_level"), 1);

  const core::Value& report = findings(o, "report.quality");
  EXPECT_EQ(report.find("quality_level")->as_text(), "QL2");
  EXPECT_GE(number(report, "missed"), 1);
  EXPECT_EQ(report.find("requirements")->items().size(), 7u);
  const std::string page = test::read_bytes(out / "a/quality.html"), xml = test::read_bytes(out / "a/quality.xml");
  for (const char* heading : {"Requirements", "Density of first returns", "Spatial distribution and voids",
                              "Flight lines against one another", "Check points", "Class of a map", "Terrain model against the reference"})
    EXPECT_NE(page.find(heading), std::string::npos) << heading;
  EXPECT_NE(xml.find("<mdq:DQ_ConformanceResult>"), std::string::npos);
  for (const char* file :
       {"swath.gpkg", "check_points.gpkg", "overlap_dz.vrt", "surface_difference.vrt", "swath_density.vrt", "spatial_distribution.png"})
    EXPECT_TRUE(fs::exists(out / "a" / file)) << file;
}

/// NVA, VVA, overlaps, voids and reference are each missed by a limit that is a little too tight, and by none that is a little too wide.
TEST_F(Quality, EveryLimitCanBeMissed) {
  const test::TemporaryFolder out;
  const auto missed = [&](const std::string& folder, double overlap, double share, double nva, double vva, double surface) {
    const auto set = [](const char* key, double v, const char* unit) {
      return std::string("run.limits.") + key + "=\"" + std::to_string(v) + unit + "\"";
    };
    const Outcome o = run(out / folder, {"surface.reference=reference.tif", "run.limits.void_share=" + std::to_string(share),
                                         set("overlap_difference", overlap, " m"), set("nva", nva, " m"), set("vva", vva, " m"),
                                         set("surface_difference", surface, " m")});
    std::vector<std::string> codes_missed;
    for (const std::string& code : codes(o))
      if (code.starts_with("limit.")) codes_missed.push_back(code.substr(6));
    EXPECT_EQ(o.code, codes_missed.empty() ? core::Exit::done : core::Exit::quality_missed);
    std::sort(codes_missed.begin(), codes_missed.end());
    return codes_missed;
  };
  // Lines differ by 5 cm; the void has 484 of some 34 000 m2; one open mark of 24 is off by 50 cm, others by up to 5 cm and 2 cm of their
  // own.
  EXPECT_EQ(missed("tight", 0.045, 0.005, 0.09, 0.02, 0.09),
            (std::vector<std::string>{"nva", "overlap_difference", "surface_difference", "void_share", "vva"}));
  EXPECT_TRUE(missed("wide", 0.06, 0.03, 0.13, 0.08, 0.16).empty());
}

TEST_F(Quality, TheXmlCitesTheSpecificationForItsOwnLimitsAlone) {
  const test::TemporaryFolder out;
  run(out / "a", {"swath.quality_level=QL2", "quality.limits.nva=\"2 m\""});
  const std::string xml = test::read_bytes(out / "a/quality.xml"), own = "limits stated for this survey";
  const size_t at = xml.find(own);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(xml.find(own, at + 1), std::string::npos);
  EXPECT_NE(xml.find("RMSE of heights on open ground (NVA): at most 2 m", at), std::string::npos);
  EXPECT_NE(xml.find("Lidar Base Specification 2025 rev. A, QL2"), std::string::npos);
}

TEST_F(Quality, WithoutLevelReferenceAndLimitsThereIsNoVerdict) {
  const test::TemporaryFolder out;
  const Outcome o = run(out / "a", {});
  EXPECT_EQ(o.code, core::Exit::done);
  EXPECT_TRUE(findings(o, "quality.surface").find("surface")->is_text());
  EXPECT_TRUE(findings(o, "report.quality").find("requirements")->items().empty());
  // By the measured spacing of both lines the void has the same area.
  EXPECT_NEAR(number(findings(o, "quality.swath"), "void_m2"), void_side * void_side, 0.02 * void_side * void_side);
}

TEST_F(Quality, UndeclaredValuesForNoneInTheReferenceAreVoidAndNamed) {
  std::string text = "ncols 160\nnrows 220\nxllcorner 499990\nyllcorner 5299990\ncellsize 1\n";
  for (int j = 219; j >= 0; --j, text += "\n")
    for (int i = 0; i < 160; ++i) text += (i < 50 ? "-9999" : std::to_string(ground(i - 9.5, j - 9.5) - reference_shift)) + " ";
  test::write_bytes(*folder_ / "undeclared.asc", text);
  const test::TemporaryFolder out;
  for (const char* side : {"100 m", "70 m"}) {
    const Outcome o = run(out / side, {"surface.reference=undeclared.asc", std::string("run.tile=\"") + side + "\""});
    EXPECT_LT(number(findings(o, "quality.surface"), "rms_m"), 0.3) << side;
    const std::string said = findings(o, "quality.surface").find("undeclared")->as_text();
    EXPECT_TRUE(said.starts_with("undeclared.asc: 8000 ")) << said;  // 40 columns of the area
    EXPECT_NE(said.find(" heights of -9999, which no ground has"), std::string::npos) << said;
    EXPECT_EQ(std::ranges::count(codes(o), "surface.undeclared"), 1);
  }
}

/// Model less reference is 10 cm where line 1 is alone; the reference ends 10 m south of the area and 60 m before its east.
TEST_F(Quality, ASectionAlongALine) {
  const test::TemporaryFolder out;
  test::write_bytes(
      *folder_ / "axis.geojson",
      R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}}, "features": [
{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[500005, 5300100], [500045, 5300100], [500045, 5300180]]}}]})");
  const Outcome o = run(out / "a", {"surface.reference=reference.tif", "surface.profiles=axis.geojson"});
  EXPECT_EQ(o.code, core::Exit::done);
  std::istringstream table(test::read_bytes(out / "a/surface_profiles.csv"));
  std::string row;
  std::getline(table, row);
  EXPECT_EQ(row, "profile,along,x,y,model,reference,difference");
  int rows = 0;
  for (; std::getline(table, row); ++rows) {
    std::vector<std::string> cells;
    std::istringstream fields(row);
    for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 7u) << row;
    EXPECT_EQ(cells[0], "line 1");
    EXPECT_NEAR(std::stod(cells[1]), rows, 1e-9);
    EXPECT_NEAR(std::stod(cells[2]), east0 + std::min(5.0 + rows, 45.0), 1e-3);
    EXPECT_NEAR(std::stod(cells[3]), north0 + 100.0 + std::max(rows - 40.0, 0.0), 1e-3);
    EXPECT_NEAR(std::stod(cells[6]), reference_shift, 4.0 * noise);  // of a few returns each
  }
  EXPECT_EQ(rows, 121);
  EXPECT_NE(test::read_bytes(out / "a/quality.html").find("Section line 1."), std::string::npos);
}

TEST_F(Quality, AReferenceOnAnotherMapIsRefusedBeforeTheRun) {
  const test::TemporaryFolder out;
  for (const char* file : {"elsewhere.tif", "none.tif"}) {
    try {
      run(out / "a", {std::string("surface.reference=") + file});
      FAIL() << file;
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      EXPECT_NE(e.where().find(file), std::string::npos);
      EXPECT_FALSE(e.hint().empty());
    }
  }
}

TEST_F(Quality, CheckPointsThatSayNothingAreNamed) {
  const test::TemporaryFolder out;
  survey("outside.csv", marks(5, 3e4));
  survey("same.csv", marks(5, 0.0, false));
  survey("few.csv", marks(2));
  const auto of = [&](const std::string& check) { return codes(run(out / check, {}, check)); };
  EXPECT_EQ(of("outside.csv"), (std::vector<std::string>{"check.outside", "check.few", "control.unused"}));
  survey("beside.csv", marks(5, 310.0));  // 118 m and more beyond the cloud, in the same tile where tiles are large
  for (const char* tile : {"100 m", "500 m"})
    EXPECT_EQ(codes(run(out / tile, {std::string("run.tile=\"") + tile + "\""}, "beside.csv")),
              (std::vector<std::string>{"check.outside", "check.few", "control.unused"}))
        << tile;
  EXPECT_EQ(of("same.csv"), (std::vector<std::string>{"check.names", "control.unused"}));
  EXPECT_EQ(of("few.csv"), (std::vector<std::string>{"check.few", "control.unused"}));
}

/// A plot of a UAV: cells of 7.5 mm over its tile of 500 m would be 4.4 thousand million.
TEST(QualityOfADensePlot, CostsWhatItsOwnAreaCosts) {
  const test::TemporaryFolder folder;
  core::Block b;
  b.origin = {east0, north0, 0};
  for (double y = 0.015; y < 6.0; y += 0.03)
    for (double x = 0.015; x < 6.0; x += 0.03) {
      if (std::abs(x - 3.0) < 0.5 && std::abs(y - 3.0) < 0.5) continue;
      b.x.push_back(x), b.y.push_back(y), b.z.push_back(ground(x, y));
    }
  b.strip.assign(b.size(), 1), b.classification.assign(b.size(), core::point_class::ground);
  b.return_number.assign(b.size(), 1), b.return_count.assign(b.size(), 1);
  io::LasWriter writer(folder / "plot.las", {});
  writer.write(b);
  writer.finish();
  test::write_bytes(folder / "survey.toml", "name = \"Plot\"\n[[points]]\nfile = \"plot.las\"\ncrs = \"EPSG:32632\"\n");
  Request r{test::source_folder() / "configs/qc.toml", {}, folder / "survey.toml", folder / "out", 2};
  r.sets = {"run.memory=\"1500 MB\""};  // it needed 2.3 GB
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  const Outcome o = pipeline::run(plan, progress, "test");
  int found = 0;
  for (const core::Value& s : o.report.find("stages")->items()) {
    if (s.find("type")->as_text() != "quality.swath") continue;
    EXPECT_NEAR(number(*s.find("findings"), "void_m2"), 1.0, 0.03);
    ++found;
  }
  EXPECT_EQ(found, 1);
}

/// Ground points of a USGS project at its own 60 check points: their makers' mean within 1 m is off by 5.6 cm on open ground, 10.7 cm under
/// vegetation.
TEST(QualityOfRealPoints, CoconinoAgreesWithItsCheckPoints) {
  SWATH_SHARED_OR_SKIP(file, "data/coconino/coconino__matched.json");
  const core::Value described = io::read_value_file(file);
  const std::string bytes = test::read_bytes(file.parent_path() / "coconino__ground.f32");
  std::vector<float> xyz(bytes.size() / sizeof(float));
  std::memcpy(xyz.data(), bytes.data(), xyz.size() * sizeof(float));
  ASSERT_EQ(xyz.size(), 3u * 16614);
  const double east = number(described, "originAlbersE"), north = number(described, "originAlbersN");
  core::Block b;
  b.origin = {std::floor(east), std::floor(north), 0};
  for (size_t k = 0; k < xyz.size(); k += 3) {
    b.x.push_back(static_cast<double>(xyz[k]) + east - b.origin.x()), b.y.push_back(static_cast<double>(xyz[k + 1]) + north - b.origin.y());
    b.z.push_back(static_cast<double>(xyz[k + 2]));
  }
  b.time.assign(b.size(), 0.0), b.strip.assign(b.size(), 1), b.classification.assign(b.size(), core::point_class::ground);
  b.return_number.assign(b.size(), 1), b.return_count.assign(b.size(), 1);
  const test::TemporaryFolder folder;
  io::LasWriter writer(folder / "ground.las", {});
  writer.write(b);
  writer.finish();
  std::ostringstream rows;
  rows.precision(10);
  rows << "name,x,y,z,cover\n";
  for (const core::Value& m : described.find("checkpoints")->items())
    rows << m.find("id")->as_text() << "," << east + number(m, "e") << "," << north + number(m, "n") << "," << number(m, "z") << ","
         << m.find("type")->as_text() << "\n";
  test::write_bytes(folder / "check.csv", rows.str());
  test::write_bytes(folder / "survey.toml",
                    "name = \"Coconino\"\n[[points]]\nfile = \"ground.las\"\ncrs = \"EPSG:6350\"\n[[control]]\nfile = \"check.csv\"\nuse "
                    "= \"check\"\n");
  test::write_bytes(folder / "points.toml",
                    "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"quality.points\"\nsurface = \"mean\"\n");
  Plan plan = make_plan({folder / "points.toml", {}, folder / "survey.toml", folder / "out", 2});
  Progress progress(Voice::quiet);
  const Outcome o = pipeline::run(plan, progress, "test");
  int found = 0;
  for (const core::Value& s : o.report.find("stages")->items()) {
    if (s.find("type")->as_text() != "quality.points") continue;
    for (const core::Value& a : s.find("findings")->find("accuracy")->items()) {
      const std::string cover = a.find("cover")->as_text();
      if (cover != "open (NVA)" && cover != "vegetated (VVA)") continue;
      const bool is_open = cover == "open (NVA)";
      ++found;
      EXPECT_EQ(a.find("n")->as_int(), is_open ? 38 : 22);
      EXPECT_NEAR(number(a, "rms"), is_open ? 0.056 : 0.107, 0.0006) << cover;                // printed with three decimals
      EXPECT_NEAR(number(a, "rmse_with_marks_m"), std::hypot(number(a, "rms"), 0.02), 1e-9);  // marks of 2 cm, none stated
    }
  }
  EXPECT_EQ(found, 2);
  for (const core::Value& w : o.report.find("warnings")->items()) EXPECT_FALSE(w.find("code")->as_text().starts_with("check.heights"));
}

}  // namespace
}  // namespace swath::pipeline
