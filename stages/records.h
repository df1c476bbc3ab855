// SPDX-License-Identifier: GPL-3.0-or-later
// What stages hand on to one another beside columns: named products, and among them records, which the engine keeps by their type.
#pragma once

#include <compare>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>

#include "core/error.h"
#include "core/records/event_data.h"
#include "core/records/gnss_data.h"
#include "core/records/imu_data.h"
#include "trajectory/trajectory.h"

namespace swath::stages {

/// Why the geometry of the flight is not to be adjusted, as quality.geometry found it.
struct GeometryDoubt {
  std::string why;
};

/// The name of a record's type in plans, help and documentation; specialised for each.
template <class R>
struct RecordName;
template <>
struct RecordName<core::ImuData> {
  static constexpr std::string_view value = "imu";
};
template <>
struct RecordName<core::GnssData> {
  static constexpr std::string_view value = "gnss";
};
template <>
struct RecordName<core::EventData> {
  static constexpr std::string_view value = "events";
};
template <>
struct RecordName<trajectory::Trajectory> {
  static constexpr std::string_view value = "trajectory";
};
template <>
struct RecordName<GeometryDoubt> {
  static constexpr std::string_view value = "geometry doubt";
};
template <class R>
concept Record = requires {
  RecordName<R>::value;
};

/// What a stage needs or gives beside columns: a record, the stream of shots or points, or a kind of grid. A plan is refused where a stage
/// needs what none before it gives.
class Product {
 public:
  static const Product shots, points, dtm, dsm, contours, breaklines, canopy, slope, hillshade, intensity, pulse_density, return_density,
      visibility;
  template <Record R>
  static constexpr Product of() {
    return Product(RecordName<R>::value);
  }
  constexpr std::string_view name() const { return name_; }
  constexpr auto operator<=>(const Product&) const = default;

 private:
  constexpr explicit Product(std::string_view name) : name_(name) {}
  std::string_view name_;
};
inline constexpr Product Product::shots{"shots"}, Product::points{"points"}, Product::dtm{"dtm"}, Product::dsm{"dsm"},
    Product::contours{"contours"}, Product::breaklines{"breaklines"}, Product::canopy{"canopy"}, Product::slope{"slope"},
    Product::hillshade{"hillshade"}, Product::intensity{"intensity"}, Product::pulse_density{"pulse_density"},
    Product::return_density{"return_density"}, Product::visibility{"visibility"};
constexpr std::string_view name_of(Product p) { return p.name(); }

/// The records of a run, one of each type. A stage that gives a record again replaces it.
class Records {
 public:
  template <Record R>
  bool has() const {
    return at_.contains(typeid(R));
  }
  /// Null where there is none.
  template <Record R>
  std::shared_ptr<const R> find() const {
    const auto at = at_.find(typeid(R));
    return at == at_.end() ? nullptr : std::static_pointer_cast<const R>(at->second);
  }
  /// A plan has checked that it is there.
  template <Record R>
  const R& get() const {
    const auto at = at_.find(typeid(R));
    if (at == at_.end()) throw core::Error("no " + std::string(RecordName<R>::value) + " was given", "", "this is a fault of the program");
    return *static_cast<const R*>(at->second.get());
  }
  template <Record R>
  void put(R record) {
    at_[typeid(R)] = std::make_shared<R>(std::move(record));
  }
  /// Null: as drop().
  template <Record R>
  void share(std::shared_ptr<const R> record) {
    if (!record) return drop<R>();
    at_[typeid(R)] = std::move(record);
  }
  template <Record R>
  void drop() {
    at_.erase(typeid(R));
  }
  /// A copy; or, where it is the `last_use`, the record itself, which is not there any more then.
  template <Record R>
  R take(bool last_use) {
    std::shared_ptr<const R> record = find<R>();
    if (!last_use) return get<R>();
    drop<R>();
    // It was made as an R that is not const.
    return record.use_count() == 1 ? R(std::move(const_cast<R&>(*record))) : *record;
  }

 private:
  std::map<std::type_index, std::shared_ptr<const void>> at_;
};

}  // namespace swath::stages
