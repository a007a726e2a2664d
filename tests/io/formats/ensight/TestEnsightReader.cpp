// SPDX-License-Identifier: Apache-2.0
#include "io/BlockSample.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/ensight/EnsightReader.h"

#include <filesystem>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;
namespace fs = std::filesystem;

TEST(EnsightReader, FilesOfAStep) {
  const std::string path = dataFile("readers/ensight.0.case");
  const MappedFile file(path);
  std::vector<std::string> names;
  for (const std::string& name : ensightFiles(file.source(), -1))
    names.push_back(name.substr(name.rfind('/') + 1));
  EXPECT_EQ(names, (std::vector<std::string>{"ensight.0.00000.geo", "ensight.0.00000_n.T",
                                             "ensight.0.00000_n.V", "ensight.0.00000_c.C"}));
  EXPECT_THROW(ensightFiles(file.source(), 7), Error);
}

TEST(EnsightReader, CBinaryAsVtkWritesIt) {
  const CellMesh mesh = readSample(readEnsight, "ensight.0.case");
  expectBlocks(mesh, 1, "T_n", "C_c");
  const Attribute& v = arrayNamed(mesh, "V_n");
  EXPECT_EQ(v.components, 3U);
  for (std::size_t i = 0; i < 27; ++i)
    for (std::uint32_t k = 0; k < 3; ++k)
      EXPECT_EQ(v.number(i, k), mesh.points[i][k]);
}

/// A case of two parts as text, with two steps: a tet and a polyhedron of the same shape, and a
/// quadrilateral.
class TextCase : public testing::Test {
protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "tetvdb_ensight_" + std::to_string(::getpid());
    fs::create_directories(folder_);
    write("a.case", kCase);
    write("a.geo", kGeometry);
    for (const int step : {0, 1}) {
      const std::string number = std::to_string(step);
      write("t00" + number + ".scl", "T\npart\n1\ncoordinates\n" + number + "1\n" + number + "2\n" +
                                         number + "3\n" + number + "4\n");
      write("s.ten", "S\npart\n1\ntetra4\n1\n2\n3\n4\n5\n6\nnfaced\n7\n8\n9\n10\n11\n12\n");
    }
    write("p.scl", "P\npart\n2\ncoordinates partial\n2\n1\n3\n0.5\n1.5\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
  }
  CellMesh readCase(const ReadOptions& options = {}) const {
    const MappedFile file(folder_ + "/a.case");
    Report report;
    Progress progress;
    return readEnsight(file.source(), options, report, progress);
  }
  std::string caseError() const {
    try {
      readCase();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  const std::string kCase =
      "# made by hand\nFORMAT\ntype:  ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\n"
      "scalar per node: 1 T t***.scl\ntensor symm per element: S s.ten\n"
      "scalar per node: P p.scl\nTIME\ntime set: 1\nnumber of steps: 2\n"
      "filename start number: 0\nfilename increment: 1\ntime values: 0.5\n 1.5\n";
  const std::string kGeometry =
      "one\ntwo\nnode id assign\nelement id given\npart\n         1\n\ncoordinates\n         4\n"
      " 0.0\n 1.0\n 0.0\n 0.0\n 0.0\n 0.0\n 1.0\n 0.0\n 0.0\n 0.0\n 0.0\n 1.0\n"
      "tetra4\n         1\n         7\n         1         2         3         4\n"
      "nfaced\n         1\n         8\n         4\n         3\n         3\n         3\n         3\n"
      "1 2 3\n1 4 2\n2 4 3\n1 3 4\npart\n         2\nskin\ncoordinates\n         4\n"
      " 0\n 1\n 1\n 0\n 0\n 0\n 1\n 1\n 5\n 5\n 5\n 5\nquad4\n         1\n         9\n"
      "         1         2         3         4\n";
  std::string folder_;
};

TEST_F(TextCase, PartsVariablesAndSteps) {
  const CellMesh mesh = readCase();
  EXPECT_EQ(mesh.points.size(), 8U);
  EXPECT_EQ(mesh.points[3], (Vec3d{0, 0, 1}));
  EXPECT_NEAR(cellVolume(mesh), 2.0 / 6, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 1, 2}));
  EXPECT_EQ(mesh.regionNames.at(2), "skin");
  EXPECT_EQ(arrayNamed(mesh, "T").number(3), 14);
  EXPECT_TRUE(std::isnan(arrayNamed(mesh, "T").number(4))); // of the other part
  // xx yy zz xy xz yz become xx yy zz xy yz xz.
  const Attribute& tensor = arrayNamed(mesh, "S");
  EXPECT_EQ(tensor.number(0, 4), 6);
  EXPECT_EQ(tensor.number(0, 5), 5);
  EXPECT_EQ(tensor.number(1, 0), 7);
  EXPECT_TRUE(std::isnan(tensor.number(2, 0)));
  EXPECT_EQ(arrayNamed(mesh, "P").number(6), 1.5);
  EXPECT_TRUE(std::isnan(arrayNamed(mesh, "P").number(5)));

  ReadOptions first;
  first.timeStep = 0;
  EXPECT_EQ(arrayNamed(readCase(first), "T").number(0), 1);
  first.timeStep = 2;
  EXPECT_THROW(readCase(first), Error);
  Report report;
  Progress progress;
  EXPECT_EQ(ensightTimes({kCase, "a.case"}, report, progress), (std::vector<double>{0.5, 1.5}));
}

// Two cells one after the other along x: by the coordinates along each axis, and by steps.
TEST_F(TextCase, StraightBlocks) {
  write("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\n"
                  "scalar per element: C c.scl\n");
  write("c.scl", "C\npart\n1\nblock\n3\n4\n");
  const auto read = [&](const std::string& block) {
    write("a.geo", "one\ntwo\nnode id off\nelement id off\npart\n1\nblocks\n" + block);
    return readCase();
  };
  const CellMesh uniform = read("block uniform\n3 2 2\n1\n2\n3\n0.5\n0.25\n2\n");
  const CellMesh rectilinear = read("block rectilinear\n3 2 2\n1\n1.5\n2\n2\n2.25\n3\n5\n");
  EXPECT_EQ(uniform.points.size(), 12U);
  EXPECT_EQ(uniform.points, rectilinear.points);
  EXPECT_EQ(uniform.points[11], (Vec3d{2, 2.25, 5}));
  EXPECT_NEAR(cellVolume(uniform), 2 * 0.5 * 0.25 * 2, 1e-12);
  EXPECT_EQ(arrayNamed(rectilinear, "C").number(1), 4);
  for (const char* block : {"block rectilinear iblanked\n2 2 2\n", "block uniform\n2 2 2\n0\n0\n",
                            "block uniform\n2000000000 2000000000 2\n0\n0\n0\n1\n1\n1\n"})
    EXPECT_THROW(read(block), Error) << block;
}

// Steps of one file after the other, and of two files with numbers.
TEST_F(TextCase, SeveralStepsInAFile) {
  const auto step = [](const std::string& text) {
    return "BEGIN TIME STEP\n" + text + "END TIME STEP\n";
  };
  const auto values = [&](int from) {
    std::string text = "T\npart\n1\ncoordinates\n";
    for (int i = 0; i < 4; ++i)
      text += std::to_string(from + i) + "\n";
    return step(text);
  };
  std::string moved = kGeometry;
  moved.replace(moved.find(" 0.0\n 1.0"), 4, "-1.0");
  write("a.geo", step(moved) + step(kGeometry) + step(moved));
  write("t01.scl", values(10) + values(20));
  write("t07.scl", values(30));
  write("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 2 a.geo\nVARIABLE\n"
                  "scalar per node: 1 1 T t**.scl\nTIME\ntime set: 1\nnumber of steps: 3\n"
                  "time values: 0 1 2\nFILE\nfile set: 1\nfilename index: 1\nnumber of steps: 2\n"
                  "filename index: 7\nnumber of steps: 1\nfile set: 2\nnumber of steps: 3\n");
  for (const int at : {0, 1, 2}) {
    ReadOptions options;
    options.timeStep = at;
    const CellMesh mesh = readCase(options);
    EXPECT_EQ(mesh.points[0], (Vec3d{at == 1 ? 0.0 : -1.0, 0, 0})) << at;
    EXPECT_EQ(arrayNamed(mesh, "T").number(2), 10 * (at + 1) + 2) << at;
    EXPECT_EQ(mesh.times.size(), 3U);
  }
  write("t07.scl", values(30).substr(0, 30));
  EXPECT_NE(caseError().find("does not end"), std::string::npos);
}

TEST_F(TextCase, Errors) {
  const auto caseWith = [&](const std::string& from, const std::string& to) {
    std::string text = kCase;
    text.replace(text.find(from), from.size(), to);
    write("a.case", text);
    return caseError();
  };
  EXPECT_NE(caseWith("ensight gold", "ensight").find("not read"), std::string::npos);
  EXPECT_NE(caseWith("ensight gold", "ensight 6").find("EnSight Gold"), std::string::npos);
  EXPECT_NE(caseWith("a.geo", "b.geo").find("missing"), std::string::npos);
  EXPECT_NE(caseWith("a.geo", "../a.geo").find("outside its folder"), std::string::npos);
  EXPECT_NE(caseWith("steps: 2", "steps: 3").find("2 times for 3 steps"), std::string::npos);
  EXPECT_NE(caseWith("model: a.geo", "model: 1 2 a.geo").find("file set 2"), std::string::npos);
  const auto inOneFile = [&](const char* steps) {
    return caseWith("# made by hand\nFORMAT\ntype:  ensight gold\nGEOMETRY\nmodel: a.geo\n",
                    "FILE\nfile set: 1\nnumber of steps: " + std::string(steps) +
                        "\nFORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 1 a.geo\n");
  };
  EXPECT_NE(inOneFile("1").find("fewer steps"), std::string::npos);
  EXPECT_NE(inOneFile("2").find("no step 2"), std::string::npos);
  EXPECT_NE(inOneFile("0").find("no steps"), std::string::npos);
  write("a.case", kCase);
  write("a.geo", std::string("Fortran Binary") + std::string(66, ' '));
  EXPECT_NE(caseError().find("Fortran"), std::string::npos);
  std::string geometry = kGeometry;
  geometry.replace(geometry.find("3         4\nnfaced"), 11, "3         5");
  write("a.geo", geometry);
  EXPECT_NE(caseError().find("node 5"), std::string::npos);
  for (std::size_t cut : {30U, 100U, 200U, 300U, 400U}) {
    write("a.geo", kGeometry.substr(0, cut));
    EXPECT_NE(caseError(), "") << cut;
  }
}

} // namespace
} // namespace tetvdb
