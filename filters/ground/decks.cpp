// SPDX-License-Identifier: GPL-3.0-or-later
// What marks a deck is the property of Sithole & Vosselman 2006 (ISPRS J. 61): its cross-section drops at both sides while lengthwise
// it joins the ground. Embankments are not decks: their sides fall no more steeply than ground can.
#include "filters/ground/decks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/config/units.h"

namespace swath::filters {
namespace {

constexpr int directions = 8;                     // of the half circle
constexpr int gap = 3;                            // cells without return at an edge: the beam's shadow beside a high deck
constexpr int alike = 2;                          // cells to each side lengthwise that must show the edges too, most of them
constexpr int growth = 8;                         // cells
constexpr double roughness = 0.15, grade = 0.08;  // m, rise / run: from cell to cell of a deck

struct Step {
  int i, j;
};

Step along(int direction, int k) {
  const double bearing = core::pi * direction / directions;
  return {static_cast<int>(std::lround(k * std::cos(bearing))), static_cast<int>(std::lround(k * std::sin(bearing)))};
}

class Edges {
 public:
  Edges(const Raster& surface, double slope, double step) : surface_(surface), slope_(slope), step_(step) {}

  /// True where the surface falls off on both sides of cell (i, j) in the direction.
  bool both(int i, int j, int direction) const {
    const int one = edge(i, j, direction, 1);
    if (one < 0) return false;
    const int other = edge(i, j, direction, -1);
    return other >= 0 && one + other + 1 <= deck_width;
  }

 private:
  /// Cells from (i, j) to the last on its level before the surface falls; -1 where it does not.
  int edge(int i, int j, int direction, int side) const {
    float z = surface_.value[surface_.at(i, j)];
    int last = 0;
    for (int k = 1; k <= deck_width + gap; ++k) {
      const Step d = along(direction, side * k);
      if (!surface_.holds(i + d.i, j + d.j)) return -1;
      const float next = surface_.value[surface_.at(i + d.i, j + d.j)];
      if (std::isnan(next)) {
        if (k - last > gap) return -1;
        continue;
      }
      const double run = k - last, fall = z - next;
      if (fall > slope_ * run + step_) return last;
      if (std::abs(fall) > roughness + grade * run || k > deck_width) return -1;
      z = next;
      last = k;
    }
    return -1;
  }

  const Raster& surface_;
  double slope_, step_;
};

}  // namespace

const int deck_support = growth + deck_width + gap + alike + 1;

void remove_decks(Raster& ground, Raster& surface, const DeckOptions& o) {
  const Edges sheer(surface, o.steepest, o.step), stepped(surface, 0.0, o.step);
  const auto taken_off = [&](size_t c) { return std::isnan(ground.value[c]) && !std::isnan(surface.value[c]); };
  std::array<std::vector<char>, directions> shows;
  for (std::vector<char>& v : shows) v.assign(surface.value.size(), 0);
  for (int j = 0; j < surface.ny; ++j)
    for (int i = 0; i < surface.nx; ++i)
      if (taken_off(surface.at(i, j)))
        for (int d = 0; d < directions; ++d) shows[static_cast<size_t>(d)][surface.at(i, j)] = sheer.both(i, j, d);
  std::vector<size_t> front;
  for (int j = 0; j < surface.ny; ++j)
    for (int i = 0; i < surface.nx; ++i) {
      const size_t c = surface.at(i, j);
      for (int d = 0; d < directions; ++d) {
        if (!shows[static_cast<size_t>(d)][c]) continue;
        int most = 0;
        for (int k = -alike; k <= alike; ++k) {
          const Step s = along(d + directions / 2, k);
          most += surface.holds(i + s.i, j + s.j) && shows[static_cast<size_t>(d)][surface.at(i + s.i, j + s.j)];
        }
        if (most <= alike) continue;
        front.push_back(c);
        break;
      }
    }
  std::vector<char> deck(surface.value.size(), 0);
  for (const size_t c : front) deck[c] = 1;
  for (int round = 0; round < growth && !front.empty(); ++round) {
    std::vector<size_t> next;
    for (const size_t c : front) {
      const int i = static_cast<int>(c % static_cast<size_t>(surface.nx)), j = static_cast<int>(c / static_cast<size_t>(surface.nx));
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          if (!surface.holds(i + di, j + dj)) continue;
          const size_t n = surface.at(i + di, j + dj);
          if (deck[n] || std::isnan(surface.value[n])) continue;
          if (std::abs(surface.value[n] - surface.value[c]) > roughness + grade * std::hypot(di, dj)) continue;
          bool strip = taken_off(n);
          for (int d = 0; d < directions && !strip; ++d) strip = stepped.both(i + di, j + dj, d);
          if (!strip) continue;
          deck[n] = 1;
          next.push_back(n);
        }
    }
    front = std::move(next);
  }
  for (size_t c = 0; c < deck.size(); ++c)
    if (deck[c]) ground.value[c] = surface.value[c] = std::nanf("");
}

}  // namespace swath::filters
