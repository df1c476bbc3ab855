// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/repeated_times.h"

#include <algorithm>
#include <cmath>

namespace swath::io {

std::vector<std::pair<size_t, size_t>> repeated_times(const std::vector<double>& time) {
  std::vector<size_t> order;
  for (size_t i = 0; i < time.size(); ++i)
    if (std::isfinite(time[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return time[a] < time[b]; });
  std::vector<std::pair<size_t, size_t>> out;
  for (size_t k = 1, first = 0; k < order.size(); ++k)
    if (time[order[k]] == time[order[first]])
      out.emplace_back(order[first], order[k]);
    else
      first = k;
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return out;
}

}  // namespace swath::io
