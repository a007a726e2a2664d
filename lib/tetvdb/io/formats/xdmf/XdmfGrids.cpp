// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/xdmf/XdmfGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/TimeStep.h"
#include "tetvdb/io/text/NumberParser.h"

#include <filesystem>
#include <set>

namespace tetvdb {
namespace {

constexpr std::size_t kDeepestGrid = 32, kMaxGrids = 1 << 16;

std::vector<double> numbersIn(std::string_view text, const std::string& where) {
  NumberParser in(text, where);
  std::vector<double> numbers;
  while (!in.atEnd())
    numbers.push_back(in.real());
  return numbers;
}

// <Time> of the collection itself: a list, or start, step and number.
std::vector<double> timesOfCollection(const XdmfMarkup& markup, pugi::xml_node time) {
  const std::string_view type = time.attribute("TimeType").value();
  const pugi::xml_node item = markup.child(time, "DataItem");
  const std::string_view format = item.attribute("Format").value();
  if (!item || (!format.empty() && !sameWord(format, "XML")))
    return {};
  std::vector<double> numbers = numbersIn(item.text().get(), markup.where(item));
  if (!sameWord(type, "HyperSlab"))
    return sameWord(type, "List") ? numbers : std::vector<double>();
  if (numbers.size() != 3 || !(numbers[2] >= 0 && numbers[2] <= 1e6))
    return {};
  std::vector<double> times;
  for (double i = 0; i < numbers[2]; ++i)
    times.push_back(numbers[0] + i * numbers[1]);
  return times;
}

/// Collects the files that data items name.
class FileNames : public pugi::xml_tree_walker {
public:
  explicit FileNames(const std::string& path)
      : folder_(std::filesystem::path(path).parent_path()) {}

  bool for_each(pugi::xml_node& node) override {
    const std::string_view format = node.attribute("Format").value();
    if (format.empty() || sameWord(format, "XML"))
      return true;
    const std::string_view text = trimmedText(node);
    const std::string_view name = text.substr(0, datasetColon(text));
    if (!name.empty())
      names.insert((folder_ / std::filesystem::path(name)).string());
    return true;
  }

  std::set<std::string> names;

private:
  std::filesystem::path folder_;
};

} // namespace

bool XdmfGrids::isCollection(pugi::xml_node grid) {
  const std::string_view type = typeOf(grid);
  return sameWord(type, "Collection") || sameWord(type, "Tree");
}

bool XdmfGrids::isTemporal(pugi::xml_node grid) {
  return sameWord(typeOf(grid), "Collection") &&
         sameWord(grid.attribute("CollectionType").value(), "Temporal");
}

pugi::xml_node XdmfGrids::temporal(pugi::xml_node grid, std::size_t depth) const {
  if (depth > kDeepestGrid)
    fail(grid, "grids are nested too deep");
  if (isTemporal(grid))
    return grid;
  if (isCollection(grid) || std::string_view(grid.name()) == "Domain")
    for (const pugi::xml_node child : children(grid))
      if (const pugi::xml_node found = temporal(child, depth + 1))
        return found;
  return {};
}

XdmfGrids::Step XdmfGrids::step(pugi::xml_node temporal, int timeStep) const {
  Step step;
  step.count = temporal ? children(temporal).size() : 0;
  if (temporal && step.count == 0)
    throw Error(Status::Invalid, markup_.where(temporal), "the temporal collection is empty",
                "export it again");
  step.index = chosenStep(step.count, timeStep, markup_.path()).value_or(0);
  return step;
}

void XdmfGrids::uniform(pugi::xml_node grid, std::size_t step, std::vector<pugi::xml_node>& found,
                        std::size_t depth) const {
  if (depth > kDeepestGrid || found.size() > kMaxGrids)
    fail(grid, "has too many grids in it");
  if (!isCollection(grid)) {
    const std::string_view type = typeOf(grid);
    if (!type.empty() && !sameWord(type, "Uniform"))
      fail(grid, "is a grid of type '" + std::string(type) + "', which is not read");
    found.push_back(grid);
    return;
  }
  const std::vector<pugi::xml_node> all = children(grid);
  if (isTemporal(grid)) {
    if (step < all.size())
      uniform(all[step], step, found, depth + 1);
    return;
  }
  for (const pugi::xml_node child : all)
    uniform(child, step, found, depth + 1);
}

void XdmfGrids::fail(pugi::xml_node grid, const std::string& what) const {
  throw Error(Status::Invalid, markup_.where(grid), what, kExport);
}

std::vector<std::string> xdmfFiles(const Source& source) {
  const XdmfMarkup markup(source);
  FileNames files(source.path);
  markup.domain().traverse(files);
  return {files.names.begin(), files.names.end()};
}

std::vector<double> xdmfTimes(const Source& source) {
  const XdmfMarkup markup(source);
  const XdmfGrids grids(markup);
  const pugi::xml_node temporal = grids.temporal(markup.domain());
  if (!temporal)
    return {};
  const std::vector<pugi::xml_node> steps = grids.children(temporal);
  std::vector<double> times;
  if (const pugi::xml_node time = markup.child(temporal, "Time"))
    times = timesOfCollection(markup, time);
  if (times.size() == steps.size() && !times.empty())
    return times;
  times.clear();
  bool all = true;
  for (const pugi::xml_node step : steps) {
    const pugi::xml_node time = markup.child(step, "Time");
    const std::vector<double> value =
        numbersIn(time.attribute("Value").value(), markup.where(step));
    all = all && value.size() == 1;
    times.push_back(all ? value.front() : 0);
  }
  for (std::size_t i = 0; i < times.size() && !all; ++i)
    times[i] = static_cast<double>(i);
  return times;
}

} // namespace tetvdb
