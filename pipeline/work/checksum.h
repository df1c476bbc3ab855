// SPDX-License-Identifier: GPL-3.0-or-later
// XXH3, 64 bits, as 16 hex digits: whether bytes are still those that were written or read before.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace swath::pipeline {

/// Of bytes that come piece by piece.
class Checksum {
 public:
  Checksum();
  ~Checksum();
  Checksum(Checksum&&) noexcept;
  Checksum& operator=(Checksum&&) noexcept;

  void add(const void* data, std::size_t n);
  std::string text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string checksum_of(std::string_view bytes);
/// Throws core::Error where the file cannot be read.
std::string checksum_of_file(const std::filesystem::path& file);
/// The same; of an object in a store, that of its size and of the ETag and time of the last change that the store states, or of its
/// content where it states neither.
std::string checksum_of_input(const std::filesystem::path& file);

}  // namespace swath::pipeline
