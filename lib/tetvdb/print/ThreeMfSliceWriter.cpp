// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification" and "Slice Extension" 1.0.2.
// The object has its mesh at full resolution for readers without the extension.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/text/ZipWriter.h"
#include "tetvdb/print/LayerFile.h"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::string_view kTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" "
    "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" "
    "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr std::string_view kRelations =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
constexpr std::size_t kMaxOfXml = std::size_t(1) << 40; // long files have 64-bit fields

class ThreeMfSliceWriter : public LayerWriter {
public:
  explicit ThreeMfSliceWriter(const PrintInfo& info) : info_(info), file_(info.path), zip_(file_) {
    put("[Content_Types].xml", kTypes);
    put("_rels/.rels", kRelations);
    zip_.begin("3D/3dmodel.model", ZipMethod::Deflated, kMaxOfXml);
    zip_.write("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
               "<model unit=\"millimeter\" xml:lang=\"en-US\" "
               "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
               "xmlns:s=\"http://schemas.microsoft.com/3dmanufacturing/slice/2015/07\">\n"
               "<resources>\n<s:slicestack id=\"1\" zbottom=\"0\">\n");
  }

  EncodedLayer encode(std::int32_t k, const Layer& layer) const override {
    std::string text = fmt::format("<s:slice ztop=\"{}\">", info_.frame.bottomOf(k + 1));
    if (!layer.contours.empty()) {
      std::string polygons;
      std::size_t first = 0;
      text += "<s:vertices>";
      for (const LayerContour& contour : layer.contours) {
        for (const auto& p : contour)
          text += fmt::format("<s:vertex x=\"{}\" y=\"{}\"/>", p[0], p[1]);
        polygons += fmt::format("<s:polygon startv=\"{}\">", first);
        for (std::size_t i = 1; i <= contour.size(); ++i)
          polygons += fmt::format("<s:segment v2=\"{}\"/>", first + i % contour.size());
        polygons += "</s:polygon>";
        first += contour.size();
      }
      text += "</s:vertices>" + polygons;
    }
    return {text + "</s:slice>\n", "", layer.filled, layer.overlap, layer.empty()};
  }

  void add(std::int32_t, const EncodedLayer& layer) override { zip_.write(layer.bytes); }

  void finish() override {
    zip_.write("</s:slicestack>\n<object id=\"2\" type=\"model\" s:slicestackid=\"1\"><mesh>\n"
               "<vertices>\n");
    const TriangleMesh& mesh = *info_.mesh;
    for (const Vec3d& p : mesh.points)
      zip_.write(fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p[0], p[1], p[2]));
    zip_.write("</vertices>\n<triangles>\n");
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
      const std::uint32_t* v = mesh.triangles.data() + 3 * t;
      zip_.write(fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", v[0], v[1], v[2]));
    }
    zip_.write("</triangles>\n</mesh></object>\n</resources>\n"
               "<build><item objectid=\"2\"/></build>\n</model>\n");
    zip_.end();
    zip_.finish();
    bytes_ = file_.size();
    file_.commit();
  }
  std::uint64_t bytes() const override { return bytes_; }

private:
  void put(const std::string& name, std::string_view text) {
    zip_.begin(name);
    zip_.write(text);
    zip_.end();
  }

  const PrintInfo info_;
  AtomicFile file_;
  ZipWriter zip_;
  std::uint64_t bytes_ = 0;
};

} // namespace

std::unique_ptr<LayerWriter> writeThreeMfSlices(const PrintInfo& info) {
  return std::make_unique<ThreeMfSliceWriter>(info);
}

} // namespace tetvdb
