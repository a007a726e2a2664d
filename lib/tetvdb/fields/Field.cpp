// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/Field.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/volume/GridKinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string_view>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kMaxComponents = 9;

using Names = std::vector<std::string_view>;

// Names of a tuple's components. Six are a symmetric tensor in VTK's order, nine a tensor by rows.
Names componentNames(std::uint32_t count) {
  switch (count) {
  case 2:
    return {"x", "y"};
  case 3:
    return {"x", "y", "z"};
  case 6:
    return {"xx", "yy", "zz", "xy", "yz", "xz"};
  case 9:
    return {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  default:
    return {};
  }
}

std::string componentName(std::uint32_t count, std::uint32_t i) {
  const Names names = componentNames(count);
  return names.empty() ? std::to_string(i) : std::string(names[i]);
}

// Indices of xx, xy, xz, yx, ... in a symmetric tensor of six.
constexpr std::array<std::uint32_t, 9> kSymmetric{0, 3, 5, 3, 1, 4, 5, 4, 2};

std::string listComponents(std::uint32_t count) {
  std::string text;
  for (std::uint32_t i = 0; i < count; ++i)
    text += (i == 0 ? "" : ", ") + componentName(count, i);
  return text;
}

std::string onText(Attribute::On on) {
  return on == Attribute::On::Points ? "points" : "cells";
}

bool fitsInt32(const Attribute& array) {
  const auto* wide = std::get_if<std::vector<std::int64_t>>(&array.values);
  return wide == nullptr || std::all_of(wide->begin(), wide->end(), [](std::int64_t v) {
           return v >= INT32_MIN && v <= INT32_MAX;
         });
}

// A requested array: a tuple whose components are in one array or in separate arrays.
struct Tuple {
  std::string name;
  Attribute::On on = Attribute::On::Points;
  std::vector<Field::Source> parts;
  bool integers = false;

  auto count() const { return static_cast<std::uint32_t>(parts.size()); }
};

Tuple tupleOf(const Attribute& array) {
  Tuple tuple{array.name, array.on, {}, array.isInteger()};
  for (std::uint32_t i = 0; i < array.components; ++i)
    tuple.parts.push_back({&array, i});
  return tuple;
}

class Resolver {
public:
  Resolver(const TetMesh& mesh, const FieldOptions& options, Report& report)
      : mesh_(mesh), options_(options), report_(report) {}

  std::vector<Field> run() {
    for (const FieldRequest& request : options_.requests)
      add(request);
    if (options_.all)
      addAll();
    if (fields_.empty())
      throw Error(Status::Usage, "`grid=all`", "the mesh has no arrays",
                  "name grids that need none, such as density");
    for (std::size_t i = 0; i < fields_.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (fields_[i].name == fields_[k].name)
          throw Error(Status::Usage, "`grid`", "two grids would be named '" + fields_[i].name + "'",
                      "give one another name with `derive=NAME=ARRAY`");
    return std::move(fields_);
  }

private:
  // --- Finding arrays.

  const Attribute* find(std::string_view name, Attribute::On on) const {
    for (const Attribute& array : mesh_.attributes)
      if (array.on == on && array.name == name)
        return &array;
    return nullptr;
  }

  std::optional<Tuple> assemble(const std::string& name, Attribute::On on) const {
    static const std::array<Names, 5> kVectors = {{{"_x", "_y", "_z"},
                                                   {".x", ".y", ".z"},
                                                   {"x", "y", "z"},
                                                   {"X", "Y", "Z"},
                                                   {"_X", "_Y", "_Z"}}};
    static const std::array<Names, 4> kTensors = {{{"_xx", "_yy", "_zz", "_xy", "_yz", "_xz"},
                                                   {"_xx", "_yy", "_zz", "_xy", "_yz", "_zx"},
                                                   {"XX", "YY", "ZZ", "XY", "YZ", "XZ"},
                                                   {"XX", "YY", "ZZ", "XY", "YZ", "ZX"}}};
    const auto fromNames = [&](const Names& suffixes) -> std::optional<Tuple> {
      Tuple tuple{name, on, {}, true};
      for (const std::string_view suffix : suffixes) {
        const Attribute* part = find(name + std::string(suffix), on);
        if (part == nullptr || part->components != 1)
          return {};
        tuple.parts.push_back({part, 0});
        tuple.integers = tuple.integers && part->isInteger();
      }
      return tuple;
    };
    for (const Names& names : kVectors)
      if (auto tuple = fromNames(names))
        return tuple;
    for (const Names& names : kTensors)
      if (auto tuple = fromNames(names))
        return tuple;
    return {};
  }

  std::optional<Tuple> lookUp(const std::string& name, Attribute::On on) const {
    if (const Attribute* array = find(name, on))
      return tupleOf(*array);
    return assemble(name, on);
  }

  // The array of that name; none if it does not exist.
  std::optional<Tuple> known(const std::string& name) {
    const auto points = lookUp(name, Attribute::On::Points);
    const auto cells = lookUp(name, Attribute::On::Cells);
    if (points && cells)
      report_.warn("ambiguous-array",
                   fmt::format("points and cells both have an array '{}'; that of the points is "
                               "used, cells:{} selects the other",
                               name, name));
    if (points)
      return *points;
    if (cells)
      return *cells;
    for (const auto& [prefix, on] : {std::pair(std::string("points:"), Attribute::On::Points),
                                     std::pair(std::string("cells:"), Attribute::On::Cells)})
      if (name.rfind(prefix, 0) == 0)
        if (auto tuple = lookUp(name.substr(prefix.size()), on))
          return *tuple;
    return {};
  }

  // "stress.xx" or "stress:mises" as a part of an array; none if it is not one.
  std::optional<std::pair<Tuple, FieldRequest>> partOf(const FieldRequest& request) {
    const std::string& name = request.array;
    const auto mark = name.find_last_of(".:");
    if (request.part != FieldPart::Whole || mark == std::string::npos || mark == 0)
      return {};
    FieldRequest part = request;
    part.array = name.substr(0, mark);
    if (!readPart(std::string_view(name).substr(mark + 1), part))
      return {};
    auto tuple = known(part.array);
    if (!tuple)
      return {};
    if (part.grid.empty())
      part.grid = tuple->name + "." + name.substr(mark + 1);
    return std::pair(std::move(*tuple), std::move(part));
  }

  // `mayBeGrid`: the name may have been meant as a grid of another kind.
  [[noreturn]] void refuseUnknown(const std::string& name, bool mayBeGrid) {
    refuseUnknownPart(name);
    std::vector<std::string> names = arrayNames(mesh_);
    std::string advice =
        names.empty() ? "it has no arrays" : "its arrays are " + describeArrays(mesh_);
    if (mayBeGrid) {
      advice += "; grids of every mesh are " + listGridKinds();
      const std::vector<std::string> kinds = gridKindNames();
      names.insert(names.begin(), kinds.begin(), kinds.end());
    }
    throw Error(Status::Usage, mayBeGrid ? "`grid`" : "", "the mesh has no array '" + name + "'",
                suggestName(name, names, advice));
  }

  // "stress:foo" or "stress.foo" if there is an array "stress".
  void refuseUnknownPart(const std::string& name) const {
    const auto colon = name.find_last_of(".:");
    if (colon == std::string::npos)
      return;
    const std::string array = name.substr(0, colon);
    if (!lookUp(array, Attribute::On::Points) && !lookUp(array, Attribute::On::Cells))
      return;
    throw Error(
        Status::Usage, "",
        fmt::format("'{}' cannot be computed from the array '{}'", name.substr(colon + 1), array),
        "choose from magnitude, mises, trace, determinant, principal1, principal2, "
        "principal3 and components such as x or xx");
  }

  // --- Making fields.

  void add(const FieldRequest& request) {
    if (const auto tuple = known(request.array))
      add(*tuple, request, request.grid.empty() ? tuple->name : request.grid);
    else if (const auto part = partOf(request))
      add(part->first, part->second, part->second.grid);
    else
      refuseUnknown(request.array, request.grid.empty() && request.part == FieldPart::Whole);
  }

  void addAll() {
    const auto taken = [&](const std::string& name) {
      return std::any_of(fields_.begin(), fields_.end(),
                         [&](const Field& field) { return field.name == name; });
    };
    for (const Attribute& array : mesh_.attributes) {
      const auto leaveOut = [&](const std::string& why) {
        report_.warn("array-left-out",
                     fmt::format("the array '{}' {} and is left out", array.name, why));
      };
      if (array.components > kMaxComponents) {
        leaveOut(fmt::format("has {} components", array.components));
        continue;
      }
      if (!fitsInt32(array)) {
        leaveOut("has integers beyond 32 bits");
        continue;
      }
      std::string name = array.name;
      if (taken(name) || reserved(name)) {
        name += array.on == Attribute::On::Points ? "_points" : "_cells";
        if (taken(name)) // it was also requested by name
          continue;
        report_.warn("array-renamed",
                     fmt::format("the array '{}' of the {} becomes grid '{}': another grid has its "
                                 "name",
                                 array.name, onText(array.on), name));
      }
      const bool asked = std::any_of(fields_.begin(), fields_.end(), [&](const Field& field) {
        return field.part == FieldPart::Whole && field.sources.size() == array.components &&
               field.sources.front().array == &array;
      });
      if (!asked)
        add(tupleOf(array), FieldRequest(), name);
    }
  }

  static bool isColour(const std::string& name) {
    const std::string lower = lowerCase(name);
    return lower == "cd" || lower.rfind("color", 0) == 0 || lower.rfind("colour", 0) == 0 ||
           lower.rfind("rgb", 0) == 0;
  }

  static bool reserved(const std::string& name) { return gridKindOf(name).has_value(); }

  void add(const Tuple& tuple, const FieldRequest& request, const std::string& name) {
    checkLengths(tuple);
    Field field;
    field.name = name;
    field.array = tuple.name;
    field.on = tuple.on;
    field.part = request.part;
    switch (request.part) {
    case FieldPart::Whole:
      return addWhole(tuple, std::move(field));
    case FieldPart::Component: {
      field.sources = {tuple.parts[componentOf(tuple, request.component)]};
      field.kind = tuple.integers ? FieldKind::Integer : FieldKind::Float;
      break;
    }
    case FieldPart::Magnitude:
      if (tuple.count() == 6)
        useTensor(tuple, field);
      else
        field.sources = tuple.parts;
      if (tuple.count() > kMaxComponents)
        refusePart(tuple, "magnitude", "it has too many components");
      break;
    default:
      if (tuple.count() != 6 && tuple.count() != 9)
        refusePart(tuple, "an invariant of tensors",
                   fmt::format("it has {} component{}, a tensor has 6 or 9", tuple.count(),
                               tuple.count() == 1 ? "" : "s"));
      useTensor(tuple, field);
    }
    finish(std::move(field));
  }

  void addWhole(const Tuple& tuple, Field field) {
    if (tuple.count() == 1 || tuple.count() == 3) {
      field.sources = tuple.parts;
      field.kind = tuple.count() == 3 ? FieldKind::Vector
                   : tuple.integers   ? FieldKind::Integer
                                      : FieldKind::Float;
      return finish(std::move(field));
    }
    if (tuple.count() > kMaxComponents)
      refusePart(tuple, "a grid", fmt::format("it has {} components", tuple.count()));
    const std::string name = field.name;
    for (std::uint32_t i = 0; i < tuple.count(); ++i) {
      Field part = field;
      part.part = FieldPart::Component;
      part.name = name + "." + componentName(tuple.count(), i);
      part.kind = tuple.integers ? FieldKind::Integer : FieldKind::Float;
      part.sources = {tuple.parts[i]};
      finish(std::move(part));
    }
  }

  static void useTensor(const Tuple& tuple, Field& field) {
    field.sources.clear();
    for (std::uint32_t i = 0; i < 9; ++i)
      field.sources.push_back(tuple.parts[tuple.count() == 6 ? kSymmetric[i] : i]);
  }

  static std::uint32_t componentOf(const Tuple& tuple, const std::string& name) {
    for (std::uint32_t i = 0; i < tuple.count(); ++i)
      if (name == componentName(tuple.count(), i) || name == std::to_string(i))
        return i;
    if (tuple.count() == 6)
      for (std::uint32_t i = 0; i < 9; ++i)
        if (name == componentName(9, i))
          return kSymmetric[i];
    refusePart(tuple, "component '" + name + "'",
               "its components are " + listComponents(tuple.count()));
  }

  [[noreturn]] static void refusePart(const Tuple& tuple, const std::string& part,
                                      const std::string& why) {
    throw Error(Status::Usage, "", fmt::format("the array '{}' does not have {}", tuple.name, part),
                why);
  }

  void checkLengths(const Tuple& tuple) const {
    const bool points = tuple.on == Attribute::On::Points;
    const std::size_t elements = points ? mesh_.points.size() : mesh_.cellCount;
    for (const Field::Source& part : tuple.parts) {
      const std::size_t numbers =
          std::visit([](const auto& v) { return v.size(); }, part.array->values);
      if (numbers != elements * part.array->components)
        throw Error(Status::Invalid, "array '" + part.array->name + "'",
                    fmt::format("has {} values for {} {} of {} component{}", numbers, elements,
                                onText(tuple.on), part.array->components,
                                part.array->components == 1 ? "" : "s"),
                    "export the file again");
    }
  }

  void finish(Field field) {
    field.turned =
        options_.turnVectors && field.kind == FieldKind::Vector && !isColour(field.array);
    if (field.kind == FieldKind::Integer) {
      for (const NamedRange& range : options_.remap)
        if (range.grid.empty() || range.grid == field.name)
          field.kind = FieldKind::Float;
      if (field.kind == FieldKind::Integer && !fitsInt32(*field.sources.front().array))
        throw Error(Status::Invalid, "array '" + field.array + "'",
                    "has integers beyond 32 bits, which no program reads from a volume",
                    "use `remap=" + field.name + "=0:1`, or leave it out");
    }
    fields_.push_back(std::move(field));
  }

  const TetMesh& mesh_;
  const FieldOptions& options_;
  Report& report_;
  std::vector<Field> fields_;
};

// Whether points and cells belong to a tet: the values of others are arbitrary.
struct InUse {
  std::vector<std::uint8_t> points, cells;

  explicit InUse(const TetMesh& mesh) : points(mesh.points.size()), cells(mesh.cellCount) {
    for (const std::uint32_t point : mesh.tets)
      points[point] = 1;
    for (std::size_t t = 0; t < mesh.tetCount(); ++t)
      cells[mesh.cell(t)] = 1;
  }
};

// Range of derived values at the points or cells themselves.
void measure(Field& field, const InUse& inUse) {
  struct Sum {
    ValueRange range;
    std::size_t bad = 0;
  };
  const auto& used = field.on == Attribute::On::Points ? inUse.points : inUse.cells;
  const std::size_t count = used.size();
  const FieldRule rule = field.rule();
  const Sum sum = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 8192), Sum{},
      [&](const tbb::blocked_range<std::size_t>& range, Sum s) {
        double read[9], value[3];
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (used[i] == 0)
            continue;
          for (std::size_t k = 0; k < field.sources.size(); ++k)
            read[k] = field.sources[k].array->number(i, field.sources[k].component);
          rule.derive(read, value);
          double number = value[0];
          if (field.kind == FieldKind::Vector)
            number = std::sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2]);
          if (std::isfinite(number))
            s.range.add(number);
          else
            ++s.bad;
        }
        return s;
      },
      [](Sum a, const Sum& b) {
        a.range.add(b.range);
        a.bad += b.bad;
        return a;
      });
  field.original = sum.range;
  field.notFinite = sum.bad;
}

// The last applicable entry; entries with the grid's own name precede those for all.
template <typename Entry>
const Entry* entryFor(const std::vector<Entry>& entries, const Field& field) {
  const Entry* found = nullptr;
  for (const Entry& entry : entries)
    if (entry.grid.empty() && field.kind != FieldKind::Vector)
      found = &entry;
  for (const Entry& entry : entries)
    if (entry.grid == field.name)
      found = &entry;
  return found;
}

void setStorage(Field& field, const FieldOptions& options) {
  const bool vector = field.kind == FieldKind::Vector;
  ValueRange from = field.original;
  if (const NamedRange* clamp = entryFor(options.clamp, field)) {
    field.clamp = {clamp->low, clamp->high};
    from = field.clamp;
  }
  if (const NamedRange* remap = entryFor(options.remap, field); remap != nullptr && !from.empty()) {
    if (vector) {
      field.scale = from.high > 0 ? remap->high / from.high : 1;
    } else {
      // A constant becomes the low end of the range.
      field.scale = from.high > from.low ? (remap->high - remap->low) / (from.high - from.low) : 0;
      field.offset = remap->low - field.scale * from.low;
    }
  }
  if (const NamedNumber* background = entryFor(options.background, field))
    field.background = background->value;
}

template <typename Entry>
void requireGrids(const std::vector<Entry>& entries, const char* option,
                  const std::vector<Field>& fields) {
  for (const Entry& entry : entries) {
    if (entry.grid.empty())
      continue;
    const bool known = std::any_of(fields.begin(), fields.end(),
                                   [&](const Field& field) { return field.name == entry.grid; });
    if (known)
      continue;
    std::vector<std::string> names;
    for (const Field& field : fields)
      names.push_back(field.name);
    throw Error(
        Status::Usage, option, "no grid is made of an array and named '" + entry.grid + "'",
        suggestName(entry.grid, names, fmt::format("there are {}", fmt::join(names, ", "))));
  }
}

} // namespace

FieldRule Field::rule() const {
  FieldRule rule;
  rule.kind = kind;
  rule.part = part;
  rule.numbers = static_cast<std::uint8_t>(sources.size());
  rule.turned = turned;
  rule.clamped = !clamp.empty();
  rule.low = clamp.low;
  rule.high = clamp.high;
  rule.scale = scale;
  rule.offset = offset;
  return rule;
}

std::vector<Field> resolveFields(const TetMesh& mesh, const FieldOptions& options, Report& report,
                                 const std::vector<ValueRange>* ranges) {
  std::vector<Field> fields = Resolver(mesh, options, report).run();
  requireGrids(options.clamp, "`clamp`", fields);
  requireGrids(options.remap, "`remap`", fields);
  requireGrids(options.background, "`background`", fields);
  const InUse inUse(mesh);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Field& field = fields[i];
    measure(field, inUse);
    if (field.notFinite > 0)
      report.warn("not-finite",
                  fmt::format("the array '{}' has no finite value at {} {}; voxels that need them "
                              "are left out of '{}'",
                              field.array, field.notFinite, onText(field.on), field.name));
    if (ranges != nullptr)
      field.original = (*ranges)[i];
    setStorage(field, options);
  }
  return fields;
}

std::vector<std::string> arrayNames(const TetMesh& mesh) {
  std::vector<std::string> names;
  for (const Attribute& array : mesh.attributes)
    names.push_back(array.name);
  for (const UnreadArray& array : mesh.unread)
    names.push_back(array.name);
  return names;
}

std::string describeArrays(const TetMesh& mesh) {
  std::string text;
  const auto add = [&](const std::string& name, Attribute::On on, std::uint32_t components) {
    text += text.empty() ? "" : ", ";
    text += fmt::format("'{}' ({}", name, onText(on));
    if (components > 1)
      text += fmt::format(", {} components", components);
    text += ")";
  };
  for (const Attribute& array : mesh.attributes)
    add(array.name, array.on, array.components);
  for (const UnreadArray& array : mesh.unread)
    add(array.name, array.on, array.components);
  return text;
}

} // namespace tetvdb
