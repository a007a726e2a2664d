// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification". lib3mf would write six
// digits behind the point, which flattens small models, and random identifiers.
#include "tetvdb/io/ThreeMfWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/ZipWriter.h"

#include <charconv>
#include <string_view>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kPerUpdate = std::size_t(1) << 14;
constexpr std::size_t kMostOfAKind = std::size_t(INT32_MAX); // readers count with int

constexpr std::string_view kTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr std::string_view kRelations =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";

/// 3MF's name of a unit.
std::string_view unitName(const std::string& units) {
  constexpr std::pair<std::string_view, std::string_view> names[] = {{"micrometre", "micron"},
                                                                     {"centimetre", "centimeter"},
                                                                     {"inch", "inch"},
                                                                     {"foot", "foot"},
                                                                     {"metre", "meter"}};
  for (const auto& [ours, theirs] : names)
    if (units == ours)
      return theirs;
  return "millimeter";
}

/// Text on its way into the archive.
class Xml {
public:
  explicit Xml(ZipWriter& zip) : zip_(zip) {}

  Xml& text(std::string_view words) {
    text_ += words;
    return *this;
  }
  template <class T>
  Xml& number(T value) {
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    return *this;
  }
  void flush() {
    zip_.write(text_);
    text_.clear();
  }

private:
  ZipWriter& zip_;
  std::string text_;
};

bool namesAPointTwice(const std::uint32_t* v) {
  return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

void writeModel(Xml& xml, const TriangleMesh& mesh, Progress& progress) {
  const std::size_t points = mesh.points.size(), faces = mesh.triangleCount();
  const auto update = [&](std::size_t done) {
    if (done % kPerUpdate != 0)
      return;
    xml.flush();
    progress.update(static_cast<double>(done) / static_cast<double>(points + faces));
  };
  xml.text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"")
      .text(unitName(mesh.units))
      .text("\" xml:lang=\"en-US\" "
            "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
            "<metadata name=\"Application\">TetVDB</metadata>\n"
            "<resources><object id=\"1\" type=\"model\"><mesh><vertices>\n");
  for (std::size_t i = 0; i < points; ++i) {
    const Vec3d& p = mesh.points[i];
    xml.text("<vertex x=\"").number(p[0]).text("\" y=\"").number(p[1]);
    xml.text("\" z=\"").number(p[2]).text("\"/>\n");
    update(i);
  }
  xml.text("</vertices><triangles>\n");
  for (std::size_t t = 0; t < faces; ++t) {
    const std::uint32_t* v = mesh.triangles.data() + 3 * t;
    if (!namesAPointTwice(v))
      xml.text("<triangle v1=\"")
          .number(v[0])
          .text("\" v2=\"")
          .number(v[1])
          .text("\" v3=\"")
          .number(v[2])
          .text("\"/>\n");
    update(points + t);
  }
  xml.text("</triangles></mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n"
           "</model>\n");
  xml.flush();
}

} // namespace

void writeThreeMf(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  if (mesh.points.size() > kMostOfAKind || mesh.triangleCount() > kMostOfAKind)
    throw Error(Status::Limit, path, "more points or faces than a .3mf file can count",
                "write .ply or .obj, or several files");
  bool empty = true;
  for (std::size_t t = 0; t < mesh.triangleCount() && empty; ++t)
    empty = namesAPointTwice(mesh.triangles.data() + 3 * t);
  if (empty)
    throw Error(Status::Invalid, path, "no face has three different points",
                "3MF holds no others; write .ply or .obj instead");
  AtomicFile file(path);
  ZipWriter zip(file);
  for (const auto& [name, text] : {std::pair(std::string("[Content_Types].xml"), kTypes),
                                   std::pair(std::string("_rels/.rels"), kRelations)}) {
    zip.begin(name);
    zip.write(text);
    zip.end();
  }
  zip.begin("3D/3dmodel.model");
  Xml xml(zip);
  writeModel(xml, mesh, progress);
  zip.end();
  zip.finish();
  file.commit();
}

} // namespace tetvdb
