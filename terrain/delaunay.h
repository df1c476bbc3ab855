// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "terrain/predicates.h"

namespace swath::terrain {

/// Delaunay triangulation of a growing set of places. Predicates are exact.
class Delaunay {
 public:
  static constexpr std::int32_t beyond = -1;  ///< the vertex at infinity, which every edge of the hull has on its outer side

  /// v: vertices, counter-clockwise; n[k]: the face across the edge opposite v[k].
  struct Face {
    std::array<std::int32_t, 3> v, n;
    bool is_finite() const { return (v[0] | v[1] | v[2]) >= 0; }
  };

  /// `places` is held by reference and may grow; no two of those inserted may be equal.
  explicit Delaunay(const std::vector<Place>& places) : places_(places) {}

  /// Inserts places `first` to `last` - 1. Any order gives the same triangulation, but for the cuts of cocircular polygons; places that
  /// are near the one before are found quickly.
  void insert(std::int32_t first, std::int32_t last);
  /// The same, of the numbers in `order`.
  void insert(const std::vector<std::int32_t>& order);

  /// Two faces.
  using Pair = std::array<std::int32_t, 2>;
  /// Neighbours with one circle, the lower number first.
  std::vector<Pair> cocircular() const;
  /// Cuts the polygons inscribed in one empty circle as fans from their vertex of least (x, y): now the triangulation is unique, if
  /// `pairs` are those that cocircular() gives.
  void settle(const std::vector<Pair>& pairs);

  /// The face that holds a place, or one beyond the edge of the hull that the place lies outside of; found quickly from a face near it.
  std::int32_t locate(const Place& q, std::int32_t near) const;

  /// Empty until three places are not on one line.
  const std::vector<Face>& faces() const { return faces_; }

 private:
  void insert(std::int32_t p);
  bool start(std::int32_t p);
  bool conflicts(const Face& f, const Place& q) const;
  const Place& at(std::int32_t v) const { return places_[static_cast<std::size_t>(v)]; }

  /// An edge of the hole around a new place: from a to b with the hole on its left, and the face across with the index of the way back.
  struct Rim {
    std::int32_t a, b, across, back;
  };
  const std::vector<Place>& places_;
  std::vector<Face> faces_;
  std::vector<std::int32_t> waiting_;  // places on one line, until one beside it comes
  std::int32_t near_ = 0;              // a face near the last place
  std::vector<std::int32_t> hole_;
  std::vector<Rim> rim_;
  std::vector<Pair> stack_;  // face, edge
};

/// The order of (x, y).
inline bool is_before(const Place& a, const Place& b) { return (a.x < b.x) | ((a.x == b.x) & (a.y < b.y)); }

}  // namespace swath::terrain
