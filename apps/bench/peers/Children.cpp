// SPDX-License-Identifier: Apache-2.0
#include "Children.h"

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tetvdb::bench {

extern const char* const kVtkScript; // made from vtk_resample.py

namespace {

bool readAll(int file, void* data, std::size_t size) {
  auto* to = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = read(file, to, size);
    if (got <= 0)
      return false;
    to += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool writeAll(int file, const void* data, std::size_t size) {
  const auto* from = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t put = write(file, from, size);
    if (put <= 0)
      return false;
    from += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

[[noreturn]] void execute(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
  _exit(127);
}

ChildResult runHere(const std::vector<std::string>& command) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    execute(command);
  }
  ChildResult result;
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child)
    return result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  result.peakBytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  return result;
}

// Commands come as a word count, and each word as its length and its letters.
void serve(int socket) {
  std::uint32_t words = 0;
  while (readAll(socket, &words, sizeof words)) {
    std::vector<std::string> command(words);
    for (std::string& word : command) {
      std::uint32_t size = 0;
      if (!readAll(socket, &size, sizeof size))
        return;
      word.resize(size);
      if (!readAll(socket, word.data(), size))
        return;
    }
    const ChildResult result = runHere(command);
    if (!writeAll(socket, &result, sizeof result))
      return;
  }
}

} // namespace

Launcher::Launcher() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error("cannot make a socket pair");
  process_ = fork();
  if (process_ == 0) {
    close(ends[0]);
    serve(ends[1]);
    _exit(0);
  }
  close(ends[1]);
  socket_ = ends[0];
}

Launcher::~Launcher() {
  close(socket_); // its reading ends
  waitpid(process_, nullptr, 0);
}

ChildResult Launcher::run(const std::vector<std::string>& command) {
  const auto words = static_cast<std::uint32_t>(command.size());
  bool sent = writeAll(socket_, &words, sizeof words);
  for (const std::string& word : command) {
    const auto length = static_cast<std::uint32_t>(word.size());
    sent = sent && writeAll(socket_, &length, sizeof length) &&
           writeAll(socket_, word.data(), word.size());
  }
  ChildResult result;
  if (!sent || !readAll(socket_, &result, sizeof result))
    throw std::runtime_error("the process that starts programs is gone");
  return result;
}

VtkPeer::VtkPeer(const std::string& mesh, const std::string& array, int threads) {
  const std::vector<std::string> command = {"/usr/bin/python3",     "-c", kVtkScript, mesh, array,
                                            std::to_string(threads)};
  int request[2], answer[2];
  if (pipe2(request, O_CLOEXEC) != 0 || pipe2(answer, O_CLOEXEC) != 0) {
    why_ = "no pipes";
    return;
  }
  std::signal(SIGPIPE, SIG_IGN);
  process_ = fork();
  if (process_ == 0) {
    dup2(request[0], STDIN_FILENO);
    dup2(answer[1], STDOUT_FILENO);
    execute(command);
  }
  close(request[0]);
  close(answer[1]);
  to_ = fdopen(request[1], "w");
  from_ = fdopen(answer[0], "r");
  const std::string hello = line();
  if (hello.rfind("ready ", 0) == 0) {
    available_ = true;
    version_ = hello.substr(6);
  } else {
    why_ = hello.empty() ? "/usr/bin/python3 cannot be run" : hello;
  }
}

VtkPeer::~VtkPeer() {
  if (to_ != nullptr)
    std::fclose(to_);
  if (from_ != nullptr)
    std::fclose(from_);
  if (process_ > 0)
    waitpid(process_, nullptr, 0);
}

std::size_t VtkPeer::peakBytes() const {
  std::ifstream status("/proc/" + std::to_string(process_) + "/status");
  for (std::string text; std::getline(status, text);)
    if (text.rfind("VmHWM:", 0) == 0)
      return std::strtoull(text.c_str() + 6, nullptr, 10) * 1024;
  return 0;
}

std::string VtkPeer::line() {
  std::string text;
  for (int c = std::fgetc(from_); c != EOF && c != '\n'; c = std::fgetc(from_))
    text += static_cast<char>(c);
  return text;
}

double VtkPeer::run(const VoxelBox& box, const GridTransform& transform) {
  double low[3], high[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const double h = transform.voxelSize[k];
    low[k] = transform.origin[k] + box.min[k] * h;
    high[k] = transform.origin[k] + (box.min[k] + box.size[k] - 1) * h;
  }
  return run({box.size[0], box.size[1], box.size[2]}, low, high);
}

double VtkPeer::run(const int (&size)[3], const double (&low)[3], const double (&high)[3]) {
  std::fprintf(to_, "%d %d %d %.17g %.17g %.17g %.17g %.17g %.17g\n", size[0], size[1], size[2],
               low[0], high[0], low[1], high[1], low[2], high[2]);
  std::fflush(to_);
  const std::string answer = line();
  char* end = nullptr;
  const double seconds = std::strtod(answer.c_str(), &end);
  if (end == answer.c_str())
    throw std::runtime_error("VTK's process failed: " + answer);
  activeVoxels_ = std::strtoull(end, nullptr, 10);
  return seconds;
}

} // namespace tetvdb::bench
