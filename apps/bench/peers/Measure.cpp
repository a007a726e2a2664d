// SPDX-License-Identifier: Apache-2.0
#include "Measure.h"

#include <algorithm>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb::bench {
namespace {

double medianOf(std::vector<double> values) {
  if (values.empty())
    return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

} // namespace

double Times::median() const {
  return medianOf(seconds);
}
double Times::min() const {
  return seconds.empty() ? 0 : *std::min_element(seconds.begin(), seconds.end());
}
double Times::max() const {
  return seconds.empty() ? 0 : *std::max_element(seconds.begin(), seconds.end());
}

double ratioOfMedians(const Times& ours, const Times& peer) {
  return ours.median() > 0 ? peer.median() / ours.median() : 0;
}

double medianOfRatios(const Times& ours, const Times& peer) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(ours.seconds.size(), peer.seconds.size()); ++i)
    ratios.push_back(peer.seconds[i] / ours.seconds[i]);
  return medianOf(ratios);
}

std::vector<Times> interleave(const std::vector<Rival>& rivals, int rounds, bool warmUp) {
  std::vector<Times> times(rivals.size());
  if (warmUp)
    for (const Rival& rival : rivals)
      rival.run();
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < rivals.size(); ++i)
      if (rivals[i].rounds == 0 || round < rivals[i].rounds)
        times[i].seconds.push_back(rivals[i].run());
  return times;
}

double measureBandwidth() {
  using Range = tbb::blocked_range<std::size_t>;
  constexpr std::size_t count = std::size_t(1) << 24; // three arrays of 128 MiB, beyond any cache
  const std::unique_ptr<double[]> a(new double[count]), b(new double[count]), c(new double[count]);
  const auto run = [&](const auto& body) {
    tbb::parallel_for(Range(0, count, count / 64), [&](const Range& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i)
        body(i);
    });
  };
  run([&](std::size_t i) {
    a[i] = 0;
    b[i] = static_cast<double>(i);
    c[i] = 1;
  });
  Times times;
  for (int round = 0; round < 7; ++round)
    times.seconds.push_back(
        secondsOf([&] { run([&](std::size_t i) { a[i] = b[i] + 3 * c[i]; }); }));
  return 3.0 * sizeof(double) * static_cast<double>(count) / times.min();
}

} // namespace tetvdb::bench
