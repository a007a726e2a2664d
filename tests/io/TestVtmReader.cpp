// SPDX-License-Identifier: Apache-2.0
#include "io/BlockSample.h"
#include "tetvdb/io/VtmReader.h"

#include <filesystem>
#include <unistd.h>

namespace tetvdb {
namespace {

using namespace test;
namespace fs = std::filesystem;

TEST(VtmReader, BlocksAreRegions) {
  Report report;
  const CellMesh mesh = readSample(readVtm, "blocks.vtm", {}, &report);
  EXPECT_TRUE(report.warnings.empty());
  expectBlocks(mesh, 2, "T", "C", 0, true);
  ASSERT_EQ(mesh.regions.size(), 16U);
  EXPECT_EQ(mesh.regions[7], 1);
  EXPECT_EQ(mesh.regions[8], 2);
  EXPECT_EQ(mesh.regionNames.at(1), "left");
  EXPECT_EQ(mesh.regionNames.at(2), "right");
}

class Folder {
public:
  Folder() : path_(testing::TempDir() + "tetvdb_vtm_" + std::to_string(::getpid())) {
    fs::create_directories(path_ + "/in");
  }
  ~Folder() { fs::remove_all(path_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ + "/" + name) << text;
    return path_ + "/" + name;
  }
  const std::string& path() const { return path_; }

private:
  std::string path_;
};

std::string naming(const std::string& file) {
  return "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><DataSet index=\"0\" "
         "file=\"" +
         file + "\"/></vtkMultiBlockDataSet></VTKFile>";
}

std::string errorOf(const std::string& path, Report* report = nullptr) {
  const MappedFile file(path);
  Report own;
  Progress progress;
  try {
    readVtm(file.source(), {}, report != nullptr ? *report : own, progress);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(VtmReader, StaysInItsFolder) {
  const Folder folder;
  const std::string block = readFile(dataFile("readers/sphere.vtu"));
  const std::string outside = folder.write("outside.vtu", block);
  for (const std::string& name :
       {std::string("../outside.vtu"), outside, std::string("a/../../outside.vtu")})
    EXPECT_NE(errorOf(folder.write("in/a.vtm", naming(name))).find("outside its folder"),
              std::string::npos)
        << name;
  fs::create_symlink(outside, folder.path() + "/in/link.vtu");
  EXPECT_NE(errorOf(folder.write("in/a.vtm", naming("link.vtu"))).find("link out"),
            std::string::npos);
  EXPECT_NE(errorOf(folder.write("in/a.vtm", naming("none.vtu"))).find("missing"),
            std::string::npos);
  folder.write("in/b.vtu", block);
  EXPECT_EQ(errorOf(folder.write("in/a.vtm", naming("./b.vtu"))), "");
}

TEST(VtmReader, CirclesEnd) {
  const Folder folder;
  EXPECT_NE(errorOf(folder.write("a.vtm", naming("a.vtm"))).find("name each other"),
            std::string::npos);
}

TEST(VtmReader, OtherBlocksAreLeftOut) {
  const Folder folder;
  folder.write("b.vti", "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\"></VTKFile>");
  Report report;
  EXPECT_EQ(errorOf(folder.write("a.vtm", naming("b.vti")), &report), "");
  EXPECT_TRUE(report.partial);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "block-left-out");
}

} // namespace
} // namespace tetvdb
