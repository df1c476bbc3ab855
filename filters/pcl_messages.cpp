// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/pcl_messages.h"

#include <pcl/console/print.h>

#include <mutex>

namespace swath::filters {

void silence_pcl() {
  static std::once_flag once;
  std::call_once(once, [] { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); });
}

}  // namespace swath::filters
