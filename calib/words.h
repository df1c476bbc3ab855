// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences by printf() formats. fmt was weighed: it checks its formats, but is one more library to find and to ship.
#pragma once

#include <cstdio>
#include <string>

namespace swath::calib {

/// A sentence with figures, as printf() makes it; 400 characters at most.
template <class... A>
std::string words(const char* format, A... a) {
  char text[400];
  std::snprintf(text, sizeof text, format, a...);
  return text;
}

}  // namespace swath::calib
