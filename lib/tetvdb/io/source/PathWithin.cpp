// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/PathWithin.h"

#include "tetvdb/core/Error.h"

#include <atomic>
#include <filesystem>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> outsideAllowed{false};

bool leadsOut(const fs::path& relative) {
  return relative.empty() || relative.is_absolute() || *relative.begin() == "..";
}

} // namespace

void allowReferencesOutside(bool allowed) {
  outsideAllowed = allowed;
}

bool areReferencesAllowedOutside() {
  return outsideAllowed;
}

std::string pathWithin(const std::string& path, const std::string& name) {
  std::string slashes = name;
  for (char& c : slashes) // in files written on Windows
    c = c == '\\' ? '/' : c;
  const fs::path named = fs::path(slashes).lexically_normal();
  const fs::path folder = fs::path(path).parent_path();
  const bool bounded = !outsideAllowed;
  const auto refuse = [&](const char* how) {
    throw Error(Status::Invalid, path, "refers to '" + name + "', " + how,
                "put the files beside each other, or use `allow_outside`");
  };
  std::error_code error;
  const fs::path base = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (bounded &&
      leadsOut(named.is_absolute() ? fs::weakly_canonical(named, error).lexically_relative(base)
                                   : named))
    refuse("which lies outside its folder");
  const fs::path found = folder / named; // an absolute name alone
  if (!fs::is_regular_file(found, error))
    throw Error(Status::Invalid, path, "the file '" + found.string() + "' is missing",
                "put it where the name says");
  if (bounded && (leadsOut(fs::canonical(found, error).lexically_relative(base)) || error))
    refuse("a link out of its folder");
  return found.string();
}

} // namespace tetvdb
