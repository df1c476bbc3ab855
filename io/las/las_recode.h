// SPDX-License-Identifier: GPL-3.0-or-later
// Records of one file as those of another, whose extra fields are defined otherwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "io/las/las_header.h"
#include "io/las/las_points.h"

namespace swath::io {

/// Does a raw value mean the same in both?
bool is_same_field(const LasExtra& a, const LasExtra& b);

/// The fields of files that all have fields of the same names: as they are where they agree, else as our own columns are written
/// (las_extras_of). Throws core::Error for files that do not have the same fields.
std::vector<LasExtra> common_extras(const std::vector<LasHeader>& files);

/// The fields without scale, offset or nodata: numbers that have one of them become floats with NaN for nodata (doubles where a float has
/// fewer digits than the raw value). Fields of several numbers, and those whose name comes twice, stay.
std::vector<LasExtra> float_extras(const std::vector<LasExtra>& extras);

/// Records with the fields of `from` as those with the fields of `to`: point formats are the same, and so are numbers and names of fields.
class LasRecoder {
 public:
  LasRecoder(const LasHeader& from, const LasHeader& to, std::string where);
  /// Valid until the next call. Throws core::Error where a number does not fit the field's new definition.
  std::span<const std::uint8_t> operator()(std::span<const std::uint8_t> records);

 private:
  LasHeader from_, to_;
  std::string where_;
  std::vector<std::size_t> other_;  ///< fields that are defined otherwise
  LasPoints in_, out_;
  std::vector<std::uint8_t> records_;
};

/// Calls `f` with the records of a LAS file that is not compressed, some at a time.
void each_las_records(const std::filesystem::path& file, const LasHeader& header,
                      const std::function<void(std::span<const std::uint8_t>)>& f);

}  // namespace swath::io
