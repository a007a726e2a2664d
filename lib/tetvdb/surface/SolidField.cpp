// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SolidField.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr double kSolidError = 0.01; ///< limit of the mean in isSolid()
constexpr float kNegative = -0.25f;
// Number of samples that may be wrong: a ray through an edge can miscount.
constexpr std::size_t kStray = 2;
constexpr float kConfident = 0.2f; ///< from a whole number
// A sample is beside a group if the group's contribution exceeds this.
constexpr float kBeside = 0.4f;
// A flat wall contributes at most a half; groups that contribute more enclose something, for
// example a cavity with holes.
constexpr float kEnclosed = 0.85f;
constexpr std::size_t kStrayShare = 10; ///< one in this many samples may be elsewhere
constexpr int kSweeps = 12;
// Reversal must improve the field by this fraction of the groups' contribution.
constexpr double kMinGain = 0.05;

} // namespace

float distanceFromSolid(float winding) {
  return winding < 0 ? std::min(-winding, 1.0f) : std::abs(winding - std::round(winding));
}

double SolidField::error() const {
  double sum = 0;
  for (const float winding : values)
    sum += distanceFromSolid(winding);
  return values.empty() ? 0 : sum / double(values.size());
}

bool SolidField::isSolid() const {
  const auto negative = static_cast<std::size_t>(std::count_if(
      values.begin(), values.end(), [](float winding) { return winding < kNegative; }));
  return negative <= kStray && error() < kSolidError;
}

double SolidField::shareInside(std::size_t count) const {
  const auto inside =
      std::count_if(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count),
                    [](float winding) { return winding > 0.5f; });
  return count == 0 ? 0 : double(inside) / double(count);
}

double SolidField::shareLostIn(const SolidField& other, std::size_t count) const {
  std::size_t solid = 0, lost = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (values[i] < 0.5f || distanceFromSolid(values[i]) > kConfident)
      continue;
    ++solid;
    lost += other.values[i] <= 0.5f;
  }
  return solid == 0 ? 0 : double(lost) / double(solid);
}

double SolidField::differenceFrom(const SolidField& other, std::size_t count) const {
  std::size_t either = 0, both = 0;
  for (std::size_t i = 0; i < count; ++i) {
    either += values[i] > 0.5f || other.values[i] > 0.5f;
    both += values[i] > 0.5f && other.values[i] > 0.5f;
  }
  return either == 0 ? 0 : double(either - both) / double(either);
}

double SolidField::shareInsideLostIn(const SolidField& other) const {
  std::size_t inside = 0, lost = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    inside += values[i] > 0.5f;
    lost += values[i] > 0.5f && other.values[i] <= 0.5f;
  }
  return inside == 0 ? 0 : double(lost) / double(inside);
}

SolidField sumOf(const GroupWinding& groups, std::uint32_t groupCount) {
  SolidField field;
  field.values.assign(groups.sampleCount(), 0);
  for (std::uint32_t group = 0; group < groupCount; ++group)
    for (std::size_t i = 0; i < field.values.size(); ++i)
      field.values[i] += groups.of(group)[i];
  return field;
}

std::vector<std::uint8_t> innerGroups(const GroupWinding& groups, std::uint32_t groupCount,
                                      SolidField& field) {
  std::vector<std::uint8_t> inner(groupCount, 0);
  for (std::uint32_t group = 0; group < groupCount; ++group) {
    const float* adds = groups.of(group);
    std::size_t beside = 0, besideOutside = 0, lost = 0, enclosed = 0;
    double gain = 0, weight = 0;
    for (std::size_t i = 0; i < field.values.size(); ++i) {
      const float now = field.values[i], without = now - adds[i];
      enclosed += std::abs(adds[i]) > kEnclosed;
      beside += std::abs(adds[i]) > kBeside;
      besideOutside += std::abs(adds[i]) > kBeside && without < 0.5f;
      lost += now > 0.5f && without <= 0.5f;
      gain += distanceFromSolid(now) - distanceFromSolid(without);
      weight += std::abs(adds[i]);
    }
    if (enclosed > kStray || beside == 0 || besideOutside * kStrayShare > beside || lost > 0 ||
        gain <= kMinGain * weight)
      continue;
    inner[group] = 1;
    for (std::size_t i = 0; i < field.values.size(); ++i)
      field.values[i] -= adds[i];
  }
  return inner;
}

std::vector<std::uint8_t> turnTowardsSolid(const GroupWinding& groups, std::uint32_t groupCount,
                                           const std::vector<std::vector<std::uint32_t>>& sets,
                                           SolidField& field, Progress& progress) {
  std::vector<std::uint8_t> turned(groupCount, 0);
  std::vector<float> adds(field.values.size());
  const auto turnIfBetter = [&](const std::vector<std::uint32_t>& set) {
    std::fill(adds.begin(), adds.end(), 0.0f);
    for (const std::uint32_t group : set)
      for (std::size_t i = 0; i < adds.size(); ++i)
        adds[i] += turned[group] ? -groups.of(group)[i] : groups.of(group)[i];
    double gain = 0, weight = 0;
    for (std::size_t i = 0; i < adds.size(); ++i) {
      const float now = field.values[i];
      gain += distanceFromSolid(now) - distanceFromSolid(now - 2 * adds[i]);
      weight += std::abs(adds[i]);
    }
    if (gain <= kMinGain * weight)
      return false;
    for (std::size_t i = 0; i < adds.size(); ++i)
      field.values[i] -= 2 * adds[i];
    for (const std::uint32_t group : set)
      turned[group] ^= 1;
    return true;
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool any = false;
    for (const auto& set : sets) {
      progress.check();
      any = turnIfBetter(set) || any;
    }
    if (!any)
      break;
  }
  return turned;
}

} // namespace tetvdb
