// SPDX-License-Identifier: Apache-2.0
//
// Loaded into the program with LD_PRELOAD, runs its main() in a fork of the started process for
// every command that arrives on a socket: a start takes some 100 ms, nearly all of it for symbols
// of shared libraries, and the tests of the command line have thousands. program.py is the client.
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <string>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

extern char** environ;

namespace {

using Main = int (*)(int, char**, char**);
using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);

Main programMain = nullptr;

// Standard input, output and error, and the working folder.
using Files = std::array<int, 4>;

bool receiveAll(int socket, void* data, std::size_t size) {
  for (char* at = static_cast<char*>(data); size > 0;) {
    const ssize_t got = ::recv(socket, at, size, 0);
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

// The numbers of bytes of arguments and of environment, with the files. False when the client is
// gone.
bool receiveHead(int socket, std::array<std::uint32_t, 2>& sizes, Files& files) {
  iovec part{sizes.data(), sizeof sizes};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(Files))> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  ssize_t got;
  do
    got = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC | MSG_WAITALL);
  while (got < 0 && errno == EINTR);
  const cmsghdr* rights = CMSG_FIRSTHDR(&message);
  if (got != sizeof sizes || rights == nullptr || rights->cmsg_len != CMSG_LEN(sizeof files))
    return false;
  std::memcpy(files.data(), CMSG_DATA(rights), sizeof files);
  return true;
}

// Of texts that each end with 0.
std::vector<char*> pointersTo(std::string& texts) {
  std::vector<char*> pointers;
  for (std::size_t at = 0; at < texts.size(); at += std::strlen(&texts[at]) + 1)
    pointers.push_back(&texts[at]);
  pointers.push_back(nullptr);
  return pointers;
}

[[noreturn]] void runCommand(int socket, const Files& files, std::string& arguments,
                             std::string& environment) {
  ::close(socket);
  for (int i = 0; i < 3; ++i)
    ::dup2(files[static_cast<std::size_t>(i)], i);
  if (::fchdir(files[3]) != 0)
    ::_exit(127);
  for (const int file : files)
    ::close(file);
  // Libraries may wait for threads at their end, which a fork does not have.
  ::on_exit(
      [](int status, void*) {
        std::fflush(nullptr);
        ::_exit(status);
      },
      nullptr);
  std::vector<char*> argv = pointersTo(arguments), variables = pointersTo(environment);
  environ = variables.data();
  std::exit(programMain(static_cast<int>(argv.size()) - 1, argv.data(), environ));
}

// Answers each command with its process and, when that has ended, its status as of wait().
int serve(int socket) {
  std::array<std::uint32_t, 2> sizes{};
  for (Files files{}; receiveHead(socket, sizes, files);) {
    std::string arguments(sizes[0], '\0'), environment(sizes[1], '\0');
    if (!receiveAll(socket, arguments.data(), arguments.size()) ||
        !receiveAll(socket, environment.data(), environment.size()))
      return 1;
    const pid_t child = ::fork();
    if (child == 0)
      runCommand(socket, files, arguments, environment);
    for (const int file : files)
      ::close(file);
    std::array<std::int32_t, 2> answer{child, -1};
    if (::send(socket, &answer[0], sizeof answer[0], MSG_NOSIGNAL) < 0 || child < 0)
      return 1;
    while (::waitpid(child, &answer[1], 0) < 0 && errno == EINTR) {
    }
    if (::send(socket, &answer[1], sizeof answer[1], MSG_NOSIGNAL) < 0)
      return 1;
  }
  return 0;
}

int serverMain(int argc, char** argv, char** variables) {
  const char* socket = std::getenv("TETVDB_SERVER_SOCKET");
  return socket != nullptr ? serve(std::atoi(socket)) : programMain(argc, argv, variables);
}

} // namespace

// Called by the program's entry point when every library is ready.
extern "C" int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(),
                                 void (*linkerFini)(), void* stackEnd) {
  programMain = main;
  const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(serverMain, argc, argv, init, fini, linkerFini, stackEnd);
}
