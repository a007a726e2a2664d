// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Legend.h"

#include "tetvdb/visualize/Text.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tetvdb {
namespace {

constexpr int kTickCount = 6;
constexpr std::size_t kLongestName = 24; // letters

struct Sizes {
  int dot, line, margin, bar;

  explicit Sizes(int pictureHeight)
      : dot(textScale(pictureHeight)), line(textHeight(dot) + 3 * dot), margin(8 * dot),
        bar(14 * dot) {}
};

std::string cutShort(const std::string& name) {
  return name.size() <= kLongestName ? name : name.substr(0, kLongestName - 2) + "..";
}

std::string nameOf(const ColorScale& scale, std::size_t kind) {
  return cutShort(scale.kinds[kind]);
}

int widestEntry(const ColorScale& scale, int dot) {
  int widest = 0;
  if (scale.map == nullptr)
    for (std::size_t kind = 0; kind < scale.kinds.size(); ++kind)
      widest = std::max(widest, textWidth(nameOf(scale, kind), dot));
  else
    for (const double tick : ticks(scale, kTickCount))
      widest = std::max(widest, textWidth(tickText(tick), dot));
  return widest;
}

void fill(Image& image, int left, int right, int top, int bottom, const Pixel& color) {
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      image.draw(x, y, color);
}

void drawKinds(Image& image, const ColorScale& scale, const Pixel& ink, const Sizes& sizes,
               LegendPlaces& places) {
  const auto room =
      static_cast<std::size_t>(std::max(1, (places.barBottom - places.barTop) / sizes.line));
  const std::size_t count = scale.kinds.size();
  const std::size_t shown = count <= room ? count : room - 1;
  int y = places.barTop;
  for (std::size_t kind = 0; kind < shown; ++kind, y += sizes.line) {
    fill(image, places.barLeft, places.barRight, y, y + capitalHeight(sizes.dot),
         opaque(scale(static_cast<double>(kind))));
    drawText(image, places.barRight + 4 * sizes.dot, y, nameOf(scale, kind), ink, sizes.dot);
  }
  if (shown < count)
    drawText(image, places.barLeft, y, "and " + std::to_string(count - shown) + " more", ink,
             sizes.dot);
}

} // namespace

int legendWidth(const ColorScale& scale, int pictureHeight) {
  const Sizes sizes(pictureHeight);
  const int entry = sizes.bar + 4 * sizes.dot + widestEntry(scale, sizes.dot);
  return 2 * sizes.margin + std::max(entry, textWidth(cutShort(scale.title), sizes.dot));
}

LegendPlaces drawLegend(Image& image, const ColorScale& scale, const Pixel& ink) {
  const Sizes sizes(image.height);
  const int left = image.width - legendWidth(scale, image.height) + sizes.margin;
  LegendPlaces places;
  places.barLeft = left;
  places.barRight = left + sizes.bar;
  places.barTop = sizes.margin + 2 * sizes.line;
  places.barBottom = std::max(places.barTop + 2, image.height - sizes.margin - sizes.line);
  drawText(image, left, sizes.margin, cutShort(scale.title), ink, sizes.dot);
  if (scale.map == nullptr) {
    drawKinds(image, scale, ink, sizes, places);
    return places;
  }

  // A row of the bar shows the value at its centre; the first and last rows are high and low.
  const int rows = places.barBottom - places.barTop;
  for (int row = 0; row < rows; ++row) {
    const double t = 1 - static_cast<double>(row) / (rows - 1);
    fill(image, places.barLeft, places.barRight, places.barTop + row, places.barTop + row + 1,
         opaque((*scale.map)(t)));
  }
  for (const double tick : ticks(scale, kTickCount)) {
    const double t = std::clamp(scale.position(tick), 0.0, 1.0);
    const int row = places.barTop + static_cast<int>(std::lround((1 - t) * (rows - 1)));
    places.ticks.push_back(tick);
    places.tickRows.push_back(row);
    fill(image, places.barRight, places.barRight + 2 * sizes.dot, row, row + 1, ink);
    drawText(image, places.barRight + 4 * sizes.dot, row - capitalHeight(sizes.dot) / 2,
             tickText(tick), ink, sizes.dot);
  }
  return places;
}

Pixel inkOn(const Pixel& background) {
  // Luminance of the background over white; mid grey is at 0.18.
  const float rest = 1 - background.alpha;
  const float luminance = 0.2126F * (background.red + rest) + 0.7152F * (background.green + rest) +
                          0.0722F * (background.blue + rest);
  return luminance > 0.18F ? Pixel{0.02F, 0.02F, 0.02F, 1} : Pixel{0.9F, 0.9F, 0.9F, 1};
}

} // namespace tetvdb
