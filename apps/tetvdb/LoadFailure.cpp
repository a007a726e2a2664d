// SPDX-License-Identifier: Apache-2.0
//
// A library that OpenVDB uses for its log starts four threads while the program is loaded. Where
// they cannot be started it throws, before main(): that is said, and no abort.
#include "tetvdb/core/Error.h"

#include <exception>
#include <string_view>
#include <sys/types.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

[[noreturn]] void endWithoutThreads() {
  constexpr std::string_view kText =
      "tetvdb: threads cannot be started: raise the limit of processes (ulimit -u) or of address "
      "space (ulimit -v)\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText.data(), kText.size());
  ::_exit(static_cast<int>(Status::Limit));
}

void expectFailure(int, char**, char**) {
  std::set_terminate(endWithoutThreads); // main() sets another
}

// Called before the libraries are initialized.
__attribute__((section(".preinit_array"),
               used)) void (*const kBeforeLibraries)(int, char**, char**) = expectFailure;

} // namespace
} // namespace tetvdb::cli
