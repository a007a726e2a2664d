// SPDX-License-Identifier: Apache-2.0
//
// XDMF as meshio, FEniCS and others write it. HDF5 files are made here through the library's own
// interface.
#include "Meshes.h"
#include "TemporaryFolder.h"
#include "io/SpooledSame.h"
#include "io/XdmfDocument.h"
#include "tetvdb/io/formats/xdmf/Hdf5Arrays.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"

#include <cstring>
#include <hdf5.h>

namespace tetvdb::test {
namespace {

// A folder for files that belong together.
class XdmfFiles : public ::testing::Test {
protected:
  std::string path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
  }
  CellMesh readHere(const std::string& text, const ReadOptions& options = {}) {
    report_ = {};
    return read(readXdmf, text, report_, path("run.xdmf"), options);
  }
  std::string errorHere(const std::string& text) {
    try {
      readHere(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
  }

  TemporaryFolder folder_;
  Report report_;
};

// An HDF5 file that is being written.
class H5File {
public:
  explicit H5File(const std::string& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~H5File() { H5Fclose(file_); }
  H5File(const H5File&) = delete;
  H5File& operator=(const H5File&) = delete;

  template <class T>
  void put(const std::string& name, hid_t type, const std::vector<hsize_t>& sizes,
           const std::vector<T>& values, bool packed = false) const {
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
    if (packed) {
      H5Pset_chunk(plan, static_cast<int>(sizes.size()), sizes.data());
      H5Pset_deflate(plan, 6);
    }
    const hid_t space = H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
    const hid_t set = H5Dcreate2(file_, name.c_str(), type, space, links, plan, H5P_DEFAULT);
    EXPECT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(plan);
    H5Pclose(links);
  }
  hid_t id() const { return file_; }

private:
  hid_t file_;
};

// --- Numbers in the XML -------------------------------------------------------------------------

TEST(XdmfReader, NumbersInTheXml) {
  const CellMesh cells = read(
      readXdmf,
      document(grid(
          mesh() + scalar("T", "Node", "1 2 3 4 5.5", "5") + scalar("kind", "Cell", "7 9", "2") +
          "<Attribute Name=\"v\" AttributeType=\"Vector\">" +
          item("5 3", "0 1 2 3 4 5 6 7 8 9 10 11 12 13 nan", "Format=\"XML\" Precision=\"8\"") +
          "</Attribute>")));
  expectTwoTets(cells);
  EXPECT_EQ(numbers(cells, "T", kOnPoints), (Doubles{1, 2, 3, 4, 5.5}));
  EXPECT_EQ(numbers(cells, "kind", kOnCells), (Doubles{7, 9}));
  const Doubles v = numbers(cells, "v", kOnPoints);
  ASSERT_EQ(v.size(), 15u);
  EXPECT_EQ(v[13], 13);
  EXPECT_TRUE(std::isnan(v[14]));
}

TEST(XdmfReader, IsSniffed) {
  EXPECT_EQ(sniffFormat(document(grid(mesh())), "a.xdmf"), FileFormat::Xdmf);
  EXPECT_EQ(sniffFormat("<Xdmf Version=\"2.0\"><Domain/></Xdmf>", "a"), FileFormat::Xdmf);
}

TEST(XdmfReader, CoordinatesApartAndBaseOffset) {
  const std::string text =
      document(grid(R"(<Topology Type="TETRAHEDRON" NumberOfElements="2" BaseOffset="1">)" +
                    item("8", "1 2 3 4 5 4 3 2", R"(Format="XML" DataType="Int")") + "</Topology>" +
                    "<Geometry GeometryType=\"X_Y_Z\">" + item("5", "0 1 0 0 1") +
                    item("5", "0 0 1 0 1") + item("5", "0 0 0 1 1") + "</Geometry>"));
  expectTwoTets(read(readXdmf, text));
}

TEST(XdmfReader, MixedCells) {
  // A triangle, a tet, a line of two points, a vertex, a hexahedron, a quadratic tet.
  std::string points;
  for (int i = 0; i < 12; ++i)
    points += std::to_string(i % 3) + " " + std::to_string(i % 5) + " " + std::to_string(i) + " ";
  const CellMesh cells = read(
      readXdmf, document(grid("<Topology TopologyType=\"Mixed\" NumberOfElements=\"6\">" +
                              item("36",
                                   "4 0 1 2  6 0 1 2 3  2 2 5 6  1 1 9  9 0 1 2 3 4 5 6 7 "
                                   "38 2 3 4 5 6 7 8 9 10 11",
                                   R"(Format="XML" NumberType="Int" Precision="8")") +
                              "</Topology><Geometry GeometryType=\"XYZ\">" + item("12 3", points) +
                              "</Geometry>" + scalar("id", "Cell", "0 1 2 3 4 5", "6"))));
  ASSERT_EQ(cells.runs.size(), 6u);
  const CellType types[] = {CellType::Flat, CellType::Tetra,      CellType::Flat,
                            CellType::Flat, CellType::Hexahedron, CellType::Tetra};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(cells.runs[i].type, types[i]) << i;
  EXPECT_EQ(cells.cellCount(), 6u);
  EXPECT_EQ(numbers(cells, "id", kOnCells), (Doubles{0, 1, 2, 3, 4, 5}));
}

TEST(XdmfReader, SymmetricTensorsInVtksOrder) {
  std::string six;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 6; ++k)
      six += std::to_string(10 * i + k) + " ";
  const auto with = [&](const std::string& type) {
    return numbers(read(readXdmf, document(grid(mesh() +
                                                "<Attribute Name=\"s\" Center=\"Cell\" "
                                                "AttributeType=\"" +
                                                type + "\">" + item("2 6", six) + "</Attribute>"))),
                   "s", kOnCells);
  };
  EXPECT_EQ(with("Tensor6"), (Doubles{0, 3, 5, 1, 4, 2, 10, 13, 15, 11, 14, 12}));
  EXPECT_EQ(with("Matrix"), (Doubles{0, 1, 2, 3, 4, 5, 10, 11, 12, 13, 14, 15}));
}

TEST(XdmfReader, ReferencesOfBothVersions) {
  const std::string three =
      grid("<Topology Reference=\"/Xdmf/Domain/Grid[1]/Topology[1]\"/><Geometry "
           "Reference=\"//Grid[@Name='mesh']/Geometry\"/>" +
               scalar("T", "Node", "5 4 3 2 1", "5"),
           "Name=\"fields\"");
  const CellMesh one = read(readXdmf, document(grid(mesh()) + three));
  expectTwoTets(one); // one mesh, with the attributes of both
  EXPECT_EQ(numbers(one, "T", kOnPoints), (Doubles{5, 4, 3, 2, 1}));

  const std::string two =
      grid("<Topology Reference=\"XML\">/Xdmf/Domain/Grid[1]/Topology[1]</Topology>"
           "<Geometry GeometryType=\"XYZ\"><DataItem Reference=\"XML\"><![CDATA[ "
           "/Xdmf/Domain/Grid/Geometry/DataItem ]]></DataItem></Geometry>",
           "Name=\"again\"");
  const CellMesh both = read(readXdmf, document(grid(mesh()) + two, "2.0"));
  EXPECT_EQ(both.points.size(), 10u); // another geometry: laid beside
}

TEST(XdmfReader, HyperSlabs) {
  // Every second row of three numbers out of eleven rows.
  std::string rows;
  for (int i = 0; i < 33; ++i)
    rows += std::to_string(i) + " ";
  const std::string slab = "<DataItem ItemType=\"HyperSlab\" Dimensions=\"5 3\">" +
                           item("3 2", "1 0  2 1  5 3", "Format=\"XML\" NumberType=\"Int\"") +
                           item("11 3", rows) + "</DataItem>";
  const CellMesh cells =
      read(readXdmf, document(grid(mesh() + "<Attribute Name=\"v\" AttributeType=\"Vector\">" +
                                   slab + "</Attribute>")));
  EXPECT_EQ(numbers(cells, "v", kOnPoints),
            (Doubles{3, 4, 5, 9, 10, 11, 15, 16, 17, 21, 22, 23, 27, 28, 29}));
}

TEST(XdmfReader, SpatialCollectionsAndTrees) {
  const std::string parts =
      grid(grid(mesh()) + grid(grid(mesh()), "GridType=\"Tree\""),
           "GridType=\"Collection\" CollectionType=\"Spatial\" Name=\"parts\"");
  const CellMesh cells = read(readXdmf, document(parts));
  EXPECT_EQ(cells.points.size(), 10u);
  EXPECT_EQ(cells.cellCount(), 4u);
  EXPECT_EQ(cells.nodes[8], 5u);
}

// Blocks of cells on the points of the first.
TEST(XdmfReader, PartsThatShareTheirPoints) {
  const auto part = [](const std::string& nodes, const std::string& points) {
    return grid("<Topology TopologyType=\"Tetrahedron\">" +
                item("1 4", nodes, R"(Format="XML" NumberType="Int")") + "</Topology>" + points +
                scalar("id", "Cell", nodes.substr(0, 1), "1"));
  };
  const CellMesh cells =
      read(readXdmf,
           document(grid(part("0 1 2 3", geometry()) +
                             part("4 3 2 1", "<Geometry Reference=\"//Grid/Grid[1]/Geometry\"/>"),
                         "GridType=\"Collection\" CollectionType=\"Spatial\"")));
  EXPECT_EQ(cells.points.size(), 10u);
  EXPECT_EQ(cells.nodes, (std::vector<std::uint32_t>{0, 1, 2, 3, 9, 8, 7, 6}));
  EXPECT_EQ(cells.points[9], (Vec3d{1, 1, 1}));
  EXPECT_EQ(numbers(cells, "id", kOnCells), (Doubles{0, 4}));
}

// --- Steps --------------------------------------------------------------------------------------

// meshio's TimeSeriesWriter: the mesh stands apart.
std::string meshioSeries() {
  const auto step = [](const std::string& time, const std::string& values) {
    return grid("<ns0:include xpointer=\"xpointer(//Grid[@Name=&quot;mesh&quot;]/*[self::Topology "
                "or self::Geometry])\" /><Time Value=\"" +
                    time + "\"/>" + scalar("T", "Node", values, "5"),
                "");
  };
  return document(
      grid(step("0.0", "0 0 0 0 0") + step("0.5", "1 2 3 4 5") + step("2.5e0", "2 4 6 8 10"),
           "Name=\"TimeSeries_meshio\" GridType=\"Collection\" "
           "CollectionType=\"Temporal\"") +
      grid(mesh(), "Name=\"mesh\" GridType=\"Uniform\""));
}

TEST(XdmfReader, StepsAsMeshioWritesThem) {
  const std::string text = meshioSeries();
  EXPECT_EQ(xdmfTimes({text, "test"}), (Doubles{0, 0.5, 2.5}));
  Report report;
  for (const auto& [step, last] : {std::pair(0, 0.0), std::pair(1, 5.0), std::pair(-1, 10.0)}) {
    ReadOptions options;
    options.timeStep = step;
    const CellMesh cells = read(readXdmf, text, report, "test", options);
    expectTwoTets(cells);
    EXPECT_EQ(numbers(cells, "T", kOnPoints).back(), last) << step;
  }
  ReadOptions options;
  options.timeStep = 3;
  try {
    read(readXdmf, text, report, "test", options);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Usage);
  }
  EXPECT_TRUE(report.warnings.empty());
}

// FEniCS (legacy): the first step has the mesh, the others include it.
TEST(XdmfReader, StepsAsFenicsWritesThem) {
  const std::string include =
      "<xi:include xpointer=\"xpointer(//Grid[@Name=&quot;TimeSeries_u&quot;]/Grid[1]/"
      "*[self::Topology or self::Geometry])\" />";
  const std::string text = document(
      grid(grid(mesh() + "<Time Value=\"0\" />" + scalar("u", "Node", "0 0 0 0 0", "5 1")) +
               grid(include + "<Time Value=\"0.1\" />" + scalar("u", "Node", "1 1 1 1 7", "5 1")),
           "Name=\"TimeSeries_u\" GridType=\"Collection\" CollectionType=\"Temporal\""));
  EXPECT_EQ(xdmfTimes({text, "test"}), (Doubles{0, 0.1}));
  const CellMesh cells = read(readXdmf, text);
  expectTwoTets(cells);
  EXPECT_EQ(numbers(cells, "u", kOnPoints).back(), 7);
}

// dolfinx: one collection a function, mesh tags with cells of their own.
TEST(XdmfReader, FunctionsAsDolfinxWritesThem) {
  const std::string include =
      "<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid[@GridType='Uniform'][1]/"
      "*[self::Topology or self::Geometry])\" />";
  const auto function = [&](const std::string& name, const std::string& a, const std::string& b) {
    return grid(
        grid(include + "<Time Value=\"1\" />" + scalar(name, "Node", a, "5"), "Name=\"x\"") +
            grid(include + "<Time Value=\"2\" />" + scalar(name, "Node", b, "5"), "Name=\"x\""),
        "Name=\"" + name + "\" GridType=\"Collection\" CollectionType=\"Temporal\"");
  };
  const std::string text =
      document(grid(mesh(), "Name=\"mesh\" GridType=\"Uniform\"") +
               function("u", "1 1 1 1 1", "2 2 2 2 2") + function("p", "3 3 3 3 3", "4 4 4 4 4"));
  const CellMesh cells = read(readXdmf, text);
  expectTwoTets(cells);
  EXPECT_EQ(numbers(cells, "u", kOnPoints), Doubles(5, 2));
  EXPECT_EQ(numbers(cells, "p", kOnPoints), Doubles(5, 4));

  const std::string tags =
      grid("<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid/Geometry)\" />"
           "<Topology TopologyType=\"Triangle\" NumberOfElements=\"1\">" +
               item("1 3", "0 1 2", R"(Format="XML" NumberType="Int")") + "</Topology>",
           "Name=\"facets\" GridType=\"Uniform\"");
  Report report;
  expectTwoTets(read(readXdmf, document(grid(mesh()) + tags), report));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "grid-left-out");
}

TEST(XdmfReader, TimesOfTheCollection) {
  const auto collection = [](const std::string& time) {
    return document(grid("<Time " + time + "</Time>" + grid(mesh()) + grid(mesh()),
                         "GridType=\"Collection\" CollectionType=\"Temporal\""));
  };
  const std::string list =
      collection("TimeType=\"List\">" + item("2", "3 4.5")); // one for each step
  EXPECT_EQ(xdmfTimes({list, "test"}), (Doubles{3, 4.5}));
  const std::string slab = collection("TimeType=\"HyperSlab\">" + item("3", "1 0.25 2"));
  EXPECT_EQ(xdmfTimes({slab, "test"}), (Doubles{1, 1.25}));
  const std::string none = collection("TimeType=\"Range\">" + item("2", "0 9"));
  EXPECT_EQ(xdmfTimes({none, "test"}), (Doubles{0, 1}));
}

TEST(XdmfReader, OnlyWantedArrays) {
  ReadOptions options;
  options.arrays = {"v"};
  Report report;
  const CellMesh cells = read(readXdmf,
                              document(grid(mesh() + scalar("T", "Node", "1 2 3 4 5", "5") +
                                            scalar("v_x", "Node", "1 2 3 4 5", "5") +
                                            scalar("c", "Cell", "not read at all", "2"))),
                              report, "test", options);
  ASSERT_EQ(cells.attributes.size(), 1u);
  EXPECT_EQ(cells.attributes[0].name, "v_x");
  ASSERT_EQ(cells.unread.size(), 2u);
  EXPECT_EQ(cells.unread[0].name, "T");
  EXPECT_EQ(cells.unread[1].on, kOnCells);
}

// --- Files beside -------------------------------------------------------------------------------

TEST_F(XdmfFiles, BinaryOfBothByteOrders) {
  // Four bytes of something else, then five big-endian floats, then as doubles in our own order.
  std::string bytes = "skip";
  const float values[5] = {1.5f, -2, 3, 1e30f, 0};
  for (const float value : values) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    for (int k = 3; k >= 0; --k)
      bytes += raw[k];
  }
  const double more[5] = {0.1, 0.2, 0.3, 0.4, 0.5};
  bytes.append(reinterpret_cast<const char*>(more), sizeof more);
  write("data.bin", bytes);
  const auto binary = [](const std::string& options) { return "Format=\"Binary\" " + options; };
  const std::string text = document(
      grid(mesh() + "<Attribute Name=\"a\">" +
           item("5", "data.bin", binary(R"(Endian="Big" Seek="4" Precision="4")")) +
           "</Attribute><Attribute Name=\"b\">" +
           item("5", " data.bin ", binary(R"(Seek="24" Precision="8")")) + "</Attribute>"));
  const CellMesh cells = readHere(text);
  EXPECT_EQ(numbers(cells, "a", kOnPoints), (Doubles{1.5, -2, 3, double(1e30f), 0}));
  EXPECT_EQ(numbers(cells, "b", kOnPoints), (Doubles{0.1, 0.2, 0.3, 0.4, 0.5}));

  const std::string beyond =
      document(grid(mesh() + "<Attribute Name=\"a\">" +
                    item("5", "data.bin", binary(R"(Seek="32" Precision="8")")) + "</Attribute>"));
  EXPECT_NE(errorHere(beyond).find("more than"), std::string::npos);
}

// More rows than are read at a time; tensors, whole numbers, several grids of one mesh, steps.
TEST_F(XdmfFiles, Hdf5PartByPart) {
  const TetMesh mesh = meshes::jittered(meshes::kuhnGrid(101, 101, 18), 0.2, 3);
  const hsize_t points = mesh.points.size(), tets = mesh.tetCount();
  ASSERT_GT(tets, hsize_t(1) << 20);
  {
    const H5File file(path("mesh.h5"));
    std::vector<double> xyz, heat;
    for (const Vec3d& p : mesh.points) {
      xyz.insert(xyz.end(), p.begin(), p.end());
      heat.push_back(p[0] - p[1]);
    }
    std::vector<int> corners, region;
    for (const std::uint32_t corner : mesh.tets)
      corners.push_back(static_cast<int>(corner) + 1);
    std::vector<float> stress(6 * tets);
    for (std::size_t i = 0; i < stress.size(); ++i)
      stress[i] = static_cast<float>(i % 1001);
    for (std::size_t i = 0; i < tets; ++i)
      region.push_back(static_cast<int>(i / 1000 % 5));
    file.put<double>("/xyz", H5T_NATIVE_DOUBLE, {points, 3}, xyz);
    file.put<int>("/tets", H5T_NATIVE_INT, {tets, 4}, corners);
    file.put<double>("/heat", H5T_NATIVE_DOUBLE, {points}, heat);
    file.put<float>("/stress", H5T_NATIVE_FLOAT, {tets, 6}, stress);
    file.put<int>("/region", H5T_NATIVE_INT, {tets, 1}, region);
  }
  const auto hdf = [&](const std::string& size, const std::string& name,
                       const std::string& type = "Float") {
    return item(size, "mesh.h5:" + name, "Format=\"HDF\" NumberType=\"" + type + "\"");
  };
  const std::string n = std::to_string(points), m = std::to_string(tets);
  const std::string shape =
      "<Topology TopologyType=\"Tetrahedron\" BaseOffset=\"1\">" + hdf(m + " 4", "/tets", "Int") +
      "</Topology><Geometry GeometryType=\"XYZ\">" + hdf(n + " 3", "/xyz") + "</Geometry>";
  const std::string arrays =
      "<Attribute Name=\"heat\">" + hdf(n, "/heat") +
      "</Attribute><Attribute Name=\"stress\" Center=\"Cell\" AttributeType=\"Tensor6\">" +
      hdf(m + " 6", "/stress") + "</Attribute><Attribute Name=\"region\" Center=\"Cell\">" +
      hdf(m, "/region", "Int") + "</Attribute>";
  write("run.xdmf", document(grid(shape + arrays)));
  expectSpooledSame(path("run.xdmf"));
  ReadOptions options;
  options.arrays = {"stress"};
  expectSpooledSame(path("run.xdmf"), options);

  const auto refuse = [&](const std::string& text, const std::string& says) {
    write("bad.xdmf", text);
    Progress progress;
    SpooledMesh spooled(folder_.path().string());
    FileFormat format = FileFormat::Unknown;
    try {
      spoolCells(path("bad.xdmf"), {}, spooled, format, report_, progress);
      ADD_FAILURE() << says;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid);
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  refuse(document(grid(test::mesh())), "HDF5");
  refuse(document(grid(shape) + grid(shape)), "another mesh");
  refuse(document(grid(shape + "<Attribute Name=\"heat\">" + hdf(n, "/nothing") + "</Attribute>")),
         "no such dataset");
  refuse(document(grid(shape + "<Attribute Name=\"heat\">" + hdf(m, "/heat") + "</Attribute>")),
         "in place of");
}

// A mixed topology of more numbers than are read at a time, with a triangle after every seventh
// cell, and topologies of one kind.
TEST_F(XdmfFiles, SpooledCellsOfSeveralKinds) {
  constexpr int kSide = 50;
  const auto at = [](int x, int y, int z) { return ((x * (kSide + 1)) + y) * (kSide + 1) + z; };
  std::vector<double> xyz;
  for (int x = 0; x <= kSide; ++x)
    for (int y = 0; y <= kSide; ++y)
      for (int z = 0; z <= kSide; ++z)
        xyz.insert(xyz.end(), {x + 0.1 * (y % 3), y + 0.1 * (z % 2), z * 1.0});
  std::vector<std::int64_t> mixed, hexahedra, wedges, pyramids;
  std::vector<int> region;
  const auto add = [&](std::vector<std::int64_t> numbers, std::vector<std::int64_t>& alone) {
    mixed.insert(mixed.end(), numbers.begin(), numbers.end());
    alone.insert(alone.end(), numbers.begin() + 1, numbers.end());
    region.push_back(static_cast<int>(region.size() / 100));
  };
  std::vector<std::int64_t> others;
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y)
      for (int z = 0; z < kSide; ++z) {
        const std::int64_t c[8] = {
            at(x, y, z),     at(x + 1, y, z),     at(x + 1, y + 1, z),     at(x, y + 1, z),
            at(x, y, z + 1), at(x + 1, y, z + 1), at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)};
        switch ((x + y + z) % 4) {
        case 0:
          add({8, c[0], c[1], c[2], c[4], c[5], c[6]}, wedges);
          add({8, c[0], c[2], c[3], c[4], c[6], c[7]}, wedges);
          break;
        case 1:
          add({7, c[0], c[1], c[2], c[3], c[4]}, pyramids);
          add({6, c[0], c[1], c[2], c[5]}, others);
          break;
        default:
          add({9, c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]}, hexahedra);
        }
        if (region.size() % 7 == 0)
          add({4, c[0], c[1], c[2]}, others);
        if (region.size() % 11 == 0)
          add({3, 5, c[0], c[1], c[2], c[3], c[4]}, others);
      }
  ASSERT_GT(mixed.size(), std::size_t(1) << 20);
  std::vector<double> load(2 * region.size());
  for (std::size_t i = 0; i < load.size(); ++i)
    load[i] = static_cast<double>(i);
  std::vector<double> heat(xyz.size() / 3, 1.5);
  {
    const H5File file(path("mesh.h5"));
    file.put<double>("/xyz", H5T_NATIVE_DOUBLE, {xyz.size() / 3, 3}, xyz);
    file.put<double>("/heat", H5T_NATIVE_DOUBLE, {heat.size()}, heat);
    file.put<double>("/load", H5T_NATIVE_DOUBLE, {region.size(), 2}, load);
    file.put<int>("/region", H5T_NATIVE_INT, {region.size()}, region);
    const auto putNodes = [&](const char* name, std::size_t each, const auto& nodes) {
      file.put<std::int64_t>(name, H5T_NATIVE_INT64, {nodes.size() / each, each}, nodes);
    };
    file.put<std::int64_t>("/mixed", H5T_NATIVE_INT64, {mixed.size()}, mixed);
    file.put<std::int64_t>("/cut", H5T_NATIVE_INT64, {mixed.size() - 1},
                           {mixed.begin(), mixed.end() - 1});
    putNodes("/hexahedra", 8, hexahedra);
    putNodes("/wedges", 6, wedges);
    putNodes("/pyramids", 5, pyramids);
  }
  const auto hdf = [&](const std::string& size, const std::string& name, const char* type) {
    return item(size, "mesh.h5:" + name, "Format=\"HDF\" NumberType=\"" + std::string(type) + "\"");
  };
  const std::string points = std::to_string(heat.size()), cells = std::to_string(region.size());
  const std::string geometry =
      "<Geometry GeometryType=\"XYZ\">" + hdf(points + " 3", "/xyz", "Float") +
      "</Geometry><Attribute Name=\"heat\">" + hdf(points, "/heat", "Float") + "</Attribute>";
  const std::string ofCells = "<Attribute Name=\"load\" Center=\"Cell\">" +
                              hdf(cells + " 2", "/load", "Float") +
                              "</Attribute><Attribute Name=\"region\" Center=\"Cell\">" +
                              hdf(cells, "/region", "Int") + "</Attribute>";
  const auto topology = [&](const std::string& type, const std::string& count,
                            const std::string& numbers, const std::string& name) {
    return "<Topology TopologyType=\"" + type + "\" NumberOfElements=\"" + count + "\">" +
           hdf(numbers, name, "Int") + "</Topology>";
  };
  const auto count = [](std::size_t n) { return std::to_string(n); };
  write("run.xdmf", document(grid(topology("Mixed", cells, count(mixed.size()), "/mixed") +
                                  geometry + ofCells)));
  expectSpooledSame(path("run.xdmf"));
  ReadOptions options;
  options.arrays = {"load"};
  expectSpooledSame(path("run.xdmf"), options);
  const auto expectAlone = [&](const char* type, const char* name, std::size_t each,
                               const auto& nodes) {
    const std::string n = count(nodes.size() / each);
    write("run.xdmf", document(grid(topology(type, n, n + " " + count(each), name) + geometry)));
    expectSpooledSame(path("run.xdmf"));
  };
  expectAlone("Hexahedron", "/hexahedra", 8, hexahedra);
  expectAlone("Wedge", "/wedges", 6, wedges);
  expectAlone("Pyramid", "/pyramids", 5, pyramids);
  const auto refuse = [&](const std::string& text, const std::string& says) {
    write("bad.xdmf", document(grid(text + geometry)));
    Progress progress;
    SpooledMesh spooled(folder_.path().string());
    FileFormat format = FileFormat::Unknown;
    try {
      spoolCells(path("bad.xdmf"), {}, spooled, format, report_, progress);
      ADD_FAILURE() << says;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid);
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  refuse(topology("Mixed", cells, count(mixed.size() - 1), "/cut"), "ends beyond");
  refuse(topology("Mixed", "3", count(mixed.size()), "/mixed"), "cells are declared");
  refuse(topology("Mixed", cells, count(region.size()), "/region"), "unknown type");
  refuse(topology("Hexahedron_20", "3", "60", "/mixed"), "linear");
  refuse(topology("Triangle", "4", "12", "/mixed"), "linear");
}

TEST_F(XdmfFiles, Hdf5OfManyTypes) {
  {
    const H5File file(path("mesh.h5"));
    file.put<double>("/Mesh/geometry", H5T_NATIVE_DOUBLE, {5, 3},
                     {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, true);
    file.put<std::int64_t>("/Mesh/topology", H5T_NATIVE_INT64, {2, 4}, {0, 1, 2, 3, 4, 3, 2, 1});
    file.put<float>("f", H5T_NATIVE_FLOAT, {5}, {1, 2, 3, 4, 0.5f});
    file.put<unsigned char>("u", H5T_NATIVE_UCHAR, {2}, {200, 7});
    file.put<std::uint64_t>("w", H5T_NATIVE_UINT64, {2}, {std::uint64_t(1) << 40, 3});
    // All steps in one: 3 x 5.
    file.put<double>("steps", H5T_NATIVE_DOUBLE, {3, 5},
                     {0, 1, 2, 3, 4, 10, 11, 12, 13, 14, 20, 21, 22, 23, 24}, true);
  }
  const auto hdf = [&](const std::string& size, const std::string& name) {
    return item(size, "mesh.h5:" + name, R"(Format="HDF" NumberType="Float")");
  };
  const std::string text = document(grid(
      "<Topology TopologyType=\"Tetrahedron\" NumberOfElements=\"2\" NodesPerElement=\"4\">" +
      hdf("2 4", "/Mesh/topology") + "</Topology><Geometry GeometryType=\"XYZ\">" +
      hdf("5 3", "/Mesh/geometry") + "</Geometry><Attribute Name=\"f\">" + hdf("5 1", "/f") +
      "</Attribute><Attribute Name=\"u\" Center=\"Cell\">" + hdf("2", "/u") +
      "</Attribute><Attribute Name=\"w\" Center=\"Cell\">" + hdf("2", "/w") +
      "</Attribute><Attribute Name=\"again\">" + hdf("5", "/f") +
      "</Attribute><Attribute Name=\"step\"><DataItem ItemType=\"HyperSlab\" Dimensions=\"1 5\">" +
      item("3 2", "1 0 1 1 1 5") + hdf("3 5", "/steps") + "</DataItem></Attribute>"));
  const CellMesh cells = readHere(text);
  expectTwoTets(cells);
  EXPECT_EQ(numbers(cells, "f", kOnPoints), (Doubles{1, 2, 3, 4, 0.5}));
  EXPECT_EQ(numbers(cells, "again", kOnPoints), (Doubles{1, 2, 3, 4, 0.5}));
  EXPECT_EQ(numbers(cells, "u", kOnCells), (Doubles{200, 7}));
  EXPECT_EQ(numbers(cells, "w", kOnCells), (Doubles{1099511627776, 3}));
  EXPECT_EQ(numbers(cells, "step", kOnPoints), (Doubles{10, 11, 12, 13, 14}));
  EXPECT_EQ(xdmfFiles({text, path("run.xdmf")}), std::vector<std::string>{path("mesh.h5")});

  const auto withAttribute = [&](const std::string& inside) {
    return document(grid(mesh() + "<Attribute Name=\"x\">" + inside + "</Attribute>"));
  };
  EXPECT_NE(errorHere(withAttribute(hdf("5", "/nothing"))).find("no such dataset"),
            std::string::npos);
  EXPECT_NE(errorHere(withAttribute(hdf("500", "/f"))).find("in place of 500"), std::string::npos);
  EXPECT_NE(errorHere(withAttribute(item("5", "other.h5:/f", "Format=\"HDF\""))).find("missing"),
            std::string::npos);
  EXPECT_NE(errorHere(withAttribute(item("5", "mesh.h5", "Format=\"HDF\""))).find("names no"),
            std::string::npos);
}

// A dataset that claims more than its file can hold, and one in another file.
TEST_F(XdmfFiles, Hdf5ThatClaimsTooMuch) {
  write("secret.bin", std::string(40, 'x'));
  {
    const H5File file(path("huge.h5"));
    const hsize_t sizes[2] = {hsize_t(1) << 30, 8};
    const hid_t space = H5Screate_simple(2, sizes, nullptr);
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[2] = {64, 8};
    H5Pset_chunk(plan, 2, chunk);
    H5Dclose(
        H5Dcreate2(file.id(), "huge", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, plan, H5P_DEFAULT));
    H5Pclose(plan);
    H5Sclose(space);
    const hsize_t five = 5;
    const hid_t line = H5Screate_simple(1, &five, nullptr);
    const hid_t outside = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(outside, path("secret.bin").c_str(), 0, 40);
    H5Dclose(H5Dcreate2(file.id(), "outside", H5T_NATIVE_DOUBLE, line, H5P_DEFAULT, outside,
                        H5P_DEFAULT));
    H5Pclose(outside);
    H5Sclose(line);
    H5Lcreate_external(path("other.h5").c_str(), "/f", file.id(), "link", H5P_DEFAULT, H5P_DEFAULT);
  }
  {
    const H5File other(path("other.h5"));
    other.put<double>("f", H5T_NATIVE_DOUBLE, {5}, {1, 2, 3, 4, 5});
  }
  const auto error = [&](const std::string& name) {
    return errorHere(document(grid(mesh() + "<Attribute Name=\"x\"><DataItem Format=\"HDF\">" +
                                   "huge.h5:/" + name + "</DataItem></Attribute>")));
  };
  EXPECT_NE(error("huge").find("more than the file holds"), std::string::npos);
  EXPECT_NE(error("outside").find("other files"), std::string::npos);
  EXPECT_NE(error("link").find("no such dataset"), std::string::npos);
}

TEST_F(XdmfFiles, DamagedHdf5IsHarmless) {
  {
    const H5File file(path("mesh.h5"));
    file.put<double>("g", H5T_NATIVE_DOUBLE, {5, 3}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1},
                     true);
    file.put<std::int64_t>("t", H5T_NATIVE_INT64, {2, 4}, {0, 1, 2, 3, 4, 3, 2, 1}, true);
  }
  const std::string text = document(
      grid("<Topology TopologyType=\"Tetrahedron\">" + item("2 4", "mesh.h5:/t", "Format=\"HDF\"") +
           "</Topology><Geometry>" + item("5 3", "mesh.h5:/g", "Format=\"HDF\"") + "</Geometry>"));
  expectTwoTets(readHere(text));
  const std::string whole = fileBytes(path("mesh.h5"));
  std::mt19937 random(7);
  std::size_t refused = 0;
  for (int i = 0; i < 120; ++i) {
    std::string bytes = whole;
    if (i % 4 == 0)
      bytes.resize(random() % whole.size());
    else
      for (int k = 0; k < 1 + i % 7; ++k)
        bytes[random() % bytes.size()] = static_cast<char>(random());
    write("mesh.h5", bytes);
    try {
      const CellMesh cells = readHere(text);
      for (const std::uint32_t node : cells.nodes)
        ASSERT_LT(node, cells.points.size());
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 30u);
}

// --- What is refused ----------------------------------------------------------------------------

TEST(XdmfReader, IsRefusedClearly) {
  const auto error = [](const std::string& inside) {
    return errorOf(readXdmf, document(grid(inside)));
  };
  const auto attribute = [](const std::string& inside) {
    return mesh() + "<Attribute Name=\"x\">" + inside + "</Attribute>";
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(errorOf(readXdmf, "<Xdmf><Domain>"), "not well-formed");
  has(errorOf(readXdmf, "<Xdmf></Xdmf>"), "no <Domain>");
  has(errorOf(readXdmf, document("")), "no <Grid>");
  has(error("<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 2 2\"/>" + geometry()),
      "structured");
  has(error(topology() + "<Geometry GeometryType=\"ORIGIN_DXDYDZ\">" + item("3", "0 0 0") +
            item("3", "1 1 1") + "</Geometry>"),
      "ORIGIN_DXDYDZ");
  has(error(attribute("<DataItem ItemType=\"Function\" Function=\"$0 + 1\" Dimensions=\"5\">" +
                      item("5", "1 2 3 4 5") + "</DataItem>")),
      "Function");
  has(error(attribute(item("5", "1 2 3", "Format=\"XML\""))), "more than");
  has(error(attribute(item("99999999999999 99999999", "1"))), "too large");
  has(error(attribute(item("7", "1 2 3 4 5 6 7"))), "7 numbers for 5 points");
  has(error(attribute(item("5", "x", "Format=\"TIFF\""))), "TIFF");
  has(error("<Topology TopologyType=\"Tetrahedron\">" + item("1 4", "0 1 2 9") + "</Topology>" +
            geometry()),
      "9");
  has(error("<Topology TopologyType=\"Tetrahedron\">" + item("1 4", "0 1 2 -1") + "</Topology>" +
            geometry()),
      "out of range");
  has(error("<Topology TopologyType=\"Mixed\">" + item("4", "6 0 1 2") + "</Topology>" +
            geometry()),
      "ends beyond");
  has(error("<Topology TopologyType=\"Mixed\">" + item("4", "77 0 1 2") + "</Topology>" +
            geometry()),
      "unknown type");
  has(error("<Topology Reference=\"/Xdmf/Domain/Grid/Topology\"/>" + geometry()), "itself");
  has(error("<Topology Reference=\"/Xdmf/[\"/>" + geometry()), "no path");
  has(error("<Topology Reference=\"/Xdmf/Nothing\"/>" + geometry()), "not there");
  has(error("<xi:include href=\"/etc/hostname\" xpointer=\"xpointer(/a)\"/>" + geometry()),
      "not read");
  has(error(topology() + "<Geometry>" + item("5 3", "0 0 0 1 0 0 0 1 0 0 0 1 1 1 inf") +
            "</Geometry>"),
      "finite");
  has(error(attribute("<DataItem ItemType=\"HyperSlab\" Dimensions=\"5\">" + item("3", "8 1 5") +
                      item("9", "1 2 3 4 5 6 7 8 9") + "</DataItem>")),
      "outside");
}

TEST(XdmfReader, DamagedTextIsHarmless) {
  const std::string whole = meshioSeries();
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 1 + i % 4; ++k)
      switch (random() % 3) {
      case 0:
        bytes[random() % bytes.size()] = static_cast<char>(random());
        break;
      case 1:
        bytes.erase(random() % bytes.size(), random() % 40);
        break;
      default:
        bytes.insert(random() % bytes.size(), std::to_string(random()));
      }
    try {
      Report report;
      const CellMesh cells = read(readXdmf, bytes, report);
      for (const std::uint32_t node : cells.nodes)
        ASSERT_LT(node, cells.points.size());
      xdmfTimes({bytes, "test"});
    } catch (const Error& error) {
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

} // namespace
} // namespace tetvdb::test
