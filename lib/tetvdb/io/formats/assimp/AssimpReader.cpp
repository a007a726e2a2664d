// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/assimp/AssimpReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/FileFormat.h"

#ifdef TETVDB_ASSIMP

#include "tetvdb/core/Letters.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/cells/PlacedFaces.h"
#include "tetvdb/io/source/IsolatedRead.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/mesh/CellMesh.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <cmath>
#include <exception>
#include <filesystem>
#include <map>
#include <pugixml.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <strings.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxNodes = std::size_t(1) << 22;
constexpr std::size_t kMaxDepth = 1024;
// assimp uses up to 13 bytes per byte of binary data, and text has fewer numbers per byte; buffers
// may be in separate files.
constexpr std::uint64_t kMemoryPerByte = 100, kMemory = std::uint64_t(4) << 30;
constexpr std::uint64_t kBytesPerSecond = std::uint64_t(1) << 18;
constexpr unsigned kSeconds = 60;

// What assimp is told of a format, and what it makes of its coordinates.
struct SceneFormat {
  const char* importer; ///< part of its name
  const char* ending;   ///< assimp requires the usual one
  const char* units;
};

SceneFormat sceneFormat(FileFormat format, std::string_view bytes) {
  switch (format) {
  case FileFormat::Gltf:
    return {"glTF", bytes.substr(0, 4) == "glTF" ? "glb" : "gltf", "metre"};
  case FileFormat::Fbx:
    return {"FBX", "fbx", "centimetre"};
  case FileFormat::ThreeDs:
    return {"3DS", "3ds", ""};
  default:
    return {"Collada", "dae", "metre"}; // converts the file's unit
  }
}

Placement toPlacement(const aiMatrix4x4& m) {
  Placement placement;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 4; ++j)
      placement.rows[i][j] = static_cast<double>(m[i][j]);
  return placement;
}

/// assimp's other importers crash on damaged files, and formats are recognised by our signatures.
void keepImporters(Assimp::Importer& importer, std::string_view part) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    const aiImporterDesc* description = importer.GetImporterInfo(i);
    if (description == nullptr ||
        std::string_view(description->mName).find(part) == std::string_view::npos)
      others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others)
    importer.UnregisterLoader(other);
}

/// Receives the log of assimp, in which it reports omissions. Messages about materials, normals and
/// similar content are ignored.
class Listener : public Assimp::LogStream {
public:
  void write(const char* message) override {
    const std::string text = lowerCase(message);
    const auto has = [&](const char* word) { return text.find(word) != text.npos; };
    for (const char* other :
         {"material", "texture", "anim", "light", "camera", "normal", "tangent", "uv", "color"})
      if (has(other))
        return;
    if (!has("drop") && !has("ignor") && !has("skip") && !has("fail") && !has("invalid") &&
        !has("range"))
      return;
    const std::size_t kind = std::string_view(message).find(": "); // "Warn,  T0: "
    if (count_++ == 0)
      first_ = readable(kind == std::string_view::npos ? message : message + kind + 2);
  }
  /// The first omission; empty if there is none.
  const std::string& first() const { return first_; }
  void report(Report& report) const {
    if (count_ == 0)
      return;
    report.warn("scene-faults", "assimp left something out, with " + std::to_string(count_) +
                                    " messages of which the first is: " + first_);
    report.partial = true;
  }

  /// One line of readable characters, at most 200.
  static std::string readable(const char* text) {
    std::string line;
    for (const char* c = text; *c != '\0' && line.size() < 200; ++c)
      line += *c < ' ' || *c > '~' ? ' ' : *c;
    while (!line.empty() && line.back() == ' ')
      line.pop_back();
    return line;
  }

private:
  std::size_t count_ = 0;
  std::string first_;
};

/// Opens the file itself and files within its folder (glTF's buffers), for reading.
class FilesWithin : public Assimp::DefaultIOSystem {
public:
  explicit FilesWithin(const std::string& path) : path_(path) {}

  bool Exists(const char* file) const override {
    return isAllowed(file) && DefaultIOSystem::Exists(file);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return isAllowed(file) && mode[0] == 'r' ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

private:
  bool isAllowed(const char* file) const {
    if (path_ == file)
      return true;
    try {
      pathWithin(path_, std::filesystem::absolute(file).string());
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }

  const std::string& path_;
};

/// Names the meshes that controllers deform in their place.
struct DeformedMeshes : pugi::xml_tree_walker {
  std::map<std::string, std::string> sources; ///< of each controller: a mesh, or another one

  bool for_each(pugi::xml_node& node) override {
    if (std::string_view(node.name()) != "instance_controller")
      return true;
    std::string mesh = node.attribute("url").value();
    for (std::size_t k = 0; k < sources.size() && sources.count(mesh) != 0; ++k)
      mesh = sources[mesh];
    node.set_name("instance_geometry");
    node.attribute("url").set_value(mesh.c_str());
    return true;
  }
};

/// Runs in a process of its own: the logger is global.
class Scene {
public:
  Scene(const Source& source, FileFormat format)
      : source_(source), format_(format), faces_(source.path) {}

  TriangleMesh read(Report& report) {
    auto* listener = new Listener; // owned by the logger
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(listener,
                                               Assimp::Logger::Err | Assimp::Logger::Warn);
    Assimp::Importer importer;
    importer.SetIOHandler(new FilesWithin(source_.path)); // the importer's from now on
    const SceneFormat format = sceneFormat(format_, source_.bytes);
    keepImporters(importer, format.importer);
    // Axes and points of rotation are those of the file; only meshes are read.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    // Where a scene has no meshes, assimp makes some that show its nodes.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_MATERIALS, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
    scene_ = readBytes(importer, format.ending);
    if (scene_ == nullptr)
      fail(Listener::readable(importer.GetErrorString()));
    if (scene_->mRootNode == nullptr || scene_->mNumMeshes == 0) {
      if (format_ == FileFormat::Collada && source_.bytes.find("<convex_mesh") != std::string::npos)
        throw Error(Status::Invalid, source_.path,
                    "its meshes are convex hulls of a physics model, which are not read",
                    "export the model's meshes");
      throw Error(Status::Invalid, source_.path,
                  listener->first().empty() ? "it holds no meshes"
                                            : "it holds no whole meshes: " + listener->first(),
                  "export it again");
    }

    Placement world;
    if (format_ == FileFormat::Fbx) {
      const double scale = fbxScale();
      for (std::size_t i = 0; i < 3; ++i)
        world.rows[i][i] = scale;
    }
    if (format_ == FileFormat::ThreeDs) // assimp turns z, which points up, to y
      world.rows = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    addNode(*scene_->mRootNode, world, 0);
    listener->report(report);
    TriangleMesh mesh = faces_.finish(report);
    mesh.units = format.units;
    return mesh;
  }

private:
  [[noreturn]] void fail(const std::string& reason) const {
    const bool lacksFile = reason.find("could not open referenced file") != reason.npos;
    const bool isUnknown = reason.find("No suitable reader") != reason.npos;
    throw Error(Status::Invalid, source_.path,
                "cannot be read: " +
                    (isUnknown ? "its header is damaged, or of a version that assimp does not read"
                               : reason),
                lacksFile ? "put that file beside it, or export it as one file"
                          : "the file is damaged; export it again");
  }

  /// A COLLADA file's meshes where its nodes put them, without what colours, deforms and moves
  /// them: assimp refuses files whose effects name no image file, and crashes on weights of bones
  /// that begin with spaces. Meshes with bones stand as they were modelled.
  std::string meshesAlone() const {
    pugi::xml_document document;
    if (!document.load_buffer(source_.bytes.data(), source_.bytes.size()))
      return std::string(source_.bytes); // assimp says what is wrong
    pugi::xml_node root = document.document_element();
    DeformedMeshes meshes;
    for (const pugi::xml_node library : root.children("library_controllers"))
      for (const pugi::xml_node controller : library.children("controller"))
        for (const char* kind : {"skin", "morph"})
          if (const pugi::xml_node deformed = controller.child(kind))
            meshes.sources[std::string("#") + controller.attribute("id").value()] =
                deformed.attribute("source").value();
    document.traverse(meshes);
    for (const char* library :
         {"library_images", "library_effects", "library_materials", "library_controllers",
          "library_animations", "library_animation_clips"})
      while (root.remove_child(library)) {
      }
    std::ostringstream text;
    document.save(text, "", pugi::format_raw);
    return text.str();
  }

  /// By the path, so that files beside it are found.
  const aiScene* readBytes(Assimp::Importer& importer, const char* usual) const {
    if (format_ == FileFormat::Collada) { // of other files it needs none then
      const std::string text = meshesAlone();
      return importer.ReadFileFromMemory(text.data(), text.size(), 0, usual);
    }
    const std::size_t dot = source_.path.find_last_of('.');
    const std::string ending = dot == source_.path.npos ? "" : source_.path.substr(dot + 1);
    if (::strcasecmp(ending.c_str(), usual) == 0)
      return importer.ReadFile(source_.path, 0);
    return importer.ReadFileFromMemory(source_.bytes.data(), source_.bytes.size(), 0, usual);
  }
  void addNode(const aiNode& node, const Placement& parent, std::size_t depth) {
    if (++nodes_ > kMaxNodes || depth > kMaxDepth)
      throw Error(Status::Limit, source_.path, "its nodes are too many or nested too deeply",
                  "merge the parts and export it again");
    const Placement placement = parent * toPlacement(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      if (node.mMeshes[i] < scene_->mNumMeshes)
        addMesh(*scene_->mMeshes[node.mMeshes[i]], placement);
    for (unsigned i = 0; i < node.mNumChildren; ++i)
      addNode(*node.mChildren[i], placement, depth + 1);
  }

  void addMesh(const aiMesh& mesh, const Placement& placement) {
    faces_.beginMesh(placement, mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      faces_.addPoint(
          {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)});
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices > 2) // lines and points are not faces
        faces_.addPolygon(face.mIndices, face.mNumIndices);
    }
  }

  /// Centimetres per unit of the file.
  double fbxScale() const {
    double scale = 1;
    float single = 1;
    if (scene_->mMetaData == nullptr)
      return 1;
    if (!scene_->mMetaData->Get("UnitScaleFactor", scale) &&
        scene_->mMetaData->Get("UnitScaleFactor", single))
      scale = static_cast<double>(single);
    return std::isfinite(scale) && scale > 0 ? scale : 1;
  }

  const Source& source_;
  FileFormat format_;
  PlacedFaces faces_;
  const aiScene* scene_ = nullptr;
  std::size_t nodes_ = 0;
};

TriangleMesh readScene(const Source& source, FileFormat format, Report& report,
                       Progress& progress) {
  const std::uint64_t bytes = source.bytes.size();
  const IsolationLimits limits{kMemory + kMemoryPerByte * bytes,
                               kSeconds + static_cast<unsigned>(bytes / kBytesPerSecond)};
  return readTrianglesIsolated(
      [&](Report& found, Progress&) { return Scene(source, format).read(found); }, source.path,
      limits, report, progress);
}

} // namespace
} // namespace tetvdb

#else

namespace tetvdb {

namespace {

TriangleMesh readScene(const Source& source, FileFormat, Report&, Progress&) {
  throw Error(
      Status::Invalid, source.path,
      "glTF, FBX, COLLADA and 3DS files are read by assimp, which this program was built without",
      "install libassimp-dev and build it again, or export the mesh as STL or OBJ");
}

} // namespace

} // namespace tetvdb

#endif

namespace tetvdb {

TriangleMesh readGltf(const Source& source, Report& report, Progress& progress) {
  return readScene(source, FileFormat::Gltf, report, progress);
}

TriangleMesh readFbx(const Source& source, Report& report, Progress& progress) {
  return readScene(source, FileFormat::Fbx, report, progress);
}

TriangleMesh readCollada(const Source& source, Report& report, Progress& progress) {
  return readScene(source, FileFormat::Collada, report, progress);
}

TriangleMesh readThreeDs(const Source& source, Report& report, Progress& progress) {
  return readScene(source, FileFormat::ThreeDs, report, progress);
}

} // namespace tetvdb
