// SPDX-License-Identifier: Apache-2.0
#include "HostBackend.h"
#include "Pipeline.h"

namespace tetvdb::nano {

struct HostTwin::State {
  HostBackend backend;
};

HostTwin::HostTwin() : state_(std::make_unique<State>()) {}
HostTwin::~HostTwin() = default;

Result HostTwin::run(const MeshView& mesh, const Job& job) {
  state_->backend.release();
  return Pipeline<HostBackend>(state_->backend, mesh, job).run();
}

} // namespace tetvdb::nano
