// SPDX-License-Identifier: Apache-2.0
//
// The numbers of XDMF's data items: all required items are registered first, then read, so that
// HDF5 files are opened once.
//
//   tetvdb::XdmfData data(document, source, report, progress);
//   data.need(item);
//   data.load();
//   const tetvdb::Attribute::Values values = data.take(item);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/formats/xdmf/Hdf5Arrays.h"
#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/Attribute.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

class XdmfData {
public:
  XdmfData(const XdmfMarkup& markup, const Source& source, Report& report, Progress& progress)
      : markup_(markup), source_(source), report_(report), progress_(progress) {}

  /// Throws Error(Invalid) for an item that cannot be read: functions, unknown formats, sizes
  /// beyond what the file holds.
  void need(pugi::xml_node item);
  /// Reads the required items in HDF5 files; others are read by take().
  void load();
  /// Bytes of the file that holds an item's numbers; 0 if they are in the XML. Throws as need().
  std::size_t fileBytes(pugi::xml_node item) const;
  /// The numbers of an item; once per call of need().
  Attribute::Values take(pugi::xml_node item);

private:
  struct Item {
    pugi::xml_node node; ///< with the numbers or the name of their file
    std::size_t numbers = 0;
    bool declared = false; ///< whether Dimensions declares the count
    bool sliced = false;
    Slab slab;
    std::vector<std::uint64_t> extent; ///< of a sliced item
    std::size_t dataset = 0;           ///< of an HDF item: its index in datasets_, from 1
    std::size_t uses = 1;              ///< remaining calls of take()
  };

  [[noreturn]] void fail(pugi::xml_node item, const std::string& what,
                         const char* advice = kExport) const;
  Item resolve(pugi::xml_node item) const;
  Hdf5Dataset datasetOf(pugi::xml_node item) const;
  std::vector<std::uint64_t> wholeNumbers(pugi::xml_node item, const std::string& text) const;
  std::vector<std::uint64_t> dimensions(pugi::xml_node item) const;
  std::size_t product(pugi::xml_node item, const std::vector<std::uint64_t>& factors) const;
  Slab slabOf(pugi::xml_node item, std::size_t rank) const;
  Attribute::Values fromText(const Item& item);
  Attribute::Values fromBinary(const Item& item);
  Attribute::Values sliced(const Item& item, Attribute::Values&& whole) const;

  const XdmfMarkup& markup_;
  const Source& source_;
  Report& report_;
  Progress& progress_;
  std::map<std::size_t, Item> items_; ///< by hash_value(), which is one a node
  std::vector<Hdf5Dataset> datasets_;
  NumberArrays loaded_;
  std::map<std::string, std::unique_ptr<MappedFile>> files_;
};

} // namespace tetvdb
