// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles leave their points as LAS records in the work folder; the merge sorts them into the octree.
#include "stages/adapters/cloud/copc.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include "core/error.h"
#include "io/copc/copc_writer.h"
#include "io/las/las_bytes.h"
#include "io/las/las_recode.h"
#include "stages/adapters/cloud/las_product.h"
#include "stages/grid_tile.h"
#include "stages/tile_product.h"

namespace swath::stages {
enum class ExtraBytes { recorded, floats };
}

template <>
struct swath::core::Choices<swath::stages::ExtraBytes> {
  static constexpr std::array<std::string_view, 2> names{"recorded", "float"};
};

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct CopcOptions : PointFields {
  CopcOptions() { only_copc = true; }
  std::string file = "points.copc.laz";
  std::optional<core::Metres> block;
  std::string folder = "copc";
  ExtraBytes extra_bytes = ExtraBytes::recorded;
};

template <class V>
void describe(CopcOptions& o, V& v) {
  v.option("file", o.file, "Name of the file within the output; not used with blocks.");
  v.option("block", o.block, core::above(0.0), "Side of square blocks with a file each; unset: one file for the whole survey.");
  v.option("folder", o.folder, "Folder of the blocks' files within the output.");
  describe(static_cast<PointFields&>(o), v);
  v.option("extra_bytes", o.extra_bytes, "Scaled extra bytes: as recorded, or as plain floats for viewers that misread scales.");
  v.check(o.file.ends_with(".copc.laz"), "file ends in .copc.laz");
}

struct CopcFindings {
  std::vector<std::string> files{};
  std::uint64_t points = 0, nodes = 0;
  int levels = 0;
  double spacing = 0.0;
};
template <class V>
void describe(const CopcFindings& r, V& v) {
  v.result("files", r.files, "Names of the files within the output.");
  v.result("points", r.points, core::plain().in_summary(), "Points in the files.");
  v.result("nodes", r.nodes, "Nodes of the octrees that hold points.");
  v.result("levels", r.levels, "Levels of the deepest octree.");
  v.result("spacing_m", r.spacing, core::metres(), "Distance of neighbouring points on the widest octree's first level.");
}

fs::path records_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "las"); }

void keep_records(TileJob& job, const Context& context, const CopcOptions& options, RunCache& cache) {
  write_points(job, context, options, cache, records_file(job.folder, job.key));
}

/// The records of a tile.
struct KeptRecords {
  fs::path file;
  io::LasHeader header;
};
using AllRecords = std::vector<KeptRecords>;

/// Of the tiles that have points; of any one where none has.
AllRecords all_records(const MergeJob& job) {
  AllRecords out;
  std::vector<std::string> ignored;
  for (const TileKey key : job.tiles) {
    const fs::path file = records_file(job.folder, key);
    out.push_back({file, io::read_las_header(file, ignored)});
  }
  const auto is_empty = [](const KeptRecords& k) { return k.header.point_count == 0; };
  if (std::all_of(out.begin(), out.end(), is_empty))
    out.resize(std::min<size_t>(out.size(), 1));
  else
    std::erase_if(out, is_empty);
  return out;
}

io::LasHeader common_header(const AllRecords& all, ExtraBytes extra_bytes) {
  std::vector<io::LasHeader> headers;
  for (const KeptRecords& k : all) headers.push_back(k.header);
  io::LasHeader out = headers.front();
  out.extras = io::common_extras(headers);
  if (extra_bytes == ExtraBytes::floats) out.extras = io::float_extras(out.extras);
  out.record_length = static_cast<std::uint16_t>(io::las_layout(out.point_format)->size + out.extra_bytes());
  return out;
}

/// Square blocks of the map, named as tiles of their side.
class Blocks {
 public:
  Blocks(const Context& context, const io::LasHeader& header, double side) : context_(context), header_(header), side_(side) {}
  TileKey of(const std::uint8_t* record) const {
    const auto index = [&](int axis) {
      const double raw = io::las::get<std::int32_t>(record + 4 * axis);
      return static_cast<int>(std::floor((raw * header_.scale[axis] + header_.offset[axis]) * context_.unit / side_));
    };
    return {index(0), index(1)};
  }
  /// May the block hold points of such a file? By the box of its header, and a step of its coordinates around it.
  bool meets(TileKey key, const io::LasHeader& file) const {
    const auto within = [&](int axis, int index) {
      const auto at = [&](double v) { return std::floor(v * context_.unit / side_); };
      return at(file.min[axis] - file.scale[axis]) <= index && at(file.max[axis] + file.scale[axis]) >= index;
    };
    return within(0, key.ix) && within(1, key.iy);
  }
  std::string name(TileKey key) const {
    const auto corner = [&](int i) {
      const double at = i * (side_ / context_.unit);
      const bool is_whole = at == std::round(at);  // else in thousandths, so that blocks keep names of their own
      return is_whole ? std::to_string(std::llround(at)) : std::to_string(std::llround(at * 1000.0)) + "mm";
    };
    return corner(key.ix) + "_" + corner(key.iy) + ".copc.laz";
  }

 private:
  const Context& context_;
  const io::LasHeader& header_;
  double side_;
};

/// All records as the header has them; with blocks those of one.
io::RecordStream stream_of(const AllRecords& all, const io::LasHeader& header, const Blocks* blocks, TileKey only) {
  return [&all, &header, blocks, only](const std::function<void(std::span<const std::uint8_t>)>& f) {
    for (const KeptRecords& k : all) {
      if (blocks && !blocks->meets(only, k.header)) continue;
      io::LasRecoder recode(k.header, header, k.file.string());
      std::vector<std::uint8_t> chosen;
      io::each_las_records(k.file, k.header, [&](std::span<const std::uint8_t> some) {
        const std::span<const std::uint8_t> records = recode(some);
        if (!blocks) return f(records);
        chosen.clear();
        const std::size_t length = header.record_length;
        for (std::size_t at = 0; at < records.size(); at += length)
          if (blocks->of(&records[at]) == only) chosen.insert(chosen.end(), &records[at], &records[at] + length);
        if (!chosen.empty()) f(chosen);
      });
    }
  };
}

CopcFindings write_copc_files(const MergeJob& job, const Context& context, const CopcOptions& o, RunCache& cache, core::Tally& tally) {
  CopcFindings found;
  const AllRecords all = all_records(job);
  if (all.empty()) return found;
  const io::LasHeader header = common_header(all, o.extra_bytes);
  const io::CopcWriteOptions how{job.folder, context.memory, static_cast<unsigned>(context.threads)};
  const auto write = [&](const fs::path& name, const io::RecordStream& records, const core::OnProgress& progress) {
    const io::CopcWritten written = io::write_copc(context.output / name, header, records, how, progress);
    found.files.push_back(name.string());
    found.points += written.points;
    found.nodes += written.nodes;
    found.levels = std::max(found.levels, written.levels);
    found.spacing = std::max(found.spacing, written.spacing * context.unit);
  };
  if (!o.block) {
    write(o.file, stream_of(all, header, nullptr, {}), context.progress);
  } else {
    const Blocks blocks(context, header, o.block->value);
    std::set<TileKey> keys;
    stream_of(all, header, nullptr, {})([&](std::span<const std::uint8_t> records) {
      for (std::size_t at = 0; at < records.size(); at += header.record_length) keys.insert(blocks.of(&records[at]));
    });
    std::vector<std::string> names;
    for (const TileKey key : keys) {
      const double before = static_cast<double>(names.size()), all_blocks = static_cast<double>(keys.size());
      write(fs::path(o.folder) / names.emplace_back(blocks.name(key)), stream_of(all, header, &blocks, key),
            [&](double share, std::string_view now) { context.progress((before + share) / all_blocks, now); });
    }
    write_list(context.output / o.folder, names);
  }
  count_not_carried(cache, tally);
  return found;
}

}  // namespace

Entry copc_writer_stage() {
  return tile<keep_records, write_copc_files>(
      "writers.copc",
      "Cloud Optimized Point Cloud: one LAZ file of the survey, or one per block, with an octree for viewers and part reads.",
      {.columns = {.needs = {}, .reads = all_columns()},
       .memory = [](const CopcOptions&, const Context&) { return TileMemory{170.0}; },
       .products = [](const CopcOptions& o) { return std::vector{o.block ? o.folder : o.file}; },
       .is_streamed = true});
}

}  // namespace swath::stages
