// SPDX-License-Identifier: Apache-2.0
#include "Report.h"

namespace tetvdb::python {

nb::object reportDict(const ReportText& report) {
  if (!report)
    return nb::dict();
  const std::string text = report();
  return nb::module_::import_("json").attr("loads")(nb::str(text.c_str(), text.size()));
}

std::string pathOf(nb::handle object) {
  PyObject* path = PyOS_FSPath(object.ptr());
  if (path == nullptr)
    throw nb::python_error();
  nb::object held = nb::steal(path);
  if (PyUnicode_Check(held.ptr()) != 0)
    held = nb::steal(PyUnicode_EncodeFSDefault(held.ptr()));
  if (!held.is_valid())
    throw nb::python_error();
  return {PyBytes_AsString(held.ptr()), static_cast<std::size_t>(PyBytes_Size(held.ptr()))};
}

} // namespace tetvdb::python
