// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification".
#include "tetvdb/io/ThreeMfReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/IsolatedRead.h"
#include "tetvdb/io/PlacedFaces.h"
#include "tetvdb/io/ThreeMfHandle.h"
#include "tetvdb/io/ZipDirectory.h"

#include <vector>

namespace tetvdb {
namespace {

using namespace NMR;

constexpr std::size_t kMaxPlacements = std::size_t(1) << 20; // of objects, nested ones counted anew
constexpr std::size_t kMaxDepth = 256;

// lib3mf keeps twice the bytes of a mesh's XML; what components repeat comes on top. It reads 100
// MB of XML a second, but takes for ever over components that contain one another many times.
constexpr std::uint64_t kMemoryPerByte = 16, kMemory = std::uint64_t(1) << 30;
constexpr std::uint64_t kBytesPerSecond = std::uint64_t(1) << 20;
constexpr unsigned kSeconds = 20;

/// By lib3mf's numbers.
constexpr const char* kUnits[] = {"micrometre", "millimetre", "centimetre",
                                  "inch",       "foot",       "metre"};

Placement toPlacement(const MODELTRANSFORM& transform) {
  Placement placement;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      placement.rows[i][j] = static_cast<double>(transform.m_fFields[i][j]);
  return placement;
}

class Model {
public:
  explicit Model(const Source& source) : source_(source), faces_(source.path) {}

  TriangleMesh read(Report& report) {
    check(lib3mf_createmodel(model_.put()), model_);
    ThreeMfHandle reader;
    check(lib3mf_model_queryreader(model_, "3mf", reader.put()), model_);
    // It takes the bytes as not constant, but only reads them.
    auto* bytes = reinterpret_cast<BYTE*>(const_cast<char*>(source_.bytes.data()));
    check(lib3mf_reader_readfrombuffer(reader, bytes, source_.bytes.size()), reader);

    ThreeMfHandle items;
    check(lib3mf_model_getbuilditems(model_, items.put()), model_);
    for (;;) {
      BOOL more = 0;
      check(lib3mf_builditemiterator_movenext(items, &more), items);
      if (more == 0)
        break;
      ThreeMfHandle item, object;
      check(lib3mf_builditemiterator_getcurrent(items, item.put()), items);
      check(lib3mf_builditem_getobjectresource(item, object.put()), item);
      MODELTRANSFORM transform;
      check(lib3mf_builditem_getobjecttransform(item, &transform), item);
      addObject(object, toPlacement(transform), 0);
    }
    if (placements_ == 0)
      throw Error(Status::Invalid, source_.path, "its build is empty: it places no object",
                  "place the parts on the build plate and export it again");
    TriangleMesh mesh = faces_.finish(report);
    mesh.units = units();
    if (beams_ > 0) {
      report.warn("beams",
                  std::to_string(beams_) + " beams of lattices were left out: they have no faces");
      report.partial = true;
    }
    return mesh;
  }

private:
  void addObject(const ThreeMfHandle& object, const Placement& placement, std::size_t depth) {
    if (++placements_ > kMaxPlacements || depth > kMaxDepth)
      throw Error(Status::Limit, source_.path,
                  "its components contain one another too often or too deeply",
                  "merge the parts and export it again");
    BOOL isMesh = 0, isComponents = 0;
    check(lib3mf_object_ismeshobject(object, &isMesh), object);
    if (isMesh != 0)
      return addMesh(object, placement);
    check(lib3mf_object_iscomponentsobject(object, &isComponents), object);
    if (isComponents == 0)
      return;
    DWORD n = 0;
    check(lib3mf_componentsobject_getcomponentcount(object, &n), object);
    for (DWORD i = 0; i < n; ++i) {
      ThreeMfHandle component, part;
      check(lib3mf_componentsobject_getcomponent(object, i, component.put()), object);
      check(lib3mf_component_getobjectresource(component, part.put()), component);
      MODELTRANSFORM transform;
      check(lib3mf_component_gettransform(component, &transform), component);
      addObject(part, placement * toPlacement(transform), depth + 1);
    }
  }

  void addMesh(const ThreeMfHandle& object, const Placement& placement) {
    DWORD points = 0, triangles = 0, beams = 0;
    check(lib3mf_meshobject_getvertexcount(object, &points), object);
    check(lib3mf_meshobject_gettrianglecount(object, &triangles), object);
    check(lib3mf_meshobject_getbeamcount(object, &beams), object);
    beams_ += beams;
    vertices_.resize(points);
    triangles_.resize(triangles);
    if (points > 0)
      check(lib3mf_meshobject_getvertices(object, vertices_.data(), points, nullptr), object);
    if (triangles > 0)
      check(lib3mf_meshobject_gettriangleindices(object, triangles_.data(), triangles, nullptr),
            object);
    faces_.beginMesh(placement, points);
    for (const MODELMESHVERTEX& v : vertices_)
      faces_.addPoint({static_cast<double>(v.m_fPosition[0]), static_cast<double>(v.m_fPosition[1]),
                       static_cast<double>(v.m_fPosition[2])});
    for (const MODELMESHTRIANGLE& t : triangles_) {
      const std::uint32_t corners[3] = {t.m_nIndices[0], t.m_nIndices[1], t.m_nIndices[2]};
      faces_.addPolygon(corners, 3);
    }
  }

  std::string units() const {
    DWORD unit = 0;
    check(lib3mf_model_getunit(model_, &unit), model_);
    return unit < std::size(kUnits) ? kUnits[unit] : "";
  }

  void check(LIB3MFRESULT result, const ThreeMfHandle& on) const {
    if (result == 0)
      return;
    throw Error(Status::Invalid, source_.path, "cannot be read as 3MF: " + on.lastError(),
                "the file is damaged or needs an extension that is not known; export it again as "
                "plain 3MF or STL");
  }

  const Source& source_;
  PlacedFaces faces_;
  ThreeMfHandle model_;
  std::size_t placements_ = 0;
  std::uint64_t beams_ = 0;
  std::vector<MODELMESHVERTEX> vertices_;
  std::vector<MODELMESHTRIANGLE> triangles_;
};

} // namespace

TriangleMesh readThreeMf(const Source& source, Report& report, Progress& progress) {
  const std::uint64_t unpacked = checkZipEntries(readZipDirectory(source), source, progress);
  const IsolationLimits limits{kMemory + kMemoryPerByte * unpacked,
                               kSeconds + static_cast<unsigned>(unpacked / kBytesPerSecond)};
  return readTrianglesIsolated([&](Report& found, Progress&) { return Model(source).read(found); },
                               source.path, limits, report, progress);
}

} // namespace tetvdb
