// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/ClosestName.h"

#include "tetvdb/core/Letters.h"

#include <algorithm>

namespace tetvdb {
namespace {

constexpr std::size_t kLongest = 200; // longer names are no misspellings

// Damerau and Levenshtein's distance in its restricted form ("optimal string alignment").
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

bool begins(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

} // namespace

std::string closestName(std::string_view wanted, const std::vector<std::string>& names) {
  if (wanted.empty() || wanted.size() > kLongest)
    return {};
  const std::string sought = lowerCase(wanted);
  std::size_t minDistance = kLongest;
  std::string closest, related;
  for (const std::string& name : names) {
    if (name.empty() || name.size() > kLongest)
      continue;
    const std::string known = lowerCase(name);
    const std::size_t distance = editDistance(sought, known);
    if (distance < minDistance && distance <= std::max(sought.size(), known.size()) / 3) {
      minDistance = distance;
      closest = name;
    }
    if (related.empty() && std::min(sought.size(), known.size()) >= 3 &&
        (begins(sought, known) || begins(known, sought)))
      related = name;
  }
  return closest.empty() ? related : closest;
}

std::string suggestName(std::string_view wanted, const std::vector<std::string>& names,
                        const std::string& advice) {
  const std::string closest = closestName(wanted, names);
  if (closest.empty())
    return advice;
  return "did you mean '" + closest + "'?" + (advice.empty() ? "" : " ") + advice;
}

} // namespace tetvdb
