// SPDX-License-Identifier: Apache-2.0
#include "FieldOptions.h"

#include "Commands.h"

namespace tetvdb::cli {

void addFieldOptions(CLI::App& command, FieldTexts& texts) {
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* type,
                        const char* about) {
    command.add_option(name, values, about)
        ->type_name(type)
        ->delimiter(',')
        ->allow_extra_args(false);
  };
  list("--derive", texts.derive, "NAME=ARRAY:PART",
       "Grids made of arrays: magnitude, mises, trace, determinant, principal1..3, or a component "
       "such as x, xx, 0; NAME=ARRAY renames a grid");
  list("--remap", texts.remap, "[NAME=]A:B",
       "Map an array's range (that of --clamp, where given) to A:B; of all grids of single numbers "
       "made of arrays, or of one");
  list("--clamp", texts.clamp, "[NAME=]A:B", "Bound an array's values, before --remap");
  list("--background", texts.background, "[NAME=]V",
       "Value outside the mesh of grids made of arrays (default 0)");
  command
      .add_option("--warp", texts.warp,
                  "Move points by a vector array, times a factor, before voxelizing")
      ->type_name("ARRAY[*F]")
      ->check(notEmpty());
  command.add_flag(
      "--smooth", texts.smooth,
      "Interpolate arrays over cells, by their means at points, in place of one value a "
      "cell");
}

} // namespace tetvdb::cli
