// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "io/text/binary_file.h"
#include "io/text/output_file.h"

namespace swath::io {

/// Decimals that hold the times first, first + step ... exactly: `least`, or 9 (ns) where those would round.
int decimals_of(double first, double step, int least);

/// Comma-separated rows of numbers, streamed to a file that appears whole with commit().
class TextRows {
 public:
  TextRows(const std::filesystem::path& file, const std::string& header);

  void number(double v, int decimals);
  void scientific(double v, int decimals);
  void shortest(double v);  ///< fewest digits that read back to the same double
  void end();
  void commit();

 private:
  void separate();
  OutputFile output_;
  BinaryAppender out_;
  std::string buffer_;
  bool first_ = true;
};

}  // namespace swath::io
