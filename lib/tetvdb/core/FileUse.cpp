// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/FileUse.h"

#include "tetvdb/core/Error.h"

#include <unistd.h>

namespace tetvdb {
namespace {

[[noreturn]] void refuse(const std::string& path, std::string text, const std::string& other,
                         const char* advice) {
  if (path != other)
    (text += ": it is the same file as ") += other;
  throw Error(Status::Usage, path, text, advice);
}

[[noreturn]] void refuseInput(const std::string& written, const std::string& read) {
  refuse(written, "is an input as well as an output", read, "choose another name for the output");
}

} // namespace

void FileUse::reads(const std::string& path) {
  if (path.empty())
    return;
  const FileIdentity identity = identify(path);
  const auto other = written_.find(identity);
  if (other != written_.end() && !identity.isDevice)
    refuseInput(other->second, path);
  read_.emplace(identity, path);
}

void FileUse::writes(const std::string& path) {
  if (path.empty())
    return;
  const FileIdentity identity = path == "-" ? identify(STDOUT_FILENO) : identify(path);
  const auto input = read_.find(identity);
  if (input != read_.end() && !identity.isDevice)
    refuseInput(path, input->second);
  const auto [other, added] = written_.emplace(identity, path);
  if (!added && !identity.isDevice)
    refuse(path, "is written to by two outputs", other->second, "give each a name of its own");
}

bool FileUse::writesStandardOutput() const {
  return written_.count(identify(STDOUT_FILENO)) > 0;
}

} // namespace tetvdb
