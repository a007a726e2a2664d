// SPDX-License-Identifier: Apache-2.0
//
// Suggestions for misspelled names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// The one of `names` that `wanted` is a misspelling of: fewest letters inserted, left out,
/// replaced or exchanged with their neighbour, at most a third of the longer name's; upper and
/// lower case are the same. A name that `wanted` begins or that begins with it comes after these.
/// The first of equals; empty where none is near. Cost: the product of the lengths, for each name.
std::string closestName(std::string_view wanted, const std::vector<std::string>& names);

/// `advice` for an error about a name that does not exist, after "did you mean 'NAME'?" where there
/// is a closest name.
std::string suggestName(std::string_view wanted, const std::vector<std::string>& names,
                        const std::string& advice);

} // namespace tetvdb
