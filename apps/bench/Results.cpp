// SPDX-License-Identifier: Apache-2.0
#include "Results.h"

#include "Table.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>

namespace tetvdb::bench {
namespace {

using Json = nlohmann::ordered_json;

Times timesOf(const Json& row, const char* name) {
  return {row.at(name).get<std::vector<double>>()};
}

std::string range(const Times& times) {
  if (times.seconds.empty())
    return "";
  return fmt::format("{} ({} - {})", duration(times.median()), duration(times.min()),
                     duration(times.max()));
}

std::string bytesOf(const Json& row, const char* name) {
  const double bytes = row.at(name);
  return bytes > 0 ? size(bytes) : "";
}

} // namespace

std::vector<Target> targetsOf(const Json& row) {
  const Times ours = timesOf(row, "ours_seconds"), peer = timesOf(row, "peer_seconds");
  const double ratio = row.at("ratio"), peak = row.at("peak_bytes"), max = row.at("target_bytes"),
               min = row.at("target_ratio"), seconds = row.at("target_seconds"),
               theirs = row.at("peer_peak_bytes"), less = row.at("target_less_bytes");
  std::vector<Target> targets;
  if (min > 0 && !peer.seconds.empty())
    targets.push_back({fmt::format("{:g}x", min), duration(ours.median()), duration(peer.median()),
                       fmt::format("{:.2f}", ratio), ratio >= min});
  if (seconds > 0)
    targets.push_back(
        {duration(seconds), duration(ours.median()), "", "", ours.median() <= seconds});
  if (max > 0)
    targets.push_back({size(max), size(peak), "", "", peak <= max});
  if (less > 0 && theirs > 0)
    targets.push_back({fmt::format("memory / {:g}", less), size(peak), size(theirs),
                       fmt::format("{:.2f}", theirs / peak), theirs >= less * peak});
  return targets;
}

std::vector<std::vector<std::string>> tableOf(const Json& entry) {
  std::vector<std::vector<std::string>> lines = {
      {"what", "peer", "ours: median (min - max)", "peer: median (min - max)", "ratio", "pairwise",
       "asked", "floor", "of floor", "memory", "peer's memory"}};
  for (const Json& row : entry.at("rows")) {
    const Times ours = timesOf(row, "ours_seconds"), peer = timesOf(row, "peer_seconds");
    const double floor = row.at("floor_seconds");
    std::string asked;
    for (const Target& target : targetsOf(row))
      asked += fmt::format("{}{}{}", asked.empty() ? "" : ", ", target.asked,
                           target.reached ? "" : ": **no**");
    lines.push_back(
        {row.at("what"), row.at("peer"), range(ours), range(peer),
         peer.seconds.empty() ? "" : fmt::format("{:.2f}", row.at("ratio").get<double>()),
         peer.seconds.empty() ? "" : fmt::format("{:.2f}", row.at("pairwise_ratio").get<double>()),
         asked, floor > 0 ? duration(floor) : "",
         floor > 0 ? fmt::format("{:.0f} %", 100 * floor / ours.median()) : "",
         bytesOf(row, "peak_bytes"), bytesOf(row, "peer_peak_bytes")});
  }
  for (std::size_t column = lines.front().size(); column-- > 1;)
    if (lines.size() > 1 && std::all_of(lines.begin() + 1, lines.end(),
                                        [&](const auto& line) { return line[column].empty(); }))
      for (auto& line : lines)
        line.erase(line.begin() + static_cast<std::ptrdiff_t>(column));
  return lines;
}

void Tables::begin(const std::string& name, const std::string& about, const std::string& along) {
  json_.push_back({{"case", name},
                   {"about", about},
                   {"along", along},
                   {"rows", Json::array()},
                   {"notes", Json::array()}});
  std::printf("\n## %s\n\n%s\n\n", name.c_str(), about.c_str());
  std::fflush(stdout);
}

void Tables::add(const Row& row) {
  const bool peer = !row.peer.seconds.empty();
  const double ratio = peer ? ratioOfMedians(row.ours, row.peer) : 0;
  json_.back()["rows"].push_back({{"what", row.what},
                                  {"peer", row.peerName},
                                  {"ours_seconds", row.ours.seconds},
                                  {"peer_seconds", row.peer.seconds},
                                  {"ratio", ratio},
                                  {"pairwise_ratio", peer ? medianOfRatios(row.ours, row.peer) : 0},
                                  {"target_ratio", row.targetRatio},
                                  {"target_seconds", row.targetSeconds},
                                  {"floor_bytes", row.floorBytes},
                                  {"floor_seconds", row.floorBytes / bandwidth_},
                                  {"peak_bytes", row.peakBytes},
                                  {"peer_peak_bytes", row.peerPeakBytes},
                                  {"target_bytes", row.targetBytes},
                                  {"target_less_bytes", row.targetLessBytes},
                                  {"curve", row.curve},
                                  {"peer_curve", row.peerCurve},
                                  {"at", row.at}});
  if (!row.note.empty())
    note(row.what + ": " + row.note);
  // What is known so far, for whoever waits.
  std::fprintf(stderr, "  %s | %s: ours %s, peer %s, ratio %.2f\n", row.what.c_str(),
               row.peerName.c_str(), range(row.ours).c_str(), range(row.peer).c_str(), ratio);
}

void Tables::note(const std::string& text) {
  Json& notes = json_.back()["notes"];
  if (std::find(notes.begin(), notes.end(), text) == notes.end())
    notes.push_back(text);
}

void Tables::end() {
  std::fputs(markdown(tableOf(json_.back())).c_str(), stdout);
  std::fputs("\n", stdout);
  for (const Json& text : json_.back()["notes"])
    std::printf("- %s\n", text.get<std::string>().c_str());
  std::fflush(stdout);
}

} // namespace tetvdb::bench
