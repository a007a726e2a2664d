// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Version.h"

namespace tetvdb {

const char* version() noexcept {
  return TETVDB_VERSION;
}

} // namespace tetvdb
