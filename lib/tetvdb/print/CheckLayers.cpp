// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/CheckLayers.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/print/CavitySweep.h"
#include "tetvdb/print/DrainPockets.h"
#include "tetvdb/print/FloorSweep.h"
#include "tetvdb/print/IslandSweep.h"
#include "tetvdb/print/LayerContacts.h"
#include "tetvdb/print/NearPixels.h"
#include "tetvdb/print/PatchSweep.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::int32_t kAtOnce = 32; // layers whose pairs are processed in parallel

// Limit of distances in pixels, or in layers.
constexpr double kMaxReach = 4096;

void checkLimits(const PrintLimits& limits, const LayerFrame& frame) {
  const auto finite = [](double value) { return std::isfinite(value) && value >= 0; };
  if (!finite(limits.overhangAngle) || limits.overhangAngle >= 90)
    throw Error(Status::Usage, "`overhang_angle`", "must be from 0 to below 90 degrees");
  if (!finite(limits.minWall) || !finite(limits.minGap) || !finite(limits.minFloor) ||
      !finite(limits.drain) || !finite(limits.minArea) || !finite(limits.minVolume))
    throw Error(Status::Usage,
                "`min_wall`, `min_gap`, `min_floor`, `drain`, `min_area`, `min_volume`",
                "must be numbers, zero or more");
  const double pixel = std::min(frame.pixelWidth, frame.pixelHeight);
  const double lean = std::max(frame.layerHeight, frame.firstLayerHeight) *
                      std::tan(limits.overhangAngle * kPi / 180);
  if (std::max({limits.minWall, limits.minGap, limits.minFloor, lean}) > kMaxReach * pixel ||
      limits.minFloor > kMaxReach * frame.layerHeight)
    throw Error(Status::Usage, "`min_wall`, `min_gap`, `min_floor`, `overhang_angle`",
                "reach farther than 4096 pixels or layers", "give a smaller one");
  constexpr double kMaxDrain = 1000;
  if (limits.drain > kMaxDrain)
    throw Error(Status::Usage, "`drain`", "is above 1000 mm", "give a smaller one");
}

// The layers in which a thickness is measured, and the thin parts there.
class Thickness {
public:
  Thickness(double limit, bool gaps, const LayerFrame& frame)
      : limit_(limit), gaps_(gaps), frame_(frame),
        step_(std::max(1, static_cast<std::int32_t>(limit / 4 / frame.layerHeight))),
        sweep_(reachOf(frame.pixelWidth), reachOf(frame.pixelHeight)) {}

  struct Region {
    LabelledSpans spans;
    std::vector<double> widths;
  };

  bool looksAt(std::int32_t k) const { return limit_ > 0 && k % step_ == 0; }

  // Thread-safe.
  Region regionOf(const SpanRows& solid) const {
    Region region;
    SpanRows thin = gaps_ ? thinGaps(solid, limit_, frame_) : thinPixels(solid, limit_, frame_);
    if (thin.empty())
      return region;
    region.spans = labelled(std::move(thin), Neighbours::Eight);
    const SpanRows rest =
        gaps_ ? SpanRows()
              : complementOf(solid, static_cast<std::int32_t>(limit_ / frame_.pixelHeight) + 2);
    region.widths = widthsOf(region.spans, gaps_ ? solid : rest, limit_, frame_);
    return region;
  }

  void add(std::int32_t k, Region region) {
    sweep_.add(k / step_, std::move(region.spans), region.widths);
  }

  void report(PrintFault fault, const PrintLimits& limits, PrintChecks& checks) {
    sweep_.finish();
    const double pixel = frame_.pixelWidth * frame_.pixelHeight;
    for (const LayerPatch& patch : sweep_.patches()) {
      PrintFinding finding;
      finding.fault = fault;
      finding.first = patch.first * step_;
      finding.last = std::min(patch.last * step_ + step_, frame_.layers) - 1;
      finding.layer = patch.largestLayer * step_;
      finding.pixel = {patch.largest.x + 0.5, patch.largest.y + 0.5};
      finding.box = patch.box;
      finding.pixels = patch.largestPixels;
      finding.area = static_cast<double>(patch.largestPixels) * pixel;
      finding.width = patch.width;
      finding.height = frame_.bottomOf(finding.last + 1) - frame_.bottomOf(finding.first);
      if (finding.area < limits.minArea || finding.height < limit_)
        ++checks.leftOut[static_cast<std::size_t>(fault)];
      else
        checks.findings.push_back(finding);
    }
  }

private:
  // The displacement of a slope of 45 degrees between two examined layers, plus a pixel.
  std::int32_t reachOf(double pixel) const {
    return static_cast<std::int32_t>(std::min(std::ceil(step_ * frame_.layerHeight / pixel), 1e6)) +
           1;
  }

  double limit_;
  bool gaps_;
  LayerFrame frame_;
  std::int32_t step_;
  PatchSweep sweep_;
};

class Checking {
public:
  Checking(const LayerFrame& frame, const PrintLimits& limits)
      : frame_(frame), limits_(limits), pixel_(frame.pixelWidth * frame.pixelHeight),
        cavities_(frame), overhangs_(leanColumns(), leanRows()),
        walls_(limits.minWall, false, frame), gaps_(limits.minGap, true, frame),
        floorPatches_(1, 1) {
    if (limits.drain > 0)
      drains_.emplace(frame, limits.drain);
    if (limits.minFloor > 0)
      floors_.emplace(frame, limits.minFloor, [this](std::int32_t k, SpanRows thin) {
        floorPatches_.add(k, labelled(std::move(thin), Neighbours::Eight));
      });
  }

  // The data of a layer by itself.
  struct Item {
    LayerComponents components;
    SpanRows cells;
    Thickness::Region walls, gaps;
    // With the layer below.
    std::vector<LayerContact> solid, voids;
    LabelledSpans overhang;
  };

  Item look(std::int32_t k, const Layer& layer) const {
    Item item;
    SpanRows solid = solidOf(layer);
    if (drains_)
      item.cells = drains_->cellsOf(solid);
    if (walls_.looksAt(k))
      item.walls = walls_.regionOf(solid);
    if (gaps_.looksAt(k))
      item.gaps = gaps_.regionOf(solid);
    item.components = componentsOf(std::move(solid), limits_.neighbours);
    return item;
  }

  void take(Item&& item) {
    waiting_.push_back(std::move(item));
    if (waiting_.size() == kAtOnce)
      sweep();
  }

  PrintChecks finish(Progress& progress) {
    sweep();
    cavities_.finish();
    overhangs_.finish();
    if (floors_)
      floors_->finish();
    floorPatches_.finish();
    reportEmptyLayers();
    reportIslands();
    reportPatches(PrintFault::Overhang, overhangs_);
    reportCavities();
    if (drains_)
      reportDrains(progress);
    walls_.report(PrintFault::ThinWall, limits_, checks_);
    gaps_.report(PrintFault::ThinGap, limits_, checks_);
    reportPatches(PrintFault::ThinFloor, floorPatches_);
    sort();
    checks_.emptyLayers = emptyLayers_;
    return std::move(checks_);
  }

private:
  // The displacement, in a plane, of an overhang of the maximum angle in a layer.
  double lean(std::int32_t k) const {
    const double apart =
        k == 0 ? frame_.layerHeight : (frame_.heightOf(k - 1) + frame_.heightOf(k)) / 2;
    return apart * std::tan(limits_.overhangAngle * kPi / 180) +
           std::hypot(frame_.pixelWidth, frame_.pixelHeight) / 2;
  }
  std::int32_t leanColumns() const {
    return static_cast<std::int32_t>(std::min(lean(1) / frame_.pixelWidth, 1e6)) + 2;
  }
  std::int32_t leanRows() const {
    return static_cast<std::int32_t>(std::min(lean(1) / frame_.pixelHeight, 1e6)) + 2;
  }

  // Processes a layer with the one below it; pairs are independent.
  void pair(std::int32_t k, const Item& below, Item& item) const {
    item.solid = solidContacts(below.components.solid, item.components.solid);
    item.voids = voidContacts(below.components, item.components);
    if (limits_.overhangAngle > 0)
      item.overhang = labelled(overhangOf(k, below.components.solid.rows, item), Neighbours::Eight);
  }

  SpanRows overhangOf(std::int32_t k, const SpanRows& below, const Item& item) const {
    const LabelledSpans& solid = item.components.solid;
    std::vector<std::uint8_t> held(solid.shapes.size(), 0);
    for (const LayerContact& contact : item.solid)
      held[contact.above] = 1;
    const PixelDisc disc(frame_.pixelWidth, frame_.pixelHeight, lean(k), false);
    if (std::find(held.begin(), held.end(), 0) == held.end())
      return withoutNear(solid.rows, below, disc);
    SpanRows rows;
    for (std::int32_t y = solid.rows.firstRow(); y < solid.rows.endRow(); ++y) {
      const auto [begin, end] = solid.rows.rangeOf(y);
      for (std::size_t i = begin; i < end; ++i)
        if (held[solid.labels[i]])
          rows.add(y, solid.rows.spans()[i].begin, solid.rows.spans()[i].end);
    }
    return withoutNear(rows, below, disc);
  }

  void sweep() {
    tbb::parallel_for(std::size_t(0), waiting_.size(), [&](std::size_t i) {
      const std::int32_t k = k_ + static_cast<std::int32_t>(i);
      if (k > 0)
        pair(k, i == 0 ? below_ : waiting_[i - 1], waiting_[i]);
    });
    for (Item& item : waiting_)
      add(item);
    if (!waiting_.empty())
      below_ = std::move(waiting_.back());
    waiting_.clear();
  }

  void add(Item& item) {
    const LabelledSpans& solid = item.components.solid;
    if (floors_)
      floors_->add(solid.rows);
    islands_.add(solid, item.solid);
    cavities_.add(item.components.gaps, item.voids);
    if (limits_.overhangAngle > 0)
      overhangs_.add(k_, std::move(item.overhang));
    if (drains_) {
      drains_->add(k_, item.cells);
      if (k_ % drains_->layers() == drains_->layers() / 2)
        sample(item.components.gaps);
    }
    if (walls_.looksAt(k_))
      walls_.add(k_, std::move(item.walls));
    if (gaps_.looksAt(k_))
      gaps_.add(k_, std::move(item.gaps));
    std::int64_t pixels = 0;
    for (const ComponentShape& shape : solid.shapes)
      pixels += shape.pixels;
    checks_.volume += static_cast<double>(pixels) * pixel_ * frame_.heightOf(k_);
    if (pixels == 0) {
      ++emptyLayers_;
    } else {
      if (k_ > filled_ + 1)
        emptyRanges_.push_back({filled_ + 1, k_ - 1});
      filled_ = k_;
    }
    ++k_;
  }

  // The cavities along the middle rows of drain cells, in their middle layers.
  struct Sample {
    std::int32_t layer, y;
    Span span;
    std::uint32_t cavity;
  };

  void sample(const LabelledSpans& gaps) {
    const std::int32_t rows = drains_->rows();
    for (std::int32_t y = gaps.rows.firstRow(); y < gaps.rows.endRow(); ++y) {
      if (y % rows != rows / 2)
        continue;
      const auto [begin, end] = gaps.rows.rangeOf(y);
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t label = gaps.labels[i];
        const std::uint32_t open = label == 0 ? CavitySweep::kOutside : cavities_.openOf()[label];
        if (open != CavitySweep::kOutside)
          samples_.push_back({k_, y, gaps.rows.spans()[i], cavities_.numbers()[open]});
      }
    }
  }

  bool isTrapped(std::int32_t layer, std::int32_t x, std::int32_t y) {
    const auto after = std::upper_bound(
        samples_.begin(), samples_.end(), std::tie(layer, y, x),
        [](const auto& at, const Sample& s) { return at < std::tie(s.layer, s.y, s.span.begin); });
    if (after == samples_.begin())
      return false;
    const Sample& s = after[-1];
    if (s.layer != layer || s.y != y || x >= s.span.end)
      return false;
    const LayerCavity& cavity = cavities_.cavities()[cavities_.cavityOf(s.cavity)];
    return cavity.end == LayerCavity::End::Closed && !cavity.onPlate;
  }

  void keep(const PrintFinding& finding, bool large) {
    if (large)
      checks_.findings.push_back(finding);
    else
      ++checks_.leftOut[static_cast<std::size_t>(finding.fault)];
  }

  PrintFinding findingOf(PrintFault fault, const ComponentShape& shape, std::int32_t first,
                         std::int32_t last, std::int32_t layer) const {
    PrintFinding finding;
    finding.fault = fault;
    finding.first = first;
    finding.last = last;
    finding.layer = layer;
    finding.pixel = {shape.x + 0.5, shape.y + 0.5};
    finding.box = shape.box;
    finding.pixels = shape.pixels;
    finding.area = static_cast<double>(shape.pixels) * pixel_;
    finding.height = frame_.bottomOf(last + 1) - frame_.bottomOf(first);
    return finding;
  }

  void reportEmptyLayers() {
    if (!limits_.emptyLayers)
      return;
    if (filled_ < 0)
      emptyRanges_.push_back({0, frame_.layers - 1});
    for (const auto& [first, last] : emptyRanges_) {
      PrintFinding finding = findingOf(PrintFault::EmptyLayer, {}, first, last, first);
      finding.pixel = {frame_.width / 2.0, frame_.height / 2.0};
      checks_.findings.push_back(finding);
    }
  }

  void reportIslands() {
    if (!limits_.islands)
      return;
    for (const Island& island : islands_.islands()) {
      PrintFinding finding =
          findingOf(PrintFault::Island, island.shape, island.layer, island.last, island.layer);
      finding.joins = island.joins;
      finding.largestArea = static_cast<double>(island.largestPixels) * pixel_;
      keep(finding, finding.largestArea >= limits_.minArea);
    }
  }

  void reportPatches(PrintFault fault, const PatchSweep& patches) {
    for (const LayerPatch& patch : patches.patches()) {
      PrintFinding finding =
          findingOf(fault, patch.largest, patch.first, patch.last, patch.largestLayer);
      finding.box = patch.box;
      finding.pixels = patch.largestPixels;
      finding.area = static_cast<double>(patch.largestPixels) * pixel_;
      finding.totalArea = static_cast<double>(patch.pixels) * pixel_;
      const double size = fault == PrintFault::Overhang ? finding.totalArea : finding.area;
      keep(finding, size >= limits_.minArea);
    }
  }

  void reportCavities() {
    for (const LayerCavity& cavity : cavities_.cavities()) {
      const bool trap = cavity.end == LayerCavity::End::Closed && !cavity.onPlate;
      if (!(trap ? limits_.traps : limits_.cups))
        continue;
      PrintFinding finding = findingOf(trap ? PrintFault::Trap : PrintFault::Cup, cavity.largest,
                                       cavity.first, cavity.last, cavity.largestLayer);
      finding.box = cavity.box;
      finding.pixels = cavity.largestPixels;
      finding.area = static_cast<double>(cavity.largestPixels) * pixel_;
      finding.volume = cavity.volume;
      finding.onPlate = cavity.onPlate && cavity.end == LayerCavity::End::Closed;
      if (cavity.end == LayerCavity::End::Open && cavity.last + 1 < frame_.layers)
        finding.joins = cavity.last + 1;
      keep(finding, finding.volume >= limits_.minVolume);
    }
  }

  void reportDrains(Progress& progress) {
    constexpr double kFewCells = 27; // rounding to cells may leave this much of an open groove
    const std::int32_t columns = drains_->columns(), rows = drains_->rows();
    const std::int32_t layers = drains_->layers();
    for (const LayerCavity& pocket : drains_->find(progress)) {
      const auto layerOf = [&](std::int32_t cell) {
        return std::clamp(cell * layers + layers / 2, 0, frame_.layers - 1);
      };
      const std::int32_t x = pocket.largest.x * columns + columns / 2;
      const std::int32_t y = pocket.largest.y * rows + rows / 2;
      if (pocket.voxels < kFewCells || isTrapped(layerOf(pocket.largestLayer), x, y))
        continue;
      PrintFinding finding =
          findingOf(PrintFault::Drain, {}, std::max(pocket.first * layers, 0),
                    std::clamp((pocket.last + 1) * layers - 1, 0, frame_.layers - 1),
                    layerOf(pocket.largestLayer));
      finding.pixel = {x + 0.5, y + 0.5};
      finding.box = {pocket.box.minX * columns, pocket.box.minY * rows,
                     (pocket.box.maxX + 1) * columns - 1, (pocket.box.maxY + 1) * rows - 1};
      finding.pixels = pocket.largestPixels * columns * rows;
      finding.area = static_cast<double>(finding.pixels) * pixel_;
      finding.volume = pocket.volume;
      checks_.findings.push_back(finding);
    }
  }

  static double sizeOf(const PrintFinding& f) {
    switch (f.fault) {
    case PrintFault::Island:
      return f.largestArea;
    case PrintFault::Overhang:
      return f.totalArea;
    case PrintFault::Cup:
    case PrintFault::Trap:
    case PrintFault::Drain:
      return f.volume;
    case PrintFault::ThinWall:
    case PrintFault::ThinGap:
    case PrintFault::ThinFloor:
      return f.area;
    case PrintFault::Outside:
    case PrintFault::EmptyLayer:
      break;
    }
    return 0;
  }

  void sort() {
    std::stable_sort(checks_.findings.begin(), checks_.findings.end(),
                     [](const PrintFinding& a, const PrintFinding& b) {
                       return std::make_tuple(a.fault, -sizeOf(a), a.layer, a.pixel[1],
                                              a.pixel[0]) <
                              std::make_tuple(b.fault, -sizeOf(b), b.layer, b.pixel[1], b.pixel[0]);
                     });
  }

  LayerFrame frame_;
  PrintLimits limits_;
  double pixel_;
  IslandSweep islands_;
  CavitySweep cavities_;
  PatchSweep overhangs_;
  Thickness walls_, gaps_;
  std::optional<FloorSweep> floors_;
  PatchSweep floorPatches_;
  std::optional<DrainPockets> drains_;
  std::vector<Sample> samples_;
  std::vector<Item> waiting_;
  Item below_;
  PrintChecks checks_;
  std::int32_t k_ = 0, filled_ = -1, emptyLayers_ = 0;
  std::vector<std::array<std::int32_t, 2>> emptyRanges_;
};

} // namespace

PrintChecks checkLayers(LayerSource& source, const PrintLimits& limits, Progress& progress) {
  checkLimits(limits, source.frame());
  Checking checking(source.frame(), limits);
  forEachLayer(
      source, [&](std::int32_t k, Layer&& layer) { return checking.look(k, layer); },
      [&](std::int32_t, Checking::Item&& item) { checking.take(std::move(item)); }, progress);
  return checking.finish(progress);
}

} // namespace tetvdb
