// SPDX-License-Identifier: GPL-3.0-or-later
// What a finished survey stage hands on to the others, as a file of the work folder, so that the stage is not done again.
#pragma once

#include <filesystem>
#include <memory>

#include "stages/stage.h"

namespace swath::pipeline {

/// The parts of a stages::Context that survey stages set. IMU records are as large as their file and are read again instead.
struct HandedOn {
  std::shared_ptr<const core::GnssData> gnss;
  std::shared_ptr<const core::EventData> events;
  std::shared_ptr<const trajectory::Trajectory> trajectory;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  stages::Area area{};

  static HandedOn of(const stages::Context& context);
  void give(stages::Context& context) const;
};

/// Writes what `after` has and `before` has not. False, and no file, where it could not be read back the same.
bool write_handed_on(const std::filesystem::path& file, const HandedOn& before, const HandedOn& after);

/// `before` with what the file gives. Throws core::SystemError where it is not what was written.
HandedOn read_handed_on(const std::filesystem::path& file, const HandedOn& before);

}  // namespace swath::pipeline
