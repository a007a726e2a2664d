// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/prepared/PreparedFiles.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/mesh/SpooledMesh.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <unistd.h>
#include <variant>
#include <xxhash.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

// "TetVDB", the kind and the version, as a number: another byte order is another number.
constexpr std::uint64_t kBoundaryMark = 0x5465745644420101u;
constexpr std::uint64_t kNodesMark = 0x5465745644420201u;
constexpr std::uint64_t kBucketMark = 0x5465745644420301u;

// Of a tet, in a mesh with shape functions: its cell, and the places of its corners there.
constexpr std::uint64_t kShapeBytesPerTet = 8;
static_assert(sizeof(CurvedShape) == 1 && sizeof(CurvedCells().corners[0]) == 4);
static_assert(sizeof(MetNode) == 16 && sizeof(BoundaryFace) == 16 && sizeof(Vec3d) == 24);

class PartHash {
public:
  PartHash() : state_(XXH3_createState(), XXH3_freeState) {
    if (!state_)
      throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }
  void add(const void* data, std::size_t size) { XXH3_128bits_update(state_.get(), data, size); }
  std::string text() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

private:
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

class PartWriter {
public:
  PartWriter(const std::string& folder, const std::string& name, std::uint64_t mark)
      : name_(name), file_((fs::path(folder) / name).string()) {
    add(&mark, sizeof mark);
  }

  void add(const void* data, std::size_t size) {
    file_.write(data, size);
    hash_.add(data, size);
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size() * sizeof(T));
  }
  PreparedFile finish() {
    const std::uint64_t bytes = file_.size();
    file_.commit();
    return {name_, bytes, hash_.text()};
  }

private:
  std::string name_;
  AtomicFile file_;
  PartHash hash_;
};

class PartReader {
public:
  PartReader(const std::string& folder, const PreparedFile& file, std::uint64_t mark)
      : path_((fs::path(folder) / file.name).string()), file_(file),
        descriptor_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0)
      fail(std::string("cannot be opened: ") + std::strerror(errno));
    std::uint64_t found = 0;
    read(&found, sizeof found);
    if (found != mark)
      fail("is no such file of this version and byte order");
  }
  ~PartReader() {
    if (descriptor_ >= 0)
      ::close(descriptor_);
  }
  PartReader(const PartReader&) = delete;
  PartReader& operator=(const PartReader&) = delete;

  void read(void* data, std::size_t size) {
    auto* to = static_cast<char*>(data);
    for (std::size_t left = size; left > 0;) {
      const ssize_t got = ::read(descriptor_, to, left);
      if (got < 0 && errno == EINTR)
        continue;
      if (got <= 0)
        fail(got < 0 ? std::string("cannot be read: ") + std::strerror(errno) : "is cut off");
      to += got;
      left -= static_cast<std::size_t>(got);
    }
    hash_.add(data, size);
  }
  template <typename T>
  void read(std::vector<T>& values, std::uint64_t count) {
    values.resize(static_cast<std::size_t>(count));
    read(values.data(), values.size() * sizeof(T));
  }
  void finish() const {
    if (hash_.text() != file_.hash)
      fail("is damaged, or belongs to another mesh: its hash is not that of the index");
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Status::Invalid, path_, what, "prepare the mesh again");
  }

private:
  std::string path_;
  const PreparedFile& file_;
  int descriptor_;
  PartHash hash_;
};

} // namespace

std::uint64_t boundaryFileBytes(std::uint64_t faces, std::uint64_t points) {
  return sizeof kBoundaryMark + faces * sizeof(BoundaryFace) + points * sizeof(Vec3d);
}

std::uint64_t nodesFileBytes(std::uint64_t nodes) {
  return sizeof kNodesMark + nodes * sizeof(MetNode);
}

std::uint64_t bucketFileBytes(const PreparedIndex& index, const TetBucket& bucket) {
  const std::uint64_t eachTet =
      20 + (index.hasRegions ? 4 : 0) + (index.hasShapes ? kShapeBytesPerTet : 0);
  std::uint64_t bytes = sizeof kBucketMark + bucket.tets * eachTet + bucket.points * sizeof(Vec3d) +
                        bucket.cellNodes * sizeof(std::uint32_t) + bucket.cells;
  for (const PreparedArray& array : index.arrays)
    bytes += (array.on == Attribute::On::Points ? bucket.points : bucket.tets) *
             SpooledArray{{}, array.on, array.components, array.type, nullptr}.bytesEach();
  return bytes;
}

PreparedFile writeBoundary(const std::string& folder, const SpooledBoundary& boundary) {
  PartWriter out(folder, kPreparedBoundary, kBoundaryMark);
  out.add(boundary.chain.faces);
  out.add(boundary.points);
  return out.finish();
}

PreparedFile writeNodes(const std::string& folder, const std::vector<MetNode>& nodes) {
  PartWriter out(folder, kPreparedNodes, kNodesMark);
  out.add(nodes);
  return out.finish();
}

PreparedFile writeBucket(const std::string& folder, const std::string& name,
                         const BucketTets& tets) {
  PartWriter out(folder, name, kBucketMark);
  out.add(tets.mesh.tets);
  out.add(tets.numbers);
  out.add(tets.mesh.regions);
  out.add(tets.mesh.points);
  const CurvedCells& curved = tets.mesh.curved;
  out.add(curved.cellOfTet);
  out.add(curved.corners);
  out.add(curved.nodes);
  for (const CurvedCells::Cell& cell : curved.cells)
    out.add(&cell.shape, sizeof cell.shape);
  for (const Attribute& array : tets.mesh.attributes) {
    const auto [bytes, size] = bytesOf(array.values);
    out.add(bytes, size);
  }
  return out.finish();
}

SpooledBoundary readBoundary(const std::string& folder, const PreparedIndex& index) {
  SpooledBoundary boundary;
  PartReader in(folder, index.boundary, kBoundaryMark);
  in.read(boundary.chain.faces, index.counts.boundaryFaces);
  in.read(boundary.points, index.boundaryPoints);
  in.finish();
  boundary.chain.flipped = index.counts.flipped;
  boundary.chain.dropped = index.counts.dropped;
  const std::size_t points = boundary.points.size();
  for (const BoundaryFace& face : boundary.chain.faces)
    if (face.a >= points || face.b >= points || face.c >= points || face.weight <= 0)
      in.fail("has a face without its points");
  return boundary;
}

std::vector<MetNode> readNodes(const std::string& folder, const PreparedIndex& index) {
  std::vector<MetNode> nodes;
  PartReader in(folder, index.nodes, kNodesMark);
  in.read(nodes, index.nodeCount);
  in.finish();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const std::int32_t place : nodes[i].node)
      if (place < -kMaxNode || place >= kMaxNode)
        in.fail("has a node outside of index space");
    if (i > 0 && !(nodes[i - 1].node < nodes[i].node))
      in.fail("has its nodes in no order");
  }
  return nodes;
}

BucketTets emptyBucket(const PreparedIndex& index) {
  BucketTets tets;
  tets.mesh.unread = index.unread;
  for (const PreparedArray& array : index.arrays)
    tets.mesh.attributes.push_back(
        emptyAttribute({array.name, array.on, array.components, array.type, nullptr}));
  return tets;
}

namespace {

void readShapes(PartReader& in, const PreparedIndex& index, const TetBucket& bucket,
                CurvedCells& curved) {
  if (!index.hasShapes)
    return;
  in.read(curved.cellOfTet, bucket.tets);
  in.read(curved.corners, bucket.tets);
  in.read(curved.nodes, bucket.cellNodes);
  std::vector<CurvedShape> shapes;
  in.read(shapes, bucket.cells);
  std::uint64_t first = 0;
  curved.cells.reserve(shapes.size());
  for (const CurvedShape shape : shapes) {
    if (shape != CurvedShape::Hex8 && shape != CurvedShape::Wedge6 &&
        shape != CurvedShape::Pyramid5)
      in.fail("has a cell of no known shape");
    curved.cells.push_back({first, shape});
    first += nodeCount(shape);
  }
  if (first != curved.nodes.size())
    in.fail("has cells without their nodes");
}

} // namespace

BucketTets readBucket(const std::string& folder, const PreparedIndex& index,
                      const TetBucket& bucket) {
  BucketTets tets = emptyBucket(index);
  TetMesh& mesh = tets.mesh;
  if (bucket.tets == 0)
    return tets;
  PartReader in(folder, bucket.file, kBucketMark);
  in.read(mesh.tets, 4 * bucket.tets);
  in.read(tets.numbers, bucket.tets);
  in.read(mesh.regions, index.hasRegions ? bucket.tets : 0);
  in.read(mesh.points, bucket.points);
  readShapes(in, index, bucket, mesh.curved);
  for (Attribute& array : mesh.attributes)
    std::visit(
        [&](auto& values) {
          in.read(values, (array.on == Attribute::On::Points ? bucket.points : bucket.tets) *
                              array.components);
        },
        array.values);
  in.finish();
  mesh.cellCount = mesh.tetCount();
  try {
    checkMesh(mesh);
  } catch (const Error& error) {
    in.fail(std::string("holds no mesh: ") + error.what());
  }
  return tets;
}

} // namespace tetvdb
