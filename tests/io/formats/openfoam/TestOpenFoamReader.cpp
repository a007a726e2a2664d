// SPDX-License-Identifier: Apache-2.0
#include "FoamSample.h"
#include "TemporaryFolder.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/formats/openfoam/OpenFoamReader.h"

#include <filesystem>
#include <fstream>

namespace tetvdb {
namespace {

using namespace test;
namespace fs = std::filesystem;

constexpr FoamForm kForms[] = {{false, 4, 8, false}, {true, 4, 8, false}, {true, 8, 8, false},
                               {true, 4, 4, false},  {true, 8, 4, true},  {true, 4, 8, true}};

// Writes a case, file by file.
class Case {
public:
  explicit Case(const FoamForm& form = {}) : foam(form), form_(form) { put("c.foam", ""); }

  void put(const std::string& name, const std::string& text) const {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
  }
  void mesh(const std::string& folder, bool gz = false, double raised = 0) const {
    const FoamMesh mesh = foamCubeAndTip(form_, raised);
    const auto one = [&](const char* name, const std::string& text) {
      put(folder + "/polyMesh/" + name + (gz ? ".gz" : ""), gz ? gzipped(text) : text);
    };
    one("points", mesh.points);
    one("faces", mesh.faces);
    one("owner", mesh.owner);
    one("neighbour", mesh.neighbour);
    one("cellZones", mesh.cellZones);
  }
  CellMesh read(const ReadOptions& options = {}, Report* report = nullptr,
                const char* name = "c.foam") const {
    Report own;
    Progress progress;
    return readCells(folder_ / name, options, report != nullptr ? *report : own, progress, nullptr);
  }
  std::string error(const ReadOptions& options = {}) const {
    try {
      read(options);
    } catch (const Error& e) {
      return e.what();
    }
    return {};
  }
  std::string path(const std::string& name) const { return folder_ / name; }

  FoamText foam;

private:
  FoamForm form_;
  TemporaryFolder folder_;
};

const Attribute* arrayOf(const CellMesh& mesh, const std::string& name) {
  for (const Attribute& array : mesh.attributes)
    if (array.name == name)
      return &array;
  return nullptr;
}

void expectCubeAndTip(const CellMesh& mesh) {
  ASSERT_EQ(mesh.runs.size(), 2u);
  EXPECT_EQ(mesh.runs[0].type, CellType::Hexahedron);
  EXPECT_EQ(mesh.runs[1].type, CellType::Pyramid);
  EXPECT_EQ(mesh.points.size(), 9u);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(mesh.regionNames.at(2), "tip");
  const TetMesh tets = splitAll(mesh);
  EXPECT_NEAR(tetVolume(tets), 1 + 1.0 / 3, 1e-12);
  for (std::size_t t = 0; t < tets.tetCount(); ++t) {
    const std::uint32_t* n = tets.tets.data() + 4 * t;
    EXPECT_GT(
        sixfoldVolume(tets.points[n[0]], tets.points[n[1]], tets.points[n[2]], tets.points[n[3]]),
        0);
  }
}

TEST(OpenFoamReader, EveryForm) {
  for (const FoamForm& form : kForms)
    for (const bool gz : {false, true}) {
      SCOPED_TRACE(testing::Message()
                   << form.binary << form.labelBytes << form.scalarBytes << form.swapped << gz);
      const Case foam(form);
      const auto put = [&](const std::string& name, const std::string& text) {
        foam.put(name + (gz ? ".gz" : ""), gz ? gzipped(text) : text);
      };
      foam.mesh("constant", gz);
      put("0.5/p", foam.foam.field("volScalarField", foam.foam.listed("scalar", {1.5, -2}, 1)));
      put("0.5/U",
          foam.foam.field("volVectorField", foam.foam.listed("vector", {1, 2, 3, 4, 5, 6}, 3)));
      put("0.5/R", foam.foam.field(
                       "volSymmTensorField",
                       foam.foam.listed("symmTensor", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 6)));
      put("0.5/T", foam.foam.field("volScalarField", "uniform 300"));
      put("0.5/d", foam.foam.field("pointScalarField",
                                   foam.foam.listed("scalar", {0, 1, 2, 3, 4, 5, 6, 7, 8}, 1)));
      put("0.5/phi", foam.foam.field("surfaceScalarField", "uniform 0"));
      foam.put("0.5/notes.txt", "no field");
      const CellMesh mesh = foam.read();
      expectCubeAndTip(mesh);
      EXPECT_EQ(mesh.times, std::vector<double>{0.5});
      EXPECT_EQ(mesh.attributes.size(), 5u);
      ASSERT_NE(arrayOf(mesh, "U"), nullptr);
      EXPECT_EQ(arrayOf(mesh, "U")->number(1, 2), 6);
      EXPECT_EQ(arrayOf(mesh, "p")->number(1), -2);
      EXPECT_EQ(arrayOf(mesh, "T")->number(1), 300);
      EXPECT_EQ(arrayOf(mesh, "d")->on, Attribute::On::Points);
      EXPECT_EQ(arrayOf(mesh, "d")->number(8), 8);
      // xx, xy, xz, yy, yz, zz in the file
      const double expected[6] = {7, 10, 12, 8, 11, 9};
      for (std::uint32_t k = 0; k < 6; ++k)
        EXPECT_EQ(arrayOf(mesh, "R")->number(1, k), expected[k]);
    }
}

// Other orders of faces and corners, and cells of every kind, as blocks beside one another.
TEST(OpenFoamReader, KindsOfCells) {
  struct Kind {
    CellType type;
    std::vector<Vec3d> points;
    std::vector<std::vector<int>> faces; // outward
    double volume;
  };
  const std::vector<Vec3d> cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const std::vector<Kind> kinds{
      {CellType::Tetra,
       {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
       {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
       1.0 / 6},
      {CellType::Wedge,
       {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
       {{0, 1, 4, 3}, {0, 2, 1}, {1, 2, 5, 4}, {3, 4, 5}, {2, 0, 3, 5}},
       0.5},
      {CellType::Pyramid,
       {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
       {{1, 2, 4}, {0, 3, 2, 1}, {0, 1, 4}, {2, 3, 4}, {3, 0, 4}},
       1.0 / 3},
      {CellType::Hexahedron,
       cube,
       {{2, 6, 5, 1}, {0, 4, 7, 3}, {3, 2, 1, 0}, {6, 7, 4, 5}, {5, 4, 0, 1}, {7, 6, 2, 3}},
       1},
      // A cube whose top is two faces, and one that is cut into a prism over a pentagon.
      {CellType::Polyhedron,
       {{0, 0, 0},
        {1, 0, 0},
        {1, 1, 0},
        {0, 1, 0},
        {0, 0, 1},
        {1, 0, 1},
        {1, 1, 1},
        {0, 1, 1},
        {0.5, 0, 1},
        {0.5, 1, 1}},
       {{0, 3, 2, 1},
        {0, 1, 5, 8, 4},
        {1, 2, 6, 5},
        {2, 3, 7, 9, 6},
        {3, 0, 4, 7},
        {4, 8, 9, 7},
        {8, 5, 6, 9}},
       1},
      {CellType::Polyhedron,
       {{0, 0, 0},
        {1, 0, 0},
        {1, 0.5, 0},
        {0.5, 1, 0},
        {0, 1, 0},
        {0, 0, 1},
        {1, 0, 1},
        {1, 0.5, 1},
        {0.5, 1, 1},
        {0, 1, 1}},
       {{4, 3, 2, 1, 0},
        {5, 6, 7, 8, 9},
        {0, 1, 6, 5},
        {1, 2, 7, 6},
        {2, 3, 8, 7},
        {3, 4, 9, 8},
        {4, 0, 5, 9}},
       0.875}};
  const FoamText foam{FoamForm()};
  std::vector<double> points;
  std::vector<std::vector<int>> faces;
  std::vector<int> owner;
  double volume = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const int first = static_cast<int>(points.size() / 3);
    for (const Vec3d& p : kinds[i].points)
      points.insert(points.end(), {p[0] + 3 * double(i), p[1], p[2]});
    for (std::vector<int> face : kinds[i].faces) {
      for (int& corner : face)
        corner += first;
      faces.push_back(face);
      owner.push_back(static_cast<int>(i));
    }
    volume += kinds[i].volume;
  }
  Report report;
  Progress progress;
  const std::string next(openfoam::kParts);
  const CellMesh mesh = openfoam::readTexts(
      foam.head("vectorField", "points") + foam.numbers(points, 3) + next + foam.faces(faces) +
          next + foam.head("labelList", "owner") + foam.labels(owner) + next +
          foam.head("labelList", "neighbour") + "0()\n",
      report, progress);
  std::vector<CellType> types;
  for (const CellRun& run : mesh.runs)
    types.insert(types.end(), run.count, run.type);
  ASSERT_EQ(types.size(), kinds.size());
  for (std::size_t i = 0; i < kinds.size(); ++i)
    EXPECT_EQ(types[i], kinds[i].type) << i;
  const TetMesh tets = splitAll(mesh);
  EXPECT_NEAR(tetVolume(tets), volume, 1e-12);
  for (std::size_t t = 0; t < tets.tetCount(); ++t) {
    const std::uint32_t* n = tets.tets.data() + 4 * t;
    const double own =
        sixfoldVolume(tets.points[n[0]], tets.points[n[1]], tets.points[n[2]], tets.points[n[3]]);
    if (tets.cell(t) < 4) {
      EXPECT_GT(own, 0) << tets.cell(t);
    }
  }
}

TEST(OpenFoamReader, StepsAndTheLatestMesh) {
  const Case foam;
  foam.mesh("constant");
  foam.put("1.5/polyMesh/points", foamCubeAndTip({}, 10).points);
  for (const char* time : {"0", "1.5", "2", "1e1"})
    foam.put(std::string(time) + "/p",
             foam.foam.field("volScalarField", std::string("uniform ") + time));
  for (const char* name : {"0.orig", "nan", "inf", "postProcessing"})
    fs::create_directories(foam.path(name));
  Report report;
  Progress progress;
  const CellMesh last = foam.read();
  EXPECT_EQ(last.times, (std::vector<double>{0, 1.5, 2, 10}));
  EXPECT_EQ(last.points[0][2], 10);
  EXPECT_EQ(arrayOf(last, "p")->number(0), 10);
  ReadOptions options;
  options.timeStep = 0;
  const CellMesh first = foam.read(options);
  EXPECT_EQ(first.points[0][2], 0);
  EXPECT_EQ(arrayOf(first, "p")->number(1), 0);
  options.timeStep = 4;
  EXPECT_NE(foam.error(options).find("has no time step 5"), std::string::npos);
  const Source source{"", foam.path("c.foam")};
  EXPECT_EQ(openFoamTimes(source, report, progress), last.times);
  const auto namesOf = [&](int step) {
    std::vector<std::string> names;
    for (const std::string& file : openFoamFiles(source, step))
      names.push_back(file.substr(foam.path("").size()));
    return names;
  };
  using Names = std::vector<std::string>;
  const std::string mesh = "constant/polyMesh/";
  EXPECT_EQ(namesOf(0), (Names{mesh + "points", mesh + "faces", mesh + "owner", mesh + "neighbour",
                               mesh + "cellZones", "0/p"}));
  EXPECT_EQ(namesOf(2), (Names{"1.5/polyMesh/points", mesh + "faces", mesh + "owner",
                               mesh + "neighbour", mesh + "cellZones", "2/p"}));
}

TEST(OpenFoamReader, ProcessorsWhereTheyWentFurther) {
  const Case foam;
  foam.mesh("constant");
  foam.mesh("processor0/constant");
  foam.mesh("processor1/constant", false, 5);
  foam.mesh("processor10/constant", false, 9);
  foam.put("0/p", foam.foam.field("volScalarField", "uniform 0"));
  for (const char* part : {"processor0", "processor1", "processor10"})
    foam.put(std::string(part) + "/0/p", foam.foam.field("volScalarField", "uniform 1"));
  EXPECT_EQ(foam.read().points.size(), 9u); // the same times: the case as a whole
  foam.put("processor0/2/p", foam.foam.field("volScalarField", "uniform 3"));
  foam.put("processor10/2/p", foam.foam.field("volScalarField", "uniform 4"));
  const CellMesh mesh = foam.read();
  ASSERT_EQ(mesh.points.size(), 27u);
  EXPECT_EQ(mesh.points[18][2], 9); // not by the names' letters
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 2, 1, 2, 1, 2}));
  const Attribute& p = *arrayOf(mesh, "p");
  EXPECT_EQ(p.number(1), 3);
  EXPECT_TRUE(std::isnan(p.number(2)));
  EXPECT_EQ(p.number(5), 4);
}

TEST(OpenFoamReader, SeveralMeshesAreRegions) {
  const Case foam;
  foam.mesh("constant/fluid");
  foam.mesh("constant/solid", false, 5);
  foam.put("3/fluid/T", foam.foam.field("volScalarField", "uniform 300"));
  foam.put("3/solid/T", foam.foam.field("volScalarField", "uniform 400"));
  const CellMesh mesh = foam.read();
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 1, 2, 2}));
  EXPECT_EQ(mesh.regionNames.at(1), "fluid");
  EXPECT_EQ(mesh.regionNames.at(2), "solid");
  EXPECT_EQ(arrayOf(mesh, "T")->number(1), 300);
  EXPECT_EQ(arrayOf(mesh, "T")->number(2), 400);
}

TEST(OpenFoamReader, ControlDict) {
  const Case foam;
  foam.mesh("constant");
  foam.put("system/controlDict",
           foam.foam.head("dictionary", "controlDict") + "application icoFoam;\n");
  expectCubeAndTip(foam.read({}, nullptr, "system/controlDict"));
}

TEST(OpenFoamReader, FieldsThatAreNotThere) {
  const Case foam;
  foam.mesh("constant");
  foam.put("1/a", foam.foam.field("volScalarField", "$internalField"));
  foam.put("1/b", foam.foam.field("volScalarField", "uniform $pressure"));
  foam.put("1/c", foam.foam.field("volScalarField", foam.foam.listed("scalar", {1, 2, 3}, 1)));
  foam.put("1/e", foam.foam.field("volScalarField", "uniform 5"));
  Report report;
  const CellMesh mesh = foam.read({}, &report);
  ASSERT_EQ(mesh.attributes.size(), 1u);
  EXPECT_EQ(mesh.attributes[0].name, "e");
  ASSERT_EQ(report.warnings.size(), 3u);
  EXPECT_EQ(report.warnings[0].code, "array-left-out");
  EXPECT_EQ(report.warnings[2].code, "array-of-other-length");
  ReadOptions options;
  options.arrays = {"c"};
  const CellMesh named = foam.read(options);
  EXPECT_EQ(named.unread.size(), 3u);
}

TEST(OpenFoamReader, ErrorsSayWhatIsWrong) {
  const FoamMesh sound = foamCubeAndTip({});
  const auto error = [&](const char* file, const std::string& text) {
    const Case foam;
    foam.mesh("constant");
    foam.put(std::string("constant/polyMesh/") + file, text);
    return foam.error();
  };
  EXPECT_NE(error("points", replaced(sound.points, "FoamFile", "File")).find("'FoamFile'"),
            std::string::npos);
  EXPECT_NE(error("points", replaced(sound.points, "9\n(", "900000\n(")).find("900000"),
            std::string::npos);
  EXPECT_NE(error("faces", replaced(sound.faces, "3(4 5 8)", "3(4 5 9)")).find("point 9"),
            std::string::npos);
  EXPECT_NE(error("faces", replaced(sound.faces, "3(4 5 8)", "2(4 5)")).find("three corners"),
            std::string::npos);
  EXPECT_NE(error("owner", replaced(sound.owner, "10\n(", "9\n(")).find("expected ')'"),
            std::string::npos);
  EXPECT_NE(error("neighbour", replaced(sound.neighbour, "\n1\n)", "\n5\n)")).find("cell 2 has 0"),
            std::string::npos);
  EXPECT_NE(error("neighbour", replaced(sound.neighbour, "\n1\n)", "\n-1\n)")).find("-1"),
            std::string::npos);
  EXPECT_NE(error("cellZones", replaced(sound.cellZones, "\n1\n)", "\n2\n)")).find("cell 2 of 2"),
            std::string::npos);
  EXPECT_NE(Case().error().find("constant/polyMesh"), std::string::npos);
  {
    const Case foam;
    foam.mesh("constant");
    fs::remove(foam.path("constant/polyMesh/owner"));
    EXPECT_NE(foam.error().find("'owner'"), std::string::npos);
  }
  {
    const Case foam;
    fs::create_directories(foam.path("processors4/constant"));
    EXPECT_NE(foam.error().find("collated"), std::string::npos);
  }
  for (const char* name : {"points", "faces", "owner"}) {
    const std::string& text = name[0] == 'p'   ? sound.points
                              : name[0] == 'f' ? sound.faces
                                               : sound.owner;
    for (const double share : {0.3, 0.7, 0.97})
      EXPECT_NE(error(name, text.substr(0, static_cast<std::size_t>(
                                               share * static_cast<double>(text.size())))),
                "")
          << name << share;
  }
}

TEST(OpenFoamReader, LinksOutOfTheCaseAreRefused) {
  const Case other, foam;
  other.mesh("constant");
  fs::create_directories(foam.path("constant"));
  fs::create_directory_symlink(other.path("constant/polyMesh"), foam.path("constant/polyMesh"));
  EXPECT_NE(foam.error().find("a link out of its folder"), std::string::npos);
}

} // namespace
} // namespace tetvdb
