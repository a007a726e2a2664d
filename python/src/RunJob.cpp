// SPDX-License-Identifier: Apache-2.0
#include "RunJob.h"

#include <atomic>
#include <pthread.h>

namespace tetvdb::python {
namespace {

PyObject* errorType = nullptr;
PyObject* warningType = nullptr;

std::atomic<bool> isForked{false};

constexpr std::chrono::milliseconds kPollInterval{20};

// Error::status() as a word.
const char* codeOf(Status status) {
  constexpr const char* kCodes[] = {"ok",        "partial", "usage", "invalid", "limit",
                                    "cancelled", "device",  "write", "found"};
  return kCodes[static_cast<std::size_t>(status)];
}

void raise(const Error& error) {
  const nb::object instance = nb::steal(PyObject_CallFunction(errorType, "s", error.what()));
  if (!instance.is_valid())
    return; // Python has an error of its own set
  const nb::object status = nb::int_(static_cast<int>(error.status()));
  const nb::object code = nb::str(codeOf(error.status()));
  if (PyObject_SetAttrString(instance.ptr(), "status", status.ptr()) == 0 &&
      PyObject_SetAttrString(instance.ptr(), "code", code.ptr()) == 0)
    PyErr_SetObject(errorType, instance.ptr());
}

} // namespace

void addErrors(nb::module_& module) {
  errorType = PyErr_NewExceptionWithDoc(
      "tetvdb.Error",
      "What the library refuses or cannot do.\n\n"
      "status: the exit status that the command line has for it, 2 to 7.\n"
      "code: the same as a word: usage, invalid, limit, cancelled, device or write.",
      PyExc_RuntimeError, nullptr);
  warningType =
      PyErr_NewExceptionWithDoc("tetvdb.MeshWarning",
                                "What a job found or did that its caller should know; the "
                                "report's \"warnings\" has the same with codes.",
                                PyExc_UserWarning, nullptr);
  if (errorType == nullptr || warningType == nullptr)
    throw nb::python_error();
  module.attr("Error") = nb::handle(errorType);
  module.attr("MeshWarning") = nb::handle(warningType);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    }
  });
}

void watchForks() {
  ::pthread_atfork(nullptr, nullptr, [] { isForked.store(true); });
}

int defaultThreads() {
  return isForked.load() ? 1 : 0;
}

SignalPoll::SignalPoll(Progress& progress)
    : progress_(progress), next_(Clock::now() + kPollInterval) {
  progress_.onCheck([this] { poll(); });
}

SignalPoll::~SignalPoll() {
  progress_.onCheck({});
}

void SignalPoll::poll() {
  if (std::this_thread::get_id() != caller_ || raised_)
    return;
  const Clock::time_point now = Clock::now();
  if (now < next_)
    return;
  next_ = now + kPollInterval;
  const nb::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() != 0) {
    raised_.emplace();
    progress_.cancel();
  }
}

void SignalPoll::rethrow() {
  if (!raised_)
    return;
  nb::python_error error = std::move(*raised_);
  raised_.reset();
  throw error;
}

void issueWarnings(const Report& report, std::size_t first) {
  // Of the line that called the function in Python.
  for (std::size_t i = first; i < report.warnings.size(); ++i)
    if (PyErr_WarnEx(warningType, report.warnings[i].text.c_str(), 2) != 0)
      throw nb::python_error();
}

} // namespace tetvdb::python
