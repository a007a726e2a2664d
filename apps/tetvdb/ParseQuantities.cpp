// SPDX-License-Identifier: Apache-2.0
#include "ParseQuantities.h"

#include "tetvdb/core/Error.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace tetvdb::cli {
namespace {

// The number that `text` begins with, and what is left; false where there is none.
bool takeNumber(std::string_view& text, double& number) {
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+')
    digits.remove_prefix(1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc())
    return false;
  digits.remove_prefix(static_cast<std::size_t>(end - digits.data()));
  text = digits;
  return true;
}

} // namespace

void refuse(const std::string& option, const std::string& text, const std::string& advice) {
  throw Error(Status::Usage, option, "'" + text + "' cannot be used", advice);
}

std::vector<double> parseNumbers(const std::string& option, const std::string& text) {
  std::vector<double> numbers;
  std::string_view left = text;
  while (true) {
    double number = 0;
    if (!takeNumber(left, number) || std::isnan(number))
      refuse(option, text, "give numbers with commas between them, without spaces");
    numbers.push_back(number);
    if (left.empty())
      return numbers;
    if (left.front() != ',')
      refuse(option, text, "give numbers with commas between them, without spaces");
    left.remove_prefix(1);
  }
}

Vec3d parsePoint(const std::string& option, const std::string& text) {
  const std::vector<double> numbers = parseNumbers(option, text);
  if (numbers.size() != 3)
    refuse(option, text, "give three numbers: X,Y,Z");
  for (const double number : numbers)
    if (!std::isfinite(number))
      refuse(option, text, "give three finite numbers: X,Y,Z");
  return {numbers[0], numbers[1], numbers[2]};
}

Vec3d parseVoxelSize(const std::string& option, const std::string& text) {
  const std::vector<double> numbers = parseNumbers(option, text);
  if (numbers.size() != 1 && numbers.size() != 3)
    refuse(option, text, "give one length, or three: HX,HY,HZ");
  for (const double number : numbers)
    if (!std::isfinite(number) || number <= 0)
      refuse(option, text, "a voxel's side must be above zero, in the input's units");
  if (numbers.size() == 1)
    return {numbers[0], numbers[0], numbers[0]};
  return {numbers[0], numbers[1], numbers[2]};
}

std::size_t parseBytes(const std::string& option, const std::string& text) {
  const std::string advice = "give a size such as 500M or 4G";
  std::string_view left = text;
  double number = 0;
  if (!takeNumber(left, number))
    refuse(option, text, advice);
  if (!left.empty()) {
    const std::string_view units = "KMGT";
    const auto power =
        units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(left.front()))));
    if (power == std::string_view::npos)
      refuse(option, text, advice);
    left.remove_prefix(1);
    if (!left.empty() && left != "B" && left != "iB")
      refuse(option, text, advice);
    number = std::ldexp(number, 10 * (static_cast<int>(power) + 1));
  }
  if (!(number >= 1) || number >= std::ldexp(1.0, 63))
    refuse(option, text, advice);
  return static_cast<std::size_t>(number);
}

double parseLength(const std::string& option, const std::string& text) {
  const std::vector<double> numbers = parseNumbers(option, text);
  if (numbers.size() != 1 || !(numbers[0] > 0) || !std::isfinite(numbers[0]))
    throw Error(Status::Usage, option, "'" + text + "' is not a length",
                "give a number above zero");
  return numbers[0];
}

RelativeLength parseRelativeLength(const std::string& option, const std::string& text,
                                   Voxels voxels) {
  const std::string advice =
      voxels == Voxels::Known
          ? "give a number above zero: a length, a share of the diagonal (1e-3d) or voxels (0.5v)"
          : "give a number above zero: a length, or a share of the diagonal (1e-3d)";
  std::string_view left = text;
  RelativeLength length;
  if (!takeNumber(left, length.value) || !(length.value > 0) || !std::isfinite(length.value))
    refuse(option, text, advice);
  if (left == "d")
    length.unit = RelativeLength::Unit::Diagonal;
  else if (left == "v" && voxels == Voxels::Known)
    length.unit = RelativeLength::Unit::Voxel;
  else if (!left.empty())
    refuse(option, text, advice);
  return length;
}

InsideRule parseInsideRule(const std::string& name) {
  if (name == "nonzero")
    return InsideRule::NonZero;
  if (name == "parity")
    return InsideRule::Parity;
  return name == "flood" ? InsideRule::Flood : InsideRule::Winding;
}

Mesher parseMesher(const std::string& name) {
  for (const Mesher mesher : {Mesher::Envelope, Mesher::Winding})
    if (name == nameOf(mesher))
      return mesher;
  return Mesher::Auto;
}

double parseSeconds(const std::string& option, const std::string& text) {
  std::string_view left = text;
  double number = 0;
  if (!takeNumber(left, number) || !left.empty() || !(number > 0))
    refuse(option, text, "give a number of seconds above zero");
  return number;
}

DeviceChoice parseDevice(const std::string& option, const std::string& text) {
  if (text == "auto")
    return {DeviceKind::Auto, {0}};
  if (text == "cpu")
    return {DeviceKind::Cpu, {}};
  if (text == "cuda")
    return {DeviceKind::Cuda, {0}};
  const auto refuse = [&](const std::string& why) {
    throw Error(Status::Usage, option, "'" + text + "' " + why,
                "name one of auto, cpu, cuda, cuda:N and cuda:N,M,...");
  };
  if (text.substr(0, 5) != "cuda:")
    refuse("is no device");
  DeviceChoice choice{DeviceKind::Cuda, {}};
  for (std::size_t begin = 5; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string digits = text.substr(begin, end - begin);
    if (digits.empty() || digits.size() > 3 ||
        digits.find_first_not_of("0123456789") != std::string::npos)
      refuse("is no device");
    const int number = std::stoi(digits);
    if (std::find(choice.numbers.begin(), choice.numbers.end(), number) != choice.numbers.end())
      refuse("names a device twice");
    choice.numbers.push_back(number);
    begin = end + 1;
  }
  return choice;
}

std::optional<FrameRange> parseFrames(const std::string& option, const std::string& text) {
  if (text.empty())
    return {};
  FrameRange range;
  if (text == "all")
    return range;
  const auto refuse = [&] {
    throw Error(Status::Usage, option, "'" + text + "' cannot be used",
                "give all, FIRST:LAST or FIRST:LAST:STRIDE, counted from 1");
  };
  std::size_t* const places[3] = {&range.first, &range.last, &range.stride};
  std::string_view left = text;
  std::size_t place = 0;
  while (true) {
    const std::string_view digits = left.substr(0, left.find(':'));
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), *places[place]);
    const bool leftOut = place == 1 && digits.empty();
    if (!leftOut &&
        (error != std::errc() || end != digits.data() + digits.size() || *places[place] == 0))
      refuse();
    if (digits.size() == left.size())
      break;
    left.remove_prefix(digits.size() + 1);
    if (++place == 3)
      refuse();
  }
  if (place == 0) // one frame
    range.last = range.first;
  return range;
}

} // namespace tetvdb::cli
