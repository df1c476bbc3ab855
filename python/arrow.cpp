// SPDX-License-Identifier: GPL-3.0-or-later
// Columns for other programs by the Arrow C data interface (https://arrow.apache.org/docs/format/CDataInterface.html): a struct with a
// field per column. Buffers are those of NumPy; nothing is copied.
#include <nanobind/stl/string.h>

#include <array>
#include <cstring>
#include <memory>
#include <vector>

#include "python/arrays.h"
#include "python/bindings.h"

// The structures of the interface, as it defines them.
struct ArrowSchema {
  const char* format;
  const char* name;
  const char* metadata;
  std::int64_t flags;
  std::int64_t n_children;
  ArrowSchema** children;
  ArrowSchema* dictionary;
  void (*release)(ArrowSchema*);
  void* private_data;
};
struct ArrowArray {
  std::int64_t length, null_count, offset, n_buffers, n_children;
  const void** buffers;
  ArrowArray** children;
  ArrowArray* dictionary;
  void (*release)(ArrowArray*);
  void* private_data;
};
struct ArrowArrayStream {
  int (*get_schema)(ArrowArrayStream*, ArrowSchema* out);
  int (*get_next)(ArrowArrayStream*, ArrowArray* out);
  const char* (*get_last_error)(ArrowArrayStream*);
  void (*release)(ArrowArrayStream*);
  void* private_data;
};

namespace swath::python {
namespace {

/// A column: one value to a row, or a list of fixed length.
struct ArrowColumn {
  std::string name, format;
  const void* data = nullptr;
  std::int64_t rows = 0, per_row = 1;
};

/// The columns, and the Python objects that own them.
struct ArrowTable {
  std::vector<ArrowColumn> columns;
  std::vector<AnyArray> owners;
  std::int64_t rows = 0;
  ArrowTable() = default;
  ArrowTable(const ArrowTable&) = delete;
  ArrowTable& operator=(const ArrowTable&) = delete;
  ~ArrowTable() {
    const nb::gil_scoped_acquire lock;  // who releases may be any thread
    owners.clear();
  }
};
using Table = std::shared_ptr<const ArrowTable>;

/// The letter of the format; empty where Arrow has none.
std::string format_of(const nb::dlpack::dtype& t) {
  using Code = nb::dlpack::dtype_code;
  const std::string letters = t.code == static_cast<std::uint8_t>(Code::Float)  ? "..fg"
                              : t.code == static_cast<std::uint8_t>(Code::Int)  ? "csil"
                              : t.code == static_cast<std::uint8_t>(Code::UInt) ? "CSIL"
                                                                                : "....";
  const int place = t.bits == 8 ? 0 : t.bits == 16 ? 1 : t.bits == 32 ? 2 : t.bits == 64 ? 3 : -1;
  return place < 0 || letters[static_cast<size_t>(place)] == '.' ? "" : letters.substr(static_cast<size_t>(place), 1);
}

struct SchemaParts {
  std::string format, name;
  std::vector<ArrowSchema> children;
  std::vector<ArrowSchema*> pointers;
};

void release_schema(ArrowSchema* s) {
  auto* parts = static_cast<SchemaParts*>(s->private_data);
  for (ArrowSchema& c : parts->children)
    if (c.release) c.release(&c);
  delete parts;
  s->release = nullptr;
}

/// `children` are moved in.
void fill_schema(ArrowSchema* s, const std::string& format, const std::string& name, std::vector<ArrowSchema> children) {
  auto* parts = new SchemaParts{format, name, std::move(children), {}};
  for (ArrowSchema& c : parts->children) parts->pointers.push_back(&c);
  *s = {parts->format.c_str(),
        parts->name.c_str(),
        nullptr,
        0,
        static_cast<std::int64_t>(parts->children.size()),
        parts->pointers.data(),
        nullptr,
        release_schema,
        parts};
}

void schema_of(const ArrowTable& table, ArrowSchema* out) {
  std::vector<ArrowSchema> fields(table.columns.size());
  for (size_t i = 0; i < fields.size(); ++i) {
    const ArrowColumn& c = table.columns[i];
    std::vector<ArrowSchema> items(c.per_row == 1 ? 0 : 1);
    if (!items.empty()) fill_schema(items.data(), c.format, "item", {});
    const std::string form = items.empty() ? c.format : "+w:" + std::to_string(c.per_row);
    fill_schema(&fields[i], form, c.name, std::move(items));
  }
  fill_schema(out, "+s", "", std::move(fields));
}

struct ArrayParts {
  Table table;
  std::array<const void*, 2> buffers{};
  std::vector<ArrowArray> children;
  std::vector<ArrowArray*> pointers;
};

void release_array(ArrowArray* a) {
  auto* parts = static_cast<ArrayParts*>(a->private_data);
  for (ArrowArray& c : parts->children)
    if (c.release) c.release(&c);
  delete parts;
  a->release = nullptr;
}

/// `data`: null for a struct or a list.
void fill_array(ArrowArray* a, const Table& table, std::int64_t length, const void* data, std::vector<ArrowArray> children) {
  auto* parts = new ArrayParts{table, {nullptr, data}, std::move(children), {}};
  for (ArrowArray& c : parts->children) parts->pointers.push_back(&c);
  *a = {length,
        0,
        0,
        data ? 2 : 1,
        static_cast<std::int64_t>(parts->children.size()),
        parts->buffers.data(),
        parts->pointers.data(),
        nullptr,
        release_array,
        parts};
}

void arrays_of(const Table& table, ArrowArray* out) {
  std::vector<ArrowArray> fields(table->columns.size());
  for (size_t i = 0; i < fields.size(); ++i) {
    const ArrowColumn& c = table->columns[i];
    std::vector<ArrowArray> items(c.per_row == 1 ? 0 : 1);
    if (!items.empty()) fill_array(items.data(), table, c.rows * c.per_row, c.data, {});
    const void* own = items.empty() ? c.data : nullptr;
    fill_array(&fields[i], table, c.rows, own, std::move(items));
  }
  fill_array(out, table, table->rows, nullptr, std::move(fields));
}

Table table_of(const nb::dict& columns) {
  auto table = std::make_shared<ArrowTable>();
  for (const auto& [key, value] : columns) {
    const auto array = nb::cast<AnyArray>(value);
    ArrowColumn c{nb::cast<std::string>(key), format_of(array.dtype()), array.data(), static_cast<std::int64_t>(array.shape(0))};
    if (array.ndim() == 2) c.per_row = static_cast<std::int64_t>(array.shape(1));
    if (c.format.empty() || array.ndim() > 2) throw core::Error("a column of this type has no form in Arrow", c.name, "leave it out");
    table->rows = c.rows;
    table->columns.push_back(std::move(c));
    table->owners.push_back(array);
  }
  return table;
}

/// A capsule of the interface: whoever takes the content sets its `release` to null.
template <class T>
nb::object capsule_of(T* content, const char* name) {
  return nb::steal(PyCapsule_New(content, name, [](PyObject* capsule) {
    auto* kept = static_cast<T*>(PyCapsule_GetPointer(capsule, PyCapsule_GetName(capsule)));
    if (kept->release) kept->release(kept);
    delete kept;
  }));
}

nb::object schema_capsule(const Table& table) {
  auto* schema = new ArrowSchema;
  schema_of(*table, schema);
  return capsule_of(schema, "arrow_schema");
}

struct StreamState {
  Table table;
  bool given = false;
};

nb::object stream_capsule(const Table& table) {
  auto* stream = new ArrowArrayStream{[](ArrowArrayStream* s, ArrowSchema* out) {
                                        schema_of(*static_cast<StreamState*>(s->private_data)->table, out);
                                        return 0;
                                      },
                                      [](ArrowArrayStream* s, ArrowArray* out) {
                                        auto* state = static_cast<StreamState*>(s->private_data);
                                        *out = {};
                                        if (!state->given) arrays_of(state->table, out);
                                        state->given = true;
                                        return 0;
                                      },
                                      [](ArrowArrayStream*) -> const char* { return nullptr; },
                                      [](ArrowArrayStream* s) {
                                        delete static_cast<StreamState*>(s->private_data);
                                        s->release = nullptr;
                                      },
                                      new StreamState{table}};
  return capsule_of(stream, "arrow_array_stream");
}

}  // namespace

void bind_arrow(nb::module_& m) {
  m.def("arrow_schema", [](const nb::dict& columns) { return schema_capsule(table_of(columns)); });
  m.def("arrow_array", [](const nb::dict& columns) {
    const Table table = table_of(columns);
    auto* array = new ArrowArray;
    arrays_of(table, array);
    return nb::make_tuple(schema_capsule(table), capsule_of(array, "arrow_array"));
  });
  m.def("arrow_stream", [](const nb::dict& columns) { return stream_capsule(table_of(columns)); });
}

}  // namespace swath::python
