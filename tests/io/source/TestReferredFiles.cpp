// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/io/source/ReferredFiles.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

class ReferredFiles : public testing::Test {
protected:
  void write(const std::string& name, const std::string& content = "x") {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  void expect(const std::string& name, std::vector<std::string> names) {
    std::vector<std::string> found = referredFiles(folder_ / name);
    for (std::string& path : found)
      path = std::filesystem::path(path).lexically_proximate(folder_.path()).string();
    std::sort(found.begin(), found.end());
    std::sort(names.begin(), names.end());
    EXPECT_EQ(found, names);
  }
  TemporaryFolder folder_;
};

TEST_F(ReferredFiles, ThoseOfListsAndOfTheListsInThem) {
  std::filesystem::create_directory(folder_ / "parts");
  write("run.pvd", "<DataSet timestep=\"0\" file=\"parts/a b.pvtu\"/><DataSet file='gone.vtu'/>"
                   "<DataSet timestep='1.5e-3' file='c.vtu'/>");
  write("parts/a b.pvtu", "<Piece Source=\"d.vtu\"/><Piece Source=\"../c.vtu\"/>");
  write("parts/d.vtu", "<Piece Source=\"e.vtu\"/>"); // no list: not looked into
  write("parts/e.vtu");
  write("c.vtu");
  expect("run.pvd", {"parts/a b.pvtu", "parts/d.vtu", "c.vtu", "parts/../c.vtu"});
}

TEST_F(ReferredFiles, DataBesideMarkup) {
  write("m.xmf", "<DataItem Format=\"HDF\">\n  m.h5:/Mesh/points\n</DataItem>"
                 "<DataItem>0.5 1.5 2.5e3</DataItem>");
  write("m.h5");
  write("0.5"); // a number is no name
  expect("m.xmf", {"m.h5"});
  write("s.gltf", R"({"buffers":[{"uri":"s.bin","byteLength":12}]})");
  write("s.bin");
  expect("s.gltf", {"s.bin"});
}

TEST_F(ReferredFiles, TheOtherHalf) {
  write("t.node");
  write("t.ele");
  expect("t.node", {"t.ele"});
  expect("t.ele", {"t.node"});
}

TEST_F(ReferredFiles, NoneOfFilesThatHoldThemselves) {
  write("a.vtu", "<a file=\"b.vtu\"/>");
  write("b.vtu");
  expect("a.vtu", {});
  expect("gone.pvd", {});
  write("round.pvd", "<DataSet file=\"round.pvd\"/>");
  expect("round.pvd", {});
}

} // namespace
} // namespace tetvdb
