// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/ZarrArrays.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/ZlibBytes.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void writeBytes(const fs::path& path, const char* bytes, std::size_t size) {
  AtomicFile file(path.string());
  file.write(bytes, size);
  file.commit();
}

void writeJson(const fs::path& path, const Json& json) {
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  writeBytes(path, text.data(), text.size());
}

void makeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    throw Error(Status::Write, path.string(), "the folder cannot be made: " + error.message());
}

Json matrixOf(const std::vector<double>& numbers) {
  Json rows = Json::array();
  for (std::size_t row = 0; row < 4; ++row)
    rows.push_back(std::vector<double>(numbers.begin() + static_cast<std::ptrdiff_t>(4 * row),
                                       numbers.begin() + static_cast<std::ptrdiff_t>(4 * row + 4)));
  return rows;
}

/// An array and the folder of its chunks, which are whole at its borders too.
class ChunkWriter {
public:
  ChunkWriter(const NamedArray& array, fs::path folder)
      : array_(array), folder_(std::move(folder)), chunk_(chunkShape(array.shape)),
        element_(static_cast<std::size_t>(array.type[2] - '0')) {}

  void write() {
    makeFolder(folder_);
    Json about;
    about["chunks"] = chunk_;
    about["compressor"] = {{"id", "zlib"}, {"level", kChunkDeflateLevel}};
    about["dtype"] = array_.type;
    if (array_.type == "|b1")
      about["fill_value"] = false;
    else
      about["fill_value"] = 0;
    about["filters"] = nullptr;
    about["order"] = "C";
    about["shape"] = array_.shape;
    about["zarr_format"] = 2;
    writeJson(folder_ / ".zarray", about);
    if (!array_.transform.empty())
      writeJson(folder_ / ".zattrs", {{"transform", matrixOf(array_.transform)}});
    if (!array_.bytes.empty())
      chunks(0, {});
  }

private:
  // Every chunk below the number so far.
  void chunks(std::size_t axis, const std::vector<std::uint64_t>& number) {
    if (axis == chunk_.size()) {
      one(number);
      return;
    }
    for (std::uint64_t i = 0; i * chunk_[axis] < array_.shape[axis]; ++i) {
      std::vector<std::uint64_t> next = number;
      next.push_back(i);
      chunks(axis + 1, next);
    }
  }

  void one(const std::vector<std::uint64_t>& number) {
    std::uint64_t count = element_;
    for (const std::uint64_t side : chunk_)
      count *= side;
    std::vector<char> bytes(count, 0);
    copy(0, number, 0, 0, bytes);
    if (std::all_of(bytes.begin(), bytes.end(), [](char byte) { return byte == 0; }))
      return;
    std::string name;
    for (const std::uint64_t i : number)
      name += (name.empty() ? "" : ".") + std::to_string(i);
    const std::string packed = zlibBytes(bytes.data(), bytes.size());
    writeBytes(folder_ / name, packed.data(), packed.size());
  }

  // Rows of the array into those of a chunk; `from` and `to` count elements so far.
  void copy(std::size_t axis, const std::vector<std::uint64_t>& number, std::uint64_t from,
            std::uint64_t to, std::vector<char>& bytes) const {
    const std::uint64_t first = number[axis] * chunk_[axis],
                        last = std::min(first + chunk_[axis], array_.shape[axis]);
    if (axis + 1 == chunk_.size()) {
      std::memcpy(bytes.data() + to * chunk_[axis] * element_,
                  array_.bytes.data() + (from * array_.shape[axis] + first) * element_,
                  (last - first) * element_);
      return;
    }
    for (std::uint64_t i = first; i < last; ++i)
      copy(axis + 1, number, from * array_.shape[axis] + i, to * chunk_[axis] + (i - first), bytes);
  }

  const NamedArray& array_;
  const fs::path folder_;
  const std::vector<std::uint64_t> chunk_;
  const std::size_t element_; // bytes
};

const Json kGroup = {{"zarr_format", 2}};

Json parsed(const fs::path& path) {
  const MappedFile file(path.string());
  return Json::parse(file.bytes(), nullptr, false);
}

void addMetadata(const fs::path& folder, const std::string& prefix, Json& all) {
  for (const char* name : {".zgroup", ".zarray", ".zattrs"})
    if (fs::exists(folder / name))
      all[prefix + name] = parsed(folder / name);
}

} // namespace

void writeZarrArrays(const std::string& folder, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about) {
  const fs::path target(folder);
  const fs::path made = target.parent_path() / ("." + target.filename().string() + ".tmp");
  std::error_code error;
  fs::remove_all(made, error); // of a process that was killed
  makeFolder(made);
  try {
    for (const NamedArray& array : arrays)
      ChunkWriter(unpacked(array), made / array.name).write();
    Json attributes;
    for (const auto& [name, value] : about.texts)
      attributes[name] = value;
    attributes["transform"] = matrixOf(about.transform);
    writeJson(made / ".zattrs", attributes);
    writeJson(made / ".zgroup", kGroup);
    fs::remove_all(target, error);
    fs::rename(made, target, error);
    if (error)
      throw Error(Status::Write, folder, "cannot be written: " + error.message());
  } catch (...) {
    fs::remove_all(made, error);
    throw;
  }
}

void joinZarrStores(const std::string& root, const std::vector<std::string>& stores) {
  const fs::path top(root);
  std::set<std::string> groups{""}; // ending with '/', but for the root
  for (const std::string& store : stores)
    for (std::size_t at = store.find('/'); at != store.npos; at = store.find('/', at + 1))
      groups.insert(store.substr(0, at + 1));
  Json all = Json::object();
  for (const std::string& group : groups) {
    writeJson(top / group / ".zgroup", kGroup);
    all[group + ".zgroup"] = kGroup;
  }
  for (const std::string& store : stores) {
    const fs::path folder = top / store;
    if (!fs::exists(folder / ".zgroup"))
      throw Error(Status::Invalid, folder.string(), "is not there any more",
                  "remove its row and run the command again with `resume`");
    addMetadata(folder, store + "/", all);
    std::vector<std::string> arrays;
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_directory())
        arrays.push_back(entry.path().filename().string());
    std::sort(arrays.begin(), arrays.end());
    for (const std::string& array : arrays)
      addMetadata(folder / array, store + "/" + array + "/", all);
  }
  writeJson(top / ".zmetadata", {{"metadata", all}, {"zarr_consolidated_format", 1}});
}

} // namespace tetvdb
