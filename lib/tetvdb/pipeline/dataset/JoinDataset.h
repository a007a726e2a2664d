// SPDX-License-Identifier: Apache-2.0
//
// Completes a data set: writes its tables, archives, card and preview.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/pipeline/dataset/DatasetOptions.h"
#include "tetvdb/pipeline/dataset/DatasetRows.h"
#include "tetvdb/pipeline/dataset/Manifest.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

struct DatasetSummary {
  std::size_t items = 0, succeeded = 0, failed = 0;
  std::size_t sameFile = 0, sameGrid = 0; ///< models that repeat an earlier one
  double seconds = 0;                     ///< of all items, one after the other
  std::vector<std::string> files;         ///< written, within the folder
};

struct JoinOptions {
  unsigned archives = 0; ///< .tar and .h5 files that the models' files go into; 0: they stay files
  bool preview = true;   ///< a picture of up to 24 models
};

/// All items of a data set: every entry and its variants.
std::vector<DatasetItem> itemsOf(const std::vector<DatasetEntry>& entries, int variants);

/// Writes into `folder` success.csv and failed.csv (every item is in exactly one), card.md,
/// preview.png, and the archives: data-00000-of-00008.tar and so on, each model in the one that
/// hashOfId() says, with NAME.json for its class, split and transform, as WebDataset reads them;
/// HDF5 files go into data-00000-of-00008.h5 and so on, a group a model. Files are removed after
/// their archive is complete. Zarr stores are kept, and the folder becomes a group of them
/// (joinZarrStores()). Everything but card.md and times depends only on the models and the options.
/// Throws Error(Invalid), and writes nothing, where an item has no row yet.
DatasetSummary joinDataset(const std::vector<DatasetItem>& items,
                           const std::map<std::string, DatasetRow>& rows,
                           const DatasetOptions& options, const JoinOptions& how,
                           const std::string& folder, Progress& progress);

} // namespace tetvdb
