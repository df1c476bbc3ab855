// SPDX-License-Identifier: GPL-3.0-or-later
// The three forms in which contours leave (io/vector/vector.h): inside of the room only.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/contour_line.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {

class ContourSink {
 public:
  virtual ~ContourSink() = default;
  /// The line is known to be sound; a closed one repeats its first vertex.
  virtual void add(const core::ContourLine& line) = 0;
  virtual void add(const core::ContourLabel&) {}
  virtual void add(const core::SpotHeight&) {}
  virtual void close() = 0;
};

std::unique_ptr<ContourSink> make_gpkg_sink(const std::filesystem::path& file, const CrsFacts& crs);
std::unique_ptr<ContourSink> make_dxf_sink(const std::filesystem::path& file, const CrsFacts& crs);
std::unique_ptr<ContourSink> make_geojson_sink(const std::filesystem::path& file, const CrsFacts& crs);

/// Text written piece by piece through an OutputFile. Throws core::Error by errno.
class TextStream {
 public:
  explicit TextStream(const std::filesystem::path& file);
  ~TextStream();
  TextStream(const TextStream&) = delete;
  TextStream& operator=(const TextStream&) = delete;

  TextStream& operator<<(std::string_view text);
  /// A number with so many decimals, the same in every locale.
  TextStream& fixed(double value, int decimals);
  /// Overwrites what stands at a byte, once everything is written.
  void patch(std::uint64_t byte, std::string_view text);
  std::uint64_t bytes() const { return flushed_ + buffer_.size(); }
  void close();

 private:
  void flush();
  std::filesystem::path file_;
  OutputFile out_;
  int fd_ = -1;
  std::string buffer_;
  std::uint64_t flushed_ = 0;
};

/// A number with so many decimals, without a sign where it rounds to zero.
std::string fixed_text(double value, int decimals);
/// The shortest text that reads back as the same number.
std::string shortest_text(double value);

}  // namespace swath::io
