// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a LAZ file a COPC file: its info record, and the pages that say where each node of the octree lies (COPC 1.0).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "io/copc/octree.h"
#include "io/las/las_header.h"

namespace swath::io {

struct CopcInfo {
  OctreeCube cube;
  double spacing = 0.0;                      ///< between points of the root, units of the coordinates
  std::uint64_t page = 0, page_bytes = 0;    ///< of the hierarchy's root
  double first_time = 0.0, last_time = 0.0;  ///< GPS time as stored
};

/// A chunk of the file's points.
struct CopcNode {
  OctreeKey key;
  std::uint64_t offset = 0;
  std::int32_t bytes = 0, points = 0;
  std::uint64_t first_record = 0;  ///< number of its first point in the file, from 0
};

/// The record of the header, the first of its list (COPC 1.0, info VLR).
LasVlr copc_info_record(const CopcInfo& info);
/// Of a file that is COPC; nothing where it is not. Throws core::Error where the record cannot be right.
std::optional<CopcInfo> copc_info(const LasHeader& header, const std::filesystem::path& file);

/// The pages of the nodes, to be written from byte `place` on, and where their root is (`info`). A page covers `page_levels` levels below
/// its top, where there are more nodes than one page should have.
std::vector<std::uint8_t> copc_pages(const std::vector<CopcNode>& nodes, std::uint64_t place, CopcInfo& info);
/// All nodes with points, in the order of the file. Throws core::Error that names file and byte where pages or nodes overlap or leave the
/// file, nodes come twice or have no parent, or do not hold as many points as the header counts.
std::vector<CopcNode> read_copc_nodes(const std::filesystem::path& file, const LasHeader& header, const CopcInfo& info);

}  // namespace swath::io
