// SPDX-License-Identifier: Apache-2.0
#include "io/BlockSample.h"
#include "io/ResultSamples.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/cgns/CgnsReader.h"

#define H5_USE_110_API
#include <cgnslib.h>
#include <cstdio>
#include <hdf5.h>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;

/// A file that libcgns writes.
class Written {
public:
  explicit Written(int type)
      : path_(testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + ".cgns") {
    cg_set_file_type(type);
    check(cg_open(path_.c_str(), CG_MODE_WRITE, &file));
    check(cg_base_write(file, "empty", 3, 3, &base));
    check(cg_base_write(file, "base", 3, 3, &base));
  }
  ~Written() {
    close();
    std::remove(path_.c_str());
  }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;

  static void check(int status) { ASSERT_EQ(status, CG_OK) << cg_get_error(); }
  void close() {
    if (file >= 0)
      check(cg_close(file));
    file = -1;
  }
  /// The cube with the pyramid on top, as an unstructured zone.
  int unstructured() {
    const cgsize_t size[3] = {9, 2, 0};
    int zone = 0, unused = 0;
    check(cg_zone_write(file, base, "solid", size, Unstructured, &zone));
    for (int k = 0; k < 3; ++k) {
      double x[9];
      for (int i = 0; i < 9; ++i)
        x[i] = kCubeAndTip[i][k];
      const std::string name = std::string("Coordinate") + "XYZ"[k];
      check(cg_coord_write(file, base, zone, RealDouble, name.c_str(), x, &unused));
    }
    return zone;
  }
  void elements(int zone, const char* name, ElementType_t type, cgsize_t first, cgsize_t last,
                const std::vector<cgsize_t>& nodes, const std::vector<cgsize_t>& offsets = {}) {
    int unused = 0;
    check(offsets.empty() ? cg_section_write(file, base, zone, name, type, first, last, 0,
                                             nodes.data(), &unused)
                          : cg_poly_section_write(file, base, zone, name, type, first, last, 0,
                                                  nodes.data(), offsets.data(), &unused));
  }
  void field(int zone, int solution, const char* name, const std::vector<double>& values) {
    int unused = 0;
    check(cg_field_write(file, base, zone, solution, RealDouble, name, values.data(), &unused));
  }
  CellMesh read(const ReadOptions& options = {}, Report* report = nullptr) {
    close();
    const MappedFile mapped(path_);
    Report own;
    Progress progress;
    return readCgns(mapped.source(), options, report != nullptr ? *report : own, progress);
  }
  std::string bytes() {
    close();
    return readFile(path_);
  }

  /// As a later library would have written an HDF5 file: from version 4.1 on in object headers,
  /// which have checksums.
  void setVersion(float version, H5D_layout_t layout) {
    close();
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    H5Pset_layout(creation, layout);
    const hid_t opened = H5Fopen(path_.c_str(), H5F_ACC_RDWR, access);
    const char* const name = "/CGNSLibraryVersion/ data";
    ASSERT_GE(H5Ldelete(opened, name, H5P_DEFAULT), 0);
    const hsize_t one = 1;
    const hid_t space = H5Screate_simple(1, &one, nullptr);
    const hid_t data =
        H5Dcreate2(opened, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    ASSERT_GE(H5Dwrite(data, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, &version), 0);
    H5Dclose(data);
    H5Sclose(space);
    ASSERT_GE(H5Fclose(opened), 0);
    H5Pclose(creation);
    H5Pclose(access);
  }

  int file = -1, base = 0;

private:
  std::string path_;
};

class CgnsKinds : public testing::TestWithParam<int> {};

TEST_P(CgnsKinds, SectionsAndSolutions) {
  Written file(GetParam());
  const int zone = file.unstructured();
  // A boundary between the solid cells: values at cell centres pass it over.
  file.elements(zone, "hexa", HEXA_8, 1, 1, {1, 2, 3, 4, 5, 6, 7, 8});
  file.elements(zone, "wall", TRI_3, 2, 2, {1, 2, 3});
  file.elements(zone, "pyra", PYRA_5, 3, 3, {5, 6, 7, 8, 9});
  int solution = 0;
  Written::check(cg_sol_write(file.file, file.base, zone, "nodes", Vertex, &solution));
  file.field(zone, solution, "T", {0, 1, 2, 3, 4, 5, 6, 7, 8});
  Written::check(cg_sol_write(file.file, file.base, zone, "cells", CellCenter, &solution));
  file.field(zone, solution, "P", {10, 20});
  Report report;
  const CellMesh mesh = file.read({}, &report);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "several-bases");
  EXPECT_EQ(mesh.points.size(), 9U);
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-12);
  EXPECT_EQ(arrayNamed(mesh, "T").number(8), 8);
  const Attribute& p = arrayNamed(mesh, "P");
  EXPECT_EQ(p.number(0), 10);
  EXPECT_TRUE(std::isnan(p.number(1)));
  EXPECT_EQ(p.number(2), 20);
  EXPECT_EQ(mesh.regionNames.at(1), "solid");

  const std::string bytes = file.bytes();
  EXPECT_EQ(readText(readCgns, bytes).nodes, mesh.nodes);
  for (const double share : {0.2, 0.5})
    EXPECT_NE(readingError(readCgns,
                           bytes.substr(0, static_cast<std::size_t>(share * double(bytes.size())))),
              "")
        << share;
}

// Some writers name the solid elements beside a boundary's in place of its points.
TEST_P(CgnsKinds, BoundariesWithoutPoints) {
  Written file(GetParam());
  const int zone = file.unstructured();
  file.elements(zone, "hexa", HEXA_8, 1, 1, {1, 2, 3, 4, 5, 6, 7, 8});
  file.elements(zone, "wall", TRI_3, 2, 2, {0, 0, 0});
  file.elements(zone, "pyra", PYRA_5, 3, 3, {5, 6, 7, 8, 9});
  EXPECT_NEAR(cellVolume(file.read()), 1 + 1.0 / 3, 1e-12);
  const std::string bytes = file.bytes();
  ReadOptions faces;
  faces.faces = true;
  Report report;
  Progress progress;
  EXPECT_THROW(readCgns({bytes, "memory"}, faces, report, progress), Error);
}

// Polyhedra, whose elements changed last.
TEST(CgnsReader, FilesOfLaterVersions) {
  for (const H5D_layout_t layout : {H5D_CONTIGUOUS, H5D_COMPACT}) {
    Written file(CG_FILE_HDF5);
    const int zone = file.unstructured();
    file.elements(zone, "faces", NGON_n, 1, 5, {5, 6, 7, 8, 5, 6, 9, 6, 7, 9, 7, 8, 9, 8, 5, 9},
                  {0, 4, 7, 10, 13, 16});
    file.elements(zone, "cell", NFACE_n, 6, 6, {-1, 2, 3, 4, 5}, {0, 5});
    const CellMesh before = file.read();
    EXPECT_EQ(before.cellCount(), 1U);
    file.setVersion(4.4F, layout);
    const std::string bytes = file.bytes();
    Report report;
    Progress progress;
    for (const CellMesh& mesh : {file.read(), readCgns({bytes, "memory"}, {}, report, progress)}) {
      EXPECT_EQ(mesh.points, before.points);
      EXPECT_EQ(mesh.nodes, before.nodes);
      EXPECT_EQ(mesh.cellCount(), 1U);
    }
    EXPECT_TRUE(file.bytes() == bytes); // the file itself is as it was
  }
}

TEST_P(CgnsKinds, MixedAndPolyhedra) {
  Written file(GetParam());
  const int zone = file.unstructured();
  file.elements(zone, "mixed", MIXED, 1, 1, {HEXA_8, 1, 2, 3, 4, 5, 6, 7, 8}, {0, 9});
  // The pyramid by its faces; the first is seen from the other side.
  file.elements(zone, "faces", NGON_n, 2, 6, {5, 6, 7, 8, 5, 6, 9, 6, 7, 9, 7, 8, 9, 8, 5, 9},
                {0, 4, 7, 10, 13, 16});
  file.elements(zone, "cells", NFACE_n, 7, 7, {-2, 3, 4, 5, 6}, {0, 5});
  const CellMesh mesh = file.read();
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-12);
}

TEST_P(CgnsKinds, StructuredZonesAndFamilies) {
  Written file(GetParam());
  for (int z = 0; z < 2; ++z) {
    const cgsize_t size[9] = {3, 2, 2, 2, 1, 1, 0, 0, 0};
    int zone = 0, unused = 0, solution = 0;
    Written::check(
        cg_zone_write(file.file, file.base, z == 0 ? "a" : "b", size, Structured, &zone));
    for (int k = 0; k < 3; ++k) {
      std::vector<double> x;
      for (int i = 0; i < 12; ++i)
        x.push_back(k == 0 ? i % 3 : k == 1 ? i / 3 % 2 : i / 6 + 2 * z);
      const std::string name = std::string("Coordinate") + "XYZ"[k];
      Written::check(
          cg_coord_write(file.file, file.base, zone, RealDouble, name.c_str(), x.data(), &unused));
    }
    Written::check(cg_goto(file.file, file.base, "Zone_t", zone, "end"));
    Written::check(cg_famname_write("water"));
    Written::check(cg_sol_write(file.file, file.base, zone, "s", CellCenter, &solution));
    file.field(zone, solution, "P", {1.0 + z, 2.0 + z});
  }
  const CellMesh mesh = file.read();
  EXPECT_NEAR(cellVolume(mesh), 4, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 1, 1, 1}));
  EXPECT_EQ(mesh.regionNames.at(1), "water");
  EXPECT_EQ(arrayNamed(mesh, "P").number(3), 3);
}

TEST_P(CgnsKinds, StepsChooseSolutions) {
  Written file(GetParam());
  const int zone = file.unstructured();
  file.elements(zone, "hexa", HEXA_8, 1, 1, {1, 2, 3, 4, 5, 6, 7, 8});
  int solution = 0;
  std::string names;
  for (const int step : {0, 1}) {
    const std::string name = "step" + std::to_string(step);
    Written::check(cg_sol_write(file.file, file.base, zone, name.c_str(), Vertex, &solution));
    file.field(zone, solution, "T", std::vector<double>(9, 7.0 + step));
    names += name + std::string(32 - name.size(), ' ');
  }
  const double times[2] = {0.25, 0.75};
  const cgsize_t two = 2, table[2] = {32, 2};
  Written::check(cg_biter_write(file.file, file.base, "times", 2));
  Written::check(cg_goto(file.file, file.base, "BaseIterativeData_t", 1, "end"));
  Written::check(cg_array_write("TimeValues", RealDouble, 1, &two, times));
  Written::check(cg_ziter_write(file.file, file.base, zone, "steps"));
  Written::check(cg_goto(file.file, file.base, "Zone_t", zone, "ZoneIterativeData_t", 1, "end"));
  Written::check(cg_array_write("FlowSolutionPointers", Character, 2, table, names.data()));
  EXPECT_EQ(arrayNamed(file.read(), "T").number(0), 8);
  ReadOptions first;
  first.timeStep = 0;
  EXPECT_EQ(arrayNamed(file.read(first), "T").number(0), 7);
  EXPECT_EQ(file.read(first).times, (std::vector<double>{0.25, 0.75}));
  const std::string bytes = file.bytes();
  Report report;
  Progress progress;
  EXPECT_EQ(cgnsTimes({bytes, "file"}, report, progress), (std::vector<double>{0.25, 0.75}));
}

TEST_P(CgnsKinds, LinksAreRefused) {
  Written file(GetParam());
  file.unstructured();
  Written::check(cg_goto(file.file, file.base, "end"));
  Written::check(cg_link_write("Zone2", "/etc/passwd", "/Base/Zone"));
  EXPECT_NE(readingError(readCgns, file.bytes()).find("other file"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, CgnsKinds, testing::Values(CG_FILE_HDF5, CG_FILE_ADF));

} // namespace
} // namespace tetvdb
