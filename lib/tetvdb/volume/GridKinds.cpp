// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/GridKinds.h"

#include "tetvdb/core/Error.h"

#include <iterator>

namespace tetvdb {

std::vector<std::string> gridKindNames() {
  std::vector<std::string> names;
  for (const GridKindInfo& info : kGridKinds)
    names.emplace_back(info.name);
  return names;
}

std::string listGridKinds() {
  std::string text;
  for (const GridKindInfo& info : kGridKinds)
    text.append(&info == &kGridKinds.front()  ? ""
                : &info == &kGridKinds.back() ? " and "
                                              : ", ")
        .append(info.name);
  return text;
}

std::vector<GridKind> madeBy(const std::vector<GridKind>& kinds,
                             std::initializer_list<GridMaker> makers) {
  std::vector<GridKind> made;
  std::copy_if(kinds.begin(), kinds.end(), std::back_inserter(made), [&](GridKind kind) {
    return std::find(makers.begin(), makers.end(), infoOf(kind).maker) != makers.end();
  });
  return made;
}

void checkGridKinds(const std::vector<GridKind>& kinds, std::initializer_list<GridMaker> makers) {
  if (kinds.empty())
    throw Error(Status::Usage, "`grid`", "no grid was asked for");
  const std::vector<GridKind> made = madeBy(kinds, makers);
  for (auto kind = kinds.begin(); kind != kinds.end(); ++kind) {
    const std::string name(infoOf(*kind).name);
    if (!contains(made, *kind))
      throw Error(Status::Usage, "`grid`", "'" + name + "' is not made by this function");
    if (std::find(kinds.begin(), kind, *kind) != kind)
      throw Error(Status::Usage, "`grid`", "'" + name + "' is asked for twice",
                  "name every grid once");
  }
}

} // namespace tetvdb
