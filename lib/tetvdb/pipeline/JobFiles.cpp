// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/JobFiles.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <set>
#include <unistd.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::size_t residentBytes() {
  std::size_t total = 0;
  std::size_t resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu %zu", &total, &resident) != 2)
      resident = 0;
    std::fclose(file);
  }
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

std::string megabytes(std::size_t bytes) {
  return std::to_string((bytes >> 20) + 1) + " MB";
}

} // namespace

OutputInfo written(const std::string& path) {
  std::error_code ignored;
  return {path, static_cast<std::uint64_t>(fs::file_size(path, ignored))};
}

std::vector<std::string> uniqueStems(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& path : paths) {
    const std::string stem = fs::path(path).stem().string();
    std::string name = stem;
    for (int n = 2; !taken.insert(name).second; ++n)
      name = stem + "_" + std::to_string(n);
    names.push_back(name);
  }
  return names;
}

void requireExtension(const std::string& path, std::initializer_list<std::string_view> known,
                      std::string_view advice) {
  const std::string extension = lowerExtension(path);
  if (std::find(known.begin(), known.end(), extension) != known.end())
    return;
  throw Error(Status::Usage, path,
              extension.empty() ? "the output's name has no extension"
                                : "cannot write files that end in '" + extension + "'",
              advice);
}

void requireNoInput(const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code ignored;
    if (fs::equivalent(output, input, ignored))
      throw Error(Status::Usage, output, "is an input as well as the output",
                  "choose another name");
  }
}

void requireWritable(const std::string& path) {
  const AtomicFile probe(path);
}

std::size_t memoryLeft(std::size_t limit) {
  if (limit == 0)
    return 0;
  const std::size_t used = residentBytes();
  if (used >= limit)
    throw Error(Status::Limit, "",
                "the mesh alone takes " + megabytes(used) + " of the " + megabytes(limit) +
                    " allowed",
                "raise --max-memory, or read a part with --region or --bbox");
  return limit - used;
}

} // namespace tetvdb
