// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"
#include "tetvdb/io/volume/arrays/NpyHeader.h"

namespace tetvdb {

std::string npyType(ElementType element, bool isBits) {
  return isBits ? "|b1" : namesOf(element).numpy;
}

std::string npyHeader(std::string_view type, const std::vector<std::uint64_t>& shape) {
  std::string text = "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (";
  for (const std::uint64_t size : shape)
    text += std::to_string(size) + (shape.size() == 1 ? "," : ", ");
  if (shape.size() > 1)
    text.resize(text.size() - 2);
  text += "), }";
  // Magic, version, length, text and a line's end fill whole blocks of 64 bytes.
  constexpr std::size_t kBefore = 10, kBlock = 64;
  text.append((kBlock - (kBefore + text.size() + 1) % kBlock) % kBlock, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8 & 0xff);
  return header + text;
}

std::string npyHeader(const DenseGrid& grid) {
  std::vector<std::uint64_t> shape{grid.box().size(0), grid.box().size(1), grid.box().size(2)};
  if (grid.components() > 1)
    shape.push_back(grid.components());
  return npyHeader(npyType(grid.element(), grid.isBits()), shape);
}

void writeNpy(const ArrayContent& content, Progress& progress) {
  content.requireOneGrid("a .npy file");
  AtomicFile file(content.path);
  const std::string header = npyHeader(*content.grids.front());
  file.write(header.data(), header.size());
  ArrayStream(content, progress)
      .send(*content.grids.front(), kXSlowest,
            [&](const char* bytes, std::size_t size) { file.write(bytes, size); });
  file.commit();
}

} // namespace tetvdb
