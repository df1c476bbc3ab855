// SPDX-License-Identifier: GPL-3.0-or-later
// LAS and LAZ files to and from NumPy columns.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "core/error.h"
#include "io/las/las_bytes.h"
#include "io/las/las_writer.h"
#include "io/text/value_file.h"
#include "pipeline/progress.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/las_cloud.h"
#include "python/watched.h"

namespace swath::python {
namespace {

namespace fs = std::filesystem;
using core::Value;

constexpr size_t rows_at_once = 1u << 18;

/// Numbers as they lie in the bytes of an extra field, `components` to a point.
template <class T>
nb::object typed(std::vector<std::uint8_t> bytes, size_t n, int components) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  bytes = {};
  if (components == 1) return array_of(std::move(values));
  return array_of(std::move(values), {n, static_cast<size_t>(components)});
}

nb::object array_of_extra(ExtraColumn& c, size_t n) {
  if (c.has_numbers()) return array_of(std::move(c.numbers));
  const int of = c.field.components();
  std::vector<std::uint8_t>& b = c.bytes;
  switch (c.field.type == 0 ? 0 : (c.field.type - 1) % 10 + 1) {
    case 0:
      return array_of(std::move(b), {n, static_cast<size_t>(c.field.size())});
    case 1:
      return of == 1 ? array_of(std::move(b)) : array_of(std::move(b), {n, static_cast<size_t>(of)});
    case 2:
      return typed<std::int8_t>(std::move(b), n, of);
    case 3:
      return typed<std::uint16_t>(std::move(b), n, of);
    case 4:
      return typed<std::int16_t>(std::move(b), n, of);
    case 5:
      return typed<std::uint32_t>(std::move(b), n, of);
    case 6:
      return typed<std::int32_t>(std::move(b), n, of);
    case 7:
      return typed<std::uint64_t>(std::move(b), n, of);
    case 8:
      return typed<std::int64_t>(std::move(b), n, of);
    case 9:
      return typed<float>(std::move(b), n, of);
    default:
      return typed<double>(std::move(b), n, of);
  }
}

/// What Python keeps of an extra field, to write it again the same.
Value about_extra(const io::LasExtra& e) {
  Value out = Value::object();
  out["name"] = e.name;
  out["description"] = e.description;
  out["type"] = static_cast<int>(e.type);
  out["bytes"] = static_cast<int>(e.bytes);
  if (e.scale) out["scale"] = (*e.scale)[0];
  if (e.offset) out["offset"] = (*e.offset)[0];
  if (e.nodata) out["nodata"] = std::to_string((*e.nodata)[0]);
  return out;
}

io::LasExtra extra_of(const Value& v) {
  io::LasExtra e;
  e.name = v.find("name")->as_text();
  e.description = v.find("description")->as_text();
  e.type = static_cast<std::uint8_t>(v.find("type")->as_int());
  e.bytes = static_cast<std::uint8_t>(v.find("bytes")->as_int());
  if (const Value* scale = v.find("scale")) e.scale = {{scale->as_number(), 0.0, 0.0}};
  if (const Value* offset = v.find("offset")) e.offset = {{offset->as_number(), 0.0, 0.0}};
  if (const Value* nodata = v.find("nodata")) e.nodata = {{std::stoull(nodata->as_text()), 0, 0}};
  return e;
}

nb::tuple read_points(const std::vector<std::string>& files, const std::optional<std::vector<std::string>>& wanted, unsigned threads) {
  LasCloud cloud;
  std::atomic<bool> stop = false;
  run_watched([&] { cloud = read_cloud({files.begin(), files.end()}, wanted, threads, stop); }, [&] { stop = true; });
  nb::dict columns;
  for_each_las_column([&](const char* name, auto member) {
    auto& column = cloud.points.*member;
    if (!column.empty() || (cloud.size == 0 && !wanted)) columns[name] = array_of(std::move(column));
  });
  Value about = value_of(cloud.header);
  about["crs"] = cloud.crs;
  Value& extras = about["extras"] = Value::array();
  for (ExtraColumn& c : cloud.extras) {
    extras.push(about_extra(c.field));
    columns[c.field.name.c_str()] = array_of_extra(c, cloud.size);
  }
  Value& warnings = about["warnings"] = Value::array();
  for (const std::string& w : cloud.warnings) warnings.push(w);
  return nb::make_tuple(columns, io::to_json(about));
}

/// Columns that are written, as Python lent them.
class Given {
 public:
  Given(const nb::dict& columns, const io::LasHeader& header) : header_(header) {
    for (const auto& [key, value] : columns) arrays_.emplace(nb::cast<std::string>(key), nb::cast<AnyArray>(value));
    n_ = arrays_.at("x").shape(0);
    for (int k = 0; k < 3; ++k) places_[static_cast<size_t>(k)] = column_of<double>(arrays_.at(std::string(1, "xyz"[k])), n_, "x, y, z");
  }
  size_t size() const { return n_; }

  /// Rows from `first` on as LAS holds them.
  void fill(size_t first, size_t n, const std::string& where, io::LasPoints& out) const {
    io::resize(out, header_, n);
    const std::array<std::vector<std::int32_t>*, 3> raw{&out.raw_x, &out.raw_y, &out.raw_z};
    for (int k = 0; k < 3; ++k) quantise(k, first, where, *raw[static_cast<size_t>(k)]);
    const double step = header_.point_format >= 6 ? io::las_angle_step : 1.0;
    for_each_las_column([&](const char* name, auto member) {
      auto& to = out.*member;
      using T = typename std::remove_reference_t<decltype(to)>::value_type;
      const auto at = arrays_.find(name);
      if (at == arrays_.end() || to.empty() || std::strlen(name) == 1) return;  // x, y, z: from the raw ones
      const T* from = column_of<T>(at->second, n_, name);
      to.assign(from + first, from + first + n);
    });
    for (size_t i = 0; i < n; ++i) out.raw_scan_angle[i] = static_cast<std::int16_t>(std::lround(out.scan_angle[i] / step));
    for (const io::LasExtra& e : header_.extras) fill_extra(e, first, n, where, out);
  }

 private:
  void quantise(int axis, size_t first, const std::string& where, std::vector<std::int32_t>& to) const {
    const double* from = places_[static_cast<size_t>(axis)] + first;
    for (size_t i = 0; i < to.size(); ++i) {
      const double raw = std::round((from[i] - header_.offset[axis]) / header_.scale[axis]);
      if (!(raw >= std::numeric_limits<std::int32_t>::min() && raw <= std::numeric_limits<std::int32_t>::max()))
        throw core::Error(std::string(1, "xyz"[axis]) + " = " + std::to_string(from[i]) + " does not fit scale " +
                              std::to_string(header_.scale[axis]) + " and offset " + std::to_string(header_.offset[axis]),
                          where + ": row " + std::to_string(first + i), "choose a coarser scale or an offset near the data");
      to[i] = static_cast<std::int32_t>(raw);
    }
  }
  void fill_extra(const io::LasExtra& e, size_t first, size_t n, const std::string& where, io::LasPoints& out) const {
    const AnyArray& array = arrays_.at(e.name);
    if (e.type >= 1 && e.type <= 10 && (e.scale || e.nodata)) {
      const double* from = column_of<double>(array, n_, e.name);
      return io::set_las_extra_values(out, header_, e.name, {from + first, n}, where + ": rows from " + std::to_string(first));
    }
    const auto width = static_cast<size_t>(e.size()), stride = static_cast<size_t>(header_.extra_bytes());
    if (array.nbytes() != n_ * width)
      throw core::Error("is not a column of " + std::to_string(n_) + " rows", e.name, "this is a fault of the module");
    out.extra.resize(n * stride);
    const auto* from = static_cast<const std::uint8_t*>(array.data()) + first * width;
    std::uint8_t* to = out.extra.data() + *header_.extra_offset(e.name);
    for (size_t i = 0; i < n; ++i) std::memcpy(to + i * stride, from + i * width, width);
  }

  const io::LasHeader& header_;
  std::map<std::string, AnyArray> arrays_;
  std::array<const double*, 3> places_{};
  size_t n_ = 0;
};

void write_points(const std::string& file, const nb::dict& columns, const std::string& about, const std::string& crs, unsigned threads) {
  const Value value = io::parse_json(about, file);
  io::LasHeader header = header_of(value, crs);
  for (const Value& e : value.find("extras")->items()) header.extras.push_back(extra_of(e));
  const Given given(columns, header);
  std::atomic<bool> stop = false;
  run_watched(
      [&] {
        io::LasRawWriter writer(file, header, threads);
        io::LasPoints batch;
        for (size_t first = 0; first < given.size(); first += rows_at_once) {
          if (stop) throw pipeline::Interrupted();
          given.fill(first, std::min(rows_at_once, given.size() - first), file, batch);
          writer.write(batch);
        }
        writer.finish();
      },
      [&] { stop = true; });
}

}  // namespace

void bind_las_files(nb::module_& m) {
  m.def("read_points", &read_points, nb::arg("files"), nb::arg("wanted").none(), nb::arg("threads"));
  m.def("write_points", &write_points);
  nb::list names;
  for_each_las_column([&](const char* name, auto member) {
    using T = typename std::remove_reference_t<decltype(std::declval<io::LasPoints>().*member)>::value_type;
    const char* kind = std::is_floating_point_v<T> ? "f" : "u";
    names.append(nb::make_tuple(name, std::string(kind) + std::to_string(sizeof(T))));
  });
  m.attr("las_columns") = names;
}

}  // namespace swath::python
