// SPDX-License-Identifier: Apache-2.0
#include "Table.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>

namespace tetvdb::bench {
namespace {

std::string range(const Times& times) {
  if (times.seconds.empty())
    return "";
  return fmt::format("{} ({} - {})", duration(times.median()), duration(times.min()),
                     duration(times.max()));
}

std::string targetOf(const Row& row) {
  if (row.targetRatio > 0)
    return fmt::format("{:g}x", row.targetRatio);
  return row.targetSeconds > 0 ? duration(row.targetSeconds) : "";
}

} // namespace

std::string duration(double seconds) {
  if (seconds >= 100)
    return fmt::format("{:.0f} s", seconds);
  if (seconds >= 1)
    return fmt::format("{:.2f} s", seconds);
  return seconds >= 0.01 ? fmt::format("{:.0f} ms", seconds * 1e3)
                         : fmt::format("{:.2f} ms", seconds * 1e3);
}

std::string size(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.2f} GB", bytes * 1e-9)
                      : fmt::format("{:.1f} MB", bytes * 1e-6);
}

std::string markdown(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 3);
  for (const auto& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k)
      widths[k] = std::max(widths[k], line[k].size());
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 0; k < lines[i].size(); ++k)
      text += k < 2 ? fmt::format("| {:<{}} ", lines[i][k], widths[k])
                    : fmt::format("| {:>{}} ", lines[i][k], widths[k]);
    text += "|\n";
    if (i > 0)
      continue;
    for (std::size_t k = 0; k < widths.size(); ++k)
      text += '|' + std::string(widths[k] + 1, '-') + (k < 2 ? '-' : ':');
    text += "|\n";
  }
  return text;
}

void Tables::begin(const std::string& name, const std::string& about) {
  lines_ = {{"what", "peer", "ours: median (min - max)", "peer: median (min - max)", "ratio",
             "pairwise", "target", "floor", "of floor"}};
  notes_.clear();
  json_.push_back({{"case", name}, {"about", about}, {"rows", nlohmann::ordered_json::array()}});
  std::printf("\n## %s\n\n%s\n\n", name.c_str(), about.c_str());
  std::fflush(stdout);
}

void Tables::add(const Row& row) {
  const bool peer = !row.peer.seconds.empty();
  const double ratio = peer ? ratioOfMedians(row.ours, row.peer) : 0;
  const double pairwise = peer ? medianOfRatios(row.ours, row.peer) : 0;
  const double floor = row.floorBytes / bandwidth_;
  lines_.push_back({row.what, row.peerName, range(row.ours), range(row.peer),
                    peer ? fmt::format("{:.2f}", ratio) : "",
                    peer ? fmt::format("{:.2f}", pairwise) : "", targetOf(row),
                    floor > 0 ? duration(floor) : "",
                    floor > 0 ? fmt::format("{:.0f} %", 100 * floor / row.ours.median()) : ""});
  if (!row.note.empty())
    note(row.what + ": " + row.note);
  json_.back()["rows"].push_back({{"what", row.what},
                                  {"peer", row.peerName},
                                  {"ours_seconds", row.ours.seconds},
                                  {"peer_seconds", row.peer.seconds},
                                  {"ratio", ratio},
                                  {"pairwise_ratio", pairwise},
                                  {"target_ratio", row.targetRatio},
                                  {"target_seconds", row.targetSeconds},
                                  {"floor_bytes", row.floorBytes},
                                  {"floor_seconds", floor},
                                  {"note", row.note}});
  // What is known so far, for whoever waits.
  std::fprintf(stderr, "  %s | %s: ours %s, peer %s, ratio %.2f\n", row.what.c_str(),
               row.peerName.c_str(), range(row.ours).c_str(), range(row.peer).c_str(), ratio);
}

void Tables::note(const std::string& text) {
  if (std::find(notes_.begin(), notes_.end(), text) == notes_.end())
    notes_.push_back(text);
}

void Tables::end() {
  std::fputs(markdown(lines_).c_str(), stdout);
  std::fputs("\n", stdout);
  for (const std::string& text : notes_)
    std::printf("- %s\n", text.c_str());
  std::fflush(stdout);
  json_.back()["notes"] = notes_;
}

} // namespace tetvdb::bench
