// SPDX-License-Identifier: Apache-2.0
#include "RunLoop.h"

#include "JobOptions.h"
#include "JsonReport.h"
#include "OptionNames.h"
#include "ProgressDisplay.h"
#include "Streams.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/FileUse.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/pipeline/JobFiles.h"

#include <atomic>
#include <csignal>
#include <exception>
#include <fmt/format.h>
#include <new>
#include <stdexcept>
#include <string_view>
#include <sys/types.h>
#include <tbb/task_arena.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

/// A cancelled job is ended after that time if it is in a library that cannot be cancelled.
constexpr unsigned kCancelSeconds = 20;

std::atomic<Progress*> runningProgress{nullptr};
std::atomic<int> interruptions{0};

extern "C" void onInterrupt(int) {
  Progress* progress = runningProgress.load();
  if (interruptions.fetch_add(1) == 0 && progress != nullptr) {
    progress->cancel();
    ::alarm(kCancelSeconds);
    return;
  }
  removeTemporaryFiles();
  ::_exit(static_cast<int>(Status::Cancelled));
}

// Ends the program wherever it is.
[[noreturn]] void end(std::string_view message, Status status) {
  removeTemporaryFiles();
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(static_cast<int>(status));
}

extern "C" void onAlarm(int) {
  end("tetvdb: the job did not stop in time and was ended\n", Status::Cancelled);
}

extern "C" void onMissingPages(int) {
  end("tetvdb: a file became shorter while it was read, or cannot be read; nothing was written\n",
      Status::Invalid);
}

// Cancels `progress` on SIGINT, SIGTERM and SIGHUP while it lives, and ends the program where a
// mapped file lacks pages.
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
    action.sa_handler = onAlarm;
    ::sigaction(SIGALRM, &action, nullptr);
    action.sa_handler = onMissingPages;
    ::sigaction(SIGBUS, &action, nullptr);
  }
  ~InterruptGuard() {
    ::alarm(0);
    runningProgress.store(nullptr);
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

struct Failure {
  Status status = Status::Ok;
  std::string text;
};

Failure attempt(const std::function<void()>& work) {
  try {
    work();
    return {};
  } catch (const Error& error) {
    return {error.status(), withOptionNames(error.what())};
  } catch (const std::bad_alloc&) {
    return {Status::Limit, "out of memory; lower the resolution, read a part with --region or "
                           "--bbox, or use a machine with more memory"};
  } catch (const std::exception& error) {
    return {Status::Invalid, error.what()};
  }
}

// The files that a command reads and writes, before any work. An input that cannot be looked up is
// left to the command, which says more about it.
void declareFiles(const Command& command, FileUse& files) {
  if (!command.files)
    throw std::logic_error("the command does not say which files it reads and writes");
  const FileNames names = command.files();
  for (const std::string& path : names.read) {
    try {
      addInput(files, path);
    } catch (const Error&) {
    }
  }
  for (const std::string& path : names.written)
    files.writes(path);
}

// Whether the report can go where --json says; where it cannot, nothing may be written there.
void checkReport(const CommonOptions& options, FileUse& files) {
  files.writes(options.json);
  if (options.json.empty() || options.json == "-")
    return;
  if (!options.force)
    requireReplaceable(options.json);
  requireWritableReport(options.json);
}

void printNotes(const Session& session, Status status) {
  if (session.options.quiet && status != Status::Partial)
    return;
  for (const Warning& warning : session.report.warnings)
    printMessage("warning: " + warning.text);
  if (!session.options.verbose)
    return;
  for (const std::string& note : session.notes)
    printMessage(note);
  for (const Stage& stage : session.report.stages) {
    printMessage(fmt::format("{} took {:.3f} s, peak memory {:.0f} MB", stage.name, stage.seconds,
                             static_cast<double>(stage.peakBytes) / 1e6));
    for (const StagePart& part : stage.parts)
      printMessage(fmt::format("  {} {:.3f} s", part.name, part.seconds));
  }
}

} // namespace

int runCommand(const Command& command) {
  const CommonOptions& options = *command.common;
  Session session;
  session.options = options;
  FileUse files;
  Failure failure = attempt([&] { declareFiles(command, files); });
  const Failure noReport = attempt([&] { checkReport(options, files); });
  if (failure.status == Status::Ok)
    failure = noReport;
  if (failure.status == Status::Ok) {
    allowReferencesOutside(options.allowOutside);
    const InterruptGuard guard(session.progress);
    ProgressDisplay display(ProgressDisplay::choose(options.quiet, options.verbose),
                            session.progress, session.estimate);
    failure = attempt([&] {
      // For good: where a limit ends, oneTBB may start the threads that it forbade.
      static const auto* const allowed = new AllowThreads(tbb::this_task_arena::max_concurrency());
      static_cast<void>(allowed);
      command.run(session);
    });
  }
  for (Warning& warning : session.report.warnings)
    warning.text = withOptionNames(warning.text);
  for (std::string& note : session.notes)
    note = withOptionNames(note);
  Status status = failure.status;
  if (status == Status::Ok)
    status = session.status;
  if (status == Status::Ok && session.report.partial)
    status = Status::Partial;

  for (const std::string& line : session.errors)
    printMessage(line);
  if (failure.status == Status::Ok)
    printNotes(session, status);
  else
    printMessage(failure.text);

  try {
    const bool textWanted = failure.status == Status::Ok && !files.writesStandardOutput() &&
                            !(options.quiet && session.textIsSummary);
    if (textWanted)
      printResult(session.text);
    const std::string report = reportText(command.parser->get_name(), status, failure.text,
                                          session.report, session.sections);
    if (noReport.status == Status::Ok && options.json == "-")
      printResult(report);
    else if (noReport.status == Status::Ok && !options.json.empty())
      writeReport(options.json, report);
  } catch (const Error& error) {
    if (failure.status == Status::Ok) {
      printMessage(withOptionNames(error.what()));
      status = error.status();
    }
  }
  return static_cast<int>(status);
}

} // namespace tetvdb::cli
