// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_files.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "io/images/image_file.h"
#include "io/las/las_reader.h"
#include "io/text/text_table.h"
#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

struct Adjusted {
  BlockConfig config;
  ReadBlock read;
  BlockSolution solution;
  BlockFound found;
};

Adjusted adjusted(const std::string& file) {
  Adjusted a{test::read_made(file), {}, {}, {}};
  a.read = read_block(a.config, file);
  a.solution = adjust_block(a.read.block, a.config.adjust);
  a.found = findings_of(a.read, a.config, a.solution);
  return a;
}

TEST(BlockFiles, OrientationsReadBackAreThoseAdjusted) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  m.write_angles = true, m.angle_use = "observed";
  m.more = "[adjust]\nrobust = false\ncomponents = false\n";
  const Adjusted a = adjusted(test::write_made(m, folder.path()));
  const auto files = write_block(folder.path() / "out", a.read, a.config, a.solution, a.found);
  EXPECT_EQ(files, (std::vector<std::string>{"orientation.csv", "camera.toml", "points.gpkg", "points.laz", "patb", "colmap", "opensfm",
                                             "block.json", "report.html"}));
  const auto known = block_products();
  for (const std::string& name : files) EXPECT_EQ(std::count(known.begin(), known.end(), name), 1) << name;
  const io::TextTable table(folder.path() / "out" / "orientation.csv");
  ASSERT_EQ(table.rows(), a.read.block.images.size());
  for (size_t i = 0; i < table.rows(); ++i) {
    const BlockImage& image = a.read.block.images[i];
    EXPECT_NEAR(table.number(i, table.column("x")), image.position.x(), 1e-4);
    const double omega = table.number(i, table.column("omega")) * core::degree, phi = table.number(i, table.column("phi")) * core::degree,
                 kappa = table.number(i, table.column("kappa")) * core::degree;
    const Eigen::Matrix3d R = (Eigen::AngleAxisd(omega, Vector3d::UnitX()) * Eigen::AngleAxisd(phi, Vector3d::UnitY()) *
                               Eigen::AngleAxisd(kappa, Vector3d::UnitZ()))
                                  .toRotationMatrix();
    EXPECT_LT((R - image.camera_R_local.transpose()).norm(), 1e-8);
    EXPECT_NEAR(table.number(i, table.column("r12")), R(0, 1), 1e-8);
    const core::Attitude body{table.number(i, table.column("roll")) * core::degree, table.number(i, table.column("pitch")) * core::degree,
                              table.number(i, table.column("heading")) * core::degree};
    Eigen::Matrix3d ned_R_enu;
    ned_R_enu << 0, 1, 0, 1, 0, 0, 0, 0, -1;
    EXPECT_LT(
        (core::matrix_of(body) - ned_R_enu * image.camera_R_local.transpose() * a.read.block.cameras[0].body_R_camera.transpose()).norm(),
        1e-8);
    EXPECT_GT(table.number(i, table.column("c11")), 0.0);
  }
  io::LasReader laz(folder.path() / "out" / "points.laz", 1);
  core::Block cloud;
  cloud.origin = Vector3d::Zero();
  ASSERT_EQ(laz.read(cloud, 100000), a.read.block.points.size());
  for (size_t p = 0; p < cloud.size(); ++p) {  // all take part: in the block's order
    EXPECT_LT((Vector3d(cloud.x[p], cloud.y[p], cloud.z[p]) - a.read.block.points[p].position).cwiseAbs().maxCoeff(), 0.00051);
    const Vector3d variance = a.solution.inference.points[p].diagonal();
    EXPECT_NEAR(cloud.sigma_h[p], std::sqrt(variance.x() + variance.y()), 0.002);  // extra bytes count millimetres
    EXPECT_NEAR(cloud.sigma_v[p], std::sqrt(variance.z()), 0.002);
    EXPECT_GE(cloud.user_data[p], 2);
  }
  io::ImageFile colmap;
  colmap.file = folder.path() / "out" / "colmap", colmap.format = io::ImageFormat::colmap;
  const io::ImageData back = io::read_image_file(colmap);
  EXPECT_EQ(back.marks.size(), a.read.block.rays.size());
  for (const io::FilePose& p : back.poses) {
    EXPECT_LT((p.position - a.read.block.images[p.image].position).norm(), 1e-8);
    EXPECT_LT((p.camera_R_frame - a.read.block.images[p.image].camera_R_local).norm(), 1e-12);
  }
  const std::string page = swath::test::read_bytes(folder.path() / "out" / "report.html");
  for (const char* part : {"Precision", "error ellipses", "Mean residuals", "Tests"}) EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST(BlockFiles, CameraTomlIsACameraOfAConfig) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  test::Making making = test::small_making();
  making.camera << 0, 0.05, -0.08, 2e-8, 0, 0, 0, 0, 0, 0;
  making.camera_sigma.head<4>().setConstant(free_value);
  m.block = test::make_block(making).given;
  m.more = "[adjust]\nrobust = false\n";
  std::string file = test::write_made(m, folder.path());
  std::string text = swath::test::read_bytes(file);
  text.insert(text.find("columns"),
              "distortion = \"ideal\"\nsigma = { f = \"free\", x0 = \"free\", y0 = \"free\", k1 = \"free\", boresight = \"held\" }\n");
  swath::test::write_bytes(file, text);
  const Adjusted a = adjusted(file);
  const std::string toml = "crs = \"local\"\n[[image_points]]\nfile = \"p\"\nsigma = \"1 um\"\n" + camera_toml(a.read, a.config, a.found);
  const BlockConfig back = read_block_config("c.toml", io::parse_toml(toml, "c.toml"));
  const BlockCamera c = camera_of(back.cameras[0], "c.toml");
  for (int k = 0; k < camera_values; ++k) EXPECT_NEAR(c.value[k], a.read.block.cameras[0].value[k], 1e-12 * std::abs(c.value[k])) << k;
  EXPECT_LT((c.body_R_camera - a.read.block.cameras[0].body_R_camera).norm(), 1e-12);
  ReadBlock named = a.read;
  named.block.cameras[0].name = "\"RMK\" \\ 15";
  EXPECT_EQ(io::parse_toml(camera_toml(named, a.config, a.found), "c.toml").find("camera")->items()[0].find("name")->as_text(),
            named.block.cameras[0].name);
  EXPECT_EQ(a.found.cameras[0].correlated, (std::vector<std::string>{"f", "x0", "y0", "k1"}));
  EXPECT_NEAR(a.found.cameras[0].values[0].value, 150.0, 5.0 * a.found.cameras[0].values[0].sigma);
}

// rms over sigma of ten check points, exceeded once in ten thousand (chi-square).
constexpr double one_in_ten_thousand = 1.88;

TEST(BlockFiles, CheckPointsAndTests) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  const test::MadeBlock made = test::make_block(test::small_making());
  m.block = made.given;
  std::vector<char> is_control(m.block.points.size(), 0);
  for (const BlockControl& c : m.block.control) is_control[c.point] = 1;
  for (std::uint32_t p = 0; p < m.block.points.size(); p += 3)
    if (!is_control[p]) m.block.control.push_back({p, true, {true, true, true}, made.truth.points[p].position, Vector3d::Constant(0.02)});
  // One gross error on a point that many images see.
  std::vector<int> rays(m.block.points.size(), 0);
  for (const ImageRay& r : m.block.rays) ++rays[r.point];
  for (ImageRay& r : m.block.rays)
    if (rays[r.point] > 4) {
      r.x += 0.5;
      m.more = m.block.points[r.point].name + " on image " + m.block.images[r.image].name;
      break;
    }
  const std::string wrong = std::exchange(m.more, "");
  ASSERT_FALSE(wrong.empty());
  const Adjusted a = adjusted(test::write_made(m, folder.path()));
  ASSERT_EQ(a.found.check.size(), 3u);
  for (const CheckFound& c : a.found.check) {
    EXPECT_GE(c.points, 10u);
    EXPECT_LT(c.over_sigma, one_in_ten_thousand) << c.coordinate;
  }
  ASSERT_FALSE(a.found.suspects.empty());
  EXPECT_NE(a.found.suspects.front().what.find("x of point " + wrong), std::string::npos) << a.found.suspects.front().what;
  EXPECT_GE(a.found.without_weight, 1u);
  EXPECT_GT(a.found.ray_redundancy, 0.2);
  EXPECT_GT(a.found.max_inner, a.found.inner);
}

}  // namespace
}  // namespace swath::calib
