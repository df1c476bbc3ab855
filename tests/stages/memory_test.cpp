// SPDX-License-Identifier: GPL-3.0-or-later
// What a tile's work takes of memory against what its stage declares, for dense and for sparse points. The run's budget is no better than
// these declarations.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>

#include "core/config/option_visitors.h"
#include "filters/noise/visibility.h"
#include "io/raster/image_raster.h"
#include "io/text/value_file.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

/// Of /proc/self/status, bytes.
double status_of(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key + ":", 0) == 0) return 1024.0 * std::stod(line.substr(key.size() + 1));
  return 0.0;
}

/// Forgets the peak of resident memory so far; false where the system does not let it.
bool forget_peak() {
  malloc_trim(0);
  std::ofstream out("/proc/self/clear_refs");
  out << "5";
  out.flush();
  return out.good();
}

/// Resident memory that `run` takes at its peak beyond what there was before, bytes.
double peak_of(const std::function<void()>& run) {
  forget_peak();
  const double before = status_of("VmRSS");
  run();
  return status_of("VmHWM") - before;
}

/// Rolling country with woods and halls: pulses `spacing` apart, a quarter of them with a first return from a crown.
void add_points(core::Block& b, const Box& box, const Box& without, double spacing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(0.0, spacing), any(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.03);
  const auto add = [&](double x, double y, double z, int number, int count, std::uint8_t type) {
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(z);
    b.time.push_back(1e-5 * static_cast<double>(b.x.size() - static_cast<size_t>(number - 1)));
    b.return_number.push_back(static_cast<std::uint8_t>(number)), b.return_count.push_back(static_cast<std::uint8_t>(count));
    b.classification.push_back(type);
  };
  for (double y0 = box.y0; y0 < box.y1; y0 += spacing)
    for (double x0 = box.x0; x0 < box.x1; x0 += spacing) {
      const double x = x0 + shift(random), y = y0 + shift(random);
      const bool crown = any(random) < 0.25;
      if (!box.holds(x, y) || without.holds(x, y)) continue;
      const double ground = 100.0 + 0.05 * x + 5.0 * std::sin(x / 40.0) * std::cos(y / 50.0) + noise(random);
      const bool hall = std::fmod(std::abs(x), 60.0) < 20.0 && std::fmod(std::abs(y), 70.0) < 20.0;
      if (hall) {
        add(x, y, 112.0 + 0.2 * std::fmod(std::abs(x), 60.0), 1, 1, core::point_class::unassigned);
      } else if (crown) {
        add(x, y, ground + 4.0 + 8.0 * any(random), 1, 2, core::point_class::unassigned);
        add(x, y, ground, 2, 2, core::point_class::ground);
      } else {
        add(x, y, ground, 1, 1, core::point_class::ground);
      }
    }
}

/// Level grids everywhere.
class LevelGrids : public Grids {
 public:
  bool has(Product p) const override { return p == Product::dtm || p == Product::dsm; }
  core::Grid window(Product, const core::Lattice& lattice) const override {
    core::Grid g(lattice);
    std::fill(g.height.begin(), g.height.end(), 100.0f);
    std::fill(g.reason.begin(), g.reason.end(), core::Void::none);
    g.sigma.assign(lattice.size(), 0.1f);
    g.count.assign(lattice.size(), 1);
    return g;
  }
  std::filesystem::path folder(Product) const override { return {}; }
  double cell(Product) const override { return 0.5; }
};

struct Case {
  std::string type, options;
  double side = 120.0;  ///< of the tile, m
  bool alone = false;   ///< no points around it
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.type << " " << c.options; }

std::string name_of(const Case& c, size_t number) {
  std::string out = c.type + "_" + std::to_string(number);
  std::replace(out.begin(), out.end(), '.', '_');
  return out;
}

/// Two photographs from 600 m above the level grids, 240 m by 180 m on the ground.
void add_photos(const std::filesystem::path& folder, io::Survey& survey) {
  std::filesystem::create_directories(folder / "photos");
  io::ImageRaster image{2000, 1500, 3, 8, {}};
  image.values.assign(static_cast<size_t>(image.columns) * static_cast<size_t>(image.rows) * 3, 100);
  for (const char* name : {"a.tif", "b.tif"}) io::write_image_raster(folder / "photos" / name, image);
  test::write_bytes(folder / "orientation.csv", "image,x,y,z,omega,phi,kappa\na,500050,5000060,700,0,0,0\nb,500070,5000060,700,0,0,0\n");
  test::write_bytes(folder / "camera.toml", "[[camera]]\nname = \"c\"\nf = \"50 mm\"\ncolumns = 2000\nrows = 1500\npixel = \"10 um\"\n");
  survey.photos.push_back({folder / "photos", folder / "orientation.csv", folder / "camera.toml", ""});
}

struct Taken {
  double measured, declared;
  size_t points;
};

/// A tile of `side` metres at work.
Taken take(const Case& c, double side, double spacing) {
  const auto stage = make_stage(c.type);
  if (!stage) throw std::runtime_error("no stage " + c.type);
  std::vector<core::Fault> faults;
  core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_toml(c.options, "test"), "", faults);
  core::throw_if_any(faults);
  const test::TemporaryFolder folder;
  io::Survey survey;
  if (c.type.starts_with("images.")) add_photos(folder.path(), survey);
  const LevelGrids grids;
  Context context{survey};
  context.tile_side = side;
  context.grids = &grids;
  context.output = folder / "products";
  context.product_crs = "EPSG:32632";
  context.origin = {500000.0, 5000000.0, 0.0};

  TileJob job{{0, 0}, {500000.0, 5000000.0, 500000.0 + side, 5000000.0 + side}, folder / "work", {}, 0, {}};
  std::filesystem::create_directories(job.folder);
  job.block.origin = context.origin;
  const Box own{0.0, 0.0, side, side};
  add_points(job.block, own, {}, spacing);
  job.own = job.block.size();
  if (stage->halo() > 0 && !c.alone) add_points(job.block, own.grown(stage->halo()), own, spacing);
  core::add_columns(job.block, stage->info().needs | stage->info().gives | stage->also_reads());
  std::fill(job.block.sigma_v.begin(), job.block.sigma_v.end(), 0.05f);
  for (size_t p = 0; p < job.block.height.size(); ++p)
    job.block.height[p] = static_cast<float>(job.block.z[p] - 100.0 - 0.05 * job.block.x[p]);

  const Box around = own.grown(stage->near_halo());
  size_t near = 0;
  for (size_t p = 0; p < job.block.size(); ++p) near += around.holds(job.block.x[p], job.block.y[p]);
  const TileMemory declared = stage->memory(context);
  Taken t{0.0, declared.bytes_per_point * declared.share_of_points * static_cast<double>(near), job.block.size()};
  double first = 0.0;
  for (const Raster& r : declared.rasters) (std::isfinite(r.rim) ? first : t.declared) += r.total(static_cast<double>(job.block.size()));
  t.declared += std::max(first, declared.bytes_per_own * static_cast<double>(job.own));
  if (c.type == "filters.visibility") {  // the stage itself wants a trajectory
    filters::VisibilityOptions o;
    std::vector<core::Fault> none;
    core::read_options(core::described(o), io::parse_toml(c.options, "test"), "", none);
    t.measured = peak_of([&] {
      std::vector<Eigen::Vector3d> scanner;
      for (size_t p = 0; p < job.block.size(); ++p) scanner.emplace_back(-100.0, job.block.y[p], 800.0);
      filters::Visibility seen;
      filters::trace_visibility(job.block, job.own, scanner, lattice_in(o.cell.value, job.box), o, seen);
    });
  } else {
    t.measured = peak_of([&] { stage->run_tile(context, job); });
  }
  return t;
}

class Memory : public testing::TestWithParam<Case> {};

TEST_P(Memory, ATileTakesNoMoreThanItsStageDeclares) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's own memory counts";
#endif
  if (!forget_peak()) GTEST_SKIP() << "this system does not tell a part's peak of memory";
  // A wider tile for figures to write down: what the allocator rounds up counts less there.
  const char* asked = std::getenv("SWATH_MEMORY_SIDE");
  mallopt(M_MMAP_THRESHOLD, 128 * 1024);  // fixed: a threshold that grows leaves freed blocks within the heap, by what ran before
  const double side = asked ? std::stod(asked) : GetParam().side;
  take(GetParam(), 10.0, 3.0);  // what is loaded once
  for (const double spacing : {3.0, 0.8}) {
    const Taken t = take(GetParam(), side, spacing);
    if (asked) std::printf("%.1f m: %zu points, %.1f MB measured, %.1f declared\n", spacing, t.points, t.measured / 1e6, t.declared / 1e6);
    constexpr double unmeasured = 4e6;  // bytes: pages that the allocator holds and code that is read in
    EXPECT_LE(t.measured, t.declared + unmeasured) << spacing;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Quick, Memory,
    testing::Values(Case{"filters.noise", ""}, Case{"filters.noise", "low_radius = \"0.5 m\"\nradius = \"0.5 m\""},
                    Case{"filters.outlier", "reach = \"0.8 m\"\ngap = \"0.5 m\"\nwindow = \"1 m\"\nmin_distance = \"0.5 m\""},
                    Case{"filters.visibility", ""}, Case{"filters.smrf", "cell = \"0.5 m\"", 60.0}, Case{"filters.hag_dem", ""},
                    Case{"terrain.dtm", "cell = \"0.25 m\""}, Case{"terrain.dsm", "cell = \"0.25 m\""}, Case{"terrain.canopy", ""},
                    Case{"terrain.relief", ""}, Case{"terrain.density", "cell = \"0.25 m\""},
                    Case{"terrain.intensity", "cell = \"0.25 m\""}, Case{"terrain.penetration", "cell = \"0.5 m\"", 260.0},
                    Case{"terrain.contours", ""}, Case{"writers.gdal", "", 260.0}, Case{"images.colour", ""}, Case{"images.orthophoto", ""},
                    Case{"images.orthophoto", "cell = \"0.1 m\""}, Case{"images.true_orthophoto", ""}),
    [](const auto& tested) { return name_of(tested.param, tested.index); });

INSTANTIATE_TEST_SUITE_P(Slow, Memory,
                         testing::Values(Case{"filters.visibility", "voxel = \"1 m\"\ncell = \"2 m\""}, Case{"filters.ground", ""},
                                         Case{"filters.ground", "", 1200.0}, Case{"filters.ground", "", 600.0, true},
                                         Case{"filters.smrf", ""}, Case{"filters.pmf", "", 10.0}, Case{"filters.csf", ""},
                                         Case{"filters.csf", "resolution = \"0.5 m\""}, Case{"filters.ptd", ""}, Case{"filters.robust", ""},
                                         Case{"filters.classify", ""}, Case{"filters.water", ""}, Case{"filters.key_points", ""},
                                         Case{"terrain.dtm", ""}, Case{"terrain.dsm", "cell = \"0.5 m\"\nmethod = \"spike_free\""},
                                         Case{"terrain.contours", "source = \"tin\""}, Case{"terrain.forest", ""},
                                         Case{"terrain.forest", "crown_cell = \"0.2 m\""}),
                         [](const auto& tested) { return name_of(tested.param, tested.index); });

}  // namespace
}  // namespace swath::stages
