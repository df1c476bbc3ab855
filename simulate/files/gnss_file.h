// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/time.h"
#include "io/survey/navigation.h"
#include "simulate/flight.h"
#include "simulate/navigation_options.h"
#include "simulate/random.h"

namespace swath::simulate {

/// One fix as recorded, with its errors.
struct Fix {
  double tag;  ///< time stamp, seconds from the start of the flight
  core::FixQuality quality;
  int satellites;
  Eigen::Vector3d sigma;              ///< stated, north, east, down, m
  Eigen::Vector3d white, correlated;  ///< true errors north, east, down, m; they are of `sigma` together
  Eigen::Vector3d outlier;            ///< beyond them, m; 0 where there is none
  Eigen::Vector3d position;           ///< as recorded, ecef, m
  Eigen::Vector3d velocity;           ///< as recorded, north, east, down, m/s
};

/// A receiver: fixes one after another at whole steps of its rate.
class Receiver {
 public:
  Receiver(const Flight& flight, const GnssOptions& options, const std::array<core::Metres, 3>& lever_arm, bool noise_free,
           std::int64_t seed);

  /// The next fix, or nothing at the end of the flight. Steps without a fix (outages, instants beyond the flight by the latency) are
  /// passed over.
  std::optional<Fix> next();

 private:
  Fix fix_at(std::int64_t k, double tag);

  const Flight& flight_;
  const GnssOptions& options_;
  Eigen::Vector3d lever_arm_;
  bool noise_free_;
  std::int64_t seed_, step_ = 0;
  std::vector<GaussMarkov> correlated_;  // north, east, down
};

/// gnss.csv: seconds of week (counting on past its end), positions with their covariance; truth/gnss.csv: the errors of each fix. Returns
/// the number of fixes. Folders must exist.
std::int64_t write_gnss(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const GnssOptions& options,
                        const std::array<core::Metres, 3>& lever_arm, bool noise_free, std::int64_t seed);

/// What survey.toml says of gnss.csv and of the antenna.
io::GnssFile describe_gnss_file(const GnssOptions& options, core::GpsTime start);
io::Antenna describe_antenna(const GnssOptions& options, const std::array<core::Metres, 3>& lever_arm);

}  // namespace swath::simulate
