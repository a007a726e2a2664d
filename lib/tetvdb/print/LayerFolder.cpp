// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerFolder.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

// Digits between the stem and any ending of three letters.
bool isLayer(const std::string& name, std::string_view stem) {
  return name.size() > stem.size() + 4 && name.compare(0, stem.size(), stem) == 0 &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(stem.size()), name.end() - 4,
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

} // namespace

LayerFolder::LayerFolder(std::string path, std::string_view stem, std::string_view ending)
    : stem_(stem), ending_(ending),
      folder_(std::move(path), {"layers", "manifest.json",
                                [stem](const std::string& name) { return isLayer(name, stem); }}) {}

[[noreturn]] void LayerFolder::fail(const char* what) const {
  throw Error(Status::Write, folder_.target(), fmt::format("{}: {}", what, std::strerror(errno)));
}

std::string LayerFolder::nameOf(std::int32_t k) const {
  return fmt::format("{}{:05}{}", stem_, k, ending_);
}

void LayerFolder::write(const std::string& name, std::string_view bytes) {
  const std::string file = folder_.temporary() + "/" + name;
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_CLOEXEC | O_WRONLY, 0666);
  if (descriptor < 0)
    fail("cannot create a file in it");
  const char* at = bytes.data();
  for (std::size_t left = bytes.size(); left > 0;) {
    const ssize_t n = ::write(descriptor, at, left);
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0) {
      const int why = errno;
      ::close(descriptor);
      errno = why;
      fail("cannot write");
    }
    at += n;
    left -= static_cast<std::size_t>(n);
  }
  if (::close(descriptor) != 0)
    fail("cannot write");
  bytes_ += bytes.size();
}

} // namespace tetvdb
