// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Renderer.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/EntryMap.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kTile = 16;

// Where rays go through a pixel, in parts of 1/32 of its side: all sixteen have a row, a column and
// a cell of 4 x 4 to themselves, the first four likewise in 2 x 2, with their mean in the centre.
// Found by trying scrambles of a (0,2)-sequence for the largest distances.
constexpr std::uint32_t kFew = 4, kMany = 16;
constexpr std::array<std::array<int, 2>, kMany> kPlaces = {{{7, 27},
                                                            {25, 5},
                                                            {9, 11},
                                                            {23, 21},
                                                            {3, 3},
                                                            {31, 29},
                                                            {15, 19},
                                                            {17, 13},
                                                            {5, 15},
                                                            {27, 17},
                                                            {11, 31},
                                                            {21, 1},
                                                            {1, 23},
                                                            {29, 9},
                                                            {13, 7},
                                                            {19, 25}}};

// Pixels of a block of kBlock x kBlock share one sequence of places in the sky, each with a run of
// it: together they cover the sky as evenly as one pixel with all of their rays would, and the
// error after smoothing is far smaller than with independent random rays.
constexpr int kBlock = 4;
constexpr std::uint32_t kBlockPixels = kBlock * kBlock;
// Further samples of a pixel are traced to the sky where fewer pixels than this share its surface.
constexpr double kCompany = 32;

// The number of a pixel within its block. Bits of x and y alternate, so that also 2 x 2 of them
// have an aligned run.
std::uint32_t placeInBlock(int x, int y) {
  const auto i = static_cast<std::uint32_t>(x), j = static_cast<std::uint32_t>(y);
  return (i & 1) | (j & 1) << 1 | (i & 2) << 1 | (j & 2) << 2;
}

// Contrasts, in parts of 255 of a display's range, below which a pixel is not refined.
constexpr int kMinContrast = 8;

// Pixels up to this far apart share their light from the sky.
constexpr int kSmoothing = 3;

// What has been gathered about a pixel besides its other light, which is in the image.
struct Gathered {
  Rgb sky{0, 0, 0};                     ///< if nothing hid it
  float visible = 1;                    ///< the share of it that was found open
  std::array<float, 3> normal{0, 0, 0}; ///< the mean; zero where nothing was hit
  float depth = 0;
  std::uint8_t contrast = 0; ///< within the pixel
  std::uint8_t hits = 0;     ///< samples that hit something: normal and depth are their means
};

// Perceived brightness: close to sRGB.
float perceived(float light) {
  return std::sqrt(std::clamp(light, 0.0F, 1.0F));
}

class Picture {
public:
  Picture(const Scene& scene, const Camera& camera, const RenderOptions& options,
          Progress& progress)
      : camera_(camera), options_(options), progress_(progress),
        lights_(scene, camera.view(), options.lighting), image_(camera.width(), camera.height()),
        gathered_(image_.pixels.size()) {
    markEntries(scene);
    const auto rows = static_cast<float>(camera.height());
    for (int y = 0; y < camera.height(); ++y) {
      const float down = (static_cast<float>(y) + 0.5F) / rows;
      Pixel bottom = scaled(scene.backgroundBottom, down);
      const Pixel top = scaled(scene.backgroundTop, 1 - down);
      background_.push_back({top.red + bottom.red, top.green + bottom.green, top.blue + bottom.blue,
                             top.alpha + bottom.alpha});
    }
  }

  Image run() {
    eachPixel(0, 0.6, [this](int x, int y) { gather(x, y, 0, kFew, true); });
    refine();
    compose();
    return std::move(image_);
  }

private:
  // Where all drawables can be marked.
  void markEntries(const Scene& scene) {
    entries_.emplace(camera_);
    const auto mark = [this](const auto& thing) { return thing->mark(*entries_); };
    if (!std::all_of(scene.drawables.begin(), scene.drawables.end(), mark) ||
        !std::all_of(scene.media.begin(), scene.media.end(), mark))
      entries_.reset();
  }

  template <typename Visit>
  void eachPixel(double from, double to, const Visit& visit) {
    const int across = (camera_.width() + kTile - 1) / kTile;
    const int down = (camera_.height() + kTile - 1) / kTile;
    std::atomic<int> done{0};
    tbb::parallel_for(0, across * down, [&](int tile) {
      const int left = tile % across * kTile, top = tile / across * kTile;
      for (int y = top; y < std::min(top + kTile, camera_.height()); ++y)
        for (int x = left; x < std::min(left + kTile, camera_.width()); ++x)
          visit(x, y);
      const int count = ++done;
      progress_.update(from + (to - from) * count / (across * down));
    });
  }

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width()) +
           static_cast<std::size_t>(x);
  }

  // How many of a pixel's rays to the sky come before those of a sample: skyRays for every kFew
  // samples, spread evenly.
  std::uint32_t skyRaysBefore(std::uint32_t sample) const {
    return options_.skyRays * sample / kFew;
  }
  // Where in the block's sequence the rays of a pixel's sample begin: the first samples of all
  // pixels come first.
  std::uint32_t firstSkyRay(int x, int y, std::uint32_t sample) const {
    const std::uint32_t place = placeInBlock(x, y), few = skyRaysBefore(kFew);
    const std::uint32_t before = skyRaysBefore(sample);
    return sample < kFew ? place * few + before
                         : kBlockPixels * few + place * (skyRaysBefore(kMany) - few) + before - few;
  }

  // Adds samples number `from` to `to` - 1.
  void gather(int x, int y, std::uint32_t from, std::uint32_t to, bool looksForSky) {
    const double entry = entries_ ? static_cast<double>(entries_->at(x, y)) : 0;
    if (std::isinf(entry))
      return; // what is there after no sample at all
    const std::uint64_t scramble =
        mixBits(kGoldenRatio + (static_cast<std::uint64_t>(y) << 32 | std::uint32_t(x)));
    const std::uint64_t skyScramble = mixBits(
        kGoldenRatio + ~(static_cast<std::uint64_t>(y / kBlock) << 32 | std::uint32_t(x / kBlock)));
    const auto before = static_cast<float>(from);
    Gathered pixel = gathered_[index(x, y)];
    Pixel light = scaled(image_.at(x, y), before);
    Rgb low{1, 1, 1}, high{0, 0, 0};
    for (float& channel : pixel.sky)
      channel *= before;
    float skyWeight = pixel.sky[0] + pixel.sky[1] + pixel.sky[2];
    float skyOpen = skyWeight * pixel.visible;
    for (float& axis : pixel.normal)
      axis *= pixel.hits;
    pixel.depth *= pixel.hits;
    for (std::uint32_t i = from; i < to; ++i) {
      Ray ray = camera_.ray(x + kPlaces[i][0] / 32.0, y + kPlaces[i][1] / 32.0);
      ray.tMin = entry;
      const double jitter =
          static_cast<double>(mixBits(kGoldenRatio + scramble + i) >> 11) * 0x1p-53;
      const std::uint32_t rays = looksForSky ? skyRaysBefore(i + 1) - skyRaysBefore(i) : 0;
      const Sample sample = lights_.sample(ray, skyScramble, firstSkyRay(x, y, i), rays, jitter);
      light.red += sample.fixed[0];
      light.green += sample.fixed[1];
      light.blue += sample.fixed[2];
      light.alpha += sample.alpha;
      if (rays > 0) {
        const float weight = sample.sky[0] + sample.sky[1] + sample.sky[2];
        skyWeight += weight;
        skyOpen += weight * sample.visible;
      }
      const Pixel& behind = background_[static_cast<std::size_t>(y)];
      const std::array<float, 3> back = {behind.red, behind.green, behind.blue};
      for (std::size_t c = 0; c < 3; ++c) {
        pixel.sky[c] += sample.sky[c];
        const float all = perceived(sample.fixed[c] + sample.sky[c] + (1 - sample.alpha) * back[c]);
        low[c] = std::min(low[c], all);
        high[c] = std::max(high[c], all);
        pixel.normal[c] += static_cast<float>(sample.normal[c]);
      }
      pixel.depth += static_cast<float>(sample.depth);
      pixel.hits = static_cast<std::uint8_t>(pixel.hits + sample.hit);
    }
    const float share = 1 / static_cast<float>(to);
    for (std::size_t c = 0; c < 3; ++c) {
      pixel.sky[c] *= share;
      const int range = static_cast<int>(std::lround((high[c] - low[c]) * 255));
      pixel.contrast = static_cast<std::uint8_t>(std::max<int>(pixel.contrast, range));
      pixel.normal[c] /= static_cast<float>(std::max<int>(pixel.hits, 1));
    }
    if (pixel.hits > 0 && pixel.hits < to) // a silhouette, whatever its colour
      pixel.contrast = std::max(pixel.contrast, std::uint8_t(kMinContrast));
    pixel.visible = skyWeight > 0 ? skyOpen / skyWeight : 1;
    pixel.depth /= static_cast<float>(std::max<int>(pixel.hits, 1));
    gathered_[index(x, y)] = pixel;
    image_.at(x, y) = scaled(light, share);
  }

  // The colours of two pixels differ so much, with the sky open.
  int contrast(std::size_t a, std::size_t b) const {
    const Pixel &p = image_.pixels[a], &q = image_.pixels[b];
    const Rgb &s = gathered_[a].sky, &t = gathered_[b].sky;
    const float largest = std::max({std::abs(perceived(p.red + s[0]) - perceived(q.red + t[0])),
                                    std::abs(perceived(p.green + s[1]) - perceived(q.green + t[1])),
                                    std::abs(perceived(p.blue + s[2]) - perceived(q.blue + t[2])),
                                    std::abs(p.alpha - q.alpha)});
    return static_cast<int>(std::lround(largest * 255));
  }

  void refine() {
    const int width = camera_.width(), height = camera_.height();
    std::vector<std::uint8_t> contrasts(gathered_.size());
    tbb::parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t here = index(x, y);
        int maxContrast = gathered_[here].contrast;
        // Half, since a slope over a whole pixel shows less than a step within one.
        if (x > 0)
          maxContrast = std::max(maxContrast, contrast(here, here - 1) / 2);
        if (x + 1 < width)
          maxContrast = std::max(maxContrast, contrast(here, here + 1) / 2);
        if (y > 0)
          maxContrast = std::max(maxContrast, contrast(here, index(x, y - 1)) / 2);
        if (y + 1 < height)
          maxContrast = std::max(maxContrast, contrast(here, index(x, y + 1)) / 2);
        contrasts[here] = static_cast<std::uint8_t>(std::min(maxContrast, 255));
      }
    });
    std::array<std::size_t, 256> histogram{};
    for (const std::uint8_t value : contrasts)
      ++histogram[value];
    const auto allowed =
        static_cast<std::size_t>(options_.refinedShare * static_cast<double>(contrasts.size()));
    int limit = 256;
    for (std::size_t count = 0; limit > kMinContrast; --limit) {
      count += histogram[static_cast<std::size_t>(limit) - 1];
      if (count > allowed)
        break;
    }
    if (limit == 256)
      return;
    std::vector<std::uint8_t> alone(gathered_.size());
    eachPixel(0.6, 0.65, [&](int x, int y) {
      if (contrasts[index(x, y)] >= limit)
        alone[index(x, y)] = skyAround(x, y).weights < kCompany;
    });
    eachPixel(0.65, 0.95, [&](int x, int y) {
      if (contrasts[index(x, y)] >= limit)
        gather(x, y, kFew, kMany, alone[index(x, y)] != 0);
    });
  }

  // The sky at a pixel and at those around it that show the same surface: how many these are, by
  // weight, and what share is open.
  struct Around {
    double weights = 1;
    float open = 1;
  };
  Around skyAround(int x, int y) const {
    const Gathered& here = gathered_[index(x, y)];
    const Vec3d n = {here.normal[0], here.normal[1], here.normal[2]};
    if (!options_.smoothSky || !(dot(n, n) > 0))
      return {1, here.visible};
    const Ray ray = camera_.ray(x + 0.5, y + 0.5);
    const double pixel = ray.pixelAt(here.depth);
    const double cosine = std::max(0.05, std::abs(dot(n, ray.direction)));
    // Depth changes so much from a pixel to the next on a plane, with room for curvature.
    const double step =
        pixel * (0.5 + 1.5 * std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine);
    double sum = 0, weights = 0;
    for (int j = std::max(0, y - kSmoothing); j <= std::min(y + kSmoothing, camera_.height() - 1);
         ++j)
      for (int i = std::max(0, x - kSmoothing); i <= std::min(x + kSmoothing, camera_.width() - 1);
           ++i) {
        const Gathered& there = gathered_[index(i, j)];
        const double alike = n[0] * there.normal[0] + n[1] * there.normal[1] +
                             n[2] * there.normal[2]; // 1 on a plane
        const int distance = std::abs(i - x) + std::abs(j - y);
        if (alike < 0.7 || std::abs(there.depth - here.depth) > step * (distance + 1))
          continue;
        const double weight = std::min(1.0, (alike - 0.7) / 0.25);
        sum += weight * there.visible;
        weights += weight;
      }
    if (!(weights > 0))
      return {1, here.visible};
    return {weights, static_cast<float>(sum / weights)};
  }

  void compose() {
    std::vector<float> open(gathered_.size());
    eachPixel(0.95, 1, [&](int x, int y) { open[index(x, y)] = skyAround(x, y).open; });
    for (std::size_t i = 0; i < open.size(); ++i) {
      Pixel& p = image_.pixels[i];
      p.red += gathered_[i].sky[0] * open[i];
      p.green += gathered_[i].sky[1] * open[i];
      p.blue += gathered_[i].sky[2] * open[i];
      p = over(p, background_[i / static_cast<std::size_t>(camera_.width())]);
    }
  }

  const Camera& camera_;
  const RenderOptions& options_;
  Progress& progress_;
  Lights lights_;
  Image image_;
  std::optional<EntryMap> entries_;
  std::vector<Gathered> gathered_;
  std::vector<Pixel> background_; ///< by row
};

} // namespace

Image render(const Scene& scene, const Camera& camera, const RenderOptions& options,
             Progress& progress) {
  if (camera.width() < 1 || camera.height() < 1)
    throw Error(Status::Limit, "", "a picture needs at least one pixel");
  progress.check();
  return Picture(scene, camera, options, progress).run();
}

} // namespace tetvdb
