// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "terrain/tin/faces.h"

namespace swath::terrain {

/// CGAL's Delaunay triangulation of a growing set of places (exact predicates), with its faces as plain numbers.
class Delaunay {
 public:
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

  /// Neighbours with one circle, the lower number first.
  std::vector<FacePair> cocircular() const;
  /// Cuts the polygons inscribed in one empty circle as fans from their vertex of least (x, y): now the triangulation is unique, if
  /// `pairs` are those that cocircular() gives. Until the next insertion, which begins from CGAL's own cuts again.
  void settle(const std::vector<FacePair>& pairs);

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

}  // namespace swath::terrain
