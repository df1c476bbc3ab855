// SPDX-License-Identifier: GPL-3.0-or-later
// Why a station or a point of a hangar survey is not determined, and what to measure.
#pragma once

#include <Eigen/Core>
#include <string>

#include "calib/hangar/combined_point.h"
#include "calib/hangar/resection.h"

namespace swath::calib {

/// Throws core::Error unless the station is determined. `distances`: measured from it.
void refuse(const Resection& resection, const std::string& name, size_t distances, const std::string& file);
/// Throws core::Error unless the point is determined.
void refuse(const PointSearch& search, const std::string& name, const std::string& file);

/// "(1.000, 2.000, 0.500)"
std::string place_text(const Eigen::Vector3d& place);

}  // namespace swath::calib
