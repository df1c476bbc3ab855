// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

#include "core/config/value.h"

namespace swath::io {

/// Does a file that starts so hold captured network packets (pcap or pcapng)?
bool looks_like_pcap(std::string_view start);

/// What a capture of network packets holds, as lidar sensors are recorded: packets, times, UDP ports with the sizes of their payloads.
core::Value describe_pcap(const std::filesystem::path& file);

}  // namespace swath::io
