// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/result_visitors.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "quality/line_offsets.h"
#include "stages/adapters/adapters.h"
#include "stages/line_comparison.h"

namespace swath::stages {
namespace {

using core::Column;

struct OverlapCounts {
  std::uint64_t overlaps = 0, alone = 0;
};

template <class V>
void describe(const OverlapCounts& r, V& v) {
  v.result("overlaps of two lines", r.overlaps, "Pairs of flight lines that overlap.");
  v.result("lines that overlap no other on smooth ground: no offset", r.alone, core::if_any(), "Flight lines without an offset.");
}

class Lines : public OptionStage<quality::LineOptions, OverlapCounts, quality::LineComparison> {
 public:
  const Info& info() const override {
    static const Info info{
        "quality.lines",
        "Flight lines compared where they overlap: a height offset per line, scatter of the returns, what neighbours share.",
        {Grain::tile, Grain::merge},
        {Column::strip, Column::flags},
        {},
        {Product::points},
        {}};
    return info;
  }
  core::ColumnSet also_reads() const override { return {Column::classification, Column::return_number, Column::return_count}; }
  double halo() const override { return quality::halo(options); }
  double bytes_per_point() const override { return 48.0; }
  std::vector<std::string> products() const override { return {"lines.json"}; }

  bool is_divisible() const override { return true; }
  void join_parts(const Context& context, const TileJob& whole, const std::vector<std::filesystem::path>& parts) const override {
    quality::LineCells cells;  // blocks that parts share are the same in each
    for (const std::filesystem::path& part : parts) read_line_cells(file_of(context, part, whole.key), cells);
    write_line_cells(file_of(context, whole.folder, whole.key), cells);
  }
  void run_tile(const Context& context, TileJob& job) const override {
    write_line_cells(file_of(context, job.folder, job.key), quality::compare_cells(job.block, job.own, options));
  }

  void run_merge(const Context& context, MergeJob& job) const override {
    quality::LineCells cells;
    for (const TileKey key : job.tiles) read_line_cells(file_of(context, job.folder, key), cells);
    const quality::LineComparison c = quality::compare_lines(std::move(cells), options);
    job.findings = core::reported(c);
    io::write_text_file(context.output / "lines.json", io::to_json(job.findings));
    OverlapCounts counts{c.pairs.size()};
    for (const quality::LineOffset& l : c.lines) counts.alone += l.pairs == 0;
    core::count_results(counts, job.tally);
  }

 private:
  static std::filesystem::path file_of(const Context& context, const std::filesystem::path& folder, TileKey key) {
    return folder / (context.label(key) + ".cells");
  }
};

}  // namespace

std::unique_ptr<Stage> make_lines() { return std::make_unique<Lines>(); }

}  // namespace swath::stages
