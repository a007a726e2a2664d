// SPDX-License-Identifier: Apache-2.0
#include "DatasetWorkers.h"

#include "ChildProgram.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRowDescriptor = 3;
constexpr int kPollMilliseconds = 50;
constexpr std::size_t kMaxStartsWithoutRow = 20; // one after the other: the program cannot start

/// Closed in children.
class Pipe {
public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw Error(Status::Limit, "", std::string("no pipe can be made: ") + std::strerror(errno));
  }
  ~Pipe() {
    closeFrom();
    closeTo();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int from() const { return ends_[0]; }
  int to() const { return ends_[1]; }
  void closeFrom() { close(ends_[0]); }
  void closeTo() { close(ends_[1]); }

private:
  static void close(int& end) {
    if (end >= 0)
      ::close(end);
    end = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

// The arguments of this process and --worker, each with a zero at its end.
std::vector<std::string> workerWords() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string all(std::istreambuf_iterator<char>(file), {});
  std::vector<std::string> words;
  for (std::size_t at = 0; at < all.size();) {
    words.emplace_back(all.c_str() + at);
    at += words.back().size() + 1;
  }
  words.emplace_back("--worker");
  return words;
}

/// One child process and the item that it works on.
class Worker {
public:
  Worker() { start(); }
  ~Worker() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  int rows() const { return rows_.from(); }
  const DatasetItem* item() const { return item_; }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

  void give(const DatasetItem& item) {
    item_ = &item;
    began_ = Clock::now();
    std::string text;
    for (const std::string& field : {item.entry.id, item.entry.path, item.entry.className,
                                     item.entry.split, std::to_string(item.variant)})
      text.append(field).push_back('\0'); // names of files may hold any other byte
    // If the child died meanwhile, this is noticed where rows are read.
    (void)!::write(items_.to(), text.data(), text.size());
  }

  /// Reads what is there. False: the child has closed its end.
  bool read() {
    std::array<char, 1 << 16> bytes{};
    const ssize_t some = ::read(rows_.from(), bytes.data(), bytes.size());
    if (some > 0)
      text_.append(bytes.data(), static_cast<std::size_t>(some));
    return some > 0 || (some < 0 && errno == EINTR);
  }

  /// The row of the item, once it is there; the worker is free then.
  std::unique_ptr<DatasetRow> takeRow() {
    const std::size_t end = text_.find('\n');
    if (end == text_.npos)
      return nullptr;
    auto row = std::make_unique<DatasetRow>(
        DatasetRow::parse(std::string_view(text_).substr(0, end), nullptr, false));
    text_.erase(0, end + 1);
    item_ = nullptr;
    return row;
  }

  /// Ends the child; says how it ended.
  std::string end() {
    ::kill(child_, SIGKILL);
    int status = 0;
    ::waitpid(child_, &status, 0);
    child_ = -1;
    if (WIFSIGNALED(status))
      return fmt::format("the process was ended by signal {} ({})", WTERMSIG(status),
                         ::strsignal(WTERMSIG(status)));
    return fmt::format("the process ended with status {}", WEXITSTATUS(status));
  }

private:
  void start() {
    const int failed = startThisProgram(
        workerWords(),
        [&](posix_spawn_file_actions_t& files) {
          posix_spawn_file_actions_adddup2(&files, items_.from(), STDIN_FILENO);
          // Its own number would keep close-on-exec.
          if (rows_.to() == kRowDescriptor)
            ::fcntl(rows_.to(), F_SETFD, 0);
          else
            posix_spawn_file_actions_adddup2(&files, rows_.to(), kRowDescriptor);
        },
        child_);
    if (failed != 0) {
      child_ = -1;
      throw Error(Status::Limit, "",
                  std::string("no process can be started: ") + std::strerror(failed));
    }
    items_.closeFrom();
    rows_.closeTo();
  }

  Pipe items_, rows_;
  pid_t child_ = -1;
  const DatasetItem* item_ = nullptr;
  Clock::time_point began_;
  std::string text_;
};

} // namespace

void makeInWorkers(const std::vector<DatasetItem>& items, const WorkerOptions& options,
                   const std::function<void(const DatasetRow&)>& take, Progress& progress) {
  const std::size_t count =
      std::min<std::size_t>(static_cast<std::size_t>(std::max(options.count, 1)), items.size());
  std::vector<std::unique_ptr<Worker>> workers(count);
  std::size_t next = 0, done = 0, barren = 0;
  const auto ended = [&](const DatasetRow& row) {
    take(row);
    progress.update(double(++done) / double(items.size()));
  };
  const auto fail = [&](std::unique_ptr<Worker>& worker, Status status, const std::string& why) {
    ended(failureRow(*worker->item(), status, why, "", worker->seconds()));
    worker.reset();
  };
  while (done < items.size()) {
    progress.check();
    std::vector<pollfd> waits;
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < count; ++i) {
      if (!workers[i] && next < items.size())
        workers[i] = std::make_unique<Worker>();
      if (workers[i] && workers[i]->item() == nullptr && next < items.size())
        workers[i]->give(items[next++]);
      if (!workers[i] || workers[i]->item() == nullptr)
        continue;
      waits.push_back({workers[i]->rows(), POLLIN, 0});
      of.push_back(i);
    }
    ::poll(waits.data(), waits.size(), kPollMilliseconds);
    for (std::size_t k = 0; k < of.size(); ++k) {
      std::unique_ptr<Worker>& worker = workers[of[k]];
      if (waits[k].revents != 0) {
        const bool alive = worker->read();
        if (const std::unique_ptr<DatasetRow> row = worker->takeRow();
            row != nullptr && row->is_object()) {
          barren = 0;
          ended(*row);
        } else if (!alive) {
          if (++barren > kMaxStartsWithoutRow)
            throw Error(Status::Limit, "", "every process ends at once: " + worker->end());
          const std::string why = worker->end();
          fail(worker, Status::Invalid, why);
          continue;
        }
      }
      if (worker->item() != nullptr && options.maxSeconds > 0 &&
          worker->seconds() > options.maxSeconds) {
        worker->end();
        fail(worker, Status::Cancelled,
             fmt::format("not done after {:g} seconds", options.maxSeconds));
      }
    }
  }
}

void serveItems(const std::function<DatasetRow(const DatasetItem&)>& make) {
  // An item waits in the pipe already; the next --resume makes it as well, under the same names.
  if (!endWithParent(SIGKILL))
    return;
  std::signal(SIGINT, SIG_IGN); // the terminal sends it to the parent too, which ends this process
  ::fcntl(kRowDescriptor, F_SETFD, FD_CLOEXEC);
  for (;;) {
    std::array<std::string, 5> fields;
    for (std::string& field : fields)
      if (!std::getline(std::cin, field, '\0'))
        return;
    const DatasetItem item{{fields[1], fields[0], fields[2], fields[3]}, std::stoi(fields[4])};
    const std::string row =
        make(item).dump(-1, ' ', false, DatasetRow::error_handler_t::replace) + "\n";
    for (std::size_t at = 0; at < row.size();) {
      const ssize_t some = ::write(kRowDescriptor, row.data() + at, row.size() - at);
      if (some < 0 && errno != EINTR)
        return;
      at += some > 0 ? static_cast<std::size_t>(some) : 0;
    }
  }
}

} // namespace tetvdb::cli
