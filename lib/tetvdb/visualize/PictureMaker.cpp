// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/PictureMaker.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/Legend.h"
#include "tetvdb/visualize/Text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tetvdb {
namespace {

constexpr int kCellWidth = 640, kCellHeight = 480, kSmallestCell = 16;
constexpr std::size_t kMaxPixels = std::size_t(1) << 28;

CutPlane planeOf(const Cut& cut, const Box& box, const View& view) {
  CutPlane plane;
  const double sign = view.toEye[cut.axis] < 0 ? -1 : 1;
  plane.normal = {0, 0, 0};
  plane.normal[cut.axis] = sign;
  const double low = box.low[cut.axis], high = box.high[cut.axis];
  plane.offset = sign * (cut.inUnits ? cut.at : low + cut.at * (high - low));
  return plane;
}

// Values that one legend can speak for.
bool areAlike(const ColorScale& a, const ColorScale& b) {
  return a.title == b.title && a.kinds == b.kinds && a.logarithmic == b.logarithmic;
}

} // namespace

PictureMaker::PictureMaker(std::vector<CaptionedSubject> subjects, const PictureOptions& options,
                           Progress& progress)
    : options_(options), view_(viewNamed(options.view, options.worldUp)) {
  if (subjects.empty())
    throw Error(Status::Usage, "", "there is nothing to draw");
  chooseScale(subjects);
  columns_ = static_cast<int>(subjects.size());
  if (columns_ > 4)
    columns_ = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(subjects.size()))));
  rows_ = (static_cast<int>(subjects.size()) + columns_ - 1) / columns_;
  arrange();
  for (CaptionedSubject& subject : subjects) {
    progress.check();
    std::optional<CutPlane> plane;
    if (options_.cut)
      plane = planeOf(*options_.cut, subject.subject->bounds(), view_);
    drawn_.push_back(subject.subject->draw(scale_ ? &*scale_ : nullptr, plane, progress));
    subject.subject.reset();
    Scene scene;
    scene.drawables = drawn_.back().drawables;
    scene.media = drawn_.back().media;
    scenes_.push_back(std::move(scene));
    captions_.push_back(std::move(subject.caption));
  }
  findFraming();
}

void PictureMaker::chooseScale(const std::vector<CaptionedSubject>& subjects) {
  for (const CaptionedSubject& subject : subjects) {
    const std::optional<ColorScale> own = subject.subject->scale();
    if (!own)
      continue;
    if (!scale_) {
      scale_ = own;
      continue;
    }
    if (!areAlike(*scale_, *own))
      throw Error(Status::Usage, subject.caption,
                  "its values (" + own->title + ") do not share colours with those of the others",
                  "make a picture of each");
    scale_->low = std::min(scale_->low, own->low);
    scale_->high = std::max(scale_->high, own->high);
  }
  const ColorMap* map = options_.colorMap.empty() ? nullptr : &ColorMap::named(options_.colorMap);
  if (!scale_) {
    if (options_.range)
      throw Error(Status::Usage, "range", "there are no values with colours");
    return;
  }
  if (!scale_->kinds.empty()) {
    if (options_.range)
      throw Error(Status::Usage, "range", "kinds have no range");
    return;
  }
  if (map != nullptr)
    scale_->map = map;
  if (options_.range) {
    scale_->low = (*options_.range)[0];
    scale_->high = (*options_.range)[1];
    if (!(scale_->low < scale_->high) || !std::isfinite(scale_->high - scale_->low))
      throw Error(Status::Usage, "range", "must go from a number to a higher one");
    if (scale_->logarithmic && !(scale_->low > 0))
      throw Error(Status::Usage, "range", "must be above zero: the scale is logarithmic");
  }
}

// The legend has a column of its own at the right edge.
void PictureMaker::arrange() {
  width_ = options_.width > 0 ? options_.width : kCellWidth * columns_;
  height_ = options_.height > 0 ? options_.height : kCellHeight * rows_;
  if (static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) > kMaxPixels)
    throw Error(Status::Limit, "",
                "a picture of " + std::to_string(width_) + " x " + std::to_string(height_) +
                    " pixels is too large");
  const int strip = scale_ ? legendWidth(*scale_, height_) : 0;
  cellWidth_ = (width_ - strip) / columns_;
  cellHeight_ = height_ / rows_;
  if (cellWidth_ < kSmallestCell || cellHeight_ < kSmallestCell)
    throw Error(Status::Usage, "",
                "a picture of " + std::to_string(width_) + " x " + std::to_string(height_) +
                    " pixels has no room for what is to be in it",
                "give a larger `size`");
}

// All pictures have the largest span of any: one scale.
void PictureMaker::findFraming() {
  double span = 0;
  for (const Scene& scene : scenes_) {
    framings_.push_back(options_.turntable > 1 ? framingOfTurn(scene)
                                               : frame(view_, options_.lens, cellWidth_,
                                                       cellHeight_, scene.support()));
    span = std::max(span, framings_.back().span);
  }
  for (Framing& framing : framings_)
    framing.span = span;
}

// A thing that turns keeps its middle in place, else it would sway, and fits in every picture.
Framing PictureMaker::framingOfTurn(const Scene& scene) const {
  const Box box = scene.bounds();
  Framing whole;
  for (std::size_t axis = 0; axis < 3; ++axis)
    whole.target[axis] = box.low[axis] / 2 + box.high[axis] / 2;
  whole.span = whole.reach = 0;
  for (std::size_t i = 0; i < options_.turntable; ++i) {
    const View view =
        turned(view_, 2 * kPi * static_cast<double>(i) / static_cast<double>(options_.turntable));
    const Framing own = frame(view, options_.lens, cellWidth_, cellHeight_, scene.support());
    const Vec3d off = minus(own.target, whole.target);
    const double aside = std::max(std::abs(dot(off, view.right)), std::abs(dot(off, view.up)));
    const double behind = std::abs(dot(off, view.toEye));
    whole.span = std::max(whole.span, own.span + 2 * aside);
    whole.reach = std::max(whole.reach, own.reach + behind);
    if (options_.lens.perspective) // the same angle at another distance
      whole.span = std::max(whole.span, own.span + 2 * (aside + behind));
  }
  return whole;
}

Image PictureMaker::take(double turn, Progress& progress) const {
  const View view = turned(view_, 2 * kPi * turn);
  Image picture(width_, height_);
  for (int y = 0; y < height_; ++y) {
    const float down = (static_cast<float>(y) + 0.5F) / static_cast<float>(height_);
    const Pixel top = scaled(options_.backgroundTop, 1 - down);
    const Pixel bottom = scaled(options_.backgroundBottom, down);
    const Pixel row = {top.red + bottom.red, top.green + bottom.green, top.blue + bottom.blue,
                       top.alpha + bottom.alpha};
    std::fill_n(&picture.at(0, y), width_, row);
  }
  const Pixel ink = inkOn(options_.backgroundTop);
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const Camera camera(view, options_.lens, framings_[i], cellWidth_, cellHeight_);
    const Image cell = render(scenes_[i], camera, options_.render, progress);
    const int left = static_cast<int>(i) % columns_ * cellWidth_;
    const int top = static_cast<int>(i) / columns_ * cellHeight_;
    for (int y = 0; y < cell.height; ++y)
      for (int x = 0; x < cell.width; ++x)
        picture.draw(left + x, top + y, cell.at(x, y));
    if (scenes_.size() > 1 || options_.captions) {
      const int dot = textScale(cellHeight_);
      drawText(picture, left + 8 * dot, top + 8 * dot,
               shortened(captions_[i], cellWidth_ - 16 * dot, dot), ink, dot);
    }
  }
  if (scale_)
    drawLegend(picture, *scale_, ink);
  return picture;
}

} // namespace tetvdb
