// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/text/npy.h"

namespace swath::test {

/// The columns of a NumPy file by name.
inline std::map<std::string, std::vector<double>> npy_columns(const std::filesystem::path& file) {
  const io::NpyHeader header = io::read_npy_header(file);
  std::vector<size_t> all(header.fields.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = i;
  io::NpyReader reader(file, all);
  std::vector<std::vector<double>> values;
  reader.read(0, reader.rows(), values);
  std::map<std::string, std::vector<double>> out;
  for (size_t i = 0; i < all.size(); ++i) out[header.fields[i].name] = values[i];
  return out;
}

}  // namespace swath::test
