// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/gmsh/GmshData.h"

#include <limits>

namespace tetvdb {
void GmshData::read(Attribute::On on, const IdMap& ids, std::size_t things,
                    std::vector<Attribute>& attributes) {
  std::string name;
  const std::size_t strings = in_.text.count("string tags", 2);
  in_.text.line();
  for (std::size_t i = 0; i < strings; ++i) {
    std::string_view line = in_.text.line();
    const auto blank = [](char c) { return static_cast<unsigned char>(c) <= ' ' || c == '"'; };
    while (!line.empty() && blank(line.front()))
      line.remove_prefix(1);
    while (!line.empty() && blank(line.back()))
      line.remove_suffix(1);
    if (i == 0)
      name = line;
  }
  const std::size_t reals = in_.text.count("real tags", 2);
  for (std::size_t i = 0; i < reals; ++i)
    in_.text.value();
  const std::size_t integers = in_.text.count("integer tags", 2);
  std::int64_t tags[3] = {0, 1, 0}; // time step, components, entries
  for (std::size_t i = 0; i < integers; ++i) {
    const std::int64_t value = in_.text.integer();
    if (i < 3)
      tags[i] = value;
  }
  in_.text.line();
  if (tags[1] < 1 || tags[1] > 1000)
    in_.fail("data '" + name + "' has " + std::to_string(tags[1]) + " components", kExportWithGmsh);
  in_.enterBinary();
  const auto components = static_cast<std::size_t>(tags[1]);
  const std::size_t n = in_.checkCount(tags[2], "values", 2 * (1 + components), 4 + 8 * components);

  // Nodes without a value also use memory: a small file must not request much of it.
  size_ += things * components;
  if (size_ / 8 > fileBytes_)
    in_.fail("data sections such as '" + name + "' have values for too few nodes or elements");
  std::vector<double>& values = array(attributes, name, on, components, things, tags[0]);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t index = ids.find(in_.integer());
    if (index == IdMap::kNone)
      ++unknown;
    for (std::size_t k = 0; k < components; ++k) {
      const double value = in_.binary ? in_.real() : in_.text.value();
      if (index != IdMap::kNone && !values.empty())
        values[index * components + k] = value;
    }
  }
  if (unknown > 0)
    report_.warn("unknown-ids", std::to_string(unknown) + " values of '" + name +
                                    "' are for nodes or elements that do not exist");
}

std::vector<double>& GmshData::array(std::vector<Attribute>& attributes, const std::string& name,
                                     Attribute::On on, std::size_t components, std::size_t things,
                                     std::int64_t step) {
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    Attribute& known = attributes[i];
    if (known.name != name || known.on != on)
      continue;
    auto& values = std::get<std::vector<double>>(known.values);
    if (step < steps_[i])
      return ignored_;
    if (step > steps_[i] || known.components != components) {
      known.components = static_cast<std::uint32_t>(components);
      values.assign(things * components, kMissing);
      steps_[i] = step;
    }
    return values;
  }
  attributes.push_back({name, on, static_cast<std::uint32_t>(components),
                        std::vector<double>(things * components, kMissing)});
  steps_.push_back(step);
  return std::get<std::vector<double>>(attributes.back().values);
}

} // namespace tetvdb
