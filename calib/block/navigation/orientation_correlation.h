// SPDX-License-Identifier: GPL-3.0-or-later
// How the errors of stations and attitudes of images are correlated: covariances between pairs of images, as a file that any program can
// write. What an image has in common with images it is not paired with follows from the pairs: given those before it that it is paired
// with, its errors depend on no other before it. That is the covariance with the largest entropy of all that have these pairs (Dempster
// 1972), and it is exact where every image is paired with every other.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/text/binary_file.h"
#include "io/text/output_file.h"

namespace swath::calib {

/// Errors, estimated less true: east, north, up of the grid (m), then the rotation w (rad) about the body's axes forward, right, down with
/// body_R_map = exp(w) body_R_map_true.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

struct CovariancePair {
  std::uint32_t image = 0, other = 0;             ///< numbers in OrientationCorrelation::images; `other` is before `image`, or the same
  PoseCovariance value = PoseCovariance::Zero();  ///< rows: of `image`
};

struct OrientationCorrelation {
  std::vector<std::string> images;    ///< in the order of the chain
  std::vector<CovariancePair> pairs;  ///< by image; of each the last one is that with itself
  std::string crs;                    ///< of the grid, as the file states it; empty where it does not
};

/// Writes the file row by row.
class CorrelationFile {
 public:
  CorrelationFile(const std::filesystem::path& file, const std::string& crs);
  /// In the order of OrientationCorrelation::pairs.
  void add(const std::string& image, const std::string& other, const PoseCovariance& value);
  void commit();

 private:
  void flush();

  io::OutputFile file_;
  io::BinaryAppender to_;
  std::string text_;
};

/// Throws core::Error with file and line: an image without a row with itself, a pair whose other image comes later or that is there twice,
/// a covariance of an image with itself that is not symmetric.
OrientationCorrelation read_correlation(const std::filesystem::path& file);

/// Throws core::Error where the file states another grid than that of `crs` (heights do not matter).
void expect_grid(const OrientationCorrelation& correlation, const std::string& crs, const std::string& file);

}  // namespace swath::calib
