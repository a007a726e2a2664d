// SPDX-License-Identifier: Apache-2.0
//
// The text and the report of `info` about tets and volumes.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace tetvdb::cli {

/// The finite values of an array, over all components.
struct ValueSpan {
  double min = 0, max = 0;
  std::size_t notFinite = 0;
  bool empty = true;
};

ValueSpan rangeOf(const Attribute& attribute);

const char* typeName(const Attribute& attribute);
std::map<std::int32_t, std::size_t> countRegions(const TetMesh& mesh);
/// Empty where it has none.
std::string regionName(const TetMesh& mesh, std::int32_t number);

nlohmann::ordered_json sectionOf(const InputInfo& info, const TetMesh& mesh);
nlohmann::ordered_json sectionOf(const GridInfo& grid);

} // namespace tetvdb::cli
