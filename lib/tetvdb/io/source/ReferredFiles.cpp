// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/ReferredFiles.h"

#include "tetvdb/core/Letters.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t(16) << 20;
constexpr int kDeepest = 4; // .pvd names .pvtu names .vtu

// Files that are lists of other files.
constexpr std::array<std::string_view, 11> kLists{".pvd",  ".pvtu", ".pvtp", ".pvti",
                                                  ".vtm",  ".vtmb", ".xdmf", ".xmf",
                                                  ".gltf", ".case", ".encas"};

std::string firstBytes(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) // opening a pipe would consume its content
    return {};
  const auto size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (!file || error)
    return {};
  std::string text(std::min<std::size_t>(static_cast<std::size_t>(size), kMaxBytes), '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

// Most of the content of such files is numbers.
bool canBeName(std::string_view text) {
  return text.size() < 4096 && text.find('.') != text.npos &&
         std::any_of(text.begin(), text.end(), [](char c) {
           return c != 'e' && c != 'E' && c != '.' && c != '+' && c != '-' && (c < '0' || c > '9');
         });
}

// The text between separators; of "run.h5:/Mesh/points" only the file.
void addNames(std::string_view text, std::string_view separators, std::set<std::string>& names) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = std::min(text.find_first_not_of(separators, at), text.size());
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    std::string_view name = text.substr(begin, end - begin);
    name = name.substr(0, name.find(":/"));
    if (canBeName(name))
      names.emplace(name);
    at = end;
  }
}

// TetGen's two halves have the same name and case.
std::string otherHalf(const fs::path& path) {
  constexpr std::array<std::array<std::string_view, 2>, 4> kHalves{
      {{".node", ".ele"}, {".ele", ".node"}, {".NODE", ".ELE"}, {".ELE", ".NODE"}}};
  for (const auto& [one, other] : kHalves)
    if (path.extension() == one)
      return fs::path(path).replace_extension(other).string();
  return {};
}

void addReferred(const fs::path& path, int depth, std::set<std::string>& found) {
  std::set<std::string> names;
  const std::string half = otherHalf(path);
  if (!half.empty())
    names.insert(fs::path(half).filename().string());
  const std::string ending = lowerCase(path.extension().string());
  if (std::find(kLists.begin(), kLists.end(), ending) != kLists.end()) {
    const std::string text = firstBytes(path);
    addNames(text, "\"'<>\r\n", names);
    addNames(text, "\"'<>\r\n\t ", names);
  }
  for (const std::string& name : names) {
    const fs::path file = path.parent_path() / name;
    std::error_code error;
    if (fs::is_regular_file(file, error) && found.insert(file.string()).second && depth < kDeepest)
      addReferred(file, depth + 1, found);
  }
}

} // namespace

std::vector<std::string> referredFiles(const std::string& path) {
  std::set<std::string> found;
  addReferred(path, 1, found);
  found.erase(path);
  return {found.begin(), found.end()};
}

} // namespace tetvdb
