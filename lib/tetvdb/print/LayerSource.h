// SPDX-License-Identifier: Apache-2.0
//
// Layers in order, from below: the input of checks, containers and sums.
//
//   forEachLayer(
//       source, [&](std::int32_t k, Layer&& layer) { return encode(k, layer); },   // in parallel
//       [&](std::int32_t k, std::string&& bytes) { file.write(k, bytes); },        // in order
//       progress);
#pragma once

#include "tetvdb/core/MakeInOrder.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/print/Layer.h"

#include <cstdint>
#include <memory>
#include <tbb/task_arena.h>
#include <type_traits>
#include <utility>

namespace tetvdb {

/// Several consecutive layers, ready to be made. Thread-safe.
class LayerBatch {
public:
  virtual ~LayerBatch() = default;
  /// One past the last layer.
  virtual std::int32_t end() const = 0;
  /// Makes a layer of the batch; overwrites `layer`.
  virtual void make(std::int32_t k, Layer& layer) const = 0;
};

/// A solid cut into layers. The layers do not depend on the number of threads.
class LayerSource {
public:
  virtual ~LayerSource() = default;
  virtual const LayerFrame& frame() const = 0;
  /// Returns the batch that begins with layer `first`: layer 0, then the end of the previous batch.
  /// Not thread-safe; batches can be used while others are made, as long as the source exists.
  virtual std::shared_ptr<const LayerBatch> batch(std::int32_t first) = 0;
};

/// Calls take(k, work(k, layer)) for every layer k, from 0 upward: work() in parallel for different
/// layers, take() for one layer at a time in order. About two layers per thread are in memory at a
/// time. Throws the errors of these functions, and Error(Cancelled).
template <typename Work, typename Take>
void forEachLayer(LayerSource& source, const Work& work, const Take& take, Progress& progress) {
  using Made = std::decay_t<decltype(work(std::int32_t(0), std::declval<Layer&&>()))>;
  struct Item {
    std::int32_t k = 0;
    std::shared_ptr<const LayerBatch> batch;
  };
  const std::int32_t layers = source.frame().layers;
  std::int32_t next = 0, taken = 0;
  std::shared_ptr<const LayerBatch> batch;
  makeInOrder<Item, Made>(
      [&](Item& item) {
        if (next == layers)
          return false;
        if (!batch || batch->end() == next)
          batch = source.batch(next);
        item = {next++, batch};
        return true;
      },
      [&](const Item& item) {
        progress.check();
        Layer layer;
        item.batch->make(item.k, layer);
        return work(item.k, std::move(layer));
      },
      [&](Made& made) {
        take(taken++, std::move(made));
        progress.update(static_cast<double>(taken) / layers);
      },
      2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
}

} // namespace tetvdb
