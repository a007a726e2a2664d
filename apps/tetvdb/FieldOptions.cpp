// SPDX-License-Identifier: Apache-2.0
#include "FieldOptions.h"

#include "Commands.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace tetvdb::cli {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& advice) {
  throw Error(Status::Usage, option, "'" + text + "' cannot be used", advice);
}

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

void addFieldOptions(CLI::App& command, FieldTexts& texts) {
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* type,
                        const char* about) {
    command.add_option(name, values, about)
        ->type_name(type)
        ->delimiter(',')
        ->allow_extra_args(false);
  };
  list("--derive", texts.derive, "NAME=ARRAY:PART",
       "Grids made of arrays: magnitude, mises, trace, determinant, principal1..3, or a component "
       "such as x, xx, 0; NAME=ARRAY alone gives another name");
  list("--remap", texts.remap, "[NAME=]A:B",
       "Map an array's range (that of --clamp, where given) to A:B; of all grids of single numbers "
       "made of arrays, or of one");
  list("--clamp", texts.clamp, "[NAME=]A:B", "Bound an array's values, before --remap");
  list("--background", texts.background, "[NAME=]V",
       "Value outside the mesh of grids made of arrays (default 0)");
  command
      .add_option("--warp", texts.warp,
                  "Move points by a vector array, times a factor, before voxelizing")
      ->type_name("ARRAY[*F]")
      ->check(notEmpty());
}

FieldRequest parseDerived(const std::string& text) {
  const std::string advice = "give NAME=ARRAY:PART, such as speed=vel:magnitude";
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse("--derive", text, advice);
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

void setFields(const FieldTexts& texts, FieldOptions& options) {
  for (const std::string& text : texts.derive)
    options.requests.push_back(parseDerived(text));
  for (const std::string& text : texts.remap)
    options.remap.push_back(parseRange("--remap", text));
  for (const std::string& text : texts.clamp) {
    options.clamp.push_back(parseRange("--clamp", text));
    if (options.clamp.back().low > options.clamp.back().high)
      refuse("--clamp", text, "give the lower number first");
  }
  for (const std::string& text : texts.background) {
    std::string_view left = text;
    NamedNumber number;
    number.grid = takeName(left);
    number.value =
        numberOf(left, "--background", text, "give a finite number, such as 0 or temperature=293");
    options.background.push_back(number);
  }
  const bool any = !texts.remap.empty() || !texts.clamp.empty() || !texts.background.empty();
  if (any && options.empty())
    throw Error(Status::Usage,
                !texts.remap.empty()   ? "--remap"
                : !texts.clamp.empty() ? "--clamp"
                                       : "--background",
                "is for grids made of arrays, and none is asked for",
                "name arrays with --grid or --derive");
}

Warp parseWarp(const std::string& text) {
  Warp warp;
  const auto star = text.rfind('*');
  warp.array = text.substr(0, star);
  if (star != std::string::npos)
    warp.factor = numberOf(std::string_view(text).substr(star + 1), "--warp", text,
                           "give an array and a finite factor, such as disp*2");
  if (warp.array.empty())
    refuse("--warp", text, "give an array and a factor, such as disp*2");
  return warp;
}

} // namespace tetvdb::cli
