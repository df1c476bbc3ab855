// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <string_view>

namespace swath::core {

/// What a long piece of work calls as it goes: the share that is done, 0 to 1, and what it is at, a word or two. Any thread may call it, as
/// often as it likes. Where the end is not known beforehand, the share is what such work usually takes, and stays below 1.
using OnProgress = std::function<void(double share, std::string_view now)>;

/// Share of `done` parts of work that usually takes `usual` of them; stays below 1.
inline double usual_share(double done, double usual) {
  constexpr double most = 0.97;
  return std::min(most, done / usual);
}

/// For work that nobody watches.
inline void unwatched(double /*share*/, std::string_view /*now*/) {}

}  // namespace swath::core
