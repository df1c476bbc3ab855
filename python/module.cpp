// SPDX-License-Identifier: GPL-3.0-or-later
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <exception>

#include "core/error.h"
#include "pipeline/provenance.h"
#include "python/bindings.h"

namespace swath::python {
namespace {

namespace nb = nanobind;

/// core::Error becomes swath.Error with what, where, hint and code.
void raise_error(const core::Error& e) {
  try {
    const nb::object type = nb::module_::import_("swath._errors").attr("Error");
    const nb::object made = type(std::string(e.what()), e.where(), e.hint(), static_cast<int>(e.code()));
    PyErr_SetObject(type.ptr(), made.ptr());
  } catch (nb::python_error& fault) {
    fault.restore();
  }
}

void translate(const std::exception_ptr& fault, void* /*payload*/) {
  try {
    std::rethrow_exception(fault);
  } catch (const core::Error& e) {
    raise_error(e);
  }
}

}  // namespace
}  // namespace swath::python

NB_MODULE(_swath, m) {
  using namespace swath::python;
  nanobind::register_exception_translator(translate);
  m.attr("version") = nanobind::str(swath::pipeline::program_version().data(), swath::pipeline::program_version().size());
  bind_las_files(m);
  bind_arrow(m);
  bind_runs(m);
  bind_declared(m);
  bind_other_files(m);
}
