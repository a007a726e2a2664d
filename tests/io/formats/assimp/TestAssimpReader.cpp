// SPDX-License-Identifier: Apache-2.0
//
// Scenes written by hand. Where the library was built without assimp, every one of them is an Error
// that says so.
#include "TriangleMeshes.h"
#include "io/TriangleSamples.h"

#include <algorithm>

namespace tetvdb {
namespace {

using namespace test;

std::string base64(const std::string& bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  std::size_t at = 0;
  for (; at + 3 <= bytes.size(); at += 3) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(bytes[at + k]); };
    const unsigned bits = unsigned(byte(0)) << 16 | unsigned(byte(1)) << 8 | byte(2);
    for (int shift = 18; shift >= 0; shift -= 6)
      text += digits[bits >> shift & 63];
  }
  return text; // of whole triples alone
}

/// The corner tetrahedron, as floats and shorts.
std::string buffer(std::uint16_t lastIndex = 3) {
  Bytes bytes;
  const TriangleMesh mesh = cornerTetrahedron();
  for (const Vec3d& p : mesh.points)
    for (const double x : p)
      bytes.floats({static_cast<float>(x)});
  for (std::size_t i = 0; i + 1 < mesh.triangles.size(); ++i)
    bytes.add<std::uint16_t>({static_cast<std::uint16_t>(mesh.triangles[i])});
  bytes.add<std::uint16_t>({lastIndex});
  return bytes.str();
}

/// Placed three times: moved, moved and moved again within, and mirrored.
std::string gltf(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[)"
         R"({"mesh":0,"translation":[10,0,0],"children":[2]},{"mesh":0,"scale":[-2,1,1]},)"
         R"({"mesh":0,"translation":[0,5,0]}],"meshes":[{"primitives":[)"
         R"({"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
         R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},)"
         R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],"bufferViews":[)"
         R"({"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],)"
         R"("buffers":[{"byteLength":72)" +
         (uri.empty() ? "" : R"(,"uri":")" + uri + "\"") + "}]}";
}
std::string gltfText() {
  return gltf("data:application/octet-stream;base64," + base64(buffer()));
}

std::string glb(const std::string& data = buffer()) {
  std::string json = gltf("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  Bytes bytes;
  bytes.text("glTF").add<std::uint32_t>(
      {2, static_cast<std::uint32_t>(28 + json.size() + data.size())});
  bytes.add<std::uint32_t>({static_cast<std::uint32_t>(json.size())}).text("JSON" + json);
  bytes.add<std::uint32_t>({static_cast<std::uint32_t>(data.size())});
  bytes.text(std::string("BIN\0", 4) + data);
  return bytes.str();
}

const std::string kCollada = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="n"><translate>0 0 100</translate><instance_geometry url="#g"/></node>
<node id="m"><scale>1 1 -1</scale><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";

const std::string kFbx = R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7400
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UpAxis", "int", "Integer", "",2
		P: "UnitScaleFactor", "double", "Number", "",100
	}
}
Objects:  {
	Geometry: 1000, "Geometry::g", "Mesh" {
		Vertices: *12 {
			a: 0,0,0,1,0,0,0,1,0,0,0,1
		}
		PolygonVertexIndex: *12 {
			a: 0,2,-2,0,1,-4,0,3,-3,1,2,-4
		}
		GeometryVersion: 124
	}
	Model: 2000, "Model::m", "Mesh" {
		Version: 232
		Properties70:  {
			P: "Lcl Translation", "Lcl Translation", "", "A",0,0,3
			P: "Lcl Scaling", "Lcl Scaling", "", "A",2,2,2
		}
	}
}
Connections:  {
	C: "OO",1000,2000
	C: "OO",2000,0
}
)";

bool isWithoutAssimp(const Reading& read) {
  return read.error.find("built without") != std::string::npos;
}

/// The largest coordinates.
Vec3d top(const TriangleMesh& mesh) {
  Vec3d largest = mesh.points.at(0);
  for (const Vec3d& p : mesh.points)
    for (std::size_t k = 0; k < 3; ++k)
      largest[k] = std::max(largest[k], p[k]);
  return largest;
}

TEST(AssimpReader, Gltf) {
  const std::pair<const char*, std::string> files[] = {
      {"a.gltf", gltfText()}, {"a.glb", glb()}, {"wrong.bin", glb()}, {"wrong.stl", gltfText()}};
  for (const auto& [name, bytes] : files) {
    FileFormat format = FileFormat::Unknown;
    const Reading read = readingFile(name, bytes, &format);
    EXPECT_EQ(format, FileFormat::Gltf);
    if (isWithoutAssimp(read))
      GTEST_SKIP() << read.error;
    ASSERT_EQ(read.error, "") << name;
    EXPECT_EQ(read.mesh.triangleCount(), 12U);
    EXPECT_EQ(top(read.mesh), (Vec3d{11, 6, 1}));
    EXPECT_NEAR(meshes::signedVolume(read.mesh), (1 + 1 + 2) / 6.0, 1e-6);
    EXPECT_EQ(read.mesh.units, "metre");
    EXPECT_EQ(read.codes(), "");
  }
}

TEST(AssimpReader, GltfWithBytesBesideIt) {
  const TemporaryPath beside("beside.bin", buffer());
  const std::string name = beside.str().substr(beside.str().find_last_of('/') + 1);
  const Reading read = readingFile("b.gltf", gltf(name));
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 12U);
  EXPECT_NE(readingFile("b.gltf", gltf("missing.bin")).error.find("put that file beside it"),
            std::string::npos);
  std::string ofVersionOne = glb();
  ofVersionOne[4] = 1;
  EXPECT_NE(readingFile("b.glb", ofVersionOne).error.find("of a version"), std::string::npos);
}

TEST(AssimpReader, GltfIndicesAreChecked) {
  const Reading read = readingFile("c.glb", glb(buffer(4)));
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  if (read.error.empty()) { // refused or salvaged, but never out of range
    EXPECT_LT(read.mesh.triangleCount(), 12U);
    EXPECT_TRUE(read.report.partial);
  }
}

TEST(AssimpReader, Collada) {
  FileFormat format = FileFormat::Unknown;
  const Reading read = readingFile("a.dae", kCollada, &format);
  EXPECT_EQ(format, FileFormat::Collada);
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 8U);
  const Vec3d largest = top(read.mesh);
  EXPECT_NEAR(largest[0], 0.01, 1e-8);
  EXPECT_NEAR(largest[2], 1.01, 1e-6);
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 2e-6 / 6, 1e-12);
  EXPECT_EQ(read.mesh.units, "metre");
}

// 3ds Max writes such files where an image is commented out.
TEST(AssimpReader, ColladaWithATextureOfNoFile) {
  std::string text = kCollada;
  text.insert(text.find("<library_geometries>"), R"(<library_effects><effect id="e"><profile_COMMON>
<newparam sid="f"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="t"><sampler2D><source>f</source></sampler2D></newparam>
<technique sid="c"><lambert><diffuse><texture texture="t" texcoord="u"/></diffuse></lambert></technique>
</profile_COMMON></effect></library_effects><library_materials><material id="m">
<instance_effect url="#e"/></material></library_materials><library_images><image id="i"/></library_images>
)");
  const std::string plain = R"(<instance_geometry url="#g"/>)";
  text.replace(text.find(plain), plain.size(), R"(<instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="a" target="#m"/></technique_common></bind_material>
</instance_geometry>)");
  const std::string triangles = R"(<triangles count="4")";
  text.insert(text.find(triangles) + triangles.size(), R"( material="a")");
  const Reading read = readingFile("t.dae", text);
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 8U);
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 2e-6 / 6, 1e-12);
}

// Of Godot's exporter for Blender, which begins lists with a space.
TEST(AssimpReader, ColladaWithBonesAndMorphs) {
  std::string text = kCollada;
  text.insert(text.find("<library_visual_scenes>"), R"(<library_controllers><controller id="c">
<skin source="#d"><source id="j"><Name_array id="ja" count="1"> bone</Name_array><technique_common>
<accessor source="#ja" count="1" stride="1"><param name="JOINT" type="Name"/></accessor></technique_common></source>
<source id="b"><float_array id="ba" count="16"> 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</float_array><technique_common>
<accessor source="#ba" count="1" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
<source id="w"><float_array id="wa" count="4"> 1 1 1 1</float_array><technique_common>
<accessor source="#wa" count="4" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/></joints>
<vertex_weights count="4"><input semantic="JOINT" source="#j" offset="0"/>
<input semantic="WEIGHT" source="#w" offset="1"/><vcount> 1 1 1 1</vcount><v> 0 0 0 1 0 2 0 3</v>
</vertex_weights></skin></controller><controller id="d"><morph source="#g"/></controller></library_controllers>
<library_animations><animation id="a"/></library_animations>
<library_animation_clips><animation_clip><instance_animation url="#a"/></animation_clip></library_animation_clips>
)");
  const std::string plain = R"(<instance_geometry url="#g"/>)";
  text.replace(text.find(plain), plain.size(),
               R"(<instance_controller url="#c"><skeleton>#n</skeleton>
</instance_controller>)");
  const Reading read = readingFile("b.dae", text);
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 8U);
  EXPECT_NEAR(top(read.mesh)[2], 1.01, 1e-6);
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 2e-6 / 6, 1e-12);
}

TEST(AssimpReader, ColladaOfAPhysicsModel) {
  std::string text = kCollada;
  const auto replaceAll = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  };
  replaceAll("<mesh>", "<convex_mesh>");
  replaceAll("</mesh>", "</convex_mesh>");
  const Reading read = readingFile("c.dae", text);
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  EXPECT_NE(read.error.find("convex hulls"), std::string::npos) << read.error;
}

TEST(AssimpReader, Fbx) {
  FileFormat format = FileFormat::Unknown;
  const Reading read = readingFile("a.fbx", kFbx, &format);
  EXPECT_EQ(format, FileFormat::Fbx);
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 4U);
  EXPECT_EQ(top(read.mesh), (Vec3d{200, 200, 500}));
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 8e6 / 6, 1);
  EXPECT_EQ(read.mesh.units, "centimetre");
}

// Chunks of a number and a length, with what they hold.
std::string chunk(std::uint16_t id, const std::string& content) {
  Bytes bytes;
  bytes.add<std::uint16_t>({id}).add<std::uint32_t>(
      {static_cast<std::uint32_t>(6 + content.size())});
  return bytes.text(content).str();
}

/// The corner tetrahedron, moved by `x`, as an object.
std::string threeDsObject(const std::string& name, float x) {
  const TriangleMesh mesh = cornerTetrahedron();
  Bytes points, faces;
  points.add<std::uint16_t>({static_cast<std::uint16_t>(mesh.points.size())});
  for (const Vec3d& p : mesh.points)
    points.floats(
        {static_cast<float>(p[0]) + x, static_cast<float>(p[1]), static_cast<float>(p[2])});
  faces.add<std::uint16_t>({static_cast<std::uint16_t>(mesh.triangleCount())});
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    faces.add<std::uint16_t>({static_cast<std::uint16_t>(mesh.triangles[i]),
                              static_cast<std::uint16_t>(mesh.triangles[i + 1]),
                              static_cast<std::uint16_t>(mesh.triangles[i + 2]), 0});
  const std::string lists = chunk(0x4110, points.str()) + chunk(0x4120, faces.str());
  return chunk(0x4000, name + std::string(1, '\0') + chunk(0x4100, lists));
}

std::string threeDs() {
  return chunk(0x4D4D, chunk(0x0002, std::string("\3\0\0\0", 4)) +
                           chunk(0x3D3D, threeDsObject("a", 0) + threeDsObject("b", 7)));
}

TEST(AssimpReader, ThreeDs) {
  FileFormat format = FileFormat::Unknown;
  const Reading read = readingFile("a.3ds", threeDs(), &format);
  EXPECT_EQ(format, FileFormat::ThreeDs);
  if (isWithoutAssimp(read))
    GTEST_SKIP() << read.error;
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.mesh.triangleCount(), 8U);
  EXPECT_EQ(top(read.mesh), (Vec3d{8, 1, 1}));
  EXPECT_NEAR(meshes::signedVolume(read.mesh), 2.0 / 6, 1e-6);
  EXPECT_EQ(read.mesh.units, "");
}

TEST(AssimpReader, NodesWithoutMeshesAreNothing) {
  const auto without = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at; (at = text.find(from)) != std::string::npos;)
      text.erase(at, text.find(to, at) + to.size() - at);
    return text;
  };
  const std::pair<const char*, std::string> files[] = {
      {"n.dae", without(kCollada, "<instance_geometry", "/>")},
      {"n.fbx", without(kFbx, "	C: \"OO\",1000", "\n")}};
  for (const auto& [name, text] : files) {
    const Reading read = readingFile(name, text);
    if (isWithoutAssimp(read))
      GTEST_SKIP() << read.error;
    EXPECT_NE(read.error.find("it holds no meshes"), std::string::npos) << name << read.error;
  }
}

TEST(AssimpReader, DamagedFilesEndInOneSentence) {
  const std::pair<const char*, std::string> files[] = {{"d.gltf", gltfText()},
                                                       {"d.glb", glb()},
                                                       {"d.dae", kCollada},
                                                       {"d.fbx", kFbx},
                                                       {"d.3ds", threeDs()}};
  for (const auto& [name, bytes] : files)
    for (std::size_t part = 1; part < 8; ++part)
      readingFile(name, bytes.substr(0, bytes.size() * part / 8));
}

} // namespace
} // namespace tetvdb
