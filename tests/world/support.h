// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace swath::test {

/// A folder that lives as long as the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// The root of the checkout.
std::filesystem::path source_folder();

/// The reference data beside the checkout (SWATH_SHARED, or ../shared); empty where it is absent.
std::filesystem::path shared_data();

/// Files and folders directly in a folder: to see that a failure left nothing behind.
size_t entries(const std::filesystem::path& folder);

std::string read_bytes(const std::filesystem::path& file);
/// Makes the folders on the way too.
void write_bytes(const std::filesystem::path& file, const std::string& bytes);

}  // namespace swath::test

/// Names the reference folder `var`, or skips the test, saying so.
#define SWATH_SHARED_OR_SKIP(var, sub)                                       \
  const std::filesystem::path var = ::swath::test::shared_data() / sub;      \
  if (::swath::test::shared_data().empty() || !std::filesystem::exists(var)) \
  GTEST_SKIP() << "reference data " << sub << " is not beside this checkout"
