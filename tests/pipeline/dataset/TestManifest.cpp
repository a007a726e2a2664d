// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/pipeline/dataset/Manifest.h"

#include <fstream>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

class ManifestTest : public ::testing::Test {
protected:
  std::vector<DatasetEntry> read(const std::string& name, const std::string& text) {
    const std::string path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return readManifest(path);
  }
  TemporaryFolder folder_;
};

TEST_F(ManifestTest, ReadsQuotesAndLineEnds) {
  const auto entries =
      read("a.csv", "\xEF\xBB\xBFPath,\"id\",class\r\n\"x,1.stl\",b,\"say \"\"hi\"\"\"\r\n"
                    "y.obj,a,plain\n");
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].id, "a");
  EXPECT_EQ(entries[1].className, "say \"hi\"");
  EXPECT_EQ(entries[1].path, folder_ / "x,1.stl");
}

TEST_F(ManifestTest, NamesWithControlCharactersAreRefused) {
  EXPECT_THROW(read("a.csv", "path,class\nx.stl,\"two\nlines\"\n"), Error);
}

// Whatever bytes come: entries whose names stay within the folder, or an error.
TEST_F(ManifestTest, MutantsEndInEntriesOrErrors) {
  const std::string texts[] = {"path,id,class,split\nm/a.stl,a/b,\"c\",train\nm/b.stl,b,d,test\n",
                               "{\"path\": \"a.stl\", \"id\": \"x/y\"}\n{\"file\": \"b.obj\"}\n"};
  std::size_t read = 0, refused = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    std::string text = texts[i % 2];
    for (std::uint64_t k = 0; k <= i % 3; ++k) {
      const std::uint64_t h = hashOfIndex(4 * i + k);
      text[h % text.size()] = "\"/.,\n\\{}:ax\0"[h >> 32 & 7];
    }
    try {
      for (const DatasetEntry& entry : this->read(i % 2 == 0 ? "m.csv" : "m.jsonl", text)) {
        EXPECT_NE(entry.id.front(), '/');
        EXPECT_EQ(("/" + entry.id + "/").find("/../"), std::string::npos);
      }
      ++read;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 100u);
  EXPECT_GT(refused, 100u);
}

} // namespace
} // namespace tetvdb
