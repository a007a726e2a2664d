// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/gmsh/GmshWriter.h"

#include "tetvdb/core/AtomicFile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kBlock = 8192; // elements buffered before they are written
constexpr std::int32_t kTetrahedron = 4;

template <class T>
void writeNumber(AtomicFile& file, T number) {
  file.write(&number, sizeof number);
}

/// A volume entity: the tets of one region.
struct Volume {
  std::int32_t tag = 0;
  Vec3d low{0, 0, 0}, high{0, 0, 0};
};

class MshWriter {
public:
  MshWriter(const std::string& path, const TetMesh& mesh, Progress& progress)
      : file_(path), mesh_(mesh), progress_(progress) {}

  void write() {
    findVolumes();
    file_.write("$MeshFormat\n4.1 1 8\n");
    writeNumber(file_, std::int32_t(1)); // tells the byte order
    file_.write("\n$EndMeshFormat\n");
    writeNames();
    writeEntities();
    writeNodes();
    writeElements();
    for (const Attribute& attribute : mesh_.attributes)
      if (attribute.components <= 9)
        writeData(attribute);
    file_.commit();
  }

private:
  std::int32_t region(std::size_t tet) const {
    return mesh_.regions.empty() ? 0 : mesh_.regions[mesh_.cell(tet)];
  }

  void findVolumes() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < mesh_.tetCount(); ++t) {
      const auto [at, isNew] = volumes_.try_emplace(region(t));
      Volume& volume = at->second;
      if (isNew) {
        volume.low = {infinity, infinity, infinity};
        volume.high = {-infinity, -infinity, -infinity};
      }
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double x = mesh_.points[mesh_.tets[4 * t + k]][axis];
          volume.low[axis] = std::min(volume.low[axis], x);
          volume.high[axis] = std::max(volume.high[axis], x);
        }
    }
    if (volumes_.empty())
      volumes_.try_emplace(0); // nodes need an entity
    std::int32_t tag = 0;
    for (auto& [number, volume] : volumes_)
      volume.tag = ++tag;
  }

  void writeNames() {
    std::string text;
    std::size_t n = 0;
    for (const auto& [number, name] : mesh_.regionNames) {
      if (number <= 0)
        continue;
      ++n;
      std::string shown = name;
      std::replace_if(
          shown.begin(), shown.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; },
          '\'');
      text += "3 " + std::to_string(number) + " \"" + shown + "\"\n";
    }
    if (n == 0)
      return;
    file_.write("$PhysicalNames\n" + std::to_string(n) + "\n" + text + "$EndPhysicalNames\n");
  }

  void writeEntities() {
    file_.write("$Entities\n");
    for (int dimension = 0; dimension < 3; ++dimension)
      writeNumber(file_, std::uint64_t(0));
    writeNumber(file_, std::uint64_t(volumes_.size()));
    for (const auto& [number, volume] : volumes_) {
      writeNumber(file_, volume.tag);
      file_.write(volume.low.data(), sizeof(Vec3d));
      file_.write(volume.high.data(), sizeof(Vec3d));
      // Physical groups are numbered from 1.
      writeNumber(file_, std::uint64_t(number > 0 ? 1 : 0));
      if (number > 0)
        writeNumber(file_, number);
      writeNumber(file_, std::uint64_t(0)); // bounding surfaces
    }
    file_.write("\n$EndEntities\n");
  }

  void writeNodes() {
    const std::uint64_t n = mesh_.points.size();
    file_.write("$Nodes\n");
    for (const std::uint64_t number : {std::uint64_t(1), n, std::uint64_t(1), n})
      writeNumber(file_, number); // blocks, nodes, min and max tag
    writeNumber(file_, std::int32_t(3));
    writeNumber(file_, volumes_.begin()->second.tag);
    writeNumber(file_, std::int32_t(0));
    writeNumber(file_, n);
    std::vector<std::uint64_t> tags;
    for (std::uint64_t i = 0; i < n; i += tags.size()) {
      tags.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, n - i)));
      for (std::size_t k = 0; k < tags.size(); ++k)
        tags[k] = i + k + 1;
      file_.write(tags.data(), tags.size() * sizeof tags[0]);
    }
    if (n > 0)
      file_.write(mesh_.points.data(), mesh_.points.size() * sizeof(Vec3d));
    file_.write("\n$EndNodes\n");
    progress_.update(0.3);
  }

  /// One block per region, in order of their numbers; a tet's tag is its number from 1.
  void writeElements() {
    const std::size_t n = mesh_.tetCount();
    std::map<std::int32_t, std::vector<std::size_t>> tets; // of each region, ascending
    for (std::size_t t = 0; t < n; ++t)
      tets[region(t)].push_back(t);
    file_.write("$Elements\n");
    for (const std::uint64_t number :
         {std::uint64_t(tets.size()), std::uint64_t(n), std::uint64_t(1), std::uint64_t(n)})
      writeNumber(file_, number);
    std::size_t done = 0;
    for (const auto& [number, members] : tets) {
      writeNumber(file_, std::int32_t(3));
      writeNumber(file_, volumes_.at(number).tag);
      writeNumber(file_, kTetrahedron);
      writeNumber(file_, std::uint64_t(members.size()));
      std::vector<std::uint64_t> block;
      for (const std::size_t t : members) {
        block.push_back(t + 1);
        for (std::size_t k = 0; k < 4; ++k)
          block.push_back(std::uint64_t(mesh_.tets[4 * t + k]) + 1);
        ++done;
        if (block.size() < 5 * kBlock)
          continue;
        writeBlock(block);
        progress_.update(0.3 + 0.4 * static_cast<double>(done) / static_cast<double>(n));
      }
      writeBlock(block);
    }
    file_.write("\n$EndElements\n");
  }

  void writeBlock(std::vector<std::uint64_t>& block) {
    file_.write(block.data(), block.size() * sizeof block[0]);
    block.clear();
  }

  void writeData(const Attribute& attribute) {
    const bool onCells = attribute.on == Attribute::On::Cells;
    const std::size_t things = onCells ? mesh_.tetCount() : mesh_.points.size();
    const std::uint32_t has = attribute.components;
    const std::uint32_t components = has == 1 ? 1 : has <= 3 ? 3 : 9;
    const auto element = [&](std::size_t i) { return onCells ? mesh_.cell(i) : i; };
    const auto isMissing = [&](std::size_t i) {
      for (std::uint32_t c = 0; c < has; ++c)
        if (!std::isnan(attribute.number(element(i), c)))
          return false;
      return true;
    };
    std::size_t present = 0;
    for (std::size_t i = 0; i < things; ++i)
      if (!isMissing(i))
        ++present;
    std::string name = attribute.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; }, '\'');
    const std::string section = onCells ? "ElementData" : "NodeData";
    file_.write("$" + section + "\n1\n\"" + name + "\"\n1\n0\n3\n0\n" + std::to_string(components) +
                "\n" + std::to_string(present) + "\n");
    for (std::size_t i = 0; i < things; ++i) {
      if (i % kBlock == 0)
        progress_.check();
      if (isMissing(i))
        continue;
      writeNumber(file_, static_cast<std::uint32_t>(i + 1));
      for (std::uint32_t c = 0; c < components; ++c)
        writeNumber(file_, c < has ? attribute.number(element(i), c) : 0.0);
    }
    file_.write("\n$End" + section + "\n");
  }

  AtomicFile file_;
  const TetMesh& mesh_;
  Progress& progress_;
  std::map<std::int32_t, Volume> volumes_; ///< by region
};

} // namespace

void writeGmsh(const std::string& path, const TetMesh& mesh, Progress& progress) {
  MshWriter(path, mesh, progress).write();
}

} // namespace tetvdb
