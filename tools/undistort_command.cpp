// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <set>

#include "calib/block/imagery/undistort.h"
#include "core/config/units.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "pipeline/input_guard.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* camera_name = "camera.toml";

struct UndistortArguments {
  std::vector<std::string> images;
  std::string cameras, camera;
  fs::path folder = "undistorted";
  bool quiet = false;
};

const calib::CameraConfig& chosen(const std::vector<calib::CameraConfig>& cameras, const UndistortArguments& a) {
  if (a.camera.empty() && cameras.size() == 1) return cameras.front();
  std::string names;
  for (const calib::CameraConfig& c : cameras) {
    if (c.name == a.camera) return c;
    names += (names.empty() ? "" : ", ") + c.name;
  }
  throw core::usage_error(a.camera.empty() ? "the file has several cameras" : "no camera is named " + a.camera, a.cameras,
                          "state --name; the file has " + names);
}

int undistort(const UndistortArguments& a) {
  const std::vector<calib::CameraConfig> cameras = calib::read_cameras(a.cameras);
  const calib::CameraConfig& camera = chosen(cameras, a);
  std::set<fs::path> products;
  for (const std::string& image : a.images) {
    const fs::path to = a.folder / (fs::path(image).stem().string() + ".tif");
    if (!products.insert(to).second) throw core::usage_error("two images would be written to " + to.string(), image);
    if (fs::exists(to) && fs::exists(image) && fs::equivalent(to, image))
      throw core::usage_error("the image would be written over", image, "state another --output");
  }
  const pipeline::InputGuard guard({a.cameras});
  guard.expect_apart(a.folder / camera_name);
  for (const std::string& image : a.images) {
    const io::ImageRaster out = calib::undistorted(io::read_image_raster(image), camera, image);
    fs::create_directories(a.folder);
    io::write_image_raster(a.folder / (fs::path(image).stem().string() + ".tif"), out);
  }
  io::write_text_file(a.folder / camera_name,
                      "# Camera of these images: no distortion, principal point in the middle.\n" + calib::undistorted_camera(camera));
  if (!a.quiet) print(core::counted(a.images.size(), "image") + " written to " + a.folder.string() + "\n");
  return 0;
}

}  // namespace

void add_undistort_command(Commands& commands) {
  const auto a = std::make_shared<UndistortArguments>();
  auto* c =
      commands.add("undistort",
                   "Examples\n  swath undistort photos/*.jpg --camera block/camera.toml --output undistorted\n\nTake the distortion off "
                   "images and put the principal point in the middle.",
                   [a] { return undistort(*a); });
  c->add_option("IMAGES", a->images, "Images as the camera took them: TIFF, JPEG, PNG and others")->required();
  c->add_option("--camera", a->cameras, "Table of the camera: camera.toml of `swath block`")->required();
  c->add_option("--name", a->camera, "Name of the camera, where the file has several");
  add_output(*c, a->folder, "Folder for TIFF images and their camera.toml; default: undistorted");
  add_quiet(*c, a->quiet);
}

}  // namespace swath::tools
