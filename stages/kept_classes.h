// SPDX-License-Identifier: GPL-3.0-or-later
// Classes that a cloud has already: which of them a filter respects.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"

namespace swath::stages {

enum class KeepClasses { none, ground, all };

/// Options of a filter that gives classes, with the choice of those it keeps.
template <class O>
struct Keeping : O {
  KeepClasses keep_classes = KeepClasses::none;
};

}  // namespace swath::stages

template <>
struct swath::core::Choices<swath::stages::KeepClasses> {
  static constexpr std::array<std::string_view, 3> names{"none", "ground", "all"};
};

namespace swath::stages {

template <class O, class V>
void describe(Keeping<O>& o, V& v) {
  describe(static_cast<O&>(o), v);
  v.option("keep_classes", o.keep_classes, "Classes that stay as they are: none, ground (taken as it is), or all but 0 and 1.");
}

/// Points whose class a filter would have changed.
struct KeptCount {
  core::Kept points;
};

template <class V>
void describe(const KeptCount& r, V& v) {
  v.result("kept the class they had (keep_classes)", r.points, core::if_any(), "Returns that the filter would have given another class.");
}

/// Puts kept classes, and the flags of their points, back after a filter has run.
class KeptClasses {
 public:
  KeptClasses(const core::Block& block, KeepClasses keep) : keep_(keep) {
    if (keep == KeepClasses::none) return;
    classes_ = block.classification;
    classes_.resize(block.size());
    flags_ = block.flags;
  }
  /// `gives_ground`: of a filter that says what is ground; where ground is kept, it changes no class. `own`: points counted.
  /// Calls f(row) for each point that kept its class.
  template <class F>
  KeptCount put_back(core::Block& block, size_t own, bool gives_ground, F&& f) const {
    KeptCount kept;
    for (size_t i = 0; i < classes_.size(); ++i) {
      const std::uint8_t before = classes_[i];
      const bool stays =
          keep_ == KeepClasses::ground ? gives_ground || before == core::point_class::ground : before > core::point_class::unassigned;
      if (!stays) continue;
      kept.points += i < own && block.classification[i] != before;
      block.classification[i] = before;
      if (!flags_.empty()) block.flags[i] = flags_[i];
      f(i);
    }
    return kept;
  }
  KeptCount put_back(core::Block& block, size_t own, bool gives_ground) const {
    return put_back(block, own, gives_ground, [](size_t) {});
  }

 private:
  KeepClasses keep_;
  std::vector<std::uint8_t> classes_;
  std::vector<std::uint16_t> flags_;
};

}  // namespace swath::stages
