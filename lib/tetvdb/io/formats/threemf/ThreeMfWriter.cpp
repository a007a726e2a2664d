// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification". lib3mf is not used: it
// writes six decimals, which flattens small models, and random identifiers.
#include "tetvdb/io/formats/threemf/ThreeMfWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/text/XmlText.h"
#include "tetvdb/io/text/ZipWriter.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxOfAKind = std::size_t(INT32_MAX); // readers count with int

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

/// Buffers text for the archive.
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

bool hasFaces(const TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t)
    if (!namesAPointTwice(mesh.triangles.data() + 3 * t))
      return true;
  return false;
}

class ModelWriter {
public:
  ModelWriter(Xml& xml, Progress& progress) : xml_(xml), progress_(progress) {}

  void write(const std::vector<const TriangleMesh*>& meshes, const std::vector<NamedMesh>* names) {
    for (const TriangleMesh* mesh : meshes)
      total_ += mesh->points.size() + mesh->triangleCount();
    xml_.text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"")
        .text(unitName(meshes.front()->units))
        .text("\" xml:lang=\"en-US\" "
              "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
              "<metadata name=\"Application\">TetVDB</metadata>\n"
              "<resources>");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      beginObject(i + 1, names != nullptr ? (*names)[i].name : std::string());
      writeMesh(*meshes[i]);
      xml_.text("</object>");
    }
    const std::vector<std::size_t> built = writeAssemblies(meshes.size(), names);
    xml_.text("</resources>\n<build>");
    for (const std::size_t id : built)
      xml_.text("<item objectid=\"").number(id).text("\"/>");
    xml_.text("</build>\n</model>\n");
    xml_.flush();
  }

private:
  void beginObject(std::size_t id, const std::string& name) {
    xml_.text("<object id=\"").number(id).text("\" type=\"model\"");
    if (!name.empty())
      xml_.text(" name=\"").text(xmlAttributeText(name)).text("\"");
    xml_.text(">");
  }

  void writeMesh(const TriangleMesh& mesh) {
    xml_.text("<mesh><vertices>\n");
    for (const Vec3d& p : mesh.points) {
      xml_.text("<vertex x=\"").number(p[0]).text("\" y=\"").number(p[1]);
      xml_.text("\" z=\"").number(p[2]).text("\"/>\n");
      update();
    }
    xml_.text("</vertices><triangles>\n");
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
      const std::uint32_t* v = mesh.triangles.data() + 3 * t;
      if (!namesAPointTwice(v))
        xml_.text("<triangle v1=\"")
            .number(v[0])
            .text("\" v2=\"")
            .number(v[1])
            .text("\" v3=\"")
            .number(v[2])
            .text("\"/>\n");
      update();
    }
    xml_.text("</triangles></mesh>");
  }

  // Writes objects of components for meshes that are placed together; returns the objects to build.
  std::vector<std::size_t> writeAssemblies(std::size_t count, const std::vector<NamedMesh>* names) {
    std::vector<std::size_t> built;
    std::size_t id = count;
    for (std::size_t first = 0, last; first < count; first = last) {
      last = first + 1;
      while (names != nullptr && last < count &&
             (*names)[last].assembly == (*names)[first].assembly)
        ++last;
      if (last == first + 1) {
        built.push_back(last);
        continue;
      }
      beginObject(++id, (*names)[first].assemblyName);
      xml_.text("<components>");
      for (std::size_t i = first; i < last; ++i)
        xml_.text("<component objectid=\"").number(i + 1).text("\"/>");
      xml_.text("</components></object>");
      built.push_back(id);
    }
    return built;
  }

  void update() {
    if (done_++ % kItemsPerUpdate != 0)
      return;
    xml_.flush();
    progress_.update(static_cast<double>(done_) / static_cast<double>(total_));
  }

  Xml& xml_;
  Progress& progress_;
  std::size_t done_ = 0, total_ = 0;
};

void writeObjects(const std::string& path, const std::vector<const TriangleMesh*>& meshes,
                  const std::vector<NamedMesh>* names, Progress& progress) {
  std::size_t points = 0, faces = 0;
  for (const TriangleMesh* mesh : meshes) {
    points = std::max(points, mesh->points.size());
    faces = std::max(faces, mesh->triangleCount());
    if (!hasFaces(*mesh))
      throw Error(Status::Invalid, path, "no face has three different points",
                  "3MF holds no others; write .ply or .obj instead");
  }
  if (points > kMaxOfAKind || faces > kMaxOfAKind)
    throw Error(Status::Limit, path, "more points or faces than a .3mf file can count",
                "write .ply or .obj, or several files");
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
  ModelWriter(xml, progress).write(meshes, names);
  zip.end();
  zip.finish();
  file.commit();
}

} // namespace

void writeThreeMf(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  writeObjects(path, {&mesh}, nullptr, progress);
}

void writeThreeMf(const std::string& path, const std::vector<NamedMesh>& objects,
                  Progress& progress) {
  std::vector<const TriangleMesh*> meshes;
  for (const NamedMesh& object : objects)
    meshes.push_back(&object.mesh);
  if (meshes.empty())
    throw Error(Status::Invalid, path, "there is no object to write");
  writeObjects(path, meshes, &objects, progress);
}

} // namespace tetvdb
