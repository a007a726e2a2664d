// SPDX-License-Identifier: Apache-2.0
//
// Small meshes as text and bytes in many formats, and what the tests of readers need around them.
#pragma once

#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

namespace tetvdb::test {

using ReadFunction = CellMesh (*)(const Source&, const ReadOptions&, Report&, Progress&);

inline CellMesh readText(ReadFunction read, const std::string& text, Report* report = nullptr,
                         const ReadOptions& options = {}) {
  Report own;
  Progress progress;
  return read(Source{text, "file"}, options, report != nullptr ? *report : own, progress);
}

/// The message of the Error(Invalid) that reading throws; "" where it does not.
inline std::string readingError(ReadFunction read, const std::string& text) {
  try {
    readText(read, text);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return {};
}

inline TetMesh splitAll(CellMesh mesh) {
  Report report;
  Progress progress;
  return splitCells(std::move(mesh), {}, report, progress);
}

inline double tetVolume(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::uint32_t* n = mesh.tets.data() + 4 * t;
    sum += std::abs(sixfoldVolume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]],
                                  mesh.points[n[3]])) /
           6;
  }
  return sum;
}

inline double cellVolume(CellMesh mesh) {
  return tetVolume(splitAll(std::move(mesh)));
}

inline std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::string dataFile(const std::string& name) {
  return std::string(TETVDB_TEST_DATA) + "/" + name;
}

/// Text and numbers one after the other, in this machine's byte order or the other.
class Bytes {
public:
  explicit Bytes(bool swap = false) : swap_(swap) {}

  Bytes& text(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  template <class T>
  Bytes& add(std::initializer_list<T> numbers) {
    for (const T number : numbers) {
      const T stored = swap_ ? byteSwapped(number) : number;
      bytes_.append(reinterpret_cast<const char*>(&stored), sizeof stored);
    }
    return *this;
  }
  Bytes& ints(std::initializer_list<std::int32_t> numbers) { return add(numbers); }
  Bytes& sizes(std::initializer_list<std::uint64_t> numbers) { return add(numbers); }
  Bytes& doubles(std::initializer_list<double> numbers) { return add(numbers); }
  Bytes& floats(std::initializer_list<float> numbers) { return add(numbers); }

  const std::string& str() const { return bytes_; }

private:
  std::string bytes_;
  bool swap_;
};

// Two tets and a triangle on five points with scattered numbers: volume 1/6 + 1/3.
inline const char* const kGmsh1 = R"($NOD
5
10 0 0 0
20 1 0 0
30 0 1 0
40 0 0 1
77 1 1 1
$ENDNOD
$ELM
3
1 2 7 1 3 10 20 30
5 4 3 1 4 10 20 30 40
9 4 4 1 4 20 30 40 77
$ENDELM
)";

inline const char* const kGmsh2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 7 "skin"
3 3 "soft part"
3 4 "bone"
$EndPhysicalNames
$Nodes
5
10 0 0 0
20 1 0 0
30 0 1 0
40 0 0 1
77 1 1 1
$EndNodes
$Elements
3
1 2 2 7 1 10 20 30
5 4 2 3 1 10 20 30 40
9 4 4 4 2 1 5 20 30 40 77
$EndElements
$Comments
whatever stands here
$EndComments
$NodeData
1
"temperature"
1
0.0
3
0
1
5
10 1
20 2
30 3
40 4
77 5
$EndNodeData
$ElementData
1
"stress"
1
0.0
3
0
3
1
9 1.5 2.5 3.5
$EndElementData
)";

inline const char* const kGmsh40 = R"($MeshFormat
4 0 8
$EndMeshFormat
$Entities
1 0 1 2
1 0 0 0 0 0 0 0
1 0 0 0 1 1 0 0 0
1 0 0 0 1 1 1 1 3 1 1
2 0 0 0 1 1 1 1 4 0
$EndEntities
$Nodes
2 5
1 3 0 4
10 0 0 0
20 1 0 0
30 0 1 0
40 0 0 1
2 2 1 1
77 1 1 1 0.5 0.5
$EndNodes
$Elements
3 3
1 2 2 1
1 10 20 30
1 3 4 1
5 10 20 30 40
2 3 4 1
9 20 30 40 77
$EndElements
)";

inline const char* const kGmsh41 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
3 3 "soft part"
3 4 "bone"
$EndPhysicalNames
$Entities
1 0 1 2
1 0 0 0 0
1 0 0 0 1 1 0 0 0
1 0 0 0 1 1 1 1 3 1 1
2 0 0 0 1 1 1 2 -4 6 0
$EndEntities
$Nodes
2 5 10 77
3 1 0 4
10
20
30
40
0 0 0
1 0 0
0 1 0
0 0 1
2 1 1 1
77
1 1 1 0.5 0.5
$EndNodes
$Elements
3 3 1 9
2 1 2 1
1 10 20 30
3 1 4 1
5 10 20 30 40
3 2 4 1
9 20 30 40 77
$EndElements
)";

inline std::string gmshBinary2(bool swap) {
  return Bytes(swap)
      .text("$MeshFormat\n2.2 1 8\n")
      .ints({1})
      .text("\n$EndMeshFormat\n$Nodes\n5\n")
      .ints({10})
      .doubles({0, 0, 0})
      .ints({20})
      .doubles({1, 0, 0})
      .ints({30})
      .doubles({0, 1, 0})
      .ints({40})
      .doubles({0, 0, 1})
      .ints({77})
      .doubles({1, 1, 1})
      .text("\n$EndNodes\n$Elements\n3\n")
      .ints({2, 1, 2, 1, 7, 1, 10, 20, 30})
      .ints({4, 2, 2, 5, 3, 1, 10, 20, 30, 40, 9, 4, 2, 20, 30, 40, 77})
      .text("\n$EndElements\n$ElementData\n1\n\"stress\"\n1\n0\n3\n0\n1\n1\n")
      .ints({9})
      .doubles({1.5})
      .text("\n$EndElementData\n")
      .str();
}

inline std::string gmshBinary40(bool swap) {
  return Bytes(swap)
      .text("$MeshFormat\n4 1 8\n")
      .ints({1})
      .text("\n$EndMeshFormat\n$Entities\n")
      .sizes({0, 0, 0, 1})
      .ints({1})
      .doubles({0, 0, 0, 1, 1, 1})
      .sizes({1})
      .ints({3})
      .sizes({0})
      .text("\n$EndEntities\n$Nodes\n")
      .sizes({1, 5})
      .ints({1, 3, 0})
      .sizes({5})
      .ints({10})
      .doubles({0, 0, 0})
      .ints({20})
      .doubles({1, 0, 0})
      .ints({30})
      .doubles({0, 1, 0})
      .ints({40})
      .doubles({0, 0, 1})
      .ints({77})
      .doubles({1, 1, 1})
      .text("\n$EndNodes\n$Elements\n")
      .sizes({1, 2})
      .ints({1, 3, 4})
      .sizes({2})
      .ints({5, 10, 20, 30, 40, 9, 20, 30, 40, 77})
      .text("\n$EndElements\n")
      .str();
}

inline std::string gmshBinary41(bool swap) {
  return Bytes(swap)
      .text("$MeshFormat\n4.1 1 8\n")
      .ints({1})
      .text("\n$EndMeshFormat\n$Entities\n")
      .sizes({0, 0, 0, 1})
      .ints({1})
      .doubles({0, 0, 0, 1, 1, 1})
      .sizes({1})
      .ints({3})
      .sizes({0})
      .text("\n$EndEntities\n$Nodes\n")
      .sizes({1, 5, 10, 77})
      .ints({3, 1, 0})
      .sizes({5, 10, 20, 30, 40, 77})
      .doubles({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1})
      .text("\n$EndNodes\n$Elements\n")
      .sizes({1, 2, 5, 9})
      .ints({3, 1, 4})
      .sizes({2, 5, 10, 20, 30, 40, 9, 20, 30, 40, 77})
      .text("\n$EndElements\n")
      .str();
}

// A hexahedron, a wedge on its side, a pyramid on its top, a tet and a triangle: 1 + 1/2 + 1/3 +
// 1/6.
inline const char* const kMedit = R"(MeshVersionFormatted 2
# a comment
Dimension 3
Vertices
11
0 0 0 0
1 0 0 0
1 1 0 0
0 1 0 0
0 0 1 0
1 0 1 0
1 1 1 0
0 1 1 0
2 0 0 0
2 0 1 0
0.5 0.5 2 0
Corners
2
1 2
Triangles
1
1 2 3 5
Hexahedra
1
1 2 3 4 5 6 7 8 1
Prisms
1
2 9 3 6 10 7 2
Pyramids
1
5 6 7 8 11 3
Tetrahedra
1
1 2 4 5 4
End
)";

inline std::string meditBinary(int version, bool swap) {
  Bytes bytes(swap);
  bytes.ints({1, version});
  const std::size_t width = version < 4 ? 4 : 8;
  const auto keyword = [&](std::int32_t code, std::uint64_t size) {
    const std::size_t head = version < 3 ? 8 : 12;
    bytes.ints({code});
    const std::uint64_t next = size == 0 ? 0 : bytes.str().size() - 4 + head + size;
    if (version < 3)
      bytes.ints({static_cast<std::int32_t>(next)});
    else
      bytes.sizes({next});
  };
  const auto integers = [&](std::initializer_list<std::int32_t> numbers) {
    for (const std::int32_t number : numbers)
      if (version < 4)
        bytes.ints({number});
      else
        bytes.add({std::int64_t(number)});
  };
  const auto point = [&](double x, double y, double z) {
    if (version == 1)
      bytes.floats({float(x), float(y), float(z)});
    else
      bytes.doubles({x, y, z});
    integers({0});
  };
  keyword(3, 4);
  bytes.ints({3});
  keyword(4, width + 5 * ((version == 1 ? 12 : 24) + width));
  integers({5});
  point(0, 0, 0), point(1, 0, 0), point(0, 1, 0), point(0, 0, 1), point(1, 1, 1);
  keyword(13, 2 * width); // corners, which are skipped
  integers({1, 1});
  keyword(6, 5 * width);
  integers({1, 1, 2, 3, 9});
  keyword(8, 11 * width);
  integers({2, 1, 2, 3, 4, 3, 2, 3, 4, 5, 4});
  keyword(54, 0);
  return bytes.str();
}

inline const char* const kNode = R"(# nodes, counted from 0
5 3 1 1

0 0 0 0  1.5 0
1 1 0 0  2.5 1 # a comment
2 0 1 0  3.5 0
3 0 0 1  4.5 0
4 1 1 1  5.5 0
)";
inline const char* const kEle = R"(2 4 2
0  0 1 2 3  7 0.5
1  1 2 3 4  8 0.25
)";

inline const char* const kNetgen = R"(# Generated by NETGEN
mesh3d
dimension
3
geomtype
0

# surfnr    bcnr   domin  domout      np      p1      p2      p3
surfaceelements
1
 2 1 1 0 3 1 2 3

#  matnr      np      p1      p2      p3      p4
volumeelements
2
1 4 1 2 3 4
2 10 2 3 4 5 1 1 1 1 1 1

# surfid  0   p1   p2   trignum1    trignum2
edgesegmentsgi2
1
1 0 1 2 -1 -1 1 0 1 0 1 0

#          X             Y             Z
points
5
0 0 0
1.0 0 0
0 1 0
0 0 1e0
1 1 1
#          pnum             index
pointelements
0
materials
2
1 inner part
2 shell
bcnames
1
1 points
endmesh
)";

inline const char* const kAbaqus = R"(*Heading
 a deck
** a comment
*NODE, NSET=Nall
10, 0., 0., 0.
20, 1.
30, 0., 1.D0
40, ,,+1.0E+00
77, 1., 1., 1.
*Element, type=S3, elset=skin
1, 10, 20, 30
*Element, type=C3D4, elset=Eall
5, 10, 20, 30, 40
9, 20, 30,
40, 77
*Elset, elset=bone, generate
8, 10, 1
*Elset, elset="Soft Part"
5,
*Material, name=steel
*Elastic
210000., 0.3
*Step
*End Step
)";

inline const char* const kUcd = R"(# AVS
9 3 1 2 0
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0.5 0.5 1
7 0 0 -1
8 1 0 -1
9 1 1 -1
10 0 1 -1
1 1 pyr 5 1 2 3 4
2 2 hex 1 2 3 4 7 8 9 10
3 9 tri 1 2 3
1 1
temperature, K
1 1
2 2
3 3
4 4
5 5
7 7
8 8
9 9
10 1e1
2 1 2
density, kg
flow, m
1 0.5 1 2
2 0.25 3 4
3 0 0 nan
)";

inline std::string ucdBinary(bool swap) {
  Bytes bytes(swap);
  bytes.text("\x07").ints({9, 2, 1, 0, 0, 13});
  bytes.ints({1, 1, 5, 5, 2, 2, 8, 7}); // number, material, corners, kind
  bytes.ints({5, 1, 2, 3, 4, 1, 2, 3, 4, 6, 7, 8, 9});
  bytes.floats({0, 1, 1, 0, 0.5F, 0, 1, 1, 0});
  bytes.floats({0, 0, 1, 1, 0.5F, 0, 0, 1, 1});
  bytes.floats({0, 0, 0, 0, 1, -1, -1, -1, -1});
  std::string label = "temperature.";
  label.resize(1024, '\0');
  bytes.text(label).text(std::string(1024, '\0'));
  bytes.ints({1, 1}).floats({1, 9}).floats({1, 2, 3, 4, 5, 6, 7, 8, 9}).ints({0});
  return bytes.str();
}

/// `text` with `to` in place of the first `from`, which must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

} // namespace tetvdb::test
