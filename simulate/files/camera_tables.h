// SPDX-License-Identifier: GPL-3.0-or-later
// What survey.toml says of a simulated camera.
#pragma once

#include "io/survey/survey.h"
#include "simulate/files/camera_files.h"
#include "simulate/options.h"

namespace swath::simulate {

/// Adds camera, image points and control. Boresight and lever arm are stated with errors sampled by their sigmas; the principal distance is
/// the nominal one, distortion is free.
void describe_camera(const Options& options, const CameraMade& made, io::Survey& survey);

}  // namespace swath::simulate
