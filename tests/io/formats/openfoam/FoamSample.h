// SPDX-License-Identifier: Apache-2.0
//
// Files of an OpenFOAM case as OpenFOAM writes them, in every form: a unit cube with a pyramid on
// top (ResultSamples.h), whose cell zones are "cube" and "tip".
#pragma once

#include "io/MeshSamples.h"
#include "io/ResultSamples.h"
#include "tetvdb/io/formats/openfoam/OpenFoamReader.h"

#include <cstdint>
#include <string>
#include <vector>
#include <zlib.h>

namespace tetvdb::test {

struct FoamForm {
  bool binary = false;
  int labelBytes = 4, scalarBytes = 8;
  bool swapped = false;
};

class FoamText {
public:
  explicit FoamText(const FoamForm& form = {}) : form_(form) {}

  std::string head(const std::string& className, const std::string& object) const {
    std::string text = "/*---*- C++ -*---*\\\n| it's OpenFOAM; { |\n\\*---*/\nFoamFile\n{\n"
                       "    version 2.0; // of the format\n    format      ";
    text += form_.binary ? "binary" : "ascii";
    text += ";\n    class       " + className + ";\n";
    if (form_.binary)
      text += std::string("    arch        \"") + (form_.swapped ? "MSB" : "LSB") +
              ";label=" + std::to_string(8 * form_.labelBytes) +
              ";scalar=" + std::to_string(8 * form_.scalarBytes) + "\";\n";
    return text + "    location    \"constant/polyMesh\";\n    object      " + object +
           ";\n}\n// * * * //\n\n\n";
  }

  std::string labels(const std::vector<int>& values) const {
    std::string text = std::to_string(values.size()) + "\n(";
    for (const int value : values) {
      if (form_.binary)
        add(text, value);
      else
        text += "\n" + std::to_string(value);
    }
    return text + (form_.binary ? ")" : "\n)\n");
  }

  /// Of `components` numbers each.
  std::string numbers(const std::vector<double>& values, int components) const {
    const std::size_t width = static_cast<std::size_t>(components);
    std::string text = std::to_string(values.size() / width) + "\n(";
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (form_.binary) {
        if (form_.scalarBytes == 4)
          addBytes(text, inOrder(static_cast<float>(values[i])));
        else
          addBytes(text, inOrder(values[i]));
        continue;
      }
      text += i % width != 0 ? " " : width > 1 ? "\n(" : "\n";
      text += printed("%.17g", values[i]);
      text += width > 1 && i % width == width - 1 ? ")" : "";
    }
    return text + (form_.binary ? ")" : "\n)\n");
  }

  std::string faces(const std::vector<std::vector<int>>& faces) const {
    std::string text;
    if (form_.binary) {
      std::vector<int> begin{0}, corners;
      for (const auto& face : faces) {
        corners.insert(corners.end(), face.begin(), face.end());
        begin.push_back(static_cast<int>(corners.size()));
      }
      return head("faceCompactList", "faces") + labels(begin) + "\n\n" + labels(corners);
    }
    text = head("faceList", "faces") + std::to_string(faces.size()) + "\n(\n";
    for (const auto& face : faces) {
      text += std::to_string(face.size()) + "(";
      for (std::size_t i = 0; i < face.size(); ++i)
        text += (i > 0 ? " " : "") + std::to_string(face[i]);
      text += ")\n";
    }
    return text + ")\n";
  }

  std::string field(const std::string& className, const std::string& values) const {
    return head(className, "x") + "dimensions      [0 2 -2 0 0 0 0];\n\ninternalField   " + values +
           ";\n\nboundaryField\n{\n    walls\n    {\n        type fixedValue;\n        value "
           "uniform 7;\n    }\n}\n";
  }
  std::string listed(const std::string& type, const std::vector<double>& values,
                     int components) const {
    return "nonuniform List<" + type + "> \n" + numbers(values, components);
  }

private:
  template <typename T>
  T inOrder(T value) const {
    return form_.swapped ? byteSwapped(value) : value;
  }
  void add(std::string& text, int value) const {
    if (form_.labelBytes == 8)
      addBytes(text, inOrder(std::int64_t(value)));
    else
      addBytes(text, inOrder(std::int32_t(value)));
  }

  FoamForm form_;
};

struct FoamMesh {
  std::string points, faces, owner, neighbour, cellZones;
};

inline FoamMesh foamCubeAndTip(const FoamForm& form, double raised = 0) {
  const FoamText foam(form);
  std::vector<double> points;
  for (const auto& p : kCubeAndTip)
    points.insert(points.end(), {p[0], p[1], p[2] + raised});
  FoamMesh mesh;
  mesh.points = foam.head("vectorField", "points") + foam.numbers(points, 3);
  mesh.faces = foam.faces({{4, 5, 6, 7},
                           {0, 3, 2, 1},
                           {0, 1, 5, 4},
                           {1, 2, 6, 5},
                           {2, 3, 7, 6},
                           {3, 0, 4, 7},
                           {4, 5, 8},
                           {5, 6, 8},
                           {6, 7, 8},
                           {7, 4, 8}});
  mesh.owner = foam.head("labelList", "owner") + foam.labels({0, 0, 0, 0, 0, 0, 1, 1, 1, 1});
  mesh.neighbour = foam.head("labelList", "neighbour") + foam.labels({1});
  mesh.cellZones = foam.head("regIOobject", "cellZones") +
                   "2\n(\ncube\n{\n    type cellZone;\ncellLabels      List<label> \n" +
                   foam.labels({0}) +
                   ";\n}\n\ntip\n{\n    type cellZone;\ncellLabels      "
                   "List<label> \n" +
                   foam.labels({1}) + ";\n}\n)\n";
  return mesh;
}

inline std::string gzipped(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, text.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// The mesh, its zones and a field, as openfoam::readTexts() takes them.
inline std::string foamTexts(const FoamForm& form) {
  const FoamMesh mesh = foamCubeAndTip(form);
  const FoamText foam(form);
  const std::string next(openfoam::kParts);
  return mesh.points + next + mesh.faces + next + mesh.owner + next + mesh.neighbour + next +
         mesh.cellZones + next +
         foam.field("volSymmTensorField",
                    foam.listed("symmTensor", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 6));
}

} // namespace tetvdb::test
