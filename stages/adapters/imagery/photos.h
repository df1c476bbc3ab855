// SPDX-License-Identifier: GPL-3.0-or-later
// The survey's photographs for stages that take colours from them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/block/imagery/oriented_images.h"
#include "core/config/result.h"
#include "stages/entry.h"
#include "stages/stage.h"

namespace swath::stages {

Entry colour_stage(), orthophoto_stage(), true_orthophoto_stage();

/// Throws core::Error (usage) where the survey has no [[photos]], or nothing orients them.
void expect_photos(const Context& context, std::string_view stage);
/// Tables of orientations and cameras, and what lies in the folders of photographs.
std::vector<std::filesystem::path> photo_inputs(const io::Survey& survey);
/// Throws core::Error as calib::read_oriented_images().
calib::OrientedImages photos_of(const Context& context);

/// What is known of the photographs.
struct PhotoFindings {
  std::uint64_t images = 0, rims = 0, missing = 0;
  std::vector<std::string> without_file{};
};
template <class V>
void describe(const PhotoFindings& r, V& v) {
  v.result("images", r.images, core::plain().in_summary(), "Photographs with an orientation.");
  v.result("cameras_with_rim", r.rims, core::if_any().in_summary(),
           "Cameras whose photographs have a black rim, as undistorted ones have: no colour is taken from it.");
  v.result("images_without_file", r.missing, core::if_any().in_summary(), "Oriented images that the folder does not have.");
  v.result("without_file", r.without_file, core::if_any(), "Their names.");
}
PhotoFindings findings_of(const calib::OrientedImages& images);

/// Throws core::Error where of `places` none was `seen`: with the nearest image and how far off it is from the middle of the tiles.
void expect_seen(const calib::OrientedImages& images, const Context& context, const std::vector<TileKey>& tiles, std::uint64_t seen,
                 std::string_view stage);

/// Bytes that a tile's photographs may take: one at a time.
double photo_memory(const Context& context);

}  // namespace swath::stages
