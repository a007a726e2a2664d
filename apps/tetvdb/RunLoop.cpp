// SPDX-License-Identifier: Apache-2.0
#include "RunLoop.h"

#include "JsonReport.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/AtomicFile.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fmt/format.h>
#include <new>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

std::atomic<Progress*> runningProgress{nullptr};
std::atomic<int> interruptions{0};

extern "C" void onInterrupt(int) {
  Progress* progress = runningProgress.load();
  if (interruptions.fetch_add(1) == 0 && progress != nullptr) {
    progress->cancel();
    return;
  }
  removeTemporaryFiles();
  ::_exit(static_cast<int>(Status::Cancelled));
}

// Cancels `progress` on SIGINT, SIGTERM and SIGHUP while it lives.
class InterruptGuard {
public:
  explicit InterruptGuard(Progress& progress) {
    runningProgress.store(&progress);
    struct sigaction action {};
    action.sa_handler = onInterrupt;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction before {};
      // A signal that is ignored from outside (nohup) stays ignored.
      if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN)
        continue;
      ::sigaction(signal, &action, nullptr);
    }
  }
  ~InterruptGuard() { runningProgress.store(nullptr); }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

struct Failure {
  Status status = Status::Ok;
  std::string text;
};

Failure attempt(Session& session, const std::function<void(Session&)>& command) {
  try {
    if (session.options.json != "-" && !session.options.json.empty())
      requireWritableReport(session.options.json);
    command(session);
    return {};
  } catch (const Error& error) {
    return {error.status(), error.what()};
  } catch (const std::bad_alloc&) {
    return {Status::Limit, "out of memory; lower the resolution, read a part with --region or "
                           "--bbox, or use a machine with more memory"};
  } catch (const std::exception& error) {
    return {Status::Invalid, error.what()};
  }
}

void printNotes(const Session& session) {
  if (session.options.quiet)
    return;
  for (const Warning& warning : session.report.warnings)
    fmt::print(stderr, "tetvdb: warning: {}\n", oneLine(warning.text));
  if (!session.options.verbose)
    return;
  for (const std::string& note : session.notes)
    fmt::print(stderr, "tetvdb: {}\n", oneLine(note));
  for (const Stage& stage : session.report.stages) {
    fmt::print(stderr, "tetvdb: {} took {:.3f} s, peak memory {:.0f} MB\n", stage.name,
               stage.seconds, static_cast<double>(stage.peakBytes) / 1e6);
    for (const StagePart& part : stage.parts)
      fmt::print(stderr, "tetvdb:   {} {:.3f} s\n", oneLine(part.name), part.seconds);
  }
}

void printResult(const std::string& text) {
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!whole || std::fflush(stdout) != 0)
    throw Error(Status::Write, "standard output",
                fmt::format("cannot write: {}", std::strerror(errno)));
}

} // namespace

void printError(const std::string& text) {
  fmt::print(stderr, "tetvdb: {}\n", oneLine(text));
}

int runCommand(const std::string& name, const CommonOptions& options,
               const std::function<void(Session&)>& command) {
  Session session;
  session.options = options;
  Failure failure;
  {
    const InterruptGuard guard(session.progress);
    ProgressDisplay display(ProgressDisplay::choose(options.quiet, options.verbose),
                            session.progress);
    failure = attempt(session, command);
  }
  Status status = failure.status;
  if (status == Status::Ok)
    status = session.status;
  if (status == Status::Ok && session.report.partial)
    status = Status::Partial;

  for (const std::string& line : session.errors)
    printError(line);
  if (failure.status == Status::Ok)
    printNotes(session);
  else
    printError(failure.text);

  try {
    const bool textWanted = failure.status == Status::Ok && options.json != "-" &&
                            !(options.quiet && session.textIsSummary);
    if (textWanted)
      printResult(session.text);
    const std::string report = reportText(name, status, failure.text, session);
    if (options.json == "-")
      printResult(report);
    else if (!options.json.empty())
      writeReport(options.json, report);
  } catch (const Error& error) {
    if (failure.status == Status::Ok)
      printError(error.what());
    if (failure.status == Status::Ok)
      status = error.status();
  }
  return static_cast<int>(status);
}

} // namespace tetvdb::cli
