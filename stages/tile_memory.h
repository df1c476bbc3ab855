// SPDX-License-Identifier: GPL-3.0-or-later
// What the filters of points take of memory, measured and counted. The engine plans tiles by it.
#pragma once

#include <vector>

#include "filters/classes/classify.h"
#include "filters/classes/water.h"
#include "filters/ground/csf.h"
#include "filters/ground/ground.h"
#include "filters/ground/ground_ptd.h"
#include "filters/ground/pmf.h"
#include "filters/ground/robust.h"
#include "filters/ground/smrf.h"
#include "filters/noise/noise.h"
#include "filters/noise/outlier.h"
#include "stages/stage.h"
#include "terrain/tin/key_points.h"

namespace swath::stages {

/// Of a tile of `side` metres. A filter that is not listed takes 64 bytes per point.
template <class O>
TileMemory memory_of(const O&, double /*side*/) {
  return {};
}
TileMemory memory_of(const filters::SmrfOptions& o, double side);
TileMemory memory_of(const filters::PtdOptions& o, double side);
TileMemory memory_of(const filters::RobustOptions& o, double side);
TileMemory memory_of(const filters::PmfOptions& o, double side);
TileMemory memory_of(const filters::CsfOptions& o, double side);
TileMemory memory_of(const filters::GroundOptions& o, double side);
TileMemory memory_of(const filters::NoiseOptions& o, double side);
TileMemory memory_of(const filters::OutlierOptions& o, double side);
TileMemory memory_of(const filters::ClassifyOptions& o, double side);
TileMemory memory_of(const filters::WaterOptions& o, double side);
TileMemory memory_of(const terrain::KeyPointOptions& o, double side);

}  // namespace swath::stages
