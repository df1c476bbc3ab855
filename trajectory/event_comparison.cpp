// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Reis, Camargo and Tommaselli 2011: positions at the events by two techniques, compared by bias and rms per axis.
#include "trajectory/event_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace swath::trajectory {

namespace {

struct OneDifference {
  Eigen::Vector3d value;  // east, north, height
  Eigen::Vector3d sigma;  // of it; 0: not known
};

void summarise(const std::vector<OneDifference>& all, PlaceDifferences& out) {
  out.pairs = all.size();
  if (all.empty()) return;
  const auto n = static_cast<double>(all.size());
  Eigen::Vector3d square = Eigen::Vector3d::Zero(), normalised = square;
  bool with_sigma = true;
  for (const OneDifference& d : all) {
    out.bias += d.value / n;
    square += d.value.cwiseAbs2() / n;
    out.largest = out.largest.cwiseMax(d.value.cwiseAbs());
    with_sigma = with_sigma && d.sigma.minCoeff() > 0.0;
    if (with_sigma) normalised += d.value.cwiseQuotient(d.sigma).cwiseAbs2() / n;
  }
  out.rms = square.cwiseSqrt();
  if (all.size() > 1) out.standard = ((square - out.bias.cwiseAbs2()).cwiseMax(0.0) * (n / (n - 1.0))).cwiseSqrt();
  if (with_sigma) out.ratio = normalised.cwiseSqrt();
}

/// Events of one technique by name and count of that name.
using Named = std::map<std::pair<std::string, int>, size_t>;

std::vector<std::pair<std::string, Named>> by_technique(const core::EventData& events) {
  std::vector<std::pair<std::string, Named>> out;
  std::map<std::pair<std::string, std::string>, int> seen;
  for (size_t i = 0; i < events.size(); ++i) {
    auto at = std::find_if(out.begin(), out.end(), [&](const auto& t) { return t.first == events.technique[i]; });
    if (at == out.end()) at = out.insert(out.end(), {events.technique[i], {}});
    at->second[{events.id[i], seen[{events.technique[i], events.id[i]}]++}] = i;
  }
  return out;
}

}  // namespace

std::vector<PlaceDifferences> compare_event_places(const core::EventData& events, const std::vector<EventPosition>& solved) {
  std::vector<PlaceDifferences> out;
  const auto techniques = by_technique(events);
  const auto is_known = [&](size_t i) { return reached(solved[i].reach) && !events.doubtful[i]; };
  for (size_t k = 1; k < techniques.size(); ++k) {
    PlaceDifferences d{techniques[k].first + " - " + techniques[0].first};
    std::vector<OneDifference> all;
    for (const auto& [name, i] : techniques[k].second) {
      const auto other = techniques[0].second.find(name);
      d.only_first += other == techniques[0].second.end();
      if (other == techniques[0].second.end() || !is_known(i) || !is_known(other->second)) continue;
      const Eigen::Vector3d& to = solved[other->second].position;
      all.push_back({local_frame(to).local_R_ecef * (solved[i].position - to), Eigen::Vector3d::Zero()});
    }
    d.only_second = techniques[0].second.size() - (techniques[k].second.size() - d.only_first);
    summarise(all, d);
    out.push_back(std::move(d));
  }
  for (const auto& [technique, named] : techniques) {
    PlaceDifferences d{technique + " - its recorder's places"};
    std::vector<OneDifference> all;
    bool has_places = false;
    for (const auto& [name, i] : named) {
      const bool placed = i < events.place.size() && events.place[i].allFinite();
      has_places = has_places || placed;
      d.only_first += !placed;
      if (!placed || !is_known(i)) continue;
      const Eigen::Vector3d& ned = events.place_sigma[i];
      const Eigen::Vector3d stated(ned.y(), ned.x(), ned.z());
      all.push_back({local_frame(events.place[i]).local_R_ecef * (solved[i].position - events.place[i]),
                     (solved[i].sigma.cwiseAbs2() + stated.cwiseAbs2()).cwiseSqrt()});
    }
    if (!has_places) continue;
    summarise(all, d);
    out.push_back(std::move(d));
  }
  return out;
}

}  // namespace swath::trajectory
