// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the blocking: Goto2008. Deviation: products are not fused with sums, and each element is summed in one order, in stretches of
// block_depth: the numbers are the same on any processor. Alternatives: Eigen's product, which is compiled for the baseline processor and
// takes about twice the time on one with AVX2; OpenBLAS, whose library for all processors takes a third of a whole package of swath.
#include "calib/sparse/dense_product.h"

#include <algorithm>
#include <vector>

#include "core/wide.h"

#ifdef SWATH_HAS_WIDE
#include <immintrin.h>
#endif

namespace swath::calib {
namespace {

using Eigen::Index;

constexpr Index tile_rows = 8, tile_columns = 4;     // of C, kept in registers
constexpr Index block_depth = 256, block_rows = 96;  // packed at a time: within the processor's second cache

/// out = a b: `depth` columns of tile_rows, rows of tile_columns.
using TileProduct = void (*)(Index depth, const double* a, const double* b, double* out);

void multiply_tile(Index depth, const double* a, const double* b, double* out) {
  double sum[tile_rows * tile_columns] = {};
  for (Index k = 0; k < depth; ++k, a += tile_rows, b += tile_columns)
    for (Index j = 0; j < tile_columns; ++j)
      for (Index i = 0; i < tile_rows; ++i) sum[j * tile_rows + i] += a[i] * b[j];
  std::copy_n(sum, tile_rows * tile_columns, out);
}

#ifdef SWATH_HAS_WIDE
[[gnu::target("avx2")]] void multiply_tile_wide(Index depth, const double* a, const double* b, double* out) {
  __m256d low[tile_columns], high[tile_columns];
  for (Index j = 0; j < tile_columns; ++j) low[j] = high[j] = _mm256_setzero_pd();
  for (Index k = 0; k < depth; ++k, a += tile_rows, b += tile_columns) {
    const __m256d a_low = _mm256_loadu_pd(a), a_high = _mm256_loadu_pd(a + 4);
#pragma GCC unroll 4
    for (Index j = 0; j < tile_columns; ++j) {
      const __m256d factor = _mm256_broadcast_sd(b + j);
      low[j] = _mm256_add_pd(low[j], _mm256_mul_pd(a_low, factor));
      high[j] = _mm256_add_pd(high[j], _mm256_mul_pd(a_high, factor));
    }
  }
#pragma GCC unroll 4
  for (Index j = 0; j < tile_columns; ++j) {
    _mm256_storeu_pd(out + j * tile_rows, low[j]);
    _mm256_storeu_pd(out + j * tile_rows + 4, high[j]);
  }
}
#endif

TileProduct tile_product() {
#ifdef SWATH_HAS_WIDE
  if (__builtin_cpu_supports("avx2")) return multiply_tile_wide;
#endif
  return multiply_tile;
}

Index tiles(Index n, Index of) { return (n + of - 1) / of; }

/// `count` rows from `first` on and `depth` columns from `from` on, as tiles of `Width` rows, column after column; zeros beyond the last.
template <Index Width>
void pack(const MatrixView& m, Index first, Index count, Index from, Index depth, std::vector<double>& out) {
  out.resize(static_cast<size_t>(tiles(count, Width) * Width * depth));
  double* to = out.data();
  for (Index i = 0; i < count; i += Width) {
    const Index there = std::min(Width, count - i);
    const double* at = m.data + (first + i) * m.row_step + from * m.column_step;
    if (there == Width && m.row_step == 1) {
      for (Index k = 0; k < depth; ++k, to += Width, at += m.column_step) std::copy_n(at, Width, to);
      continue;
    }
    for (Index k = 0; k < depth; ++k, to += Width, at += m.column_step) {
      for (Index r = 0; r < there; ++r) to[r] = at[r * m.row_step];
      std::fill(to + there, to + Width, 0.0);
    }
  }
}

/// C -= a tile, of which C holds `rows` and `columns`.
void subtract_tile(const double* tile, Index rows, Index columns, double* C, Index step) {
  for (Index j = 0; j < columns; ++j, C += step, tile += tile_rows) {
    if (rows == tile_rows)
      for (Index i = 0; i < tile_rows; ++i) C[i] -= tile[i];
    else
      for (Index i = 0; i < rows; ++i) C[i] -= tile[i];
  }
}

}  // namespace

void subtract_product(Eigen::Ref<Eigen::MatrixXd> C, const MatrixView& A, const MatrixView& B) {
  static const TileProduct product = tile_product();
  thread_local std::vector<double> packed_a, packed_b;
  const MatrixView columns = B.transposed();
  double tile[tile_rows * tile_columns];
  for (Index from = 0; from < A.columns; from += block_depth) {
    const Index depth = std::min(block_depth, A.columns - from);
    pack<tile_columns>(columns, 0, B.columns, from, depth, packed_b);
    for (Index first = 0; first < A.rows; first += block_rows) {
      const Index rows = std::min(block_rows, A.rows - first);
      pack<tile_rows>(A, first, rows, from, depth, packed_a);
      for (Index j = 0; j < B.columns; j += tile_columns)
        for (Index i = 0; i < rows; i += tile_rows) {
          product(depth, packed_a.data() + i * depth, packed_b.data() + j * depth, tile);
          subtract_tile(tile, std::min(tile_rows, rows - i), std::min(tile_columns, B.columns - j), &C(first + i, j), C.outerStride());
        }
    }
  }
}

}  // namespace swath::calib
