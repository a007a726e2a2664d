// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/FieldRequest.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::array<std::pair<std::string_view, FieldPart>, 7> kParts = {
    {{"magnitude", FieldPart::Magnitude},
     {"mises", FieldPart::Mises},
     {"trace", FieldPart::Trace},
     {"determinant", FieldPart::Determinant},
     {"principal1", FieldPart::Principal1},
     {"principal2", FieldPart::Principal2},
     {"principal3", FieldPart::Principal3}}};

// x, y, z, xx to zz, or one or two digits.
bool isComponent(std::string_view text) {
  const auto all = [&](auto is) { return std::all_of(text.begin(), text.end(), is); };
  if (text.empty() || text.size() > 2)
    return false;
  return all([](char c) { return c >= 'x' && c <= 'z'; }) ||
         all([](char c) { return c >= '0' && c <= '9'; });
}

} // namespace

bool readPart(std::string_view text, FieldRequest& request) {
  for (const auto& [name, part] : kParts)
    if (text == name) {
      request.part = part;
      return true;
    }
  if (!isComponent(text))
    return false;
  request.part = FieldPart::Component;
  request.component = text;
  return true;
}

} // namespace tetvdb
