// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/Formats.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace tetvdb {
namespace {

using namespace test;

std::string document(const std::string& name) {
  return readFile(dataFile("../../" + name));
}

/// Whether a row of the document's tables names all endings of the format.
bool namesEndings(const std::string& text, const Format& format) {
  const std::vector<std::string> endings = endingsOf(format);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("|", 0) == 0 &&
        std::all_of(endings.begin(), endings.end(), [&](const std::string& ending) {
          return line.find("`" + ending + "`") != std::string::npos;
        }))
      return true;
  return false;
}

TEST(Formats, RowsAreWhole) {
  std::set<FileFormat> seen;
  for (const Format& format : formats()) {
    EXPECT_TRUE(seen.insert(format.id).second) << format.name;
    EXPECT_EQ(&formatOf(format.id), &format);
    EXPECT_EQ(formatName(format.id), format.name);
    EXPECT_FALSE(format.description.empty()) << format.name;
    EXPECT_NE(format.description.back(), '.') << format.name;
    EXPECT_FALSE(endingsOf(format).empty()) << format.name;
    for (const std::string& ending : endingsOf(format))
      EXPECT_EQ(endingOf("a/b.c" + ending), ending);
    const bool isRead = can(format, FormatUse::ReadVolume) ||
                        (can(format, FormatUse::ReadMesh) && format.writeArrays == nullptr);
    EXPECT_EQ(format.isContent != nullptr || format.isNamed != nullptr, isRead) << format.name;
    if (format.readCells != nullptr || format.writeTets != nullptr) {
      EXPECT_NE(format.holds & holds::kTets, 0U) << format.name;
    }
    if (format.readTriangles != nullptr || format.writeTriangles != nullptr) {
      EXPECT_NE(format.holds & holds::kTriangles, 0U) << format.name;
    }
    if (format.readVolume != nullptr || format.writeVolume != nullptr ||
        format.writeArrays != nullptr) {
      EXPECT_NE(format.holds & holds::kVolume, 0U) << format.name;
    }
    if (format.readTimes != nullptr) {
      EXPECT_NE(format.holds & holds::kSteps, 0U) << format.name;
    }
  }
  EXPECT_EQ(formatName(FileFormat::Unknown), "unknown");
  EXPECT_TRUE(endingsOf(formatOf(FileFormat::Unknown)).empty());
}

TEST(Formats, TheDocumentNamesEveryFormat) {
  const std::string details = document("docs/formats.md");
  for (const Format& format : formats())
    EXPECT_TRUE(namesEndings(details, format)) << "docs/formats.md lacks " << format.name;
}

TEST(Formats, EveryReaderOfOurOwnHasAFuzzTarget) {
  std::istringstream words(document("tests/fuzz/CMakeLists.txt"));
  const std::string text = words.str();
  const std::size_t begin = text.find("set(formats"), end = text.find(')', begin);
  ASSERT_NE(begin, std::string::npos);
  std::istringstream names(text.substr(begin + 11, end - begin - 11));
  std::size_t targets = 0;
  for (std::string name; names >> name;)
    ++targets;
  // assimp reads scenes; a .vts is read by the reader of .vtu, a .nhdr by that of .nrrd, a .pvtu as
  // the files that it names.
  const std::set<FileFormat> others{FileFormat::Gltf,    FileFormat::Fbx, FileFormat::Collada,
                                    FileFormat::ThreeDs, FileFormat::Vts, FileFormat::Pvtu,
                                    FileFormat::Nhdr};
  std::size_t readers = 0;
  for (const Format& format : formats())
    readers += (can(format, FormatUse::ReadCells) || can(format, FormatUse::ReadTriangles) ||
                can(format, FormatUse::ReadArrays)) &&
               others.count(format.id) == 0;
  EXPECT_EQ(targets, readers);
}

TEST(Formats, EndingsChooseAmongThoseWithTheUse) {
  EXPECT_EQ(endingOf("a/b.VTU"), ".vtu");
  EXPECT_EQ(endingOf("a.b/c"), "");
  EXPECT_EQ(endingOf("a/.vtu"), "");
  EXPECT_EQ(endingOf(""), "");
  ASSERT_NE(formatForEnding("A.STL", FormatUse::ReadTriangles), nullptr);
  EXPECT_EQ(formatForEnding("A.STL", FormatUse::ReadTriangles)->id, FileFormat::Stl);
  EXPECT_EQ(formatForEnding("a.stl", FormatUse::ReadCells), nullptr);
  EXPECT_EQ(formatForEnding("a.inp", FormatUse::ReadCells)->id, FileFormat::Abaqus);
  EXPECT_EQ(formatForEnding("a", FormatUse::ReadCells), nullptr);
  EXPECT_EQ(formatForEnding("a.meshb", FormatUse::WriteTets), nullptr);
}

TEST(Formats, ListsAreSentences) {
  const std::vector<std::string> endings = endingsFor(FormatUse::ReadMesh);
  EXPECT_EQ(std::set<std::string>(endings.begin(), endings.end()).size(), endings.size());
  EXPECT_EQ(std::count(endings.begin(), endings.end(), ".inp"), 1); // of two formats
  EXPECT_EQ(endingList(FormatUse::WriteTets), ".msh, .mesh or .vtu");
  EXPECT_EQ(endingList(FormatUse::WriteTets, "and"), ".msh, .mesh and .vtu");
}

TEST(Formats, VolumesAndSequencesAreToldByContent) {
  EXPECT_EQ(sniffFormat(std::string_view(" BDV\0\0\0\0", 8), "a"), FileFormat::Vdb);
  EXPECT_EQ(sniffFormat("NanoVDB0", "a.vdb"), FileFormat::Nvdb);
  EXPECT_EQ(sniffFormat("<VTKFile type=\"Collection\"><Collection/></VTKFile>", "a.vtu"),
            FileFormat::Pvd);
}

} // namespace
} // namespace tetvdb
