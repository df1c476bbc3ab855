// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/plane_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr double widest_sample = sample_sides.back();
constexpr int cells_of_district = static_cast<int>(district_side / widest_sample);

std::uint64_t mixed(std::uint64_t v) {  // the finalizer of splitmix64 (Steele, Lea & Flood 2014)
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

std::uint64_t hash_of(const core::Block& b, std::size_t p) {
  const std::uint64_t x = std::bit_cast<std::uint64_t>(b.x[p]), y = std::bit_cast<std::uint64_t>(b.y[p]);
  std::uint64_t kind = 0;  // of returns at one place
  if (!b.return_number.empty()) kind |= b.return_number[p];
  if (!b.return_count.empty()) kind |= std::uint64_t{b.return_count[p]} << 8;
  if (!b.classification.empty()) kind |= std::uint64_t{b.classification[p]} << 16;
  const std::uint64_t place =
      mixed(x * 0x9e3779b97f4a7c15u ^ std::rotl(y * 0xc2b2ae3d27d4eb4fu, 23) ^ std::rotl(std::bit_cast<std::uint64_t>(b.z[p]), 41));
  return kind == 0 ? place : mixed(place + kind * 0x165667b19e3779f9u);
}

}  // namespace

Districts districts(const core::Block& b) {
  Districts out;
  out.lattice = lattice_around(b, district_side, 0);
  const core::Lattice& d = out.lattice;
  const core::Lattice fine{widest_sample, d.i0 * cells_of_district, d.j0 * cells_of_district, d.nx * cells_of_district,
                           d.ny * cells_of_district};
  std::vector<std::uint32_t> count(fine.size(), 0);
  for (std::size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const CellIndex c = cell_of(fine, b, p);
    ++count[fine.at(c.i, c.j)];
  }
  out.side.assign(d.size(), static_cast<std::uint8_t>(sample_sides.size() - 1));
  std::vector<std::uint32_t> around;
  for (int j = 0; j < d.ny; ++j)
    for (int i = 0; i < d.nx; ++i) {
      around.clear();
      for (int v = std::max((j - 1) * cells_of_district, 0); v < std::min((j + 2) * cells_of_district, fine.ny); ++v)
        for (int u = std::max((i - 1) * cells_of_district, 0); u < std::min((i + 2) * cells_of_district, fine.nx); ++u)
          if (const std::uint32_t n = count[fine.at(u, v)]; n > 0) around.push_back(n);
      if (around.empty()) continue;
      const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
      std::nth_element(around.begin(), middle, around.end());
      const double density = *middle / (widest_sample * widest_sample);
      for (std::size_t k = sample_sides.size(); k-- > 0;)
        if (sample_sides[k] * sample_sides[k] * density >= returns_of_cell) out.side[d.at(i, j)] = static_cast<std::uint8_t>(k);
    }
  return out;
}

Samples::Samples(const core::Block& b, const core::Lattice& l)
    : lattice_(l), count_(lattice_.size(), 0), samples_(lattice_.size() * samples_of_cell) {
  std::vector<std::uint64_t> hashes(samples_.size());
  for (std::uint32_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const CellIndex at = cell_of(lattice_, b, p);
    if (!lattice_.holds(at.i, at.j)) continue;
    const std::size_t c = lattice_.at(at.i, at.j), first = c * samples_of_cell;
    const std::uint64_t hash = hash_of(b, p);
    std::size_t n = count_[c];
    if (n == samples_of_cell && hash >= hashes[first + n - 1]) continue;
    if (n < samples_of_cell) n = ++count_[c];
    std::size_t k = first + n - 1;
    for (; k > first && hashes[k - 1] > hash; --k) hashes[k] = hashes[k - 1], samples_[k] = samples_[k - 1];
    hashes[k] = hash;
    samples_[k] = {static_cast<float>(b.origin.x() + b.x[p] - lattice_.centre_x(at.i)),
                   static_cast<float>(b.origin.y() + b.y[p] - lattice_.centre_y(at.j)), static_cast<float>(b.z[p]), p};
  }
}

}  // namespace swath::filters
