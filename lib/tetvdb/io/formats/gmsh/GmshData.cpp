// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/gmsh/GmshData.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kNumbersAtOnce = std::size_t(1) << 18; // numbers

// Values of consecutive elements go into a file together.
class Runs {
public:
  Runs(FileSpool& spool, std::size_t components) : spool_(spool), components_(components) {}

  void put(std::size_t index, const double* values) {
    if (index != first_ + values_.size() / components_ || values_.size() >= kNumbersAtOnce) {
      flush();
      first_ = index;
    }
    values_.insert(values_.end(), values, values + components_);
  }
  void flush() {
    if (!values_.empty())
      spool_.overwrite(first_ * components_ * sizeof(double), values_.data(),
                       values_.size() * sizeof(double));
    values_.clear();
  }

private:
  FileSpool& spool_;
  std::size_t components_, first_ = 0;
  std::vector<double> values_;
};

} // namespace

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
  const Target to = target(attributes, name, on, components, things, tags[0]);
  std::optional<Runs> runs;
  if (to.spool != nullptr)
    runs.emplace(*to.spool, components);
  std::vector<double> tuple(components);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t index = ids.find(in_.integer());
    for (double& value : tuple)
      value = in_.binary ? in_.real() : in_.text.value();
    if (index == IdMap::kNone)
      ++unknown;
    else if (runs)
      runs->put(index, tuple.data());
    else if (to.values != nullptr)
      std::copy(tuple.begin(), tuple.end(),
                to.values->begin() + static_cast<std::ptrdiff_t>(index * components));
  }
  if (runs)
    runs->flush();
  if (unknown > 0)
    report_.warn("unknown-ids", std::to_string(unknown) + " values of '" + name +
                                    "' are for nodes or elements that do not exist");
}

GmshData::Target GmshData::target(std::vector<Attribute>& attributes, const std::string& name,
                                  Attribute::On on, std::size_t components, std::size_t things,
                                  std::int64_t step) {
  if (spool_ != nullptr)
    return spooled(name, on, components, things, step);
  std::vector<double>& values = array(attributes, name, on, components, things, step);
  return {values.empty() ? nullptr : &values, nullptr};
}

GmshData::Target GmshData::spooled(const std::string& name, Attribute::On on,
                                   std::size_t components, std::size_t things, std::int64_t step) {
  constexpr std::size_t kDouble = 1; // of Attribute::Values
  SpooledArray* known = spool_->find(name, on);
  if (known == nullptr) {
    known = spool_->add(name, on, static_cast<std::uint32_t>(components), kDouble);
    steps_.push_back(step);
  } else {
    std::int64_t& last = steps_[static_cast<std::size_t>(known - spool_->arrays.data())];
    if (step < last)
      return {};
    if (step == last && known->components == components)
      return {nullptr, known->values.get()};
    last = step;
    known->components = static_cast<std::uint32_t>(components);
    known->values->clear();
  }
  const std::vector<double> missing(std::min(kNumbersAtOnce, things * components), kMissing);
  for (std::size_t left = things * components; left > 0;) {
    const std::size_t some = std::min(left, missing.size());
    known->values->append(missing.data(), some * sizeof(double));
    left -= some;
  }
  return {nullptr, known->values.get()};
}

void GmshData::finish(const std::function<void(const VisitRun&)>& eachRun) {
  for (SpooledArray& array : spool_->arrays) {
    if (array.on != Attribute::On::Cells)
      continue;
    auto solid = std::make_unique<FileSpool>(spool_->folder());
    array.values->finish();
    const char* from = array.values->as<char>();
    eachRun([&](std::size_t count, bool isSolid) {
      constexpr std::size_t kBytes = kNumbersAtOnce * sizeof(double);
      for (std::size_t left = count * array.bytesEach(); left > 0;) {
        const std::size_t some = std::min(left, kBytes);
        if (isSolid)
          solid->append(from, some);
        from += some;
        left -= some;
        array.values->release();
      }
    });
    array.values = std::move(solid);
  }
}

std::vector<double>& GmshData::array(std::vector<Attribute>& attributes, const std::string& name,
                                     Attribute::On on, std::size_t components, std::size_t things,
                                     std::int64_t step) {
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
