// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/SpoolCells.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtuData.h"
#include "tetvdb/io/formats/vtk/VtuLayout.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"
#include "tetvdb/mesh/SpooledMesh.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

using namespace vtk;

// Elements at a time; a multiple of the bits of a byte.
constexpr std::size_t kChunk = std::size_t(1) << 18;
// Numbers of the connectivity at a time.
constexpr std::size_t kNumbers = std::size_t(1) << 21;

// The numbers of an array, one after the other.
class Numbers {
public:
  Numbers(const VtuLayout& layout, pugi::xml_node node, std::size_t numbers, const Source& source,
          Progress& progress)
      : source_(source), progress_(progress), place_(layout.locate(node, numbers)),
        swap_(layout.encoding().swap) {
    if (place_.isText)
      text_.emplace(source.bytes.substr(0, place_.from.begin + place_.from.bytes.size()),
                    source.path, 0, place_.from.begin);
    else
      stream_.emplace(place_.from, place_.base64, layout.encoding(), source.path);
  }

  /// The next `n`.
  Array next(std::size_t n) {
    progress_.check();
    if (text_)
      return parseText(*text_, place_.type, n, progress_);
    Array out;
    out.type = place_.type;
    out.swap = swap_;
    out.count = n;
    out.where = where();
    const std::uint64_t bytes = bytesFor(place_.type, n);
    if (bytes > stream_->left())
      throw Error(Status::Invalid, out.where,
                  "an array that ends " + std::to_string(bytes - stream_->left()) + " bytes early",
                  "the file is damaged or cut off; export it again");
    out.owned.reset(new char[bytes]);
    stream_->read(out.owned.get(), bytes);
    out.data = out.owned.get();
    source_.release();
    return out;
  }
  void skip(std::uint64_t n) {
    for (; n > 0; n -= std::min<std::uint64_t>(n, kNumbers))
      next(static_cast<std::size_t>(std::min<std::uint64_t>(n, kNumbers)));
  }
  std::string where() const {
    return source_.path + " at byte " + std::to_string(place_.from.begin);
  }

private:
  const Source& source_;
  Progress& progress_;
  ArrayPlace place_;
  bool swap_;
  std::optional<NumberParser> text_;
  std::optional<ArrayStream> stream_;
};

class VtuSpooler : VtuLayout {
public:
  VtuSpooler(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
             Progress& progress)
      : VtuLayout(source), source_(source), options_(options), mesh_(mesh), report_(report),
        progress_(progress) {}

  void read() {
    if (dataset() != Dataset::Unstructured)
      fail(source_.path, "holds no UnstructuredGrid", "save the mesh as an unstructured grid");
    const std::vector<pugi::xml_node> all = pieces();
    for (std::size_t i = 0; i < all.size(); ++i) {
      beginPiece(i);
      readPiece(all[i]);
    }
    // Those that a piece does not have.
    const auto isCut = [&](const SpooledArray& array) {
      const std::size_t elements =
          array.on == Attribute::On::Points ? mesh_.pointCount() : mesh_.cellCount();
      return array.values->size() != elements * array.bytesEach();
    };
    for (const SpooledArray& array : mesh_.arrays)
      if (isCut(array))
        report_.warn("array-not-in-all-pieces",
                     "the array '" + array.name + "' is left out: some piece lacks it");
    mesh_.arrays.erase(std::remove_if(mesh_.arrays.begin(), mesh_.arrays.end(), isCut),
                       mesh_.arrays.end());
  }

private:
  Numbers numbers(pugi::xml_node node, std::size_t n) const {
    return {*this, node, n, source_, progress_};
  }

  void readPiece(pugi::xml_node piece) {
    const std::size_t points = count(piece, "NumberOfPoints");
    const std::size_t cells = count(piece, "NumberOfCells");
    firstPoint_ = mesh_.pointCount();
    if (points >= 0xffffffffu - firstPoint_)
      throw Error(Status::Limit, source_.path, "more than 2^32 - 2 points", "split the mesh");
    if (points > 0)
      readPoints(piece.child("Points").child("DataArray"), points);
    hasFlat_ = false;
    if (cells > 0)
      readCells(piece.child("Cells"), points, cells);
    readArrays(piece.child("PointData"), Attribute::On::Points, points, {});
    readArrays(piece.child("CellData"), Attribute::On::Cells, cells, piece.child("Cells"));
  }

  void readPoints(pugi::xml_node node, std::size_t points) {
    if (!node)
      fail(where(), "<Points> has no array");
    if (components(node, 3) != 3)
      fail(where(), "points have " + std::to_string(components(node, 3)) + " coordinates, not 3");
    Numbers in = numbers(node, product(points, 3));
    for (std::size_t done = 0; done < points; done += kChunk) {
      const std::size_t n = std::min(kChunk, points - done);
      mesh_.points.append(toPoints(in.next(3 * n)));
      progress_.update(0.3 * static_cast<double>(done) / static_cast<double>(points));
    }
  }

  void readCells(pugi::xml_node node, std::size_t points, std::size_t cells) {
    Numbers types = numbers(needed(node, "types"), cells);
    Numbers offsets = numbers(needed(node, "offsets"), cells);
    Numbers connectivity = numbers(needed(node, "connectivity"), 1);
    std::uint64_t begin = 0;
    for (std::size_t done = 0; done < cells; done += kChunk) {
      const std::size_t n = std::min(kChunk, cells - done);
      const std::vector<std::uint8_t> kinds = toTypes(types.next(n));
      const std::vector<std::uint64_t> ends = toOffsets(offsets.next(n));
      for (std::size_t i = 0; i < n;) {
        const CellProperties& kind = cellKind(kinds[i]);
        if (kind.type == CellType::Flat) {
          skipFlat(kind, done + i, begin, ends[i], connectivity);
          begin = ends[i++];
          continue;
        }
        const std::size_t each = kind.nodes;
        if (each == 0 || each != SpooledMesh::cornersOf(kind.type))
          refuseToSpool(where(), kind.name);
        // Cells of this kind up to one that is none.
        std::size_t last = i;
        for (; last < n && kinds[last] == kinds[i] && each * (last - i) < kNumbers; ++last)
          if (ends[last] != begin + each * (last - i + 1))
            fail(types.where(), "cell " + std::to_string(done + last) + " " + textOf(kinds[i]) +
                                    " does not have " + std::to_string(each) + " nodes");
        append(kinds[i], connectivity.next(each * (last - i)), points, done + i,
               connectivity.where());
        begin = ends[last - 1];
        i = last;
      }
      progress_.update(0.3 + 0.4 * static_cast<double>(done) / static_cast<double>(cells));
    }
  }

  static std::string textOf(std::uint8_t type) {
    return "(" + std::string(cellKind(type).name) + ", VTK type " + std::to_string(type) + ")";
  }

  void append(std::uint8_t type, const Array& numbers, std::size_t points, std::size_t first,
              const std::string& place) {
    const CellProperties& kind = cellKind(type);
    std::vector<std::uint32_t> nodes = toIndices(numbers);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (nodes[k] >= points)
        fail(place, "cell " + std::to_string(first + k / kind.nodes) + " " + textOf(type) +
                        " refers to a point that is not there: there are " +
                        std::to_string(points) + ", numbered from 0");
      nodes[k] += static_cast<std::uint32_t>(firstPoint_);
    }
    mesh_.addCells(kind.type, nodes.data(), nodes.size() / kind.nodes);
    mesh_.cells[kind.name] += nodes.size() / kind.nodes;
  }

  void skipFlat(const CellProperties& kind, std::size_t cell, std::uint64_t begin,
                std::uint64_t end, Numbers& connectivity) {
    if (end < begin)
      fail(connectivity.where(), "cell " + std::to_string(cell) +
                                     " ends before it begins: its offset is below that of the "
                                     "cell before");
    connectivity.skip(end - begin);
    hasFlat_ = true;
    ++mesh_.cells[kind.name];
  }

  // As VtuReader does: what is asked for, and whole numbers of cells, which may be regions.
  void readArrays(pugi::xml_node section, Attribute::On on, std::size_t elements,
                  pugi::xml_node cells) {
    std::vector<std::string> known;
    for (const pugi::xml_node node : section.children("DataArray")) {
      const auto type = xmlNumber(node.attribute("type").value());
      std::string name = node.attribute("Name").value();
      if (!type)
        continue; // strings
      const bool forRegions =
          on == Attribute::On::Cells && (isInteger(*type) || name == options_.regionArray);
      if (!options_.attributes && !forRegions && name != options_.regionArray)
        continue;
      if (name.empty())
        name = "unnamed";
      if (std::find(known.begin(), known.end(), name) != known.end()) // time steps of one array
        continue;
      known.push_back(name);
      const std::uint32_t width = components(node, 1);
      if (options_.attributes && !options_.wants(name) && !forRegions) {
        noteUnread(name, on, width);
        continue;
      }
      readArray(node, name, on, elements, width, cells);
    }
  }

  void noteUnread(const std::string& name, Attribute::On on, std::uint32_t width) {
    const bool noted =
        std::any_of(mesh_.unread.begin(), mesh_.unread.end(),
                    [&](const UnreadArray& a) { return a.name == name && a.on == on; });
    if (!noted)
      mesh_.unread.push_back({name, on, width});
  }

  void readArray(pugi::xml_node node, const std::string& name, Attribute::On on,
                 std::size_t elements, std::uint32_t width, pugi::xml_node cells) {
    Numbers in = numbers(node, product(elements, width));
    std::optional<Numbers> types;
    if (on == Attribute::On::Cells && hasFlat_)
      types.emplace(static_cast<const VtuLayout&>(*this), needed(cells, "types"), elements, source_,
                    progress_);
    // As many as about kNumbers numbers.
    const std::size_t each = std::max<std::size_t>(kChunk / width / 8 * 8, 8);
    for (std::size_t done = 0; done < elements; done += each) {
      const std::size_t n = std::min(each, elements - done);
      Attribute part = toAttribute(name, on, width, in.next(n * width));
      if (types)
        keepSolid(toTypes(types->next(n)), part);
      SpooledArray* array = mesh_.find(name, on);
      if (array == nullptr)
        array = mesh_.add(name, on, width, part.values.index());
      if (array->components != width || array->type != part.values.index())
        fail(where(), "the array '" + name + "' has other numbers than in the pieces before");
      const auto [bytes, size] = bytesOf(part.values);
      array->values->append(bytes, size);
      progress_.update(0.7 + 0.3 * static_cast<double>(done) / static_cast<double>(elements));
    }
  }

  static void keepSolid(const std::vector<std::uint8_t>& kinds, Attribute& part) {
    std::visit(
        [&](auto& values) {
          auto to = values.begin();
          for (std::size_t i = 0; i < kinds.size(); ++i) {
            const auto from =
                values.begin() + static_cast<std::ptrdiff_t>(i * std::size_t(part.components));
            if (cellKind(kinds[i]).type != CellType::Flat)
              to = std::copy(from, from + part.components, to);
          }
          values.erase(to, values.end());
        },
        part.values);
  }

  const Source& source_;
  const ReadOptions& options_;
  SpooledMesh& mesh_;
  Report& report_;
  Progress& progress_;
  std::size_t firstPoint_ = 0;
  bool hasFlat_ = false; ///< the piece
};

} // namespace

void spoolVtu(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
              Progress& progress) {
  VtuSpooler(source, options, mesh, report, progress).read();
}

} // namespace tetvdb
