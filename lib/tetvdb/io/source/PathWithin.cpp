// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/PathWithin.h"

#include "tetvdb/core/Error.h"

#include <filesystem>

namespace tetvdb {

namespace fs = std::filesystem;

std::string pathWithin(const std::string& path, const std::string& name) {
  std::string slashes = name;
  for (char& c : slashes) // of files that were written on Windows
    c = c == '\\' ? '/' : c;
  const fs::path relative = fs::path(slashes).lexically_normal();
  const fs::path folder =
      fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  const auto leads = [](const fs::path& one) {
    return one.empty() || one.is_absolute() || *one.begin() == "..";
  };
  if (leads(relative))
    throw Error(Status::Invalid, path, "refers to '" + name + "', which lies outside its folder",
                "put the files beside each other");
  const fs::path found = folder / relative;
  std::error_code error;
  if (!fs::is_regular_file(found, error))
    throw Error(Status::Invalid, path, "the file '" + found.string() + "' is missing",
                "put it where the name says");
  const fs::path real = fs::canonical(found, error), base = fs::canonical(folder, error);
  if (error || leads(real.lexically_relative(base)))
    throw Error(Status::Invalid, path, "refers to '" + name + "', a link out of its folder",
                "put the files beside each other");
  return found.string();
}

} // namespace tetvdb
