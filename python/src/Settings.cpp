// SPDX-License-Identifier: Apache-2.0
#include "Settings.h"

#include "ParseQuantities.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanobind/stl/string.h>

namespace tetvdb::python {
namespace {

std::string quoted(const char* name) {
  return "`" + std::string(name) + "`";
}

bool isText(nb::handle value) {
  return nb::isinstance<nb::str>(value);
}

std::string shown(nb::handle value) {
  return nb::cast<std::string>(nb::repr(value));
}

// As the command line would be given it: numbers, those of NumPy too, with all their digits.
std::string textOfItem(nb::handle value) {
  if (isText(value))
    return nb::cast<std::string>(value);
  nb::object number;
  if (PyIndex_Check(value.ptr()) != 0)
    number = nb::steal(PyNumber_Index(value.ptr()));
  else if (const double real = PyFloat_AsDouble(value.ptr()); PyErr_Occurred() == nullptr)
    number = nb::float_(real);
  PyErr_Clear();
  return shown(number.is_valid() ? number : nb::borrow(value));
}

} // namespace

void Settings::refuse(const char* name, const std::string& what, const std::string& advice) {
  throw Error(Status::Usage, quoted(name), what, advice);
}

nb::object Settings::get(const char* name) const {
  PyObject* value = PyDict_GetItemString(values_.ptr(), name);
  return value == nullptr ? nb::none() : nb::borrow(value);
}

bool Settings::has(const char* name) {
  known_.emplace_back(name);
  PyObject* value = PyDict_GetItemString(values_.ptr(), name);
  return value != nullptr && value != Py_None;
}

std::string Settings::textOf(const char* name) const {
  const nb::object value = get(name);
  if (!isText(value))
    refuse(name, shown(value) + " is no text", "give a str");
  return nb::cast<std::string>(value);
}

double Settings::numberOf(const char* name) const {
  const nb::object value = get(name);
  const double number = isText(value) ? -1 : PyFloat_AsDouble(value.ptr());
  if (isText(value) || (number == -1 && PyErr_Occurred() != nullptr)) {
    PyErr_Clear();
    refuse(name, shown(value) + " is no number", "give a number");
  }
  if (!std::isfinite(number))
    refuse(name, shown(value) + " is not finite", "give a finite number");
  return number;
}

void Settings::take(const char* name, bool& value) {
  if (!has(name))
    return;
  const int truth = PyObject_IsTrue(get(name).ptr());
  if (truth < 0) {
    PyErr_Clear();
    refuse(name, shown(get(name)) + " is neither true nor false", "give True or False");
  }
  value = truth != 0;
}

void Settings::take(const char* name, int& value) {
  if (!has(name))
    return;
  const double number = numberOf(name);
  if (number != std::floor(number) || std::abs(number) > std::numeric_limits<int>::max())
    refuse(name, shown(get(name)) + " is no whole number", "give an int");
  value = static_cast<int>(number);
}

void Settings::takeWhole(const char* name, std::uint64_t low, std::uint64_t high,
                         std::uint64_t& value) {
  if (!has(name))
    return;
  const double number = numberOf(name);
  if (number != std::floor(number) || number < static_cast<double>(low) ||
      number > static_cast<double>(high))
    refuse(name, shown(get(name)) + " cannot be used",
           "give a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  value = static_cast<std::uint64_t>(number);
}

void Settings::take(const char* name, double& value) {
  if (has(name))
    value = numberOf(name);
}

void Settings::take(const char* name, std::string& value) {
  if (has(name))
    value = textOf(name);
}

void Settings::take(const char* name, std::vector<std::string>& value) {
  if (!has(name))
    return;
  const nb::object given = get(name);
  value.clear();
  if (!isText(given) && PySequence_Check(given.ptr()) != 0) {
    for (const nb::handle item : given)
      value.push_back(textOfItem(item));
    return;
  }
  const std::string text = textOfItem(given);
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    value.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

void Settings::takePoint(const char* name, Vec3d& value) {
  if (!has(name))
    return;
  const nb::object given = get(name);
  if (isText(given)) {
    value = cli::parsePoint(quoted(name), textOf(name));
    return;
  }
  std::size_t axis = 0;
  if (PySequence_Check(given.ptr()) != 0)
    for (const nb::handle item : given) {
      const double number = PyFloat_AsDouble(item.ptr());
      if (number == -1 && PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        axis = 4;
        break;
      }
      if (axis < 3)
        value[axis] = number;
      ++axis;
    }
  if (axis != 3 || !(std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2])))
    refuse(name, shown(given) + " is no point", "give three finite numbers");
}

void Settings::takePair(const char* name, std::vector<double>& value) {
  if (!has(name))
    return;
  const nb::object given = get(name);
  value.clear();
  bool isNumbers = !isText(given) && PySequence_Check(given.ptr()) != 0;
  if (isNumbers)
    for (const nb::handle item : given) {
      value.push_back(PyFloat_AsDouble(item.ptr()));
      isNumbers = isNumbers && PyErr_Occurred() == nullptr && std::isfinite(value.back());
      PyErr_Clear();
    }
  if (!isNumbers || value.size() != 2)
    refuse(name, shown(given) + " cannot be used", "give two numbers");
}

void Settings::takeLength(const char* name, double& value) {
  if (!has(name))
    return;
  const double number = numberOf(name);
  if (!(number > 0))
    refuse(name, shown(get(name)) + " is not a length", "give a number above zero");
  value = number;
}

void Settings::takeRelative(const char* name, RelativeLength& value, bool voxels) {
  if (has(name))
    value = cli::parseRelativeLength(quoted(name), textOfItem(get(name)),
                                     voxels ? cli::Voxels::Known : cli::Voxels::None);
}

JobLimits Settings::takeLimits() {
  JobLimits limits;
  limits.threads = defaultThreads();
  take("threads", limits.threads);
  if (has("threads") && (limits.threads < 1 || limits.threads > 4096))
    refuse("threads", shown(get("threads")) + " cannot be used", "give a number from 1 to 4096");
  if (has("max_memory"))
    limits.maxMemory = cli::parseBytes(quoted("max_memory"), textOfItem(get("max_memory")));
  takeLength("max_time", limits.maxTime);
  return limits;
}

void Settings::takeSize(Vec3d& voxelSize, int& resolution) {
  if (has("voxel_size")) {
    if (has("resolution"))
      refuse("resolution", "and `voxel_size` were given", "leave one of them out");
    const nb::object given = get("voxel_size");
    if (!isText(given) && PySequence_Check(given.ptr()) != 0) {
      takePoint("voxel_size", voxelSize);
    } else if (isText(given)) {
      voxelSize = cli::parseVoxelSize(quoted("voxel_size"), textOf("voxel_size"));
    } else {
      double side = 0;
      takeLength("voxel_size", side);
      voxelSize = {side, side, side};
    }
    if (!(voxelSize[0] > 0 && voxelSize[1] > 0 && voxelSize[2] > 0))
      refuse("voxel_size", shown(given) + " cannot be used",
             "a voxel's side must be above zero, in the input's units");
  }
  take("resolution", resolution);
  if (has("resolution") && resolution < 1)
    refuse("resolution", shown(get("resolution")) + " cannot be used",
           "give a number of voxels above zero");
}

void Settings::takeCleaning(CleanOptions& clean) {
  if (has("weld")) {
    const double distance = numberOf("weld");
    if (distance < 0)
      refuse("weld", shown(get("weld")) + " is not a length", "give 0, or a number above zero");
    clean.weldDistance = distance;
  }
  bool keep = false;
  take("keep_orientation", keep);
  clean.orient = !keep;
}

void Settings::takeInside(SolidOptions& solid) {
  takeWord("inside",
           {{"winding", InsideRule::Winding},
            {"nonzero", InsideRule::NonZero},
            {"parity", InsideRule::Parity},
            {"flood", InsideRule::Flood}},
           solid.inside);
  takeLength("shell", solid.shell);
}

void Settings::finish() {
  for (const auto& [name, value] : values_) {
    const std::string text = nb::cast<std::string>(name);
    if (std::find(known_.begin(), known_.end(), text) == known_.end())
      throw nb::type_error(("unknown setting '" + text + "'").c_str());
  }
}

} // namespace tetvdb::python
