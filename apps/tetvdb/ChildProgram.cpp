// SPDX-License-Identifier: Apache-2.0
#include "ChildProgram.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <string_view>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace tetvdb::cli {
namespace {

using Clock = std::chrono::steady_clock;

const char* const kParent = "TETVDB_PARENT"; ///< in a child's environment: the parent's number

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace

int startThisProgram(std::vector<std::string> words,
                     const std::function<void(posix_spawn_file_actions_t&)>& addFiles,
                     pid_t& child) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words)
    pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::string parent = kParent + ("=" + std::to_string(::getpid()));
  std::vector<char*> environment{parent.data()};
  for (char** one = environ; *one != nullptr; ++one)
    if (std::string_view(*one).substr(0, parent.find('=') + 1) !=
        std::string_view(parent).substr(0, parent.find('=') + 1))
      environment.push_back(*one);
  environment.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  addFiles(files);
  const int failed =
      posix_spawn(&child, "/proc/self/exe", &files, nullptr, pointers.data(), environment.data());
  posix_spawn_file_actions_destroy(&files);
  return failed;
}

bool endWithParent(int signal) {
  const char* parent = std::getenv(kParent);
  if (parent == nullptr)
    return false;
  ::prctl(PR_SET_PDEATHSIG, signal);
  if (std::to_string(::getppid()) == parent)
    return true;
  ::prctl(PR_SET_PDEATHSIG, 0); // it has ended, or the variable came from elsewhere
  return false;
}

ChildEnd runThisProgram(const std::vector<std::string>& arguments, double maxSeconds,
                        const Progress& progress) {
  ChildEnd end;
  const Clock::time_point began = Clock::now();
  std::vector<std::string> words = {"tetvdb"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto addFiles = [](posix_spawn_file_actions_t& files) {
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  };
  pid_t child = -1;
  if (startThisProgram(std::move(words), addFiles, child) != 0)
    return end;
  int status = 0;
  rusage usage{};
  bool killed = false;
  for (auto pause = std::chrono::milliseconds(1); wait4(child, &status, WNOHANG, &usage) == 0;) {
    if (!killed && (progress.cancelled() || since(began) > maxSeconds)) {
      ::kill(child, progress.cancelled() ? SIGTERM : SIGKILL);
      killed = true;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(10));
  }
  progress.check();
  end.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  end.seconds = since(began);
  end.peakBytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  return end;
}

} // namespace tetvdb::cli
