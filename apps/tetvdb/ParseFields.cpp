// SPDX-License-Identifier: Apache-2.0
#include "ParseFields.h"

#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace tetvdb::cli {
namespace {

double numberOf(std::string_view digits, const std::string& option, const std::string& text,
                const std::string& advice) {
  if (!digits.empty() && digits.front() == '+')
    digits.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(number))
    refuse(option, text, advice);
  return number;
}

// "NAME=" off the front; names may have '=' in them, values not.
std::string takeName(std::string_view& text) {
  const auto equals = text.rfind('=');
  if (equals == std::string_view::npos)
    return {};
  std::string name(text.substr(0, equals));
  text.remove_prefix(equals + 1);
  return name;
}

NamedRange parseRange(const std::string& option, const std::string& text) {
  const std::string advice = "give two finite numbers, such as 0:1 or temperature=0:1";
  std::string_view left = text;
  NamedRange range;
  range.grid = takeName(left);
  const auto colon = left.find(':');
  if (colon == std::string_view::npos)
    refuse(option, text, advice);
  range.low = numberOf(left.substr(0, colon), option, text, advice);
  range.high = numberOf(left.substr(colon + 1), option, text, advice);
  return range;
}

} // namespace

FieldRequest parseDerived(const std::string& option, const std::string& text) {
  const std::string advice = "give NAME=ARRAY:PART, such as speed=vel:magnitude";
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse(option, text, advice);
  FieldRequest request;
  request.grid = text.substr(0, equals);
  request.array = text.substr(equals + 1);
  const auto colon = request.array.rfind(':');
  if (colon == std::string::npos || colon == 0)
    return request;
  const std::string array = request.array.substr(0, colon), part = request.array.substr(colon + 1);
  if (array == "points" || array == "cells")
    return request;
  if (readPart(part, request))
    request.array = array;
  return request;
}

void setFields(const FieldTexts& texts, SettingName nameOf, FieldOptions& options) {
  for (const std::string& text : texts.derive)
    options.requests.push_back(parseDerived(nameOf("derive"), text));
  for (const std::string& text : texts.remap)
    options.remap.push_back(parseRange(nameOf("remap"), text));
  for (const std::string& text : texts.clamp) {
    options.clamp.push_back(parseRange(nameOf("clamp"), text));
    if (options.clamp.back().low > options.clamp.back().high)
      refuse(nameOf("clamp"), text, "give the lower number first");
  }
  for (const std::string& text : texts.background) {
    std::string_view left = text;
    NamedNumber number;
    number.grid = takeName(left);
    number.value = numberOf(left, nameOf("background"), text,
                            "give a finite number, such as 0 or temperature=293");
    options.background.push_back(number);
  }
  const bool any = !texts.remap.empty() || !texts.clamp.empty() || !texts.background.empty();
  if (any && options.empty())
    throw Error(Status::Usage,
                nameOf(!texts.remap.empty()   ? "remap"
                       : !texts.clamp.empty() ? "clamp"
                                              : "background"),
                "is for grids made of arrays, and none is asked for",
                "name arrays with `grid` or `derive`");
}

Warp parseWarp(const std::string& option, const std::string& text) {
  Warp warp;
  const auto star = text.rfind('*');
  warp.array = text.substr(0, star);
  if (star != std::string::npos)
    warp.factor = numberOf(std::string_view(text).substr(star + 1), option, text,
                           "give an array and a finite factor, such as disp*2");
  if (warp.array.empty())
    refuse(option, text, "give an array and a factor, such as disp*2");
  return warp;
}

} // namespace tetvdb::cli
