// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtkCells.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <iterator>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <utility>
#include <variant>

namespace tetvdb::vtk {
namespace {

using Kinds = std::array<CellProperties, 256>;

// The numbers are those of vtkCellType.h.
Kinds makeKinds() {
  Kinds kinds;
  for (CellProperties& kind : kinds)
    kind.name = "unknown";
  const auto flat = [&](int type, const char* name) {
    kinds[std::size_t(type)] = {CellType::Flat, 0, 0, name};
  };
  const auto solid = [&](int type, CellType as, int corners, int nodes, const char* name) {
    kinds[std::size_t(type)] = {as, std::uint8_t(corners), std::uint8_t(nodes), name};
  };
  static constexpr std::pair<int, const char*> kFlat[] = {
      {0, "empty"},          {1, "vertex"},        {2, "poly vertex"},     {3, "line"},
      {4, "poly line"},      {5, "triangle"},      {6, "triangle strip"},  {7, "polygon"},
      {8, "pixel"},          {9, "quad"},          {21, "line3"},          {22, "triangle6"},
      {23, "quad8"},         {28, "quad9"},        {30, "quad6"},          {34, "triangle7"},
      {35, "line4"},         {36, "polygon q"},    {51, "param. curve"},   {52, "param. surface"},
      {53, "param. tri"},    {54, "param. quad"},  {60, "order-n edge"},   {61, "order-n tri"},
      {62, "order-n quad"},  {63, "order-n poly"}, {68, "Lagrange curve"}, {69, "Lagrange tri"},
      {70, "Lagrange quad"}, {75, "Bezier curve"}, {76, "Bezier tri"},     {77, "Bezier quad"}};
  for (const auto& [type, name] : kFlat)
    flat(type, name);
  solid(10, CellType::Tetra, 4, 4, "tetra");
  solid(11, CellType::Voxel, 8, 8, "voxel");
  solid(12, CellType::Hexahedron, 8, 8, "hexahedron");
  solid(13, CellType::Wedge, 6, 6, "wedge");
  solid(14, CellType::Pyramid, 5, 5, "pyramid");
  solid(15, CellType::PentagonalPrism, 10, 10, "5-sided prism");
  solid(16, CellType::HexagonalPrism, 12, 12, "6-sided prism");
  solid(24, CellType::Tetra, 4, 10, "tetra10");
  solid(25, CellType::Hexahedron, 8, 20, "hexahedron20");
  solid(26, CellType::Wedge, 6, 15, "wedge15");
  solid(27, CellType::Pyramid, 5, 13, "pyramid13");
  solid(29, CellType::Hexahedron, 8, 27, "hexahedron27");
  solid(31, CellType::Wedge, 6, 12, "wedge12");
  solid(32, CellType::Wedge, 6, 18, "wedge18");
  solid(33, CellType::Hexahedron, 8, 24, "hexahedron24");
  solid(37, CellType::Pyramid, 5, 19, "pyramid19");
  solid(41, CellType::OtherSolid, 0, 0, "point set");
  solid(42, CellType::Polyhedron, 0, 0, "polyhedron");
  solid(55, CellType::OtherSolid, 0, 0, "param. tetra");
  solid(56, CellType::OtherSolid, 0, 0, "param. hexa");
  solid(64, CellType::OtherSolid, 0, 0, "order-n tetra");
  solid(65, CellType::OtherSolid, 0, 0, "order-n wedge");
  solid(66, CellType::OtherSolid, 0, 0, "order-n pyramid");
  solid(67, CellType::OtherSolid, 0, 0, "order-n hexa");
  // Corners come first in these, for any degree.
  solid(71, CellType::Tetra, 4, 0, "Lagrange tetra");
  solid(72, CellType::Hexahedron, 8, 0, "Lagrange hexa");
  solid(73, CellType::Wedge, 6, 0, "Lagrange wedge");
  solid(74, CellType::Pyramid, 5, 0, "Lagrange pyram.");
  solid(78, CellType::Tetra, 4, 0, "Bezier tetra");
  solid(79, CellType::Hexahedron, 8, 0, "Bezier hexa");
  solid(80, CellType::Wedge, 6, 0, "Bezier wedge");
  solid(81, CellType::Pyramid, 5, 0, "Bezier pyramid");
  return kinds;
}

class Appender {
public:
  Appender(Cells& cells, CellMesh& mesh, Progress& progress, bool faces)
      : cells_(cells), mesh_(mesh), progress_(progress), faces_(faces),
        points_(mesh.points.size()) {}

  void run() {
    checkOffsets();
    const std::size_t n = cells_.types.size();
    if (takeOver(n))
      return;
    std::size_t changes = 1;
    for (std::size_t i = 1; i < n; ++i)
      changes += cells_.types[i] != cells_.types[i - 1];
    mesh_.runs.reserve(mesh_.runs.size() + changes);
    for (std::size_t begin = 0; begin < n;) {
      const std::uint8_t type = cells_.types[begin];
      std::size_t end = begin + 1;
      while (end < n && cells_.types[end] == type)
        ++end;
      append(cellKind(type), begin, end);
      begin = end;
      if (++runs_ % 4096 == 0)
        progress_.check();
    }
  }

private:
  using Range = tbb::blocked_range<std::size_t>;

  [[noreturn]] void fail(std::size_t cell, const std::string& what) const {
    throw Error(Status::Invalid, cells_.where, "cell " + std::to_string(cell) + " " + what,
                kExport);
  }
  std::uint64_t begin(std::size_t cell) const { return cell == 0 ? 0 : cells_.ends[cell - 1]; }
  std::string type(std::size_t cell) const {
    return "(" + std::string(cellKind(cells_.types[cell]).name) + ", VTK type " +
           std::to_string(cells_.types[cell]) + ")";
  }

  // First i of [begin, end) for which bad(i), or end.
  template <class Bad>
  std::size_t firstBad(std::size_t begin, std::size_t end, Bad bad) const {
    if (end - begin < 4096) {
      while (begin < end && !bad(begin))
        ++begin;
      return begin;
    }
    return tbb::parallel_reduce(
        Range(begin, end, 1 << 16), end,
        [&](const Range& range, std::size_t first) {
          bool any = false; // first the whole range, so that it vectorises
          for (std::size_t i = range.begin(); i < range.end(); ++i)
            any |= bad(i);
          for (std::size_t i = range.begin(); any && i < range.end() && i < first; ++i)
            if (bad(i))
              first = i;
          return first;
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
  }

  void checkOffsets() const {
    const auto& ends = cells_.ends;
    const std::size_t n = cells_.types.size();
    if (ends.size() != n)
      throw Error(Status::Invalid, cells_.where,
                  std::to_string(n) + " cell types, but " + std::to_string(ends.size()) +
                      " cell offsets",
                  "export the file again");
    if (n == 0)
      return;
    const std::size_t falls = firstBad(1, n, [&](std::size_t i) { return ends[i] < ends[i - 1]; });
    if (falls < n)
      fail(falls, "ends before it begins: its offset is below that of the cell before");
    if (ends.back() > cells_.connectivity.size()) {
      const std::uint64_t size = cells_.connectivity.size();
      fail(std::size_t(std::upper_bound(ends.begin(), ends.end(), size) - ends.begin()),
           "ends beyond the connectivity, which has " + std::to_string(size) + " numbers");
    }
  }

  // Checks the nodes of cells [begin, end), all nodes and not only corners.
  void checkNodes(std::size_t beginCell, std::size_t endCell) const {
    const std::uint64_t first = begin(beginCell), last = cells_.ends[endCell - 1];
    const std::uint32_t* nodes = cells_.connectivity.data();
    const std::size_t points = points_;
    const std::size_t bad =
        firstBad(first, last, [=](std::size_t i) { return nodes[i] >= points; });
    if (bad == last)
      return;
    const auto cell = std::size_t(std::upper_bound(cells_.ends.begin(), cells_.ends.end(), bad) -
                                  cells_.ends.begin());
    failNode(cell, nodes[bad]);
  }
  [[noreturn]] void failNode(std::size_t cell, std::uint32_t node) const {
    const bool wide = node == 0xffffffffu; // see toIndices()
    fail(cell, type(cell) + " refers to " +
                   (wide ? std::string("a point out of range") : "point " + std::to_string(node)) +
                   ", but there are " + std::to_string(points_) + " points, numbered from 0");
  }
  /// Nodes of the kind's first cell in the file; 0: any number. Some programs write quadratic cells
  /// under the number of the linear type, of which VTK takes the corners.
  std::size_t nodesInFile(const CellProperties& kind, std::size_t cell) const {
    const std::uint64_t nodes = cells_.ends[cell] - begin(cell);
    const bool curved = kind.nodes == kind.corners && nodes <= 32 &&
                        curvedShape(kind.type, static_cast<std::uint32_t>(nodes));
    return curved ? static_cast<std::size_t>(nodes) : kind.nodes;
  }
  void checkSizes(const CellProperties& kind, std::size_t inFile, std::size_t beginCell,
                  std::size_t endCell) const {
    const std::uint64_t nodes = inFile != 0 ? inFile : kind.corners;
    const bool exact = inFile != 0;
    const std::uint64_t* ends = cells_.ends.data();
    if (begin(beginCell) + nodes > ends[beginCell] ||
        (exact && begin(beginCell) + nodes != ends[beginCell]))
      failSize(beginCell, nodes, exact);
    const std::size_t bad = firstBad(beginCell + 1, endCell, [=](std::size_t i) {
      const std::uint64_t size = ends[i] - ends[i - 1];
      return exact ? size != nodes : size < nodes;
    });
    if (bad < endCell)
      failSize(bad, nodes, exact);
  }
  [[noreturn]] void failSize(std::size_t cell, std::uint64_t nodes, bool exact) const {
    fail(cell, type(cell) + " has " + std::to_string(cells_.ends[cell] - begin(cell)) +
                   " nodes in place of " + (exact ? "" : "at least ") + std::to_string(nodes));
  }

  // Only one linear type: the connectivity is the node array.
  bool takeOver(std::size_t n) {
    if (n == 0)
      return true;
    const std::uint8_t type = cells_.types[0];
    const CellProperties& kind = cellKind(type);
    if (!mesh_.nodes.empty() || kind.corners == 0 || kind.corners != kind.nodes ||
        cells_.ends.back() != n * kind.corners)
      return false;
    const std::uint8_t* types = cells_.types.data();
    if (firstBad(0, n, [=](std::size_t i) { return types[i] != type; }) < n)
      return false;
    checkSizes(kind, kind.nodes, 0, n);
    checkNodes(0, n);
    cells_.connectivity.resize(cells_.ends.back());
    mesh_.nodes = std::move(cells_.connectivity);
    addRun(kind, kind.corners, n, false);
    return true;
  }

  void append(const CellProperties& kind, std::size_t beginCell, std::size_t endCell) {
    if (kind.type == CellType::Polyhedron)
      return appendPolyhedra(kind, beginCell, endCell);
    checkNodes(beginCell, endCell);
    if (kind.corners == 0 && faces_ && isPolygon(cells_.types[beginCell]))
      return appendPolygons(kind, beginCell, endCell);
    if (kind.corners == 0)
      return addRun(kind, 0, endCell - beginCell, false);
    const std::size_t inFile = nodesInFile(kind, beginCell);
    checkSizes(kind, inFile, beginCell, endCell);
    const std::uint32_t* from = cells_.connectivity.data();
    if (mesh_.nodes.capacity() == 0)
      mesh_.nodes.reserve(cells_.connectivity.size());
    if (inFile != 0) {
      const std::uint8_t kept = curvedShape(kind.type, kind.nodes) ? kind.nodes : kind.corners;
      copyCorners(from + begin(beginCell), inFile, kept, endCell - beginCell);
      return addRun(kind, kept, endCell - beginCell, inFile != kind.corners);
    }
    for (std::size_t cell = beginCell; cell < endCell; ++cell) {
      const std::uint32_t* nodes = from + begin(cell);
      mesh_.nodes.insert(mesh_.nodes.end(), nodes, nodes + kind.corners);
      addRun(kind, kind.corners, 1, cells_.ends[cell] - begin(cell) != kind.corners);
    }
  }

  void copyCorners(const std::uint32_t* from, std::size_t stride, std::size_t corners,
                   std::size_t count) {
    if (stride == corners) {
      mesh_.nodes.insert(mesh_.nodes.end(), from, from + count * corners);
      return;
    }
    const std::size_t old = mesh_.nodes.size();
    mesh_.nodes.resize(old + count * corners);
    std::uint32_t* to = mesh_.nodes.data() + old;
    for (std::size_t i = 0; i < count; ++i, from += stride)
      to = std::copy_n(from, corners, to);
  }

  // Corners of flat cells with area; strips and pixels have their own orders.
  static constexpr std::uint8_t kStrip = 6, kPolygon = 7, kPixel = 8, kQuadraticPolygon = 36;
  static std::size_t cornersOf(std::uint8_t type) {
    switch (type) {
    case 5:
    case 22:
    case 34:
    case 61:
    case 69:
    case 76:
      return 3;
    case kPixel:
    case 9:
    case 23:
    case 28:
    case 30:
    case 62:
    case 70:
    case 77:
      return 4;
    default:
      return 0;
    }
  }
  static bool isPolygon(std::uint8_t type) {
    return cornersOf(type) != 0 || type == kStrip || type == kPolygon || type == kQuadraticPolygon;
  }
  void appendPolygons(const CellProperties& kind, std::size_t beginCell, std::size_t endCell) {
    const std::uint8_t type = cells_.types[beginCell];
    for (std::size_t cell = beginCell; cell < endCell; ++cell) {
      const std::uint32_t* nodes = cells_.connectivity.data() + begin(cell);
      const std::size_t n = cells_.ends[cell] - begin(cell), corners = cornersOf(type);
      if (n < std::max<std::size_t>(corners, 1) || n > 0xffffffffu)
        failSize(cell, std::max<std::size_t>(corners, 1), false);
      if (type == kStrip) { // every second triangle is reversed
        for (std::size_t i = 0; i + 2 < n; ++i)
          addPolygon(kind, {nodes[i], nodes[i + 1 + i % 2], nodes[i + 2 - i % 2]});
      } else if (type == kPixel) {
        addPolygon(kind, {nodes[0], nodes[1], nodes[3], nodes[2]});
      } else {
        const std::size_t kept = corners != 0 ? corners : type == kPolygon ? n : n / 2;
        mesh_.nodes.insert(mesh_.nodes.end(), nodes, nodes + kept);
        addRun(kind, static_cast<std::uint32_t>(kept), 1, false);
      }
    }
  }
  void addPolygon(const CellProperties& kind, std::initializer_list<std::uint32_t> corners) {
    mesh_.nodes.insert(mesh_.nodes.end(), corners);
    addRun(kind, static_cast<std::uint32_t>(corners.size()), 1, false);
  }

  void appendPolyhedra(const CellProperties& kind, std::size_t beginCell, std::size_t endCell) {
    const bool inlineFaces = cells_.facesInConnectivity;
    const auto& stream = inlineFaces ? cells_.connectivity : cells_.faces;
    if (!inlineFaces && cells_.faceEnds.size() != cells_.types.size())
      fail(beginCell, "is a polyhedron, but the file has no faces for it");
    for (std::size_t cell = beginCell; cell < endCell; ++cell) {
      const std::uint64_t first = inlineFaces ? begin(cell) : faceBegin_;
      const std::uint64_t last = inlineFaces ? cells_.ends[cell] : cells_.faceEnds[cell];
      if (last <= first || last > stream.size() || last - first > 0xffffffffu)
        fail(cell, type(cell) + " has face offsets that do not fit its faces");
      checkFaces(cell, stream.data() + first, stream.data() + last);
      mesh_.nodes.insert(mesh_.nodes.end(), stream.data() + first, stream.data() + last);
      addRun(kind, static_cast<std::uint32_t>(last - first), 1, false);
      faceBegin_ = last;
    }
  }
  void checkFaces(std::size_t cell, const std::uint32_t* at, const std::uint32_t* end) const {
    const std::uint32_t faces = *at++;
    for (std::uint32_t face = 0; face < faces; ++face) {
      if (at == end || *at < 3 || *at > static_cast<std::size_t>(end - at - 1))
        fail(cell, type(cell) + " has a list of faces that does not fit its length");
      const std::uint32_t* last = at + 1 + *at;
      for (++at; at < last; ++at)
        if (*at >= points_)
          failNode(cell, *at);
    }
    if (at != end)
      fail(cell, type(cell) + " has a list of faces that does not fit its length");
  }

  void addRun(const CellProperties& kind, std::uint32_t nodesPerCell, std::size_t count,
              bool quadratic) {
    if (lastKind_ == &kind && mesh_.runs.back().nodesPerCell == nodesPerCell &&
        mesh_.runs.back().quadratic == quadratic) {
      mesh_.runs.back().count += count;
      return;
    }
    mesh_.runs.push_back({kind.type, nodesPerCell, count, kind.name, quadratic});
    lastKind_ = &kind;
  }

  Cells& cells_;
  CellMesh& mesh_;
  Progress& progress_;
  bool faces_;
  std::size_t points_;
  std::uint64_t faceBegin_ = 0;
  const CellProperties* lastKind_ = nullptr;
  std::size_t runs_ = 0;
};

void warnDropped(const Attribute& attribute, Report& report) {
  const std::string text =
      "the array '" + attribute.name +
      "' is left out: some piece lacks it or has it with another number of components";
  for (const Warning& warning : report.warnings) // once, for any number of pieces
    if (warning.text == text)
      return;
  report.warn("array-not-in-all-pieces", text);
}

// Appends, as the wider type if they differ.
void appendValues(Attribute::Values& to, const Attribute::Values& from) {
  const auto widen = [&](auto tag) {
    using Wide = decltype(tag);
    if (std::holds_alternative<std::vector<Wide>>(to))
      return;
    std::vector<Wide> wide;
    std::visit(
        [&](const auto& v) {
          wide.reserve(v.size());
          for (auto x : v)
            wide.push_back(static_cast<Wide>(x));
        },
        to);
    to = std::move(wide);
  };
  const bool integers = to.index() >= 2 && from.index() >= 2;
  if (to.index() != from.index()) {
    if (integers)
      widen(std::int64_t{});
    else
      widen(double{});
  }
  std::visit(
      [&](auto& a, const auto& b) {
        using Value = typename std::decay_t<decltype(a)>::value_type;
        if constexpr (std::is_same_v<std::decay_t<decltype(a)>, std::decay_t<decltype(b)>>) {
          a.insert(a.end(), b.begin(), b.end());
        } else {
          a.reserve(a.size() + b.size());
          for (auto x : b)
            a.push_back(static_cast<Value>(x));
        }
      },
      to, from);
}

void appendAttributes(CellMesh& whole, CellMesh& piece, Report& report) {
  std::vector<bool> used(piece.attributes.size(), false);
  std::vector<Attribute> kept;
  for (Attribute& attribute : whole.attributes) {
    std::size_t i = 0;
    for (; i < used.size(); ++i) {
      const Attribute& other = piece.attributes[i];
      if (!used[i] && other.on == attribute.on && other.name == attribute.name &&
          other.components == attribute.components)
        break;
    }
    if (i == used.size()) {
      warnDropped(attribute, report);
      continue;
    }
    used[i] = true;
    appendValues(attribute.values, piece.attributes[i].values);
    kept.push_back(std::move(attribute));
  }
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i])
      warnDropped(piece.attributes[i], report);
  whole.attributes = std::move(kept);
}

} // namespace

const CellProperties& cellKind(std::uint8_t type) {
  static const Kinds kinds = makeKinds();
  return kinds[type];
}

void appendCells(Cells&& cells, CellMesh& mesh, Progress& progress, bool faces) {
  Appender(cells, mesh, progress, faces).run();
}

void appendPiece(CellMesh& whole, CellMesh&& piece, Report& report) {
  if (piece.points.empty() && piece.runs.empty()) // empty, and often without any array
    return;
  if (whole.points.empty() && whole.runs.empty()) {
    whole = std::move(piece);
    return;
  }
  const std::size_t first = whole.points.size();
  if (first + piece.points.size() >= 0xffffffffu)
    throw Error(Status::Limit, "", "the pieces together have more than 2^32 - 2 points",
                "read them one by one");
  appendAttributes(whole, piece, report); // unread arrays are those of the first piece
  whole.points.insert(whole.points.end(), piece.points.begin(), piece.points.end());

  const auto shift = static_cast<std::uint32_t>(first);
  std::uint32_t* at = piece.nodes.data();
  for (const CellRun& run : piece.runs) {
    std::uint32_t* const end = at + run.count * run.nodesPerCell;
    if (run.type != CellType::Polyhedron) {
      for (; at < end; ++at)
        *at += shift;
      continue;
    }
    while (at < end)
      for (std::uint32_t faces = *at++; faces > 0; --faces)
        for (std::uint32_t nodes = *at++; nodes > 0; --nodes)
          *at++ += shift;
  }
  whole.nodes.insert(whole.nodes.end(), piece.nodes.begin(), piece.nodes.end());
  for (CellRun& run : piece.runs) {
    CellRun* last = whole.runs.empty() ? nullptr : &whole.runs.back();
    if (last && last->type == run.type && last->nodesPerCell == run.nodesPerCell &&
        last->quadratic == run.quadratic && last->fileType == run.fileType)
      last->count += run.count;
    else
      whole.runs.push_back(std::move(run));
  }
}

} // namespace tetvdb::vtk
