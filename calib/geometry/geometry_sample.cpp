// SPDX-License-Identifier: GPL-3.0-or-later
// No published source. A place is chosen where two passes lie nearest to one another; of each pass the stretch that lies beside it is kept.
#include "calib/geometry/geometry_sample.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "calib/ties/local_points.h"
#include "calib/ties/plane_cells.h"
#include "core/geo/frames.h"
#include "core/records/trajectory_columns.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;

constexpr double track_step = 0.5;                // s
constexpr double straight = 40.0 * core::degree;  // a pass ends where its course has turned by this
constexpr double shortest_pass = 2.0;             // s
constexpr double swath_share = 1.2;               // of the range: no usual swath is wider
constexpr double profile_length = 20.0;           // s
constexpr double profile_rate = 500.0;            // returns/s
constexpr double spot_share = 0.4;                // of the reach: within most swaths
constexpr size_t most_profiles = 12;
constexpr double returns_of_a_cell = 10.0;
constexpr double at_once = 5.0;      // s between two pieces of one line that are not compared
constexpr double seam = track_step;  // s between the files of one line

/// Half the length of a stretch, m: wide enough that signs of pitch do not part two stretches of one place.
double half_length(double range) { return std::clamp(8.0 + 0.06 * range, 10.0, 80.0); }

void close(Pass& pass, std::vector<Pass>& out) {
  if (pass.time.size() >= 2) {
    const Vector2d way = pass.track.back() - pass.track.front();
    const double taken = pass.time.back() - pass.time.front();
    pass.first = pass.time.front();
    pass.last = pass.time.back();
    pass.speed = way.norm() / taken;
    pass.course = std::atan2(way.x(), way.y());
    if (taken >= shortest_pass && pass.speed > 1.0) out.push_back(pass);
  }
  pass.time.clear();
  pass.track.clear();
}

void fly(const RecordedLine& line, const trajectory::Trajectory& t, const trajectory::LocalFrame& frame, double shift,
         std::vector<Pass>& out, double& seconds, double& covered) {
  Pass pass;
  pass.line = line.line;
  const double taken = line.last - line.first;
  pass.rate = static_cast<double>(line.records) / std::max(taken, 1e-3);
  const auto steps = static_cast<size_t>(std::clamp(std::ceil(taken / track_step), 1.0, 1e6));
  trajectory::Cursor cursor(t);
  double course = 0.0;
  for (size_t k = 0; k <= steps; ++k) {
    const double time = line.first + taken * static_cast<double>(k) / static_cast<double>(steps);
    seconds += 1;
    if (!cursor.seek(time + shift)) {
      close(pass, out);
      continue;
    }
    covered += 1;
    const Eigen::Vector3d p = frame.local_R_ecef * (cursor.pose(time + shift).position - frame.origin);
    const Vector2d here = p.head<2>();
    if (!pass.track.empty()) {
      const Vector2d way = here - pass.track.back();
      const double now = std::atan2(way.x(), way.y());
      if (pass.track.size() == 1) course = now;
      if (std::abs(core::wrap_pi(now - course)) > straight) close(pass, out), course = now;
    }
    pass.time.push_back(time);
    pass.track.push_back(here);
  }
  close(pass, out);
}

/// Where two passes come near: time on each, and how far apart.
struct Site {
  double distance = 0.0, time_a = 0.0, time_b = 0.0;
};

std::vector<Site> sites_of(const Pass& a, const Pass& b, double reach, int most) {
  std::vector<Site> near;
  // A pass advances along its course throughout: what lies within reach of a point lies within reach along the course.
  const Vector2d ahead(std::sin(b.course), std::cos(b.course));
  std::vector<double> along;
  for (const Vector2d& p : b.track) along.push_back(p.dot(ahead));
  for (size_t i = 0; i < a.track.size(); ++i) {
    Site best{reach, 0, 0};
    bool found = false;
    const double here = a.track[i].dot(ahead);
    const auto first = std::lower_bound(along.begin(), along.end(), here - reach) - along.begin();
    for (auto j = static_cast<size_t>(first); j < b.track.size() && along[j] <= here + reach; ++j)
      if (const double d = (a.track[i] - b.track[j]).norm(); d < best.distance) best = {d, a.time[i], b.time[j]}, found = true;
    if (found) near.push_back(best);
  }
  if (near.empty()) return near;
  // The nearer half, so that a crossing is looked at where both swaths are.
  const auto nearest = std::min_element(near.begin(), near.end(), [](const Site& x, const Site& y) { return x.distance < y.distance; });
  const double limit = nearest->distance + 0.35 * (reach - nearest->distance);
  std::erase_if(near, [&](const Site& s) { return s.distance > limit; });
  std::vector<Site> out;
  const auto n = std::min<size_t>(static_cast<size_t>(most), near.size());
  for (size_t k = 0; k < n; ++k) out.push_back(near[(2 * k + 1) * near.size() / (2 * n)]);
  return out;
}

/// Pairs of passes with tracks that may come within reach, by number: those with points in neighbouring cells of a lattice.
std::vector<std::pair<size_t, size_t>> candidates(const std::vector<Pass>& passes, double reach) {
  double longest = 0.0;  // m between two points of a track
  for (const Pass& p : passes)
    for (size_t i = 1; i < p.track.size(); ++i) longest = std::max(longest, (p.track[i] - p.track[i - 1]).norm());
  // Points further apart than half the reach, or neighbours: each point of a track lies within this of one of them.
  const double off = std::max(0.5 * reach, longest), side = reach + 2 * off;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<size_t>> cells;
  const auto cell_of = [side](const Vector2d& v) {
    return std::pair(static_cast<std::int64_t>(std::floor(v.x() / side)), static_cast<std::int64_t>(std::floor(v.y() / side)));
  };
  for (size_t k = 0; k < passes.size(); ++k) {
    Vector2d last = Vector2d::Constant(1e300);
    for (const Vector2d& v : passes[k].track) {
      if ((v - last).norm() < off) continue;
      last = v;
      std::vector<size_t>& in = cells[cell_of(v)];
      if (in.empty() || in.back() != k) in.push_back(k);
    }
  }
  std::vector<std::pair<size_t, size_t>> out;
  for (const auto& [at, in] : cells)
    for (const std::int64_t dx : {-1, 0, 1})
      for (const std::int64_t dy : {-1, 0, 1}) {
        const auto beside = cells.find({at.first + dx, at.second + dy});
        if (beside == cells.end()) continue;
        for (const size_t a : in)
          for (const size_t b : beside->second)
            if (a < b) out.emplace_back(a, b);
      }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Two files of one line, the second recorded at once after the first: where they meet nothing is compared.
bool follow_at_once(const Pass& a, const Pass& b) {
  return a.line == b.line && a.recorded != b.recorded && std::max(a.first, b.first) - std::min(a.last, b.last) < at_once;
}

struct PairSites {
  size_t a = 0, b = 0;
  double distance = 0.0;
  std::vector<Site> sites;
};

std::vector<PairSites> near_pairs(const std::vector<Pass>& passes, double reach, int most) {
  std::vector<PairSites> out;
  for (const auto& [a, b] : candidates(passes, reach)) {
    if (follow_at_once(passes[a], passes[b])) continue;
    PairSites p{a, b, reach, sites_of(passes[a], passes[b], reach, most)};
    for (const Site& s : p.sites) p.distance = std::min(p.distance, s.distance);
    if (!p.sites.empty()) out.push_back(std::move(p));
  }
  // Every pass once before any twice; nearer pairs first.
  std::stable_sort(out.begin(), out.end(), [](const PairSites& x, const PairSites& y) { return x.distance < y.distance; });
  std::map<size_t, int> used;
  std::vector<std::pair<int, size_t>> order;
  for (size_t i = 0; i < out.size(); ++i) order.emplace_back(std::min(used[out[i].a]++, used[out[i].b]++), i);
  std::stable_sort(order.begin(), order.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  std::vector<PairSites> sorted;
  for (const auto& [round, i] : order) sorted.push_back(std::move(out[i]));
  return sorted;
}

/// At most so many of them, at even steps.
template <class T>
std::vector<T> evenly(const std::vector<T>& all, size_t most) {
  std::vector<T> out;
  const size_t n = std::min(most, all.size());
  for (size_t k = 0; k < n; ++k) out.push_back(all[k * all.size() / n]);
  return out;
}

/// How near the tracks come to places, and the two passes nearest to each of some of them: number and time.
std::vector<std::pair<size_t, double>> passes_at(const std::vector<Vector2d>& spots, double reach, size_t most, SamplePlan& plan) {
  const std::vector<CourseBox> boxes(plan.passes.begin(), plan.passes.end());
  std::vector<std::vector<std::pair<size_t, double>>> found;
  for (const Vector2d& spot : spots) {
    std::vector<std::tuple<double, size_t, double>> near;  // distance, pass, time
    for (size_t k = 0; k < boxes.size(); ++k)
      if (const auto best = boxes[k].nearest(spot, std::max(reach, plan.nearest_spot))) near.emplace_back(best->first, k, best->second);
    std::sort(near.begin(), near.end());
    if (near.empty()) continue;
    const double distance = std::get<0>(near.front());
    plan.nearest_spot = std::min(plan.nearest_spot, distance);
    plan.near_spots += distance < reach;
    std::vector<std::pair<size_t, double>> at;
    for (size_t k = 0; k < std::min<size_t>(2, near.size()) && std::get<0>(near[k]) < spot_share * reach; ++k)
      at.emplace_back(std::get<1>(near[k]), std::get<2>(near[k]));
    if (!at.empty()) found.push_back(std::move(at));
  }
  std::vector<std::pair<size_t, double>> out;
  for (const auto& at : evenly(found, most)) out.insert(out.end(), at.begin(), at.end());
  return out;
}

/// Of files that were read one after the other.
void sort_by_time(core::Shots& s) {
  if (std::is_sorted(s.time.begin(), s.time.end())) return;
  std::vector<size_t> order(s.time.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t x, size_t y) {
    return std::tie(s.time[x], s.angle[x], s.range[x], x) < std::tie(s.time[y], s.angle[y], s.range[y], y);
  });
  for (auto* column : {&s.time, &s.angle, &s.range, &s.forward}) {
    if (column->empty()) continue;
    std::vector<double> sorted;
    for (const size_t i : order) sorted.push_back((*column)[i]);
    *column = std::move(sorted);
  }
}

/// The returns of a batch that lie in a stretch.
void keep(const Stretch& s, const core::Shots& batch, core::Shots& into) {
  const auto begin = std::lower_bound(batch.time.begin(), batch.time.end(), s.first) - batch.time.begin();
  const auto end = std::upper_bound(batch.time.begin(), batch.time.end(), s.last) - batch.time.begin();
  for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
    if (!is_last_return(batch, i)) continue;
    const std::uint64_t number = batch.record.empty() ? i : batch.record[i];
    if (s.every > 1 && mixed(number) % s.every != 0) continue;
    into.time.push_back(batch.time[i]);
    into.angle.push_back(batch.angle[i]);
    into.range.push_back(batch.range[i]);
    if (batch.forward.empty() && into.forward.empty()) continue;
    into.forward.resize(into.time.size(), 0.0);  // a file without that angle may come first, or last
    if (!batch.forward.empty()) into.forward.back() = batch.forward[i];
  }
}

/// Stretches of one pass that overlap become one.
void join(std::vector<Stretch>& s) {
  std::sort(s.begin(), s.end(),
            [](const Stretch& x, const Stretch& y) { return std::tie(x.profile, x.pass, x.first) < std::tie(y.profile, y.pass, y.first); });
  std::vector<Stretch> out;
  for (const Stretch& k : s) {
    if (!out.empty() && out.back().pass == k.pass && out.back().profile == k.profile && k.first <= out.back().last)
      out.back().last = std::max(out.back().last, k.last);
    else
      out.push_back(k);
  }
  s = std::move(out);
}

}  // namespace

std::vector<RecordedLine> whole_lines(std::vector<RecordedLine> lines) {
  std::stable_sort(lines.begin(), lines.end(),
                   [](const RecordedLine& x, const RecordedLine& y) { return std::tie(x.line, x.first) < std::tie(y.line, y.first); });
  std::vector<RecordedLine> out;
  for (const RecordedLine& l : lines) {
    if (!out.empty() && out.back().line == l.line && l.first <= out.back().last + seam) {
      out.back().last = std::max(out.back().last, l.last);
      out.back().records += l.records;
    } else {
      out.push_back(l);
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const RecordedLine& x, const RecordedLine& y) { return x.first < y.first; });
  return out;
}

SamplePlan plan_sample(const std::vector<RecordedLine>& lines, const trajectory::Trajectory& t, const trajectory::LocalFrame& frame,
                       double shift, double range, const SampleSize& size, const std::vector<Vector2d>& spots) {
  SamplePlan plan;
  double seconds = 0, covered = 0;
  const std::vector<RecordedLine> whole = whole_lines(lines);
  for (size_t k = 0; k < whole.size(); ++k) {
    const size_t before = plan.passes.size();
    fly(whole[k], t, frame, shift, plan.passes, seconds, covered);
    for (size_t p = before; p < plan.passes.size(); ++p) plan.passes[p].recorded = k;
  }
  plan.covered = seconds > 0 ? covered / seconds : 0.0;
  plan.spots = spots.size();
  const double half = half_length(range), reach = swath_share * range;
  plan.cell = std::clamp(std::sqrt(returns_of_a_cell * 2 * half * 0.75 * range / size.returns), 0.75, 12.0);
  const auto add = [&](size_t number, double time) {
    const Pass& p = plan.passes[number];
    const double reach_s = half / p.speed, expected = p.rate * 2 * reach_s;
    plan.stretches.push_back({number, std::max(p.first, time - reach_s), std::min(p.last, time + reach_s),
                              static_cast<std::uint32_t>(std::max(1.0, std::round(expected / size.returns))), false});
  };
  for (const PairSites& pair : near_pairs(plan.passes, reach, size.sites)) {
    plan.nearest = std::min(plan.nearest, pair.distance);
    for (const Site& s : pair.sites) add(pair.a, s.time_a), add(pair.b, s.time_b);
    join(plan.stretches);
    if (plan.stretches.size() >= size.most_stretches) break;
  }
  for (const auto& [pass, time] : passes_at(spots, reach, size.most_spots, plan)) add(pass, time);
  const size_t step = std::max<size_t>(1, plan.passes.size() / most_profiles);
  for (size_t k = 0; k < plan.passes.size(); k += step) {
    const Pass& p = plan.passes[k];
    const double middle = 0.5 * (p.first + p.last), reach_s = 0.5 * std::min(profile_length, p.last - p.first);
    plan.stretches.push_back(
        {k, middle - reach_s, middle + reach_s, static_cast<std::uint32_t>(std::max(1.0, std::round(p.rate / profile_rate))), true});
  }
  join(plan.stretches);
  return plan;
}

std::vector<size_t> spots_seen(const SamplePlan& plan, double range, const std::vector<Vector2d>& spots, size_t most) {
  std::vector<Pass> pieces;
  for (const Stretch& s : plan.stretches) {
    if (s.profile) continue;
    const Pass& whole = plan.passes[s.pass];
    Pass& piece = pieces.emplace_back();
    piece.course = whole.course;
    for (size_t i = 0; i < whole.time.size(); ++i)
      if (std::abs(whole.time[i] - std::clamp(whole.time[i], s.first, s.last)) <= track_step)
        piece.time.push_back(whole.time[i]), piece.track.push_back(whole.track[i]);
  }
  const std::vector<CourseBox> boxes(pieces.begin(), pieces.end());
  std::vector<size_t> seen;
  for (size_t k = 0; k < spots.size(); ++k)
    if (std::any_of(boxes.begin(), boxes.end(), [&](const CourseBox& b) { return b.nearest(spots[k], swath_share * range); }))
      seen.push_back(k);
  return evenly(seen, most);
}

std::vector<GeometrySample> collect_samples(const std::vector<const SamplePlan*>& plans, const ShotStream& stream) {
  std::map<int, std::vector<std::pair<Stretch, core::Shots*>>> of_line;
  std::vector<std::map<std::pair<bool, size_t>, core::Shots>> shots(plans.size());
  for (size_t k = 0; k < plans.size(); ++k)
    for (const Stretch& s : plans[k]->stretches) of_line[plans[k]->passes[s.pass].line].emplace_back(s, &shots[k][{s.profile, s.pass}]);
  stream([&](int line, const core::Shots& batch) {
    const auto at = of_line.find(line);
    if (at == of_line.end()) return;
    for (const auto& [s, into] : at->second) keep(s, batch, *into);
  });
  std::vector<GeometrySample> out(plans.size());
  for (size_t k = 0; k < plans.size(); ++k)
    for (auto& [key, kept] : shots[k]) {
      sort_by_time(kept);
      if (kept.size() > 0) (key.first ? out[k].profiles : out[k].surfaces).push_back({key.second, std::move(kept)});
    }
  return out;
}

core::TrajectoryData cut_trajectory(const core::TrajectoryData& d, const SamplePlan& plan, double shift, double margin) {
  std::vector<std::pair<double, double>> windows;
  for (const Stretch& s : plan.stretches) windows.emplace_back(s.first + shift - margin, s.last + shift + margin);
  std::sort(windows.begin(), windows.end());
  core::TrajectoryData out;
  size_t from = 0;
  for (const auto& [first, last] : windows) {
    const auto a = std::max(from, static_cast<size_t>(std::lower_bound(d.time.begin(), d.time.end(), first) - d.time.begin()));
    const auto b = static_cast<size_t>(std::upper_bound(d.time.begin(), d.time.end(), last) - d.time.begin());
    if (b <= a) continue;
    core::for_each_trajectory_column([&](auto member, const char*) {
      const auto& column = d.*member;
      if (!column.empty())
        (out.*member)
            .insert((out.*member).end(), column.begin() + static_cast<std::ptrdiff_t>(a), column.begin() + static_cast<std::ptrdiff_t>(b));
    });
    from = b;
  }
  return out;
}

}  // namespace swath::calib
