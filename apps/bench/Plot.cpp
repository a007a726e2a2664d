// SPDX-License-Identifier: Apache-2.0
#include "Plot.h"

#include "Measure.h"
#include "Table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <vector>

namespace tetvdb::bench {
namespace {

using Json = nlohmann::ordered_json;

// Colours that differ also for the colour-blind (Okabe and Ito, 2008); ours is the first.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#999999", "#e69f00", "#009e73",
                                                "#cc79a7", "#56b4e9", "#d55e00"};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    switch (c) {
    case '<':
      result += "&lt;";
      break;
    case '&':
      result += "&amp;";
      break;
    default:
      result += c;
    }
  return result;
}

/// A logarithmic axis over whole powers of ten.
class Axis {
public:
  Axis(double from, double to) : from_(from), to_(to) {}

  void include(double value) {
    if (value > 0 && std::isfinite(value)) {
      low_ = std::min(low_, static_cast<int>(std::floor(std::log10(value))));
      high_ = std::max(high_, static_cast<int>(std::ceil(std::log10(value))));
    }
  }
  double at(double value) const {
    const double share = (std::log10(value) - low_) / std::max(1, high_ - low_);
    return from_ + std::clamp(share, 0.0, 1.0) * (to_ - from_);
  }
  int low() const { return low_; }
  int high() const { return std::max(high_, low_ + 1); }

private:
  double from_, to_; ///< pixels
  int low_ = std::numeric_limits<int>::max(), high_ = std::numeric_limits<int>::min();
};

std::string secondsName(int power) {
  static const std::array<const char*, 3> units = {" s", " ms", " us"};
  const int unit = std::clamp(-static_cast<int>(std::floor(power / 3.0)), 0, 2);
  return fmt::format("{:g}{}", std::pow(10.0, power + 3 * unit), units[std::size_t(unit)]);
}

std::string powerName(int power) {
  static const std::array<const char*, 7> names = {"1",      "10",      "100",      "1000",
                                                   "10,000", "100,000", "1,000,000"};
  return power >= 0 && power < 7 ? names[std::size_t(power)] : fmt::format("10^{}", power);
}

class Drawing {
public:
  Drawing(int width, int height) {
    text_ =
        fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" "
                    "font-family=\"sans-serif\" font-size=\"12\">\n"
                    "<rect width=\"{}\" height=\"{}\" rx=\"6\" fill=\"white\"/>\n",
                    width, height, width, width, height);
  }
  void line(double x0, double y0, double x1, double y1, const char* color, double width = 1) {
    text_ += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", x0, y0,
        x1, y1, color, width);
  }
  void box(double x, double y, double width, double height, const char* color) {
    text_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x, y,
        width, height, color);
  }
  void dot(double x, double y, const char* color) {
    text_ +=
        fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x, y, color);
  }
  void words(double x, double y, const std::string& text, const char* anchor = "start",
             const char* color = "#222") {
    text_ +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\">{}</text>\n", x,
                    y, anchor, color, escaped(text));
  }
  std::string done() const { return text_ + "</svg>\n"; }

private:
  std::string text_;
};

struct Bar {
  std::string name;
  Times times;
  const char* color;
};

/// Rows of one name: ours once, then every peer.
struct Group {
  std::string name;
  double floor = 0;
  std::vector<Bar> bars;
};

std::vector<Group> groupsOf(const Json& rows) {
  std::vector<Group> groups;
  for (const Json& row : rows) {
    const std::string what = row.at("what");
    if (groups.empty() || groups.back().name != what)
      groups.push_back(
          {what,
           row.at("floor_seconds"),
           {{"TetVDB", {row.at("ours_seconds").get<std::vector<double>>()}, kColors[0]}}});
    const Times peer{row.at("peer_seconds").get<std::vector<double>>()};
    if (!peer.seconds.empty()) {
      Group& group = groups.back();
      group.bars.push_back(
          {row.at("peer"), peer, kColors[std::min(group.bars.size(), kColors.size() - 1)]});
    }
  }
  return groups;
}

std::string bars(const Json& rows) {
  constexpr int kWidth = 760, kLeft = 190, kRight = 80, kTop = 12, kBar = 15, kName = 20, kGap = 10;
  const std::vector<Group> groups = groupsOf(rows);
  Axis axis(kLeft, kWidth - kRight);
  int height = kTop;
  for (const Group& group : groups) {
    height += kName + kBar * static_cast<int>(group.bars.size()) + kGap;
    axis.include(group.floor);
    for (const Bar& bar : group.bars) {
      axis.include(bar.times.min());
      axis.include(bar.times.max());
    }
  }
  Drawing drawing(kWidth, height + 44);
  for (int power = axis.low(); power <= axis.high(); ++power) {
    const double x = axis.at(std::pow(10.0, power));
    drawing.line(x, kTop, x, height, "#ddd");
    drawing.words(x, height + 16, secondsName(power), "middle");
  }
  double y = kTop;
  for (const Group& group : groups) {
    drawing.words(12, y + 14, group.name);
    const double top = y + kName;
    for (std::size_t i = 0; i < group.bars.size(); ++i) {
      const Bar& bar = group.bars[i];
      const double at = top + static_cast<double>(i) * kBar, midpoint = at + kBar / 2.0;
      const double x = axis.at(bar.times.median());
      drawing.words(kLeft - 8, midpoint + 4, bar.name, "end", "#555");
      drawing.box(kLeft, at + 1.5, x - kLeft, kBar - 3, bar.color);
      drawing.line(axis.at(bar.times.min()), midpoint, axis.at(bar.times.max()), midpoint, "#222");
      drawing.words(axis.at(bar.times.max()) + 6, midpoint + 4, duration(bar.times.median()));
    }
    const double bottom = top + kBar * static_cast<double>(group.bars.size());
    if (group.floor > 0)
      drawing.line(axis.at(group.floor), top, axis.at(group.floor), bottom, "#d55e00", 2);
    y = bottom + kGap;
  }
  drawing.words(kWidth / 2.0, height + 36,
                "medians; thin lines: least to greatest; red marks: the floor", "middle", "#555");
  return drawing.done();
}

struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

std::vector<Curve> curvesOf(const Json& rows) {
  std::vector<Curve> curves;
  const auto add = [&](const std::string& name, double at, const Times& times) {
    if (name.empty() || times.seconds.empty())
      return;
    auto found =
        std::find_if(curves.begin(), curves.end(), [&](const Curve& c) { return c.name == name; });
    if (found == curves.end())
      found = curves.insert(curves.end(), {name, {}});
    const std::pair<double, double> point(at, times.median());
    if (std::find(found->points.begin(), found->points.end(), point) == found->points.end())
      found->points.push_back(point);
  };
  for (const Json& row : rows) {
    add(row.at("curve"), row.at("at"), {row.at("ours_seconds").get<std::vector<double>>()});
    add(row.at("peer_curve"), row.at("at"), {row.at("peer_seconds").get<std::vector<double>>()});
  }
  for (Curve& curve : curves)
    std::sort(curve.points.begin(), curve.points.end());
  return curves;
}

std::string curves(const Json& rows, const std::string& along) {
  constexpr int kWidth = 760, kHeight = 440, kLeft = 70, kRight = 190, kTop = 16, kBottom = 56;
  const std::vector<Curve> all = curvesOf(rows);
  Axis x(kLeft, kWidth - kRight), y(kHeight - kBottom, kTop);
  for (const Curve& curve : all)
    for (const auto& [at, seconds] : curve.points) {
      x.include(at);
      y.include(seconds);
    }
  Drawing drawing(kWidth, kHeight);
  for (int power = x.low(); power <= x.high(); ++power) {
    const double at = x.at(std::pow(10.0, power));
    drawing.line(at, kTop, at, kHeight - kBottom, "#ddd");
    drawing.words(at, kHeight - kBottom + 18, powerName(power), "middle");
  }
  for (int power = y.low(); power <= y.high(); ++power) {
    const double at = y.at(std::pow(10.0, power));
    drawing.line(kLeft, at, kWidth - kRight, at, "#ddd");
    drawing.words(kLeft - 8, at + 4, secondsName(power), "end");
  }
  // Names beside the curves' ends, none on another.
  std::vector<std::size_t> order(all.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return y.at(all[a].points.back().second) < y.at(all[b].points.back().second);
  });
  double below = kTop;
  for (const std::size_t i : order) {
    const Curve& curve = all[i];
    const char* color = kColors[i % kColors.size()];
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
      const auto& [at, seconds] = curve.points[k];
      drawing.dot(x.at(at), y.at(seconds), color);
      if (k > 0)
        drawing.line(x.at(curve.points[k - 1].first), y.at(curve.points[k - 1].second), x.at(at),
                     y.at(seconds), color, 2);
    }
    const double at = std::max(below, y.at(curve.points.back().second) + 4);
    drawing.words(x.at(curve.points.back().first) + 10, at, curve.name, "start", color);
    below = at + 15;
  }
  drawing.words((kLeft + kWidth - kRight) / 2.0, kHeight - 12, along, "middle", "#555");
  return drawing.done();
}

} // namespace

std::string plot(const Json& entry) {
  const Json& rows = entry.at("rows");
  if (rows.empty())
    return "";
  const std::string along = entry.at("along");
  return along.empty() ? bars(rows) : curves(rows, along);
}

} // namespace tetvdb::bench
