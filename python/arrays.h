// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of numbers between C++ and NumPy without copies.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace swath::python {

namespace nb = nanobind;

/// A C-contiguous array of any numbers, as Python gives it.
using AnyArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;

/// What a vector held, as a read-only NumPy array of the shape that owns it: nothing is copied.
template <class T>
nb::object array_of(std::vector<T> values, const std::vector<size_t>& shape) {
  if (values.empty()) values.reserve(1);  // so that it has a place
  auto* kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, const T>(kept->data(), shape.size(), shape.data(), owner));
}
template <class T>
nb::object array_of(std::vector<T> values) {
  const size_t n = values.size();
  return array_of(std::move(values), {n});
}

/// The elements of a one-dimensional array of exactly this type. Throws core::Error naming `name`.
template <class T>
const T* column_of(const AnyArray& array, size_t n, const std::string& name) {
  if (array.dtype() != nb::dtype<T>() || array.ndim() != 1 || array.shape(0) != n)
    throw core::Error("is not a column of " + std::to_string(n) + " numbers of the expected type", name, "this is a fault of the module");
  return static_cast<const T*>(array.data());
}

}  // namespace swath::python
