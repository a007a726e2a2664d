// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/MeditWriter.h"

#include "tetvdb/core/AtomicFile.h"

#include <charconv>
#include <string_view>

namespace tetvdb {
namespace {

constexpr std::size_t kPerUpdate = std::size_t(1) << 17;

/// One line of numbers at a time.
class Line {
public:
  template <class T>
  void add(T number) {
    at_ = std::to_chars(at_, text_ + sizeof text_, number).ptr;
    *at_++ = ' ';
  }
  void end(AtomicFile& file) {
    at_[-1] = '\n';
    file.write(text_, static_cast<std::size_t>(at_ - text_));
    at_ = text_;
  }

private:
  char text_[256]; // five numbers of at most 25 characters
  char* at_ = text_;
};

void writeText(AtomicFile& file, std::string_view text) {
  file.write(text.data(), text.size());
}

} // namespace

void writeMedit(const std::string& path, const TetMesh& mesh, Progress& progress) {
  AtomicFile file(path);
  Line line;
  const std::size_t total = mesh.points.size() + mesh.tetCount();
  writeText(file, "MeshVersionFormatted 2\nDimension 3\nVertices\n");
  line.add(mesh.points.size());
  line.end(file);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (const double x : mesh.points[i])
      line.add(x);
    line.add(0);
    line.end(file);
    if (i % kPerUpdate == 0)
      progress.update(static_cast<double>(i) / static_cast<double>(total));
  }
  writeText(file, "Tetrahedra\n");
  line.add(mesh.tetCount());
  line.end(file);
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    for (std::size_t k = 0; k < 4; ++k)
      line.add(std::uint64_t(mesh.tets[4 * t + k]) + 1);
    line.add(mesh.regions.empty() ? 0 : mesh.regions[mesh.cell(t)]);
    line.end(file);
    if (t % kPerUpdate == 0)
      progress.update(static_cast<double>(mesh.points.size() + t) / static_cast<double>(total));
  }
  writeText(file, "End\n");
  file.commit();
}

} // namespace tetvdb
