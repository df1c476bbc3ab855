// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/sparse/node_order.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>
#include <utility>

namespace swath::calib {
namespace {

// Share of zeros that a front of so many unknowns may store.
constexpr int small_front = 48, wide_front = 144;
constexpr double zeros_of_small = 0.3, zeros_of_wide = 0.1, zeros_of_others = 0.04;

/// The nodes in an order that keeps fronts small.
std::vector<int> minimum_degree(const std::vector<std::vector<int>>& neighbours) {
  const auto n = static_cast<int>(neighbours.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < n; ++a) {
    entries.emplace_back(a, a, 1.0);
    for (const int b : neighbours[static_cast<size_t>(a)]) entries.emplace_back(a, b, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> p;
  Eigen::AMDOrdering<int>()(pattern, p);
  return {p.indices().data(), p.indices().data() + n};
}

std::vector<int> places_of(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (size_t k = 0; k < order.size(); ++k) place[static_cast<size_t>(order[k])] = static_cast<int>(k);
  return place;
}

/// Of each place the places below it that its elimination touches, rising; the first of them is its parent.
std::vector<std::vector<int>> touched_by(const std::vector<std::vector<int>>& neighbours, const std::vector<int>& order) {
  const std::vector<int> place = places_of(order);
  const size_t n = order.size();
  std::vector<std::vector<int>> below(n), children(n);
  std::vector<int> seen(n, -1);
  for (size_t k = 0; k < n; ++k) {
    std::vector<int>& mine = below[k];
    const auto me = static_cast<int>(k);
    const auto take = [&](int p) {
      if (p > me && std::exchange(seen[static_cast<size_t>(p)], me) != me) mine.push_back(p);
    };
    for (const int b : neighbours[static_cast<size_t>(order[k])]) take(place[static_cast<size_t>(b)]);
    for (const int child : children[k])
      for (const int p : below[static_cast<size_t>(child)]) take(p);
    std::sort(mine.begin(), mine.end());
    if (!mine.empty()) children[static_cast<size_t>(mine.front())].push_back(me);
  }
  return below;
}

/// The same elimination with each subtree's places side by side, the child with most rows last, beside its parent. Old places by new.
std::vector<int> depth_first(const std::vector<std::vector<int>>& below) {
  const size_t n = below.size();
  std::vector<std::vector<int>> children(n);
  std::vector<int> todo, reversed;
  for (size_t k = 0; k < n; ++k) {
    if (below[k].empty())
      todo.push_back(static_cast<int>(k));
    else
      children[static_cast<size_t>(below[k].front())].push_back(static_cast<int>(k));
  }
  while (!todo.empty()) {
    const int k = todo.back();
    todo.pop_back();
    reversed.push_back(k);
    std::vector<int>& mine = children[static_cast<size_t>(k)];
    std::stable_sort(mine.begin(), mine.end(),
                     [&](int a, int b) { return below[static_cast<size_t>(a)].size() < below[static_cast<size_t>(b)].size(); });
    todo.insert(todo.end(), mine.begin(), mine.end());
  }
  return {reversed.rbegin(), reversed.rend()};
}

/// Entries that a front stores, and how many of them are zeros.
struct Growing {
  NodeFront front;
  double zeros = 0.0;
  double entries() const { return 0.5 * front.own * (front.own + 1.0) + static_cast<double>(front.own) * front.rows; }
};

/// Joins the front before with the one that its elimination leads to, where few zeros come of it.
bool join(const Growing& before, Growing& into) {
  if (before.front.below.empty() || before.front.below.front() >= into.front.last) return false;
  Growing both = into;
  both.front.first = before.front.first;
  both.front.own += before.front.own;
  both.zeros = both.entries() - (before.entries() - before.zeros) - (into.entries() - into.zeros);
  const int own = both.front.own;
  const double allowed = own <= small_front ? zeros_of_small : own <= wide_front ? zeros_of_wide : zeros_of_others;
  if (both.zeros > allowed * both.entries()) return false;
  into = std::move(both);
  return true;
}

}  // namespace

double NodeFront::work() const {
  const double o = own, r = rows;
  return o * o * o / 3 + o * o * r + o * r * r;
}

std::vector<int> NodeOrder::subtrees() const {
  std::vector<int> first(fronts.size());
  std::iota(first.begin(), first.end(), 0);
  for (size_t k = 0; k < fronts.size(); ++k)
    if (fronts[k].parent >= 0) {
      int& of_parent = first[static_cast<size_t>(fronts[k].parent)];
      of_parent = std::min(of_parent, first[k]);
    }
  return first;
}

NodeOrder order_of(const std::vector<std::vector<int>>& neighbours, const std::vector<int>& sizes) {
  const std::vector<int> found = minimum_degree(neighbours);
  const std::vector<std::vector<int>> touched = touched_by(neighbours, found);
  const std::vector<int> old = depth_first(touched), now = places_of(old);
  NodeOrder out;
  std::vector<Growing> fronts;
  for (size_t k = 0; k < old.size(); ++k) {
    const auto was = static_cast<size_t>(old[k]);
    out.node.push_back(found[was]);
    Growing g;
    g.front = {static_cast<int>(k), static_cast<int>(k) + 1, -1, {}, sizes[static_cast<size_t>(found[was])], 0};
    for (const int p : touched[was]) {
      g.front.below.push_back(now[static_cast<size_t>(p)]);
      g.front.rows += sizes[static_cast<size_t>(found[static_cast<size_t>(p)])];
    }
    std::sort(g.front.below.begin(), g.front.below.end());
    while (!fronts.empty() && join(fronts.back(), g)) fronts.pop_back();
    fronts.push_back(std::move(g));
  }
  std::vector<int> front_at(old.size());
  for (size_t f = 0; f < fronts.size(); ++f)
    std::fill(front_at.begin() + fronts[f].front.first, front_at.begin() + fronts[f].front.last, static_cast<int>(f));
  for (Growing& g : fronts) {
    if (!g.front.below.empty()) g.front.parent = front_at[static_cast<size_t>(g.front.below.front())];
    out.fronts.push_back(std::move(g.front));
  }
  return out;
}

}  // namespace swath::calib
