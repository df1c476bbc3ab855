// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/camera_checks.h"

#include <algorithm>

#include "io/survey/survey_checks.h"

namespace swath::io {
namespace {

/// One fault for a key.
void add_fault(const core::Value& tree, const std::string& key, std::string what, std::string hint, std::vector<core::Fault>& faults) {
  if (std::none_of(faults.begin(), faults.end(), [&](const core::Fault& f) { return f.key == key; }))
    faults.push_back({place_in(tree, key), key, std::move(what), std::move(hint)});
}

/// A key of a camera whose default would be a guess.
void expect_stated(const core::Value& tree, size_t camera, const char* name, const char* what, const char* hint,
                   std::vector<core::Fault>& faults) {
  const core::Value* list = tree.find("camera");
  if (list && list->is_array() && camera < list->items().size() && list->items()[camera].is_object() && !list->items()[camera].find(name))
    add_fault(tree, numbered("camera", camera) + "." + name, what, hint, faults);
}

class CameraChecks {
 public:
  CameraChecks(const Survey& survey, const core::Value& tree, std::vector<core::Fault>& faults)
      : survey_(survey), tree_(tree), faults_(faults) {}

  void all() {
    for (size_t i = 0; i < survey_.cameras.size(); ++i) camera(i);
    for (size_t i = 0; i < survey_.images.size(); ++i) {
      const ImageListFile& f = survey_.images[i];
      const std::string key = numbered("image", i) + ".file";
      if (f.file.empty())
        fault(key, "no file is named");
      else
        exists(resolve(survey_, f.file), key);
    }
    for (size_t i = 0; i < survey_.image_points.size(); ++i) points(survey_.image_points[i], numbered("image_points", i));
    for (size_t i = 0; i < survey_.photos.size(); ++i) photos(survey_.photos[i], numbered("photos", i));
    if (survey_.cameras.empty()) {
      if (!survey_.images.empty()) fault("image", "images are listed, and the survey has no [[camera]]", "describe the camera");
      if (!survey_.image_points.empty())
        fault("image_points", "image points are listed, and the survey has no [[camera]]", "describe the camera");
    } else if (survey_.events.empty() && survey_.photos.empty()) {
      fault("camera", "a camera is described, and no [[event]] file has its exposures", "name the file of its exposures");
    }
  }

 private:
  void fault(const std::string& key, std::string what, std::string hint = {}) {
    add_fault(tree_, key, std::move(what), std::move(hint), faults_);
  }

  void exists(const std::filesystem::path& path, const std::string& key) {
    std::error_code ec;
    if (!std::filesystem::is_regular_file(path, ec))
      fault(key, "no such file: " + path.string(), "names are relative to the folder of the survey file");
  }

  void photos(const PhotoFiles& f, const std::string& key) {
    std::error_code ec;
    if (f.folder.empty())
      fault(key + ".folder", "no folder of photographs is named");
    else if (const auto folder = resolve(survey_, f.folder); !std::filesystem::is_directory(folder, ec))
      fault(key + ".folder", "no such folder: " + folder.string(), "names are relative to the folder of the survey file");
    if (!f.orientation.empty()) exists(resolve(survey_, f.orientation), key + ".orientation");
    if (!f.camera.empty()) exists(resolve(survey_, f.camera), key + ".camera");
  }

  void camera(size_t i) {
    const SurveyCamera& c = survey_.cameras[i];
    const std::string key = numbered("camera", i);
    if (c.name.empty()) fault(key + ".name", "the camera has no name", "name it");
    for (size_t other = 0; other < i; ++other)
      if (survey_.cameras[other].name == c.name)
        fault(key + ".name", "the name " + c.name + " is that of " + numbered("camera", other), "give each camera a name of its own");
    expect_stated(tree_, i, "mount", "the mount of the camera is not stated",
                  "the angle from the direction of flight to the image's x axis, clockwise from above: mount = \"90 deg\"", faults_);
    expect_stated(tree_, i, "lever_arm", "the lever arm of the camera is not stated",
                  "lever_arm = [\"... m\", \"... m\", \"... m\"] from the IMU's centre to the perspective centre: forward, right, down",
                  faults_);
    if (!survey_.image_points.empty()) expect_distance(tree_, i, faults_);
    if (core::lacks_distortion(c, c.sigma)) fault(key + ".distortion", core::distortion_fault, core::distortion_hint);
  }

  /// That no camera has what coordinates in pixels need, before hours of work.
  void sensor(const ImageFile& f, const std::string& key) {
    const auto states = [](const SurveyCamera& c) { return c.pixel && c.columns > 0 && c.rows > 0; };
    if (!needs_pixels(f)) return;
    // Of several files each may be of another camera.
    if (survey_.image_points.size() > 1 && std::any_of(survey_.cameras.begin(), survey_.cameras.end(), states)) return;
    for (size_t i = 0; i < survey_.cameras.size(); ++i)
      if (!states(survey_.cameras[i]))
        fault(numbered("camera", i) + ".pixel", "pixels of " + key + " need columns, rows and pixel of the camera, which are not stated",
              "columns = ..., rows = ..., pixel = \"5 um\"");
  }

  void points(const ImageFile& f, const std::string& key) {
    if (f.file.empty()) return fault(key + ".file", "no file is named");
    ImageFile there = f;
    there.file = resolve(survey_, f.file);
    std::error_code ec;
    if (f.format == ImageFormat::colmap && std::filesystem::exists(there.file / "images.bin", ec) &&
        !std::filesystem::exists(there.file / "images.txt", ec))
      return fault(key + ".file", "the COLMAP model " + there.file.string() + " is binary",
                   "convert it: colmap model_converter --output_type TXT");
    for (const std::filesystem::path& path : files_of(there)) exists(path, key + ".file");
    for (const ConventionFault& c : convention_faults(f)) fault(key + "." + c.key, c.what, c.hint);
    sensor(f, key);
  }

  const Survey& survey_;
  const core::Value& tree_;
  std::vector<core::Fault>& faults_;
};

}  // namespace

void check_cameras(const Survey& survey, const core::Value& tree, std::vector<core::Fault>& faults) {
  CameraChecks(survey, tree, faults).all();
}

void expect_distance(const core::Value& tree, size_t camera, std::vector<core::Fault>& faults) {
  expect_stated(tree, camera, "f", "the principal distance of the camera is not stated", "f = \"... mm\"", faults);
}

}  // namespace swath::io
