// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy .npy files (format versions 1 to 3): structured arrays and plain arrays of one or two dimensions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/text/binary_file.h"
#include "io/text/output_file.h"

namespace swath::io {

/// One field of a structured array, or one column of a plain array.
struct NpyField {
  std::string name;  ///< empty in plain arrays
  char kind = 'f';   ///< 'u' 'i' 'f' 'b' as in NumPy; others (text, complex, dates) cannot be read as numbers
  size_t bytes = 8;
  bool big_endian = false;
  std::uint64_t offset = 0;  ///< of the first row's value, from data_begin
  std::string type;          ///< as written in the file, for messages
};

struct NpyHeader {
  std::vector<NpyField> fields;
  std::uint64_t rows = 0;
  std::uint64_t row_stride = 0;  ///< bytes between the rows of one field
  std::uint64_t data_begin = 0;
  bool by_column = false;  ///< plain two-dimensional array in Fortran order: each column is contiguous
};

/// Reads and checks the header. Throws Error: no .npy file, truncated (header or data; the byte is named), object or nested types,
/// more than two dimensions.
NpyHeader read_npy_header(const std::filesystem::path& file);

/// Index of the field that a survey names: its name, or a number from 1. Throws Error with the fields that exist and the nearest name.
size_t field_of(const NpyHeader& header, const std::string& field, const std::filesystem::path& file);

/// Reads rows of chosen fields as doubles (integers above 2^53 are rounded).
class NpyReader {
 public:
  /// Throws Error where a field holds no numbers.
  NpyReader(const std::filesystem::path& file, std::vector<size_t> fields);

  std::uint64_t rows() const { return header_.rows; }
  const NpyHeader& header() const { return header_; }
  /// Values of rows [first, first + n): `columns[i]` gets n values of the i-th chosen field. The rows must exist.
  void read(std::uint64_t first, size_t n, std::vector<std::vector<double>>& columns);

 private:
  BinaryFile file_;
  NpyHeader header_;
  std::vector<size_t> fields_;
  std::vector<unsigned char> bytes_;
};

/// One field of a structured array to write: "f8" "f4" "u1" "u2" "u4" "u8" "i1" "i2" "i4" "i8".
struct NpyColumn {
  std::string name, type;
};

/// Writes a structured array (little-endian, packed), row blocks in sequence. The file appears with commit().
class NpyWriter {
 public:
  NpyWriter(const std::filesystem::path& file, std::vector<NpyColumn> columns);
  /// Appends n rows, `values[i]` the i-th column's n values. Integers are rounded to nearest; Error where a value does not fit.
  void append(const std::vector<const double*>& values, size_t n);
  void commit();

 private:
  std::string header() const;
  OutputFile output_;
  std::filesystem::path name_;
  BinaryAppender out_;
  std::vector<NpyColumn> columns_;
  size_t row_bytes_ = 0;
  std::uint64_t rows_ = 0;
  std::vector<unsigned char> bytes_;
};

}  // namespace swath::io
