// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/world/support.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace swath::test {

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "swath-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path source_folder() { return SWATH_SOURCE_DIR; }

std::filesystem::path shared_data() {
  if (const char* given = std::getenv("SWATH_SHARED")) return given;
  const std::filesystem::path beside = std::filesystem::path(SWATH_SOURCE_DIR) / ".." / "shared";
  return std::filesystem::exists(beside / "conventions.md") ? beside.lexically_normal() : std::filesystem::path();
}

size_t entries(const std::filesystem::path& folder) {
  size_t n = 0;
  for ([[maybe_unused]] const auto& e : std::filesystem::directory_iterator(folder)) ++n;
  return n;
}

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace swath::test
