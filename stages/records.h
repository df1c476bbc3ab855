// SPDX-License-Identifier: GPL-3.0-or-later
// What stages hand on to one another beside columns: named products, and among them records, which the engine keeps by their type.
#pragma once

#include <compare>
#include <cstdint>
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
      visibility, orientations;
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
    Product::return_density{"return_density"}, Product::visibility{"visibility"}, Product::orientations{"orientations"};
constexpr std::string_view name_of(Product p) { return p.name(); }

/// The records of a run, one of each type. A stage that gives a record again replaces it. Copies of the store share their records.
class Records {
 public:
  /// Which records there are, without holding them: one that is put in the place of another has another number.
  using Marks = std::map<std::type_index, std::uint64_t>;
  Marks marks() const {
    Marks out;
    for (const auto& [type, kept] : at_) out[type] = kept.number;
    return out;
  }
  template <Record R>
  static std::uint64_t mark_of(const Marks& marks) {
    const auto at = marks.find(typeid(R));
    return at == marks.end() ? 0 : at->second;
  }

  template <Record R>
  bool has() const {
    return at_.contains(typeid(R));
  }
  /// Null where there is none. It holds until the record is replaced or taken.
  template <Record R>
  const R* find() const {
    const auto at = at_.find(typeid(R));
    return at == at_.end() ? nullptr : static_cast<const R*>(at->second.record.get());
  }
  /// A plan has checked that it is there.
  template <Record R>
  const R& get() const {
    const R* record = find<R>();
    if (!record) throw core::Error("no " + std::string(RecordName<R>::value) + " was given", "", "this is a fault of the program");
    return *record;
  }
  template <Record R>
  void put(R record) {
    at_[typeid(R)] = {std::make_shared<R>(std::move(record)), ++given_};
  }
  template <Record R>
  void drop() {
    at_.erase(typeid(R));
  }
  /// A copy; or, where it is the `last_use`, the record itself, which is not there any more then.
  template <Record R>
  R take(bool last_use) {
    if (!last_use) return get<R>();
    get<R>();
    const std::shared_ptr<void> record = std::move(at_.extract(typeid(R)).mapped().record);
    R& kept = *static_cast<R*>(record.get());
    if (record.use_count() > 1) return kept;  // a copy of the store has it, too
    return std::move(kept);
  }

 private:
  struct Kept {
    std::shared_ptr<void> record;
    std::uint64_t number = 0;  ///< of all that were put, from 1
  };
  std::map<std::type_index, Kept> at_;
  std::uint64_t given_ = 0;
};

}  // namespace swath::stages
