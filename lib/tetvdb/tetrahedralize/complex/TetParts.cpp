// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/TetParts.h"

#include "tetvdb/geometry/SplitAlongAxis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace tetvdb {
namespace {

constexpr std::uint32_t kShared = 0xFFFFFFFEu;
constexpr std::uint32_t kUnseen = 0xFFFFFFFFu;

// Three frames, each rotated against the others, so that no cut of one is parallel to one of
// another.
constexpr double kFrames[TetParts::kRounds][3][3] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {{2. / 3, 2. / 3, 1. / 3}, {-2. / 3, 1. / 3, 2. / 3}, {1. / 3, -2. / 3, 2. / 3}},
    {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}};

struct Centre {
  float at[3]; // along the frame's axes
  std::uint32_t tet;
};

using Centres = std::vector<Centre>;

// Halves first..last at the median of the longest axis, `levels` times. Parts are numbered from
// `base` on.
void halve(Centres& centres, std::size_t first, std::size_t last, int levels,
           std::vector<std::size_t>& ends, std::size_t base) {
  if (levels == 0) {
    ends[base + 1] = last;
    return;
  }
  const auto position = [](const Centre& c) -> const auto& {
    return c.at;
  };
  const std::size_t median = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return centres.begin() + static_cast<std::ptrdiff_t>(i); };
  splitAlongAxis(longestAxis(at(first), at(last), position), at(first), at(median), at(last),
                 position, [](const Centre& c) { return c.tet; });
  const std::size_t half = std::size_t(1) << (levels - 1);
  tbb::parallel_invoke([&] { halve(centres, first, median, levels - 1, ends, base); },
                       [&] { halve(centres, median, last, levels - 1, ends, base + half); });
}

// A part's number for every point of the whole mesh that it has.
class PointNumbers {
public:
  PointNumbers() : table_(std::size_t(1) << 12, {TetComplex::kNone, 0}) {}

  /// Whether the point is new.
  bool add(std::uint32_t whole) {
    if (2 * size_ >= table_.size())
      grow();
    auto& entry = table_[find(whole)];
    if (entry[0] == whole)
      return false;
    entry[0] = whole;
    ++size_;
    return true;
  }
  /// Of a point that was added.
  std::uint32_t& operator[](std::uint32_t whole) { return table_[find(whole)][1]; }

private:
  std::size_t find(std::uint32_t whole) const {
    const std::size_t last = table_.size() - 1;
    std::size_t i = whole * std::size_t(0x9E3779B97F4A7C15u) >> 40 & last;
    while (table_[i][0] != whole && table_[i][0] != TetComplex::kNone)
      i = (i + 1) & last;
    return i;
  }
  void grow() {
    std::vector<std::array<std::uint32_t, 2>> old(2 * table_.size(), {TetComplex::kNone, 0});
    old.swap(table_);
    for (const auto& entry : old)
      if (entry[0] != TetComplex::kNone)
        table_[find(entry[0])] = entry;
  }

  std::vector<std::array<std::uint32_t, 2>> table_; // whole, part
  std::size_t size_ = 0;
};

} // namespace

std::uint32_t TetParts::Part::local(std::uint32_t whole) const {
  const auto found = std::lower_bound(pointOfWhole.begin(), pointOfWhole.end(), whole);
  return found != pointOfWhole.end() && *found == whole
             ? static_cast<std::uint32_t>(found - pointOfWhole.begin())
             : TetComplex::kNone;
}

TetParts::TetParts(TetComplex& whole, int round, std::size_t tetsPerPart) : whole_(whole) {
  int levels = 0;
  if (round >= 0)
    while (whole.tetCount() >> (levels + 1) >= tetsPerPart)
      ++levels;
  parts_.resize(std::size_t(1) << levels);
  if (levels == 0) {
    parts_[0].complex = std::move(whole_);
    parts_[0].pointOfWhole.resize(parts_[0].complex.points.size());
    std::iota(parts_[0].pointOfWhole.begin(), parts_[0].pointOfWhole.end(), 0u);
    return;
  }
  const std::vector<std::vector<std::uint32_t>> tetsOfPart = cut(round, levels);
  findBorders();
  tbb::parallel_for(std::size_t(0), parts_.size(),
                    [&](std::size_t p) { extract(p, tetsOfPart[p]); });
  for (std::size_t p = 0; p < whole.points.size(); ++p)
    if (partOfPoint_[p] == kShared)
      whole.points[p].changed = 0; // set again by parts
  whole_.tets.clear();
  whole_.free_.clear();
}

// The tets of every part, in ascending order, so that neighbours in memory stay so.
std::vector<std::vector<std::uint32_t>> TetParts::cut(int round, int levels) {
  const std::size_t count = parts_.size();
  Centres centres;
  centres.reserve(whole_.tetCount());
  for (std::size_t t = 0; t < whole_.tets.size(); ++t)
    if (whole_.tets[t].exists())
      centres.push_back({{0, 0, 0}, static_cast<std::uint32_t>(t)});
  const auto& frame = kFrames[round % kRounds];
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, centres.size()), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      Vec3d sum{0, 0, 0};
      for (const std::uint32_t corner : whole_.tets[centres[i].tet].corners)
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum[axis] += whole_.at(corner)[axis];
      for (int axis = 0; axis < 3; ++axis)
        centres[i].at[axis] = static_cast<float>(sum[0] * frame[axis][0] + sum[1] * frame[axis][1] +
                                                 sum[2] * frame[axis][2]);
    }
  });
  std::vector<std::size_t> ends(count + 1, 0);
  halve(centres, 0, centres.size(), levels, ends, 0);
  partOfTet_.assign(whole_.tets.size(), kUnseen);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t p) {
    for (std::size_t i = ends[p]; i < ends[p + 1]; ++i)
      partOfTet_[centres[i].tet] = static_cast<std::uint32_t>(p);
  });
  indexInPart_.resize(whole_.tets.size());
  std::vector<std::vector<std::uint32_t>> tetsOfPart(count);
  for (std::size_t p = 0; p < count; ++p)
    tetsOfPart[p].reserve(ends[p + 1] - ends[p]);
  for (std::size_t t = 0; t < whole_.tets.size(); ++t) {
    if (partOfTet_[t] == kUnseen)
      continue;
    auto& mine = tetsOfPart[partOfTet_[t]];
    indexInPart_[t] = static_cast<std::uint32_t>(mine.size());
    mine.push_back(static_cast<std::uint32_t>(t));
  }
  return tetsOfPart;
}

// Points that several parts share, and numbers for the faces between parts.
void TetParts::findBorders() {
  borders_.resize(whole_.tets.size());
  partOfPoint_.assign(whole_.points.size(), kUnseen);
  for (std::size_t t = 0; t < whole_.tets.size(); ++t) {
    const auto& tet = whole_.tets[t];
    if (!tet.exists())
      continue;
    for (const std::uint32_t corner : tet.corners) {
      std::uint32_t& part = partOfPoint_[corner];
      part = part == kUnseen || part == partOfTet_[t] ? partOfTet_[t] : kShared;
    }
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      if (next == TetComplex::kOutside || partOfTet_[next] == partOfTet_[t])
        continue;
      // Numbered by the tet of lower number.
      borders_[t][localFace] =
          next > t ? static_cast<std::uint32_t>(borderCount_++)
                   : borders_[next][whole_.localFaceOf(next, static_cast<std::uint32_t>(t))];
    }
  }
}

void TetParts::extract(std::size_t index, const std::vector<std::uint32_t>& mine) {
  Part& part = parts_[index];
  part.index = index;
  auto& wholes = part.pointOfWhole;
  PointNumbers numbers;
  for (const std::uint32_t t : mine)
    for (const std::uint32_t corner : whole_.tets[t].corners)
      if (numbers.add(corner))
        wholes.push_back(corner);
  std::sort(wholes.begin(), wholes.end());
  TetComplex& complex = part.complex;
  complex.points.resize(wholes.size());
  for (std::size_t i = 0; i < wholes.size(); ++i) {
    numbers[wholes[i]] = static_cast<std::uint32_t>(i);
    complex.points[i] = whole_.points[wholes[i]];
    complex.points[i].fixed = complex.points[i].fixed || partOfPoint_[wholes[i]] == kShared;
  }
  complex.tets.resize(mine.size());
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const TetComplex::Tet& old = whole_.tets[mine[i]];
    TetComplex::Tet& tet = complex.tets[i];
    tet = old;
    tet.mark = 0;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      tet.corners[localFace] = numbers[old.corners[localFace]];
      complex.points[tet.corners[localFace]].tet = static_cast<std::uint32_t>(i);
      const std::uint32_t next = old.neighbours[localFace];
      if (next != TetComplex::kOutside)
        tet.neighbours[localFace] = partOfTet_[next] == index
                                        ? indexInPart_[next]
                                        : TetComplex::kElsewhere + borders_[mine[i]][localFace];
    }
  }
}

void TetParts::run(const std::function<void(Part&)>& work, Progress& progress) {
  tbb::parallel_for(
      std::size_t(0), parts_.size(),
      [&](std::size_t p) {
        progress.check();
        work(parts_[p]);
      },
      tbb::simple_partitioner());
  join();
}

void TetParts::join() {
  if (parts_.size() == 1) {
    whole_ = std::move(parts_[0].complex);
    parts_.clear();
    return;
  }
  const std::size_t count = parts_.size();
  // The first tet and the first new point of each part.
  std::vector<std::size_t> firstTet(count + 1, 0), firstPoint(count + 1, whole_.points.size());
  for (std::size_t p = 0; p < count; ++p) {
    firstTet[p + 1] = firstTet[p] + parts_[p].complex.tetCount();
    firstPoint[p + 1] =
        firstPoint[p] + parts_[p].complex.points.size() - parts_[p].pointOfWhole.size();
  }
  whole_.tets.resize(firstTet[count]);
  whole_.points.resize(firstPoint[count]);
  tbb::parallel_for(std::size_t(0), count,
                    [&](std::size_t p) { copyBack(parts_[p], firstTet[p], firstPoint[p]); });
  joinBorders();
  for (const Part& part : parts_)
    for (std::size_t i = 0; i < part.pointOfWhole.size(); ++i)
      if (partOfPoint_[part.pointOfWhole[i]] == kShared) {
        TetComplex::Point& point = whole_.points[part.pointOfWhole[i]];
        point.onBoundary = point.onBoundary || part.complex.points[i].onBoundary;
        point.setChanged(part.complex.points[i].changed);
      }
  parts_.clear();
}

// Copies a part's tets and points into the whole mesh. Faces between parts keep their numbers.
void TetParts::copyBack(Part& part, std::size_t firstTet, std::size_t firstPoint) {
  const TetComplex& complex = part.complex;
  const std::size_t old = part.pointOfWhole.size();
  const auto pointOfWhole = [&](std::uint32_t point) {
    return point < old ? part.pointOfWhole[point]
                       : static_cast<std::uint32_t>(firstPoint + point - old);
  };
  std::vector<std::uint32_t> numbers(complex.tets.size(), TetComplex::kNone);
  auto next = static_cast<std::uint32_t>(firstTet);
  for (std::size_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists())
      numbers[t] = next++;
  for (std::size_t i = 0; i < complex.points.size(); ++i) {
    const std::uint32_t whole = pointOfWhole(static_cast<std::uint32_t>(i));
    if (i < old && partOfPoint_[whole] == kShared)
      continue; // fixed: only its tet and its flags have changed
    whole_.points[whole] = complex.points[i];
    if (complex.points[i].exists())
      whole_.points[whole].tet = numbers[complex.points[i].tet];
  }
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    if (numbers[t] == TetComplex::kNone)
      continue;
    TetComplex::Tet tet = complex.tets[t];
    tet.mark = 0;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      tet.corners[localFace] = pointOfWhole(tet.corners[localFace]);
      if (tet.neighbours[localFace] < TetComplex::kElsewhere)
        tet.neighbours[localFace] = numbers[tet.neighbours[localFace]];
    }
    whole_.tets[numbers[t]] = tet;
  }
  part.complex.points.shrink_to_fit();
}

// Joins tets across faces between parts; a shared point gets the last tet that has it.
void TetParts::joinBorders() {
  struct Side {
    std::uint32_t tet, localFace;
  };
  std::vector<std::array<Side, 2>> sides(borderCount_);
  std::vector<std::uint8_t> seen(borderCount_, 0);
  for (std::size_t t = 0; t < whole_.tets.size(); ++t) {
    TetComplex::Tet& tet = whole_.tets[t];
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t corner = tet.corners[localFace], next = tet.neighbours[localFace];
      if (corner < partOfPoint_.size() && partOfPoint_[corner] == kShared)
        whole_.points[corner].tet = static_cast<std::uint32_t>(t);
      if (next < TetComplex::kElsewhere || next == TetComplex::kOutside)
        continue;
      const std::size_t border = next - TetComplex::kElsewhere;
      sides[border][seen[border]++] = {static_cast<std::uint32_t>(t), localFace};
    }
  }
  for (const auto& [a, b] : sides) {
    whole_.tets[a.tet].neighbours[a.localFace] = b.tet;
    whole_.tets[b.tet].neighbours[b.localFace] = a.tet;
  }
}

} // namespace tetvdb
