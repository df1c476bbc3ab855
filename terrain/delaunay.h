// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "terrain/predicates.h"

namespace swath::terrain {

/// CGAL's Delaunay triangulation of a growing set of places (exact predicates), with its faces as plain numbers.
class Delaunay {
 public:
  static constexpr std::int32_t beyond = -1;  ///< the vertex at infinity, which every edge of the hull has on its outer side

  /// v: vertices, counter-clockwise; n[k]: the face across the edge opposite v[k].
  struct Face {
    std::array<std::int32_t, 3> v, n;
    bool is_finite() const { return (v[0] | v[1] | v[2]) >= 0; }
  };

  /// `places` is held by reference and may grow; no two of those inserted may be equal.
  explicit Delaunay(const std::vector<Place>& places);
  ~Delaunay();
  Delaunay(const Delaunay&) = delete;
  Delaunay& operator=(const Delaunay&) = delete;

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
  /// `pairs` are those that cocircular() gives. Until the next insertion, which begins from CGAL's own cuts again.
  void settle(const std::vector<Pair>& pairs);

  /// The face that holds a place, or one beyond the edge of the hull that the place lies outside of; found quickly from a face near it.
  std::int32_t locate(const Place& q, std::int32_t near) const;

  /// Empty until three places are not on one line.
  const std::vector<Face>& faces() const { return faces_; }

 private:
  void copy_faces();
  const Place& at(std::int32_t v) const { return places_[static_cast<std::size_t>(v)]; }

  struct Cgal;  // CGAL's headers are in the source alone
  const std::vector<Place>& places_;
  std::unique_ptr<Cgal> cgal_;
  std::vector<Face> faces_;
  bool settled_ = false;  ///< faces_ are cut otherwise than CGAL's
};

/// The order of (x, y).
inline bool is_before(const Place& a, const Place& b) { return (a.x < b.x) | ((a.x == b.x) & (a.y < b.y)); }

}  // namespace swath::terrain
