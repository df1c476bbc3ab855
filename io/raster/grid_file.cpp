// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/grid_file.h"

#include <cstring>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/packed_column.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

struct Head {
  char magic[8];
  core::Lattice lattice;
  std::uint32_t has_sigma, has_count;
};
constexpr char magic[8] = {'s', 'w', 'g', 'r', 'i', 'd', '2', 0};
constexpr size_t cells_per_byte = size_t{1} << 15;  ///< more than zstd makes of one

template <class T>
void put(std::string& out, const std::vector<T>& v) {
  if (!v.empty()) pack(v.data(), v.size(), sizeof(T), out);
}

template <class T>
void take(const std::string& in, size_t& at, std::vector<T>& v, size_t n, const std::filesystem::path& file) {
  v.resize(n);
  if (n == 0) return;
  PackedHead head;
  if (in.size() - at < sizeof head) cut_short(file);
  std::memcpy(&head, in.data() + at, sizeof head);
  at += sizeof head;
  if (in.size() - at < head.bytes || !unpack(head, in.data() + at, v.data(), n, sizeof(T))) cut_short(file);
  at += head.bytes;
}

}  // namespace

void cut_short(const std::filesystem::path& file) {
  throw core::SystemError("the intermediate result was changed or damaged while the run was at work", file.string(),
                          "run the same command again: what is damaged is made anew");
}

void write_grid_file(const std::filesystem::path& file, const core::Grid& grid) {
  Head head{};
  std::memcpy(head.magic, magic, sizeof magic);
  head.lattice = grid.lattice;
  head.has_sigma = !grid.sigma.empty();
  head.has_count = !grid.count.empty();
  std::string out(sizeof head, '\0');
  std::memcpy(out.data(), &head, sizeof head);
  put(out, grid.height);
  put(out, grid.sigma);
  put(out, grid.count);
  put(out, grid.reason);
  write_text_file(file, out);
}

core::Grid read_grid_file(const std::filesystem::path& file) {
  const std::string in = read_text_file(file);
  Head head{};
  if (in.size() < sizeof head || std::memcmp(in.data(), magic, sizeof magic) != 0) cut_short(file);
  std::memcpy(&head, in.data(), sizeof head);
  if (head.lattice.nx < 0 || head.lattice.ny < 0 || head.lattice.size() / cells_per_byte > in.size()) cut_short(file);
  core::Grid grid(head.lattice);
  const size_t n = head.lattice.size();
  size_t at = sizeof head;
  take(in, at, grid.height, n, file);
  if (head.has_sigma) take(in, at, grid.sigma, n, file);
  if (head.has_count) take(in, at, grid.count, n, file);
  take(in, at, grid.reason, n, file);
  return grid;
}

}  // namespace swath::io
