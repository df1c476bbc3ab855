// SPDX-License-Identifier: GPL-3.0-or-later
// BlocksExchange XML (Bentley's documentation of the format and of its perspective camera; Metashape and others write it, too): pixels
// count from the centre of the upper left pixel, y down; a rotation takes the world to axes that CameraOrientation states; lengths are
// millimetres with the sensor's larger side or pixel size; Brown's P1 and P2 are OpenCV's p2 and p1. Positions of control points are not
// read: control comes from its own files.
#include <cpl_minixml.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "core/error.h"
#include "io/images/image_file.h"
#include "io/images/image_lines.h"
#include "io/text/line_reader.h"
#include "io/text/value_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

struct CloseXml {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

class BlocksFile {
 public:
  explicit BlocksFile(const std::filesystem::path& file) { out_.file = file; }
  ImageData read();

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const { throw core::Error(what, out_.file.string(), hint); }
  /// The text below a path of names; fails where `needed` and missing.
  std::string text(const CPLXMLNode* node, const char* path, bool needed, const std::string& whose) const;
  double number(const CPLXMLNode* node, const char* path, const std::string& whose) const;
  double number_or(const CPLXMLNode* node, const char* path, double otherwise, const std::string& whose) const;
  int pixels(const CPLXMLNode* node, const char* path, const std::string& whose) const;
  void read_group(const CPLXMLNode* group);
  void read_photo(const CPLXMLNode* photo, const Eigen::Matrix3d& ours_R_oriented);
  void read_points(const CPLXMLNode* list, const char* element, NumberedNames& point_number);
  Eigen::Matrix3d axes_of(const std::string& orientation) const;

  ImageData out_;
  std::map<std::string, std::uint32_t> image_of_id_;
  std::set<std::string> image_names_;
};

std::string BlocksFile::text(const CPLXMLNode* node, const char* path, bool needed, const std::string& whose) const {
  const char* found = CPLGetXMLValue(const_cast<CPLXMLNode*>(node), path, nullptr);
  if (!found && needed) fail(whose + " has no <" + path + ">");
  return found ? found : "";
}

double BlocksFile::number(const CPLXMLNode* node, const char* path, const std::string& whose) const {
  const std::string word = text(node, path, true, whose);
  double value = 0.0;
  if (!read_number(word, value) || !std::isfinite(value)) fail("<" + std::string(path) + "> of " + whose + " is not a number: " + word);
  return value;
}

double BlocksFile::number_or(const CPLXMLNode* node, const char* path, double otherwise, const std::string& whose) const {
  return text(node, path, false, whose).empty() ? otherwise : number(node, path, whose);
}

int BlocksFile::pixels(const CPLXMLNode* node, const char* path, const std::string& whose) const {
  const std::optional<int> found = pixel_count(number(node, path, whose));
  if (!found) fail("<" + std::string(path) + "> of " + whose + " is not a number of pixels");
  return *found;
}

/// From the axes of CameraOrientation (x right, left, down or up; z = x cross y) to x right, y up, z backward.
Eigen::Matrix3d BlocksFile::axes_of(const std::string& orientation) const {
  static const std::map<std::string, Eigen::Vector3d> senses{
      {"Right", {1, 0, 0}}, {"Left", {-1, 0, 0}}, {"Down", {0, -1, 0}}, {"Up", {0, 1, 0}}};
  const size_t y = orientation.find('Y');
  if (orientation.starts_with("X") && y != std::string::npos) {
    const auto a = senses.find(orientation.substr(1, y - 1)), b = senses.find(orientation.substr(y + 1));
    if (a != senses.end() && b != senses.end() && a->second.dot(b->second) == 0.0) {
      Eigen::Matrix3d out;
      out << a->second, b->second, a->second.cross(b->second);
      return out;
    }
  }
  fail("<CameraOrientation> is " + orientation, "known are XRightYDown, XRightYUp, XLeftYDown, XLeftYUp, XDownYRight ... XUpYLeft");
}

void BlocksFile::read_photo(const CPLXMLNode* photo, const Eigen::Matrix3d& ours_R_oriented) {
  const std::string id = text(photo, "Id", true, "a photo"), whose = "photo " + id;
  const auto image = static_cast<std::uint32_t>(out_.images.size());
  if (!image_of_id_.try_emplace(id, image).second) fail("photo " + id + " is there twice");
  std::string path = text(photo, "ImagePath", true, whose);
  std::replace(path.begin(), path.end(), '\\', '/');
  const std::string name = path.substr(path.rfind('/') + 1);
  if (!image_names_.insert(name).second)
    fail("two photos have the name " + name + ", in different folders", "give the images names of their own, and export the block again");
  out_.images.push_back(name);
  out_.camera_of.push_back(static_cast<std::uint32_t>(out_.cameras.size() - 1));
  if (!CPLGetXMLNode(const_cast<CPLXMLNode*>(photo), "Pose.Rotation") || text(photo, "Pose.Center.x", false, whose).empty()) return;
  if (text(photo, "Pose.Rotation.M_00", false, whose).empty())
    fail("the rotation of " + whose + " is not given as a matrix", "export it with <M_00> to <M_22>");
  FilePose pose;
  pose.image = image;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      pose.camera_R_frame(r, c) = number(photo, ("Pose.Rotation.M_" + std::to_string(r) + std::to_string(c)).c_str(), whose);
  pose.camera_R_frame = ours_R_oriented * pose.camera_R_frame;
  if (std::abs(pose.camera_R_frame.determinant() - 1.0) > 1e-6) fail("the matrix of " + whose + " is not a rotation");
  pose.position = {number(photo, "Pose.Center.x", whose), number(photo, "Pose.Center.y", whose), number(photo, "Pose.Center.z", whose)};
  out_.poses.push_back(pose);
}

void BlocksFile::read_group(const CPLXMLNode* group) {
  FileCamera c;
  c.name = text(group, "Name", false, "");
  if (c.name.empty()) c.name = "photogroup " + std::to_string(out_.cameras.size() + 1);
  const std::string model = text(group, "CameraModelType", false, c.name);
  if (!model.empty() && model != "Perspective") fail("the camera of " + c.name + " is of type " + model + ", which is not Brown's");
  c.columns = pixels(group, "ImageDimensions.Width", c.name);
  c.rows = pixels(group, "ImageDimensions.Height", c.name);
  double f = number_or(group, "FocalLengthPixels", 0.0, c.name);
  if (!(f > 0.0)) {
    double pixel = number_or(group, "PixelSize", 0.0, c.name);
    if (!(pixel > 0.0)) pixel = number(group, "SensorSize", c.name) / std::max(c.columns, c.rows);
    f = number(group, "FocalLength", c.name) / pixel;
  }
  c.fx = f;
  c.fy = f * number_or(group, "AspectRatio", 1.0, c.name);
  if (number_or(group, "Skew", 0.0, c.name) != 0.0) fail("<Skew> of " + c.name + " is not 0", "calibrate without skew");
  c.cx = 0.5 + number_or(group, "PrincipalPoint.x", c.columns / 2.0 - 0.5, c.name);
  c.cy = 0.5 + number_or(group, "PrincipalPoint.y", c.rows / 2.0 - 0.5, c.name);
  if (!text(group, "PrincipalPoint.xmm", false, c.name).empty())
    fail("the principal point of " + c.name + " is given in millimetres", "export it in pixels");
  c.k1 = number_or(group, "Distortion.K1", 0.0, c.name), c.k2 = number_or(group, "Distortion.K2", 0.0, c.name);
  c.k3 = number_or(group, "Distortion.K3", 0.0, c.name);
  c.p2 = number_or(group, "Distortion.P1", 0.0, c.name), c.p1 = number_or(group, "Distortion.P2", 0.0, c.name);
  out_.cameras.push_back(c);
  std::string orientation = text(group, "CameraOrientation", false, c.name);
  if (orientation.empty()) orientation = "XRightYDown";
  const Eigen::Matrix3d axes = axes_of(orientation);
  for (const CPLXMLNode* n = group->psChild; n; n = n->psNext)
    if (n->eType == CXT_Element && std::string(n->pszValue) == "Photo") read_photo(n, axes);
}

void BlocksFile::read_points(const CPLXMLNode* list, const char* element, NumberedNames& point_number) {
  size_t k = 0;
  for (const CPLXMLNode* point = list ? list->psChild : nullptr; point; point = point->psNext) {
    if (point->eType != CXT_Element || std::string(point->pszValue) != element) continue;
    std::string name = text(point, "Name", false, "");
    const bool own = name.empty();
    ++k;
    if (own) name = (std::string(element) == "TiePoint" ? "T" : "C") + std::to_string(k);
    const size_t points = out_.points.size();
    std::uint32_t number_of_point = point_number(name);
    while (own && out_.points.size() == points) number_of_point = point_number(name += "'");  // a named point is called so, too
    out_.numbered.resize(out_.points.size(), own);
    for (const CPLXMLNode* m = point->psChild; m; m = m->psNext) {
      if (m->eType != CXT_Element || std::string(m->pszValue) != "Measurement") continue;
      const std::string id = text(m, "PhotoId", true, "a measurement of " + name);
      const auto image = image_of_id_.find(id);
      if (image == image_of_id_.end()) fail("point " + name + " is measured in photo " + id + ", which is not there");
      if (!text(m, "xmm", false, name).empty()) fail("the measurements of " + name + " are in millimetres", "export them in pixels");
      out_.marks.push_back({image->second, number_of_point, 0.5 + number(m, "x", "a measurement of " + name),
                            0.5 + number(m, "y", "a measurement of " + name), 0});
    }
  }
}

ImageData BlocksFile::read() {
  const GdalMessages messages;  // a parser that prints nothing
  const std::string all = read_text_file(out_.file);
  const std::unique_ptr<CPLXMLNode, CloseXml> tree(CPLParseXMLString(all.c_str()));
  const CPLXMLNode* root = tree ? CPLGetXMLNode(tree.get(), "=BlocksExchange") : nullptr;
  if (!tree) messages.fail("not an XML file with <BlocksExchange>", out_.file, "export the block as BlocksExchange XML");
  if (!root) fail("not an XML file with <BlocksExchange>", "export the block as BlocksExchange XML");
  const CPLXMLNode* block = CPLGetXMLNode(const_cast<CPLXMLNode*>(root), "Block");
  if (!block) fail("the file has no <Block>");
  const CPLXMLNode* groups = CPLGetXMLNode(const_cast<CPLXMLNode*>(block), "Photogroups");
  for (const CPLXMLNode* n = groups ? groups->psChild : nullptr; n; n = n->psNext)
    if (n->eType == CXT_Element && std::string(n->pszValue) == "Photogroup") read_group(n);
  NumberedNames point_number(out_.points);
  read_points(CPLGetXMLNode(const_cast<CPLXMLNode*>(block), "ControlPoints"), "ControlPoint", point_number);
  read_points(CPLGetXMLNode(const_cast<CPLXMLNode*>(block), "TiePoints"), "TiePoint", point_number);
  return std::move(out_);
}

}  // namespace

ImageData read_blocks_exchange(const std::filesystem::path& file) { return BlocksFile(file).read(); }

}  // namespace swath::io
