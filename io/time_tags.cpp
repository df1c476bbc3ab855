// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/time_tags.h"

namespace swath::io {

double radians_per(AngleUnit unit) {
  switch (unit) {
    case AngleUnit::unstated:
      return 0.0;
    case AngleUnit::deg:
      return core::degree;
    case AngleUnit::rad:
      return 1.0;
    case AngleUnit::gon:
      return core::pi / 200.0;
  }
  return 0.0;
}

}  // namespace swath::io
