// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/Shard.h"

#include "tetvdb/core/Error.h"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

namespace tetvdb {
namespace {

constexpr unsigned kMaxShards = 1u << 20;

std::optional<unsigned> wholeNumber(std::string_view text) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || text.empty())
    return std::nullopt;
  return number;
}

std::optional<unsigned> variable(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? std::nullopt : wholeNumber(text);
}

Shard checked(unsigned index, unsigned count, const std::string& where) {
  if (count == 0 || count > kMaxShards || index >= count)
    throw Error(Status::Usage, "`shard`", where + " is no shard",
                "give I/N with I from 0 to N - 1, such as 0/16 to 15/16");
  return {index, count};
}

Shard shardOfEnvironment() {
  if (const auto task = variable("SLURM_ARRAY_TASK_ID")) {
    const unsigned first = variable("SLURM_ARRAY_TASK_MIN").value_or(0);
    const unsigned step = variable("SLURM_ARRAY_TASK_STEP").value_or(1);
    const unsigned count = variable("SLURM_ARRAY_TASK_COUNT").value_or(0);
    if (*task < first || step == 0)
      throw Error(Status::Usage, "`shard`", "Slurm's array variables contradict each other");
    return checked((*task - first) / step, count, "the task of the Slurm array");
  }
  struct Launcher {
    const char* rank;
    const char* size;
  };
  for (const Launcher& launcher :
       {Launcher{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"}, Launcher{"PMI_RANK", "PMI_SIZE"},
        Launcher{"SLURM_PROCID", "SLURM_NTASKS"}})
    if (const auto rank = variable(launcher.rank))
      return checked(*rank, variable(launcher.size).value_or(0), launcher.rank);
  throw Error(Status::Usage, "`shard`",
              "neither Slurm nor an MPI launcher says which task this process is",
              "start it by a job array or mpirun, or give I/N");
}

} // namespace

std::string Shard::name() const {
  return std::to_string(index) + "-of-" + std::to_string(count);
}

Shard parseShard(const std::string& text) {
  if (text == "auto")
    return shardOfEnvironment();
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos)
    throw Error(Status::Usage, "`shard`", "'" + text + "' is neither auto nor I/N");
  const auto index = wholeNumber(std::string_view(text).substr(0, slash));
  const auto count = wholeNumber(std::string_view(text).substr(slash + 1));
  if (!index || !count)
    throw Error(Status::Usage, "`shard`", "'" + text + "' is neither auto nor I/N");
  return checked(*index, *count, "'" + text + "'");
}

} // namespace tetvdb
