// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/refusals.h"

#include "calib/words.h"
#include "core/config/units.h"
#include "core/error.h"

namespace swath::calib {

using core::Error;

std::string place_text(const Eigen::Vector3d& v) { return words("(%.3f, %.3f, %.3f)", v.x(), v.y(), v.z()); }

void refuse(const Resection& r, const std::string& name, size_t distances, const std::string& file) {
  const std::string station = "station '" + name + "'";
  switch (r.state) {
    case ResectionState::solved:
      return;
    case ResectionState::too_few:
      throw Error(station + " has " + core::counted(distances, "distance") + " to targets, 3 are needed and 4 for a check", file,
                  "measure more distances from it, or state its coordinates with `at` and `sigma`");
    case ResectionState::in_line:
      throw Error("the targets of " + station + " lie in one line: it may be anywhere on a circle around it", file,
                  "measure to targets off that line");
    case ResectionState::weak:
      throw Error(station + " lies in the plane of its targets, so that its distance from the plane is not determined", file,
                  "measure to targets well above or below the instrument");
    case ResectionState::two_fit:
      throw Error("the targets of " + station + " lie in one plane: it fits at " + place_text(r.position) + " and, mirrored, at " +
                      place_text(r.mirror.value_or(r.position)),
                  file, "state its `start` on the right side, or measure to a target off the plane");
    case ResectionState::not_found:
      throw Error("no position of " + station + " fits its distances", file, "check names and units of its distances");
  }
}

void refuse(const PointSearch& p, const std::string& name, const std::string& file) {
  const std::string point = "point '" + name + "'";
  switch (p.state) {
    case PointState::solved:
      return;
    case PointState::too_few:
      throw Error(
          point +
              " has too few sights: two stations with both angles of their triangle and a vertical angle make one condition each, a "
              "distance one; 3 are needed and 4 for a check",
          file, "sight it from three stations, or state its coordinates with `at` and `sigma`");
    case PointState::not_determined:
      throw Error("the stations that see " + point + " are fewer than three or lie in one line", file,
                  "sight it from three stations that make a triangle");
    case PointState::weak:
      throw Error("the sights at " + point + " hardly determine it: it lies in the plane of its stations, or they are too close together",
                  file, "leave elevation_signs at true and measure vertical angles, or sight it from stations at other heights");
    case PointState::two_fit:
      throw Error(point + " fits at " + place_text(p.position) + " and, mirrored in the plane of the stations, at " +
                      place_text(p.mirror.value_or(p.position)),
                  file, "measure a vertical angle to it, or state its `start` on the right side");
    case PointState::not_found:
      throw Error("the adjustment of " + point + " does not converge", file, "check the names and units of its sights");
  }
}

}  // namespace swath::calib
