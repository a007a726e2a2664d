// SPDX-License-Identifier: Apache-2.0
//
// What the numbers were measured on, and what else the machine did meanwhile.
#pragma once

#include <nlohmann/json.hpp>

namespace tetvdb::bench {

/// date (of today, local), processor, cores, cache and memory in words, system, compiler,
/// libraries, version, revision (of the sources that this program was built from; "+" where they
/// had changed).
nlohmann::ordered_json describeMachine();

/// Processor seconds since some moment: of the whole machine, and of this process and those that it
/// started, also by others.
struct Work {
  double machine = 0, own = 0;
};
/// Zeros where the system does not tell.
Work workSoFar();

} // namespace tetvdb::bench
