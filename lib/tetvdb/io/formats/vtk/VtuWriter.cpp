// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtuWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/text/XmlText.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kTetsAtOnce = 1 << 16; ///< tets converted at a time

template <class T>
std::string_view typeName() {
  if constexpr (std::is_same_v<T, float>)
    return "Float32";
  else if constexpr (std::is_same_v<T, double>)
    return "Float64";
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return "Int32";
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return "UInt8";
  else
    return "Int64";
}

bool machineIsLittleEndian() {
  const std::uint16_t one = 1;
  return *reinterpret_cast<const unsigned char*>(&one) == 1;
}

class VtuWriting {
public:
  VtuWriting(const std::string& path, const TetMesh& mesh, Progress& progress)
      : file_(path), mesh_(mesh), progress_(progress) {
    for (const Attribute& attribute : mesh.attributes)
      if (attribute.on == Attribute::On::Cells && attribute.name == "region")
        regionName_ = "tetvdb_region";
  }

  void write() {
    writeMarkup();
    const std::size_t tets = mesh_.tetCount();
    raw(mesh_.points.data(), mesh_.points.size() * sizeof(Vec3d));
    spread<std::int64_t>(tets * 4, [&](std::size_t i) { return mesh_.tets[i]; });
    spread<std::int64_t>(tets, [](std::size_t i) { return 4 * (i + 1); });
    spread<std::uint8_t>(tets, [](std::size_t) { return 10; });
    for (const Attribute::On on : {Attribute::On::Points, Attribute::On::Cells})
      for (const Attribute& attribute : mesh_.attributes)
        if (attribute.on == on)
          std::visit([&](const auto& values) { writeValues(attribute, values); }, attribute.values);
    if (!mesh_.regions.empty())
      spread<std::int32_t>(tets, [&](std::size_t i) { return mesh_.regions[mesh_.cell(i)]; });
    text("\n  </AppendedData>\n</VTKFile>\n");
    file_.commit();
  }

private:
  void text(const std::string& s) { file_.write(s.data(), s.size()); }

  // --- markup: each array's offset in the appended data is known before they are written ---

  void writeMarkup() {
    const std::size_t points = mesh_.points.size(), tets = mesh_.tetCount();
    text("<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" +
         std::string(machineIsLittleEndian() ? "LittleEndian" : "BigEndian") +
         "\" header_type=\"UInt64\">\n"
         "  <UnstructuredGrid>\n"
         "    <Piece NumberOfPoints=\"" +
         std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(tets) + "\">\n");
    text("      <Points>\n");
    declare<double>("Points", 3, points);
    text("      </Points>\n      <Cells>\n");
    declare<std::int64_t>("connectivity", 1, tets * 4);
    declare<std::int64_t>("offsets", 1, tets);
    declare<std::uint8_t>("types", 1, tets);
    text("      </Cells>\n      <PointData>\n");
    declareAttributes(Attribute::On::Points, points);
    text("      </PointData>\n      <CellData>\n");
    declareAttributes(Attribute::On::Cells, tets);
    if (!mesh_.regions.empty())
      declare<std::int32_t>(regionName_, 1, tets);
    text("      </CellData>\n"
         "    </Piece>\n"
         "  </UnstructuredGrid>\n"
         "  <AppendedData encoding=\"raw\">\n   _");
  }

  template <class T>
  void declare(const std::string& name, std::uint32_t components, std::size_t elements) {
    text("        <DataArray type=\"" + std::string(typeName<T>()) + "\" Name=\"" +
         xmlAttributeText(name) + "\" NumberOfComponents=\"" + std::to_string(components) +
         "\" format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n");
    offset_ += sizeof(std::uint64_t) + elements * components * sizeof(T);
  }
  void declareAttributes(Attribute::On on, std::size_t elements) {
    for (const Attribute& attribute : mesh_.attributes)
      if (attribute.on == on)
        std::visit(
            [&](const auto& values) {
              using T = typename std::decay_t<decltype(values)>::value_type;
              declare<T>(attribute.name, attribute.components, elements);
            },
            attribute.values);
  }

  // --- data ---

  void raw(const void* data, std::uint64_t bytes) {
    file_.write(&bytes, sizeof bytes);
    constexpr std::uint64_t kStep = 8 << 20;
    for (std::uint64_t done = 0; done < bytes; done += kStep) {
      progress_.update(static_cast<double>(file_.size()) / static_cast<double>(offset_));
      file_.write(static_cast<const char*>(data) + done, std::min(kStep, bytes - done));
    }
  }

  /// Writes the numbers value(0) to value(n - 1) as T.
  template <class T, class Value>
  void spread(std::size_t n, Value value) {
    const std::uint64_t bytes = n * sizeof(T);
    file_.write(&bytes, sizeof bytes);
    std::vector<T> buffer(std::min(n, kTetsAtOnce));
    for (std::size_t begin = 0; begin < n; begin += kTetsAtOnce) {
      const std::size_t end = std::min(n, begin + kTetsAtOnce);
      for (std::size_t i = begin; i < end; ++i)
        buffer[i - begin] = static_cast<T>(value(i));
      progress_.update(static_cast<double>(file_.size()) / static_cast<double>(offset_));
      file_.write(buffer.data(), (end - begin) * sizeof(T));
    }
  }

  template <class T>
  void writeValues(const Attribute& attribute, const std::vector<T>& values) {
    const std::size_t width = attribute.components;
    if (attribute.on == Attribute::On::Points)
      raw(values.data(), values.size() * sizeof(T));
    else if (width == 1)
      spread<T>(mesh_.tetCount(), [&](std::size_t i) { return values[mesh_.cell(i)]; });
    else
      spread<T>(mesh_.tetCount() * width,
                [&](std::size_t i) { return values[mesh_.cell(i / width) * width + i % width]; });
  }

  AtomicFile file_;
  const TetMesh& mesh_;
  Progress& progress_;
  std::string regionName_ = "region";
  std::uint64_t offset_ = 0;
};

} // namespace

void writeVtu(const std::string& path, const TetMesh& mesh, Progress& progress) {
  VtuWriting(path, mesh, progress).write();
}

} // namespace tetvdb
