// SPDX-License-Identifier: Apache-2.0
//
// Format: numpy.savez(), a ZIP archive of .npy files. "transform" (4 x 4), "origin" and
// "voxel_size" are those of docs/formats.md, as are "NAME.coordinates", "NAME.values" and
// "NAME.background".
#include "tetvdb/io/text/GunzipBytes.h"
#include "tetvdb/io/text/ZipDirectory.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/NpyArray.h"

#include <optional>

namespace tetvdb {
namespace {

class NpzInput {
public:
  NpzInput(const Source& source, const ArraySink& sink, Progress& progress)
      : source_(source), sink_(sink), progress_(progress), entries_(readZipDirectory(source)) {
    checkZipSizes(entries_, source, kBestDeflate);
  }

  void read() {
    readPlace();
    for (const ZipEntry& entry : entries_) {
      const std::string name = nameOf(entry);
      if (isPlace(name) || endsWith(name, ".values") || endsWith(name, ".background"))
        continue;
      if (endsWith(name, ".coordinates") && readList(name.substr(0, name.size() - 12)))
        continue;
      if (!endsWith(entry.name, ".npy")) {
        sink_.leftOut(name, "no .npy file");
        continue;
      }
      const Content content(*this, entry);
      StoredArray array = placed(name);
      if (setVoxels(content.array, array))
        sink_.array(array);
      else
        sink_.leftOut(name, content.array.describe());
    }
  }

private:
  struct Content {
    Content(const NpzInput& file, const ZipEntry& entry)
        : bytes(unpackZipEntry(entry, file.source_, file.progress_)),
          array(parseNpy(bytes, file.source_.path + ", " + entry.name)) {}
    Content(const Content&) = delete; // `array` refers to `bytes`
    Content& operator=(const Content&) = delete;

    std::string bytes;
    NpyArray array;
  };

  static bool endsWith(std::string_view text, std::string_view end) {
    return text.size() > end.size() && text.substr(text.size() - end.size()) == end;
  }
  static std::string nameOf(const ZipEntry& entry) {
    return endsWith(entry.name, ".npy") ? entry.name.substr(0, entry.name.size() - 4) : entry.name;
  }
  bool isPlace(std::string_view name) const {
    return hasPlace_ &&
           (name == "transform" || name == "origin" || name == "voxel_size" || name == "box");
  }

  std::optional<Content> find(const std::string& name) const {
    for (const ZipEntry& entry : entries_)
      if (entry.name == name + ".npy")
        return std::optional<Content>(std::in_place, *this, entry);
    return {};
  }

  void readPlace() {
    using Shape = std::vector<std::uint64_t>;
    const auto transform = find("transform"), origin = find("origin");
    if (!transform || !transform->array.unknownType.empty() ||
        transform->array.element != ElementType::Float64 || transform->array.shape != Shape{4, 4})
      return;
    hasPlace_ = true;
    for (std::size_t i = 0; i < 16; ++i)
      place_.transform[i] =
          transform->array.number(transform->array.isFortran ? i % 4 * 4 + i / 4 : i);
    if (origin && origin->array.element == ElementType::Int32 && origin->array.shape == Shape{3})
      for (std::size_t k = 0; k < 3; ++k)
        place_.low[k] = static_cast<std::int32_t>(origin->array.number(k));
  }

  StoredArray placed(const std::string& name) const {
    StoredArray array = place_;
    array.placed = hasPlace_;
    array.name = name;
    return array;
  }

  // Voxels and their values; false if the file has no such values.
  bool readList(const std::string& name) const {
    const auto coordinates = find(name + ".coordinates"), values = find(name + ".values");
    if (!coordinates || !values)
      return false;
    const NpyArray &at = coordinates->array, &value = values->array;
    const bool fits =
        at.unknownType.empty() && value.unknownType.empty() && at.element == ElementType::Int32 &&
        !at.swap && !at.isFortran && at.shape.size() == 2 && at.shape[1] == 3 && !value.isFortran &&
        (value.shape.size() == 1 || value.shape.size() == 2) && value.shape[0] == at.shape[0];
    if (!fits)
      return false;
    StoredArray array = placed(name);
    array.element = value.element;
    array.swap = value.swap;
    array.isBits = value.isBits;
    array.bytes = value.bytes;
    array.low = {0, 0, 0};
    array.size = {at.shape[0], 1, 1};
    array.components = value.shape.size() == 2 ? value.shape[1] : 1;
    array.step = {array.components, 1, 1};
    array.coordinates = at.bytes;
    if (const auto background = find(name + ".background");
        background && !background->array.bytes.empty())
      array.background = background->array.number(0);
    sink_.array(array);
    return true;
  }

  const Source& source_;
  const ArraySink& sink_;
  Progress& progress_;
  std::vector<ZipEntry> entries_;
  StoredArray place_;
  bool hasPlace_ = false;
};

} // namespace

void readNpz(const Source& source, const ArraySink& sink, Progress& progress) {
  NpzInput(source, sink, progress).read();
}

} // namespace tetvdb
