// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/ThreeMfWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/ThreeMfHandle.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace tetvdb {
namespace {

using namespace NMR;

constexpr std::size_t kMostOfAKind = std::size_t(INT32_MAX); // lib3mf counts with int
constexpr DWORD kMillimetre = 1;

DWORD unitOf(const std::string& name) {
  for (DWORD i = 0; i < std::size(kThreeMfUnits); ++i)
    if (name == kThreeMfUnits[i])
      return i;
  return kMillimetre;
}

float toFloat(double x) {
  constexpr double largest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -largest, largest));
}

std::vector<MODELMESHVERTEX> vertices(const TriangleMesh& mesh) {
  std::vector<MODELMESHVERTEX> result(mesh.points.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      result[i].m_fPosition[k] = toFloat(mesh.points[i][k]);
  return result;
}

std::vector<MODELMESHTRIANGLE> faces(const TriangleMesh& mesh) {
  std::vector<MODELMESHTRIANGLE> result;
  result.reserve(mesh.triangleCount());
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const std::uint32_t* v = mesh.triangles.data() + 3 * t;
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      continue;
    MODELMESHTRIANGLE triangle;
    std::copy(v, v + 3, triangle.m_nIndices);
    result.push_back(triangle);
  }
  return result;
}

} // namespace

void writeThreeMf(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  if (mesh.points.size() > kMostOfAKind || mesh.triangleCount() > kMostOfAKind)
    throw Error(Status::Limit, path, "more points or faces than a .3mf file can count",
                "write .ply or .obj, or several files");
  const auto check = [&](LIB3MFRESULT result, const ThreeMfHandle& on) {
    if (result != 0)
      throw Error(Status::Write, path, "cannot write 3MF: " + on.lastError(),
                  "write .stl or .ply instead");
    progress.check();
  };
  std::vector<MODELMESHTRIANGLE> triangles = faces(mesh);
  if (triangles.empty())
    throw Error(Status::Invalid, path, "no face has three different points",
                "3MF holds no others; write .ply or .obj instead");
  std::vector<MODELMESHVERTEX> points = vertices(mesh);

  ThreeMfHandle model, object, item, writer;
  check(lib3mf_createmodel(model.put()), model);
  check(lib3mf_model_setunit(model, unitOf(mesh.units)), model);
  check(lib3mf_model_addmeshobject(model, object.put()), model);
  check(lib3mf_meshobject_setgeometry(object, points.data(), static_cast<DWORD>(points.size()),
                                      triangles.data(), static_cast<DWORD>(triangles.size())),
        object);
  check(lib3mf_model_addbuilditem(model, object, nullptr, item.put()), model);
  check(lib3mf_model_querywriter(model, "3mf", writer.put()), model);
  ULONG64 size = 0;
  check(lib3mf_writer_getstreamsize(writer, &size), writer);
  std::vector<BYTE> bytes(static_cast<std::size_t>(size));
  check(lib3mf_writer_writetobuffer(writer, bytes.data(), size), writer);
  AtomicFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

} // namespace tetvdb
