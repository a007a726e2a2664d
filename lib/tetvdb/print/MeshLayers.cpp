// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/MeshLayers.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/print/ContourLines.h"
#include "tetvdb/print/CutLayer.h"
#include "tetvdb/print/LayerFaces.h"
#include "tetvdb/print/OffsetRows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

double midpointOf(const LayerFrame& frame, std::int32_t k) {
  return frame.bottomOf(k) + frame.heightOf(k) / 2;
}

// The number of layers, from the lowest, for which below(k) holds; below(k) must be monotonic.
// `guess` is close to the result.
template <typename Below>
std::int32_t countLayers(const LayerFrame& frame, double guess, const Below& below) {
  auto k = static_cast<std::int32_t>(std::clamp(guess, 0.0, static_cast<double>(frame.layers)));
  while (k > 0 && !below(k - 1))
    --k;
  while (k < frame.layers && below(k))
    ++k;
  return k;
}

} // namespace

class MeshLayers::Impl {
public:
  Impl(FrameFaces faces, const LayerFrame& frame, LayerShare share, const GreyLevels& levels,
       const LayerOffset& offset)
      : faces_(std::move(faces)), frame_(frame), share_(share), levels_(levels), offset_(offset),
        layerFaces_(ranges(), frame.layers) {}

  const LayerFrame& frame() const { return frame_; }
  LayerSlab next() { return layerFaces_.next(); }

  void make(std::int32_t k, const std::uint32_t* begin, const std::uint32_t* end,
            Layer& layer) const {
    if (share_ == LayerShare::Contours)
      return makeContours(k, begin, end, layer);
    PixelSums& sums = sums_.local();
    sums.clear();
    if (offset_.of(k) != 0)
      addOffset(k, begin, end, sums);
    else if (share_ == LayerShare::Volume)
      addVolumes(k, begin, end, sums);
    else
      addAreas(k, begin, end, sums);
    sums.finish(levels_, layer);
  }

private:
  std::array<const Vec3d*, 3> cornersOf(std::uint32_t face) const {
    const std::uint32_t* v = faces_.triangles.data() + 3 * std::size_t(face);
    return {&faces_.points[v[0]], &faces_.points[v[1]], &faces_.points[v[2]]};
  }

  LayerRange rangeOf(std::uint32_t face) const {
    const auto [a, b, c] = cornersOf(face);
    const double low = std::min({(*a)[2], (*b)[2], (*c)[2]});
    const double high = std::max({(*a)[2], (*b)[2], (*c)[2]});
    const auto guess = [&](double z) {
      return (z - frame_.firstLayerHeight) / frame_.layerHeight + 1;
    };
    LayerRange range;
    if (share_ == LayerShare::Volume) {
      range.first = countLayers(frame_, guess(low),
                                [&](std::int32_t k) { return frame_.bottomOf(k + 1) <= low; });
      range.last = countLayers(frame_, guess(high),
                               [&](std::int32_t k) { return frame_.bottomOf(k) < high; }) -
                   1;
    } else {
      range.first = countLayers(frame_, guess(low),
                                [&](std::int32_t k) { return midpointOf(frame_, k) <= low; });
      range.last = countLayers(frame_, guess(high),
                               [&](std::int32_t k) { return midpointOf(frame_, k) <= high; }) -
                   1;
    }
    return range;
  }

  std::vector<LayerRange> ranges() const {
    const std::size_t count = faces_.triangles.size() / 3;
    if (count >= 0xFFFFFFFFu)
      throw Error(Status::Limit, "", "the mesh has 2^32 triangles or more", "split it in parts");
    std::vector<LayerRange> result(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& part) {
      for (std::size_t i = part.begin(); i != part.end(); ++i)
        result[i] = rangeOf(static_cast<std::uint32_t>(i));
    });
    return result;
  }

  void addVolumes(std::int32_t k, const std::uint32_t* begin, const std::uint32_t* end,
                  PixelSums& sums) const {
    const LayerHeights heights{frame_.bottomOf(k), frame_.heightOf(k)};
    const int weight = faces_.mirrored ? -1 : 1;
    for (const std::uint32_t* face = begin; face != end; ++face)
      addVolumeOfFace(cornersOf(*face), weight, heights, sums);
  }

  // Calls visit(i, j, m, n) for each face: the plane crosses from edge (i, j) to edge (m, n), each
  // from the lower corner to the upper one, with the solid on the left.
  template <typename Visit>
  void forEachLine(double z, const std::uint32_t* begin, const std::uint32_t* end,
                   const Visit& visit) const {
    for (const std::uint32_t* face = begin; face != end; ++face) {
      const std::uint32_t* v = faces_.triangles.data() + 3 * std::size_t(*face);
      std::array<bool, 3> above;
      for (std::size_t i = 0; i < 3; ++i)
        above[i] = faces_.points[v[i]][2] >= z;
      std::size_t up = 3, down = 3; // edges i, i + 1 that lead up and down
      for (std::size_t i = 0; i < 3; ++i) {
        if (!above[i] && above[(i + 1) % 3])
          up = i;
        if (above[i] && !above[(i + 1) % 3])
          down = i;
      }
      if (up < 3 && down < 3)
        visit(v[(down + 1) % 3], v[down], v[up], v[(up + 1) % 3]);
    }
  }

  void addAreas(std::int32_t k, const std::uint32_t* begin, const std::uint32_t* end,
                PixelSums& sums) const {
    const double z = midpointOf(frame_, k);
    const int weight = faces_.mirrored ? -1 : 1;
    const std::vector<Vec3d>& p = faces_.points;
    forEachLine(
        z, begin, end, [&](std::uint32_t i, std::uint32_t j, std::uint32_t m, std::uint32_t n) {
          addAreaOfLine(crossingOfEdge(p[i], p[j], z), crossingOfEdge(p[m], p[n], z), weight, sums);
        });
  }

  void addOffset(std::int32_t k, const std::uint32_t* begin, const std::uint32_t* end,
                 PixelSums& sums) const {
    const int planes = share_ == LayerShare::Volume ? 4 : 1;
    const int lines = 32 / planes;
    const int weight = faces_.mirrored ? -1 : 1;
    const std::vector<Vec3d>& p = faces_.points;
    OffsetRows rows(frame_, offset_.of(k), lines);
    for (int plane = 0; plane < planes; ++plane) {
      const double z = frame_.bottomOf(k) + frame_.heightOf(k) * (2 * plane + 1) / (2 * planes);
      forEachLine(
          z, begin, end, [&](std::uint32_t i, std::uint32_t j, std::uint32_t m, std::uint32_t n) {
            rows.addLine(crossingOfEdge(p[i], p[j], z), crossingOfEdge(p[m], p[n], z), weight);
          });
      rows.finishPlane(1.0 / (planes * lines), sums);
    }
  }

  void makeContours(std::int32_t k, const std::uint32_t* begin, const std::uint32_t* end,
                    Layer& layer) const {
    layer.clear();
    const double z = midpointOf(frame_, k);
    const std::vector<Vec3d>& p = faces_.points;
    std::vector<ContourLine> lines;
    lines.reserve(static_cast<std::size_t>(end - begin));
    const auto edge = [](std::uint32_t a, std::uint32_t b) {
      return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
    };
    forEachLine(z, begin, end,
                [&](std::uint32_t i, std::uint32_t j, std::uint32_t m, std::uint32_t n) {
                  lines.push_back({edge(i, j), edge(m, n), crossingOfEdge(p[i], p[j], z)});
                });
    layer.contours = closedContours(lines);
    for (const LayerContour& contour : layer.contours)
      layer.filled += areaOf(contour);
  }

  FrameFaces faces_;
  LayerFrame frame_;
  LayerShare share_;
  GreyLevels levels_;
  LayerOffset offset_;
  LayerFaces layerFaces_;
  mutable tbb::enumerable_thread_specific<PixelSums> sums_;
};

namespace {

// Several layers with their faces. `Maker` is MeshLayers::Impl, which is incomplete here.
template <typename Maker>
class MeshBatch : public LayerBatch {
public:
  MeshBatch(const Maker& maker, LayerSlab slab) : maker_(maker), slab_(std::move(slab)) {}
  std::int32_t end() const override { return slab_.end(); }
  void make(std::int32_t k, Layer& layer) const override {
    const auto i = static_cast<std::size_t>(k - slab_.first);
    maker_.make(k, slab_.faces.data() + slab_.starts[i], slab_.faces.data() + slab_.starts[i + 1],
                layer);
  }

private:
  const Maker& maker_;
  LayerSlab slab_;
};

} // namespace

MeshLayers::MeshLayers(FrameFaces faces, const LayerFrame& frame, LayerShare share,
                       const GreyLevels& levels, const LayerOffset& offset)
    : impl_(std::make_unique<Impl>(std::move(faces), frame, share, levels, offset)) {}
MeshLayers::~MeshLayers() = default;

const LayerFrame& MeshLayers::frame() const {
  return impl_->frame();
}

std::shared_ptr<const LayerBatch> MeshLayers::batch(std::int32_t) {
  return std::make_shared<MeshBatch<Impl>>(*impl_, impl_->next());
}

} // namespace tetvdb
