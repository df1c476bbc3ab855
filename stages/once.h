// SPDX-License-Identifier: GPL-3.0-or-later
// A stage that works once on a whole survey is a free function:
//
//   Given<core::ImuData, ImuFindings> read_imu(const io::Survey& survey, core::Tally& tally);
//   TrajectoryFiles write_trajectory(const trajectory::Trajectory& t, const Output& to, const TrajectoryWriteOptions& o,
//                                    core::Tally& tally);
//
// Its signature says what it needs and gives. Parameters, in any order:
// clang-format off
//   const R&, R, const R*     a record that a stage before it gave; by value: its own, moved on its last use; a pointer: null where there is none
//   const O&                  its options, a struct with a describe()
//   const io::Survey&, const Output&, core::Tally&, const core::OnProgress&, const georef::ShotStream&
//   const Context&            for what is left of the run: CRS, tiles, strips
// clang-format on
// It returns a record, a struct of results, or both (Given; Corrected). registry.cpp makes a stage of it in one line:
//
//   once<read_imu>("readers.imu", "Reads the survey's IMU records as increments in body axes.", {.inputs = imu_files}),
#pragma once

#include <algorithm>
#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/config/result_visitors.h"
#include "stages/adapters/flight/place.h"
#include "stages/entry.h"
#include "stages/shot_source.h"
#include "stages/stage.h"

namespace swath::stages {

/// A record and what the report says of it.
template <Record R, class F>
struct Given {
  R record;
  F findings;
};

/// A record that the function has corrected; none: it stays as it is. The place on the map stays, too.
template <Record R, class F>
struct Corrected {
  std::optional<R> record;
  F findings;
};

/// Where a stage puts its files.
struct Output {
  std::filesystem::path folder;
};

/// A stage at work on a survey.
struct Site {
  Context& context;
  core::Tally& tally;
};

/// How a parameter of type P is found. `declare` adds what it needs to the stage's Info.
template <class P>
struct Argument;

struct PlainArgument {
  static void declare(Info&) {}
};
template <>
struct Argument<const io::Survey&> : PlainArgument {
  static const io::Survey& of(auto& s) { return s.context.survey; }
};
template <>
struct Argument<core::Tally&> : PlainArgument {
  static core::Tally& of(auto& s) { return s.tally; }
};
template <>
struct Argument<const core::OnProgress&> : PlainArgument {
  static const core::OnProgress& of(auto& s) { return s.context.progress; }
};
template <>
struct Argument<const Context&> : PlainArgument {
  static const Context& of(auto& s) { return s.context; }
};
template <>
struct Argument<const Output&> : PlainArgument {
  static Output of(auto& s) { return {s.context.output}; }
};
template <>
struct Argument<const georef::ShotStream&> {
  static void declare(Info& info) { info.needs_products.push_back(Product::shots); }
  static georef::ShotStream of(auto& s) { return stream_shots(s.context); }
};
template <Record R>
struct Argument<const R&> {
  static void declare(Info& info) { info.needs_products.push_back(Product::of<R>()); }
  static const R& of(auto& s) { return s.context.records.template get<R>(); }
};
template <Record R>
struct Argument<R> {
  static void declare(Info& info) { info.needs_products.push_back(Product::of<R>()); }
  static R of(Site& s) { return s.context.records.take<R>(std::ranges::count(s.context.last_uses, Product::of<R>()) > 0); }
};
template <Record R>
struct Argument<const R*> {
  static void declare(Info& info) {
    if (std::ranges::count(info.uses_products, Product::of<R>()) == 0) info.uses_products.push_back(Product::of<R>());
  }
  static const R* of(auto& s) { return s.context.records.template find<R>(); }
};

/// Is a parameter the stage's options?
template <class P>
constexpr bool is_options = core::Described<std::remove_cvref_t<P>> && !std::same_as<std::remove_cvref_t<P>, io::Survey>;

/// What a function's parameters say. Where there is no function: nothing.
template <class F>
struct Signature {
  using Result = void;
  using Options = NoOptions;
  static void declare(Info&) {}
};
template <class T, class... P>
struct Signature<T (*)(P...)> {
  using Result = T;
  /// The type of the parameter that is the options; NoOptions where there is none.
  using Options = std::remove_cvref_t<std::tuple_element_t<
      0, decltype(std::tuple_cat(std::declval<std::conditional_t<is_options<P>, std::tuple<std::remove_cvref_t<P>>, std::tuple<>>>()...,
                                 std::declval<std::tuple<NoOptions>>()))>>;
  static void declare(Info& info) { (declare_one<P>(info), ...); }
  template <class S, class O>
  static T call(T (*function)(P...), S& site, const O& o) {
    return function(one<P>(site, o)...);
  }

 private:
  template <class Q>
  static void declare_one(Info& info) {
    if constexpr (!is_options<Q>) Argument<Q>::declare(info);
  }
  template <class Q, class S, class O>
  static decltype(auto) one(S& site, const O& o) {
    if constexpr (is_options<Q>)
      return (o);
    else
      return Argument<Q>::of(site);
  }
};

/// Hands a record on. What follows from it is settled: the place on the map follows from the trajectory.
template <Record R>
void hand_on(Site& s, R record) {
  if constexpr (std::same_as<R, core::GnssData>) check_place_of_fixes(s.context, record);
  if constexpr (std::same_as<R, trajectory::Trajectory>) place_on_map(s.context, record, s.tally);
  s.context.records.put(std::move(record));
}

/// What a function's result is to the run.
template <class T>
struct Returned {
  using Findings = T;
  static void declare(Info&) {}
  static core::Value keep(Site&, T findings) {
    if constexpr (std::same_as<T, core::Value>)
      return findings;
    else
      return core::reported(findings);
  }
};
template <Record R>
struct Returned<R> {
  using Findings = NoResults;
  static void declare(Info& info) { info.gives_products.push_back(Product::of<R>()); }
  static core::Value keep(Site& s, R record) {
    hand_on(s, std::move(record));
    return core::Value::object();
  }
};
template <Record R, class F>
struct Returned<Given<R, F>> {
  using Findings = F;
  static void declare(Info& info) { Returned<R>::declare(info); }
  static core::Value keep(Site& s, Given<R, F> given) {
    core::Value findings = Returned<F>::keep(s, std::move(given.findings));
    hand_on(s, std::move(given.record));
    return findings;
  }
};
template <Record R, class F>
struct Returned<Corrected<R, F>> {
  using Findings = F;
  static void declare(Info& info) { Returned<R>::declare(info); }
  static core::Value keep(Site& s, Corrected<R, F> corrected) {
    if (corrected.record) s.context.records.put(std::move(*corrected.record));
    return Returned<F>::keep(s, std::move(corrected.findings));
  }
};

/// For OnceExtras::memory: a function of records and options, whose parameters are found as the stage's own.
template <auto function, class O>
double memory_by(const Context& context, const O& options) {
  const struct { const Context& context; } site{context};
  return Signature<decltype(function)>::call(function, site, options);
}

/// What a function does not say of itself; each may be left out.
template <class O>
struct OnceExtras {
  void (*check)(const Context&, const O&) = nullptr;                          ///< as Stage::check
  std::vector<std::filesystem::path> (*inputs)(const io::Survey&) = nullptr;  ///< as Stage::inputs
  std::vector<std::string> (*products)(const O&) = nullptr;                   ///< as Stage::products
  double (*memory)(const Context&, const O&) = nullptr;                       ///< as Stage::survey_memory
  std::vector<Product> needs{}, gives{};                                      ///< beside records: what lies in files
};

template <auto function>
class OnceStage : public OptionStage<typename Signature<decltype(function)>::Options> {
 public:
  using Function = Signature<decltype(function)>;
  using Options = typename Function::Options;
  using Result = Returned<typename Function::Result>;
  using Findings = typename Result::Findings;

  OnceStage(std::string_view name, std::string_view summary, OnceExtras<Options> extras)
      : info_{name, summary, {Grain::survey}, {}, {}, {}, {}}, extras_(extras) {
    Function::declare(info_);
    Result::declare(info_);
    info_.needs_products.insert(info_.needs_products.end(), extras.needs.begin(), extras.needs.end());
    info_.gives_products.insert(info_.gives_products.end(), extras.gives.begin(), extras.gives.end());
  }
  const Info& info() const override { return info_; }
  void visit_findings(core::ResultVisitor& v) const override {
    if constexpr (!std::same_as<Findings, core::Value>) describe(Findings{}, v);
  }
  void check(const Context& c) const override {
    if (extras_.check) extras_.check(c, this->options);
  }
  std::vector<std::filesystem::path> inputs(const io::Survey& s) const override {
    return extras_.inputs ? extras_.inputs(s) : std::vector<std::filesystem::path>{};
  }
  std::vector<std::string> products() const override {
    return extras_.products ? extras_.products(this->options) : std::vector<std::string>{};
  }
  double survey_memory(const Context& c) const override { return extras_.memory ? extras_.memory(c, this->options) : 0.0; }
  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    Site site{context, tally};
    findings = Result::keep(site, Function::call(function, site, this->options));
  }

 private:
  Info info_;
  OnceExtras<Options> extras_;
};

template <auto function>
Entry once(std::string_view name, std::string_view summary, OnceExtras<typename Signature<decltype(function)>::Options> extras = {}) {
  return {name, [=] { return std::make_unique<OnceStage<function>>(name, summary, extras); }};
}

}  // namespace swath::stages
