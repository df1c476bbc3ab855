// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/table_rows.h"

#include <algorithm>

#include "core/error.h"
#include "io/text/delimited.h"
#include "io/text/npy.h"

namespace swath::io {
namespace {

constexpr size_t chunk = 8192;  // rows

class DelimitedRows : public TableRows {
 public:
  DelimitedRows(const std::filesystem::path& file, const DelimitedLayout& layout, std::vector<size_t> columns)
      : name_(file.string()), cut_(layout.cut_line), reader_(file, layout, std::move(columns)) {}
  std::uint64_t cut_line() const override { return cut_; }
  bool next(double* values) override { return reader_.next(values); }
  std::uint64_t number() const override { return reader_.line(); }
  std::string place_of(std::uint64_t line) const override { return name_ + ":" + std::to_string(line); }

 private:
  std::string name_;
  std::uint64_t cut_;
  DelimitedReader reader_;
};

class NpyRows : public TableRows {
 public:
  NpyRows(const std::filesystem::path& file, std::vector<size_t> fields) : name_(file.string()), reader_(file, std::move(fields)) {}

  bool next(double* values) override {
    if (at_ == reader_.rows()) return false;
    const size_t row = static_cast<size_t>(at_ % chunk);
    if (row == 0) reader_.read(at_, static_cast<size_t>(std::min<std::uint64_t>(chunk, reader_.rows() - at_)), columns_);
    for (size_t c = 0; c < columns_.size(); ++c) values[c] = columns_[c][row];
    ++at_;
    return true;
  }
  std::uint64_t number() const override { return at_ - 1; }
  std::string place_of(std::uint64_t record) const override { return name_ + ": record " + std::to_string(record); }

 private:
  std::string name_;
  NpyReader reader_;
  std::vector<std::vector<double>> columns_;
  std::uint64_t at_ = 0;
};

}  // namespace

std::unique_ptr<TableRows> open_table(const std::filesystem::path& file, RecordFormat format, const std::string& delimiter,
                                      const std::vector<std::string>& columns) {
  std::vector<size_t> at;
  switch (format) {
    case RecordFormat::text: {
      const DelimitedLayout layout = inspect_delimited(file, delimiter);
      for (const std::string& c : columns) at.push_back(column_of(layout, c, file));
      return std::make_unique<DelimitedRows>(file, layout, std::move(at));
    }
    case RecordFormat::npy: {
      const NpyHeader header = read_npy_header(file);
      for (const std::string& c : columns) at.push_back(field_of(header, c, file));
      return std::make_unique<NpyRows>(file, std::move(at));
    }
    case RecordFormat::automatic:
      break;
  }
  throw core::usage_error("the name does not tell the format of the records", file.string(), "state format = \"text\" or \"npy\"");
}

}  // namespace swath::io
