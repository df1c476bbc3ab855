// SPDX-License-Identifier: GPL-3.0-or-later
// Columns one after the other, each with its length, in the machine's own byte order: the work folder is never carried elsewhere. A
// trajectory goes as its records and the longest step within its spans, from which the same spans follow.
#include "pipeline/work/handed_on.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "core/records/gnss_columns.h"
#include "core/records/trajectory_columns.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {
namespace {

template <class T>
constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class Packer {
 public:
  template <class T>
  void operator()(const T& v) {
    static_assert(is_plain<T>);
    raw(&v, sizeof v);
  }
  void operator()(const std::string& s) { (*this)(s.size()), raw(s.data(), s.size()); }
  template <class T>
  void operator()(const std::vector<T>& v) {
    (*this)(v.size());
    if constexpr (std::is_same_v<T, std::string>)
      for (const T& one : v) (*this)(one);
    else if (!v.empty())
      raw(v.data(), v.size() * sizeof(T));  // numbers, arrays of them, or Eigen's of fixed size
  }
  std::string bytes;

 private:
  void raw(const void* from, size_t n) { bytes.append(static_cast<const char*>(from), n); }
};

class Unpacker {
 public:
  Unpacker(std::string bytes, const std::filesystem::path& file) : bytes_(std::move(bytes)), file_(file) {}
  template <class T>
  void operator()(T& v) {
    static_assert(is_plain<T>);
    raw(&v, sizeof v);
  }
  void operator()(std::string& s) {
    s.resize(length(1));
    raw(s.data(), s.size());
  }
  template <class T>
  void operator()(std::vector<T>& v) {
    if constexpr (std::is_same_v<T, std::string>) {
      v.resize(length(1));
      for (T& one : v) (*this)(one);
    } else {
      v.resize(length(sizeof(T)));
      if (!v.empty()) raw(v.data(), v.size() * sizeof(T));
    }
  }
  void expect_end() const {
    if (at_ != bytes_.size()) throw damaged_work(file_);
  }

 private:
  size_t length(size_t item) {
    size_t n = 0;
    (*this)(n);
    if (n > (bytes_.size() - at_) / item) throw damaged_work(file_);
    return n;
  }
  void raw(void* to, size_t n) {
    if (n > bytes_.size() - at_) throw damaged_work(file_);
    if (n > 0) std::memcpy(to, bytes_.data() + at_, n);
    at_ += n;
  }
  std::string bytes_;
  std::filesystem::path file_;
  size_t at_ = 0;
};

template <class F, class G>
void visit_gnss(F& f, G& d) {
  core::for_each_gnss_column([&](auto member) { f(d.*member); });
}

template <class F, class E>
void visit_events(F& f, E& d) {
  f(d.time), f(d.sigma), f(d.id), f(d.strip), f(d.technique), f(d.doubtful), f(d.place), f(d.place_sigma);
}

template <class F, class T>
void visit_trajectory(F& f, T& d) {
  core::for_each_trajectory_column([&](auto member, const char*) { f(d.*member); });
  f(d.covariance.time), f(d.covariance.upper);
  f(d.errors.states), f(d.errors.time), f(d.errors.lefts), f(d.errors.rights), f(d.errors.links);
  f(d.response.time), f(d.response.per_unit);
}

template <class F, class A>
void visit_area(F& f, A& a) {
  f(a.box.x0), f(a.box.y0), f(a.box.x1), f(a.box.y1), f(a.lowest), f(a.highest);
}

/// A max_gap with which the same records make the same spans.
double longest_step(const trajectory::Trajectory& t) {
  const std::vector<double>& time = t.data().time;
  double longest = 0.0;
  for (const trajectory::Span& s : t.spans()) {
    const auto first = std::lower_bound(time.begin(), time.end(), s.first), last = std::lower_bound(time.begin(), time.end(), s.last);
    for (auto at = first; at != last; ++at) longest = std::max(longest, *(at + 1) - *at);
  }
  return longest;
}

trajectory::Trajectory made_of(core::TrajectoryData data, double max_gap, const std::filesystem::path& file) {
  trajectory::TrajectoryOptions options;
  options.max_gap = core::Seconds(max_gap);
  return trajectory::Trajectory(std::move(data), options, file.string());
}

/// What became of a record.
enum class Fate : std::uint8_t { as_before, given, gone };

template <stages::Record R>
Fate fate_of(const stages::Records::Marks& before, const stages::Context& context) {
  const std::uint64_t was = stages::Records::mark_of<R>(before), is = stages::Records::mark_of<R>(context.records.marks());
  return was == is ? Fate::as_before : is == 0 ? Fate::gone : Fate::given;
}

template <stages::Record R, class Visit>
void pack_record(Packer& pack, const stages::Records::Marks& before, const stages::Context& context, Visit visit) {
  const Fate fate = fate_of<R>(before, context);
  pack(fate);
  if (fate == Fate::given) visit(context.records.get<R>());
}

template <stages::Record R, class Visit>
void unpack_record(Unpacker& unpack, stages::Context& context, Visit read) {
  Fate fate{};
  unpack(fate);
  if (fate == Fate::gone) context.records.drop<R>();
  if (fate == Fate::given) context.records.put<R>(read());
}

template <class F, class C>
void visit_place(F& f, C& context) {
  for (int k = 0; k < 3; ++k) f(context.origin[k]);
  visit_area(f, context.area);
}

}  // namespace

bool write_handed_on(const std::filesystem::path& file, const stages::Records::Marks& before, const stages::Context& context) {
  using trajectory::Trajectory;
  Packer pack;
  bool comes_back = true;
  pack_record<core::GnssData>(pack, before, context, [&](const core::GnssData& d) { visit_gnss(pack, d); });
  pack_record<core::EventData>(pack, before, context, [&](const core::EventData& d) { visit_events(pack, d); });
  pack_record<Trajectory>(pack, before, context, [&](const Trajectory& t) {
    const double gap = longest_step(t);
    comes_back = made_of(t.data(), gap, file).spans() == t.spans();
    pack(gap);
    visit_trajectory(pack, t.data());
  });
  if (!comes_back) return false;
  visit_place(pack, context);
  io::write_text_file(file, pack.bytes);
  return true;
}

void read_handed_on(const std::filesystem::path& file, stages::Context& context) {
  Unpacker unpack(io::read_text_file(file), file);
  unpack_record<core::GnssData>(unpack, context, [&] {
    core::GnssData d;
    visit_gnss(unpack, d);
    return d;
  });
  unpack_record<core::EventData>(unpack, context, [&] {
    core::EventData d;
    visit_events(unpack, d);
    return d;
  });
  unpack_record<trajectory::Trajectory>(unpack, context, [&] {
    double gap = 0.0;
    unpack(gap);
    core::TrajectoryData d;
    visit_trajectory(unpack, d);
    return made_of(std::move(d), gap, file);
  });
  visit_place(unpack, context);
  unpack.expect_end();
}

}  // namespace swath::pipeline
