// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/PrintPicture.h"

#include "tetvdb/visualize/LineDrawable.h"
#include "tetvdb/visualize/Renderer.h"
#include "tetvdb/visualize/Text.h"
#include "tetvdb/visualize/TriangleDrawable.h"

#include <array>
#include <cstddef>
#include <fmt/format.h>
#include <memory>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kPanelWidth = 760, kPanelHeight = 700, kFoot = 60;
constexpr double kLinePixels = 2.5;
constexpr float kHidden = 0.45F; // opacity of lines behind the model
constexpr std::size_t kMarked = 200;

// By fault; distinct from one another and from the model's grey.
constexpr std::array<Rgb, kPrintFaults> kColors = {{{0.02F, 0.02F, 0.02F},
                                                    {0.02F, 0.02F, 0.02F},
                                                    {0.80F, 0.02F, 0.02F},
                                                    {0.85F, 0.32F, 0.00F},
                                                    {0.02F, 0.15F, 0.80F},
                                                    {0.45F, 0.02F, 0.55F},
                                                    {0.00F, 0.42F, 0.55F},
                                                    {0.55F, 0.42F, 0.00F},
                                                    {0.00F, 0.40F, 0.08F},
                                                    {0.35F, 0.12F, 0.02F}}};

void addBox(const Vec3d& low, const Vec3d& high, const Rgb& color, std::vector<Line>& lines) {
  const auto corner = [&](std::size_t i) {
    return Vec3d{(i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2]};
  };
  for (std::size_t i = 0; i < 8; ++i)
    for (const std::size_t axis : {std::size_t(1), std::size_t(2), std::size_t(4)})
      if ((i & axis) == 0)
        lines.push_back({corner(i), corner(i | axis), color});
}

std::vector<Line> marksOf(const CheckPrintResult& result) {
  std::array<std::size_t, kPrintFaults> marked{};
  std::vector<Line> lines;
  for (std::size_t i = 0; i < result.checks.findings.size(); ++i) {
    const auto fault = static_cast<std::size_t>(result.checks.findings[i].fault);
    if (++marked[fault] <= kMarked)
      addBox(result.places[i].low, result.places[i].high, kColors[fault], lines);
  }
  return lines;
}

Image panel(const Scene& both, const Scene& marks, const char* view, Progress& progress) {
  const View from = viewNamed(view);
  const Camera camera(from, {}, frame(from, {}, kPanelWidth, kPanelHeight, both.support()),
                      kPanelWidth, kPanelHeight);
  Image image = render(both, camera, {}, progress);
  if (marks.drawables.empty())
    return image;
  const Image hidden = render(marks, camera, {}, progress);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.draw(x, y, scaled(hidden.at(x, y), kHidden));
  return image;
}

// Lists the kinds of findings, each in its colour.
void drawKinds(const CheckPrintResult& result, Image& image) {
  std::array<std::size_t, kPrintFaults> counts{};
  for (const PrintFinding& finding : result.checks.findings)
    ++counts[static_cast<std::size_t>(finding.fault)];
  constexpr int scale = 2;
  const int top = image.height - kFoot / 2 - textHeight(scale) / 2;
  int left = kFoot / 2;
  for (std::size_t i = 0; i < kPrintFaults; ++i) {
    if (counts[i] == 0)
      continue;
    const std::string text = fmt::format("{}: {}", nameOf(static_cast<PrintFault>(i)), counts[i]);
    drawText(image, left, top, text, opaque(kColors[i]), scale);
    left += textWidth(text, scale) + kFoot / 2;
  }
  if (left == kFoot / 2)
    drawText(image, left, top, "nothing found", opaque(kColors[0]), scale);
}

} // namespace

Image printPicture(TriangleMesh mesh, const CheckPrintResult& result, Progress& progress) {
  TriangleLook look;
  Scene both, marks;
  both.backgroundTop = {0.74F, 0.79F, 0.86F, 1};
  both.backgroundBottom = {0.98F, 0.98F, 0.98F, 1};
  both.drawables.push_back(
      std::make_shared<TriangleDrawable>(std::move(mesh), std::move(look), progress));
  std::vector<Line> lines = marksOf(result);
  if (!lines.empty()) {
    marks.drawables.push_back(std::make_shared<LineDrawable>(std::move(lines), kLinePixels));
    both.drawables.push_back(marks.drawables.front());
  }
  Image image(2 * kPanelWidth, kPanelHeight + kFoot, {0.98F, 0.98F, 0.98F, 1});
  image.paste(panel(both, marks, "iso", progress), 0, 0);
  image.paste(panel(both, marks, "1,-1,-0.8", progress), kPanelWidth, 0);
  drawKinds(result, image);
  return image;
}

} // namespace tetvdb
