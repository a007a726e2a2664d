// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/cgns/CgnsFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/TemporaryFile.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Hdf5File.h"
#include "tetvdb/io/source/IsolatedRead.h"

#include <cgns_io.h>
#include <cgnslib.h>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>
#include <utility>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

bool isHdf5(const Source& source) {
  return source.bytes.substr(0, 4) == "\x89HDF";
}

/// Whether the tree below a node has links, which the children of an ADF file say of themselves.
bool hasLinks(int file, double node, int depth, std::size_t& nodesLeft) {
  constexpr int deepest = 24;
  int count = 0, found = 0;
  if (depth > deepest || cgio_number_children(file, node, &count) != CGIO_ERR_NONE || count < 0 ||
      static_cast<std::size_t>(count) > nodesLeft)
    return true;
  nodesLeft -= static_cast<std::size_t>(count);
  std::vector<double> children(static_cast<std::size_t>(count));
  if (count > 0 &&
      (cgio_children_ids(file, node, 1, count, &found, children.data()) != CGIO_ERR_NONE ||
       found != count))
    return true;
  for (const double child : children) {
    int length = 0;
    if (cgio_is_link(file, child, &length) != CGIO_ERR_NONE || length > 0 ||
        hasLinks(file, child, depth + 1, nodesLeft))
      return true;
  }
  return false;
}

/// What to change in an HDF5 file that libcgns would take for too new.
std::vector<ByteChange> changesOfVersion(const Source& source, Progress& progress) {
  if (!isHdf5(source))
    return {};
  const auto read = [&](Report&, Progress&) {
    const std::string name = "/CGNSLibraryVersion/ data";
    std::vector<std::int64_t> positions;
    std::vector<std::int32_t> values;
    double version = 0;
    {
      const Hdf5File file(source);
      if (file.has(name))
        std::visit(
            [&](const auto& found) {
              version = found.size() == 1 ? static_cast<double>(found[0]) : 0;
            },
            file.read(name));
    }
    if (version >= CGNS_VERSION / 1000 + 1)
      for (const ByteChange& change : changesForNumber(source, name, CGNS_DOTVERS)) {
        positions.push_back(static_cast<std::int64_t>(change.position));
        values.push_back(change.value);
      }
    return NumberArrays{std::move(positions), std::move(values)};
  };
  Report ignored;
  NumberArrays found;
  try {
    found = readArraysIsolated(read, source.path, {}, ignored, progress);
  } catch (const Error& error) {
    if (error.status() == Status::Cancelled)
      throw;
    return {}; // libcgns says what is wrong
  }
  std::vector<ByteChange> changes;
  const auto* positions =
      found.size() == 2 ? std::get_if<std::vector<std::int64_t>>(&found[0]) : nullptr;
  const auto* values =
      found.size() == 2 ? std::get_if<std::vector<std::int32_t>>(&found[1]) : nullptr;
  if (positions == nullptr || values == nullptr || positions->size() != values->size())
    return {};
  for (std::size_t i = 0; i < values->size(); ++i)
    if (const auto position = static_cast<std::uint64_t>((*positions)[i]);
        position < source.bytes.size())
      changes.push_back({position, static_cast<char>((*values)[i])});
  return changes;
}

} // namespace

CgnsBytes::CgnsBytes(const Source& source, Progress& progress) : path_(source.path) {
  const std::vector<ByteChange> changes = changesOfVersion(source, progress);
  if (source.isMapped && changes.empty())
    return;
  const std::string folder = std::filesystem::temp_directory_path().string();
  const int file = createTemporaryFile(folder, "tetvdb", 0600, temporary_);
  std::string_view left = source.bytes;
  while (file >= 0 && !left.empty()) {
    const ssize_t written = ::write(file, left.data(), left.size());
    if (written <= 0)
      break;
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  bool isWritten = left.empty();
  for (const ByteChange& change : changes)
    isWritten = isWritten && writeAllAt(file, change.position, &change.value, 1);
  if (file >= 0)
    ::close(file);
  if (!isWritten) {
    if (file >= 0)
      ::unlink(temporary_.c_str());
    throw Error(Status::Limit, source.path, "its bytes do not fit into the folder " + folder,
                "make room there, or name another one by TMPDIR");
  }
  path_ = temporary_;
}

CgnsBytes::~CgnsBytes() {
  if (!temporary_.empty())
    ::unlink(temporary_.c_str());
}

CgnsFile::CgnsFile(const Source& source, const std::string& path) : source_(source) {
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
  refuseLinks(path);
  check(cg_open(path.c_str(), CG_MODE_READ, &id_), "the file");
}

CgnsFile::~CgnsFile() {
  if (id_ >= 0)
    cg_close(id_);
}

void CgnsFile::refuseLinks(const std::string& path) const {
  if (isHdf5(source_)) {
    const std::string name = Hdf5File(source_).firstOutside();
    if (!name.empty())
      fail("'" + name + "' lies in another file, which is not read");
    return;
  }
  int file = 0;
  double root = 0;
  if (cgio_open_file(path.c_str(), CGIO_MODE_READ, CGIO_FILE_NONE, &file) != CGIO_ERR_NONE)
    fail("is not a whole CGNS file");
  std::size_t nodesLeft = source_.bytes.size() / 64; // an ADF node takes more bytes
  const bool linked =
      cgio_get_root_id(file, &root) != CGIO_ERR_NONE || hasLinks(file, root, 0, nodesLeft);
  cgio_close_file(file);
  if (linked)
    fail("has links to other files, which are not read, or is damaged", "export it as one file");
}

void CgnsFile::check(int status, const char* what) const {
  if (status != CG_OK)
    fail(std::string(what) + " cannot be read: " + cg_get_error());
}

void CgnsFile::fail(const std::string& what, const char* advice) const {
  throw Error(Status::Invalid, source_.path, what, advice == nullptr ? kCut : advice);
}

std::size_t CgnsFile::checked(double n, std::size_t bytesEach, const char* things) const {
  const double room = static_cast<double>(source_.bytes.size()) * (isHdf5(source_) ? 1100.0 : 1.0);
  if (!(n >= 0) || n * static_cast<double>(bytesEach) > room)
    fail("declares more " + std::string(things) + " than it holds");
  return static_cast<std::size_t>(n);
}

} // namespace tetvdb
