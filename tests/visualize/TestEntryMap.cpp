// SPDX-License-Identifier: Apache-2.0
//
// The oracles: every ray that meets a box on its own does so behind the entry of its pixel, and
// pictures by entries are those of scenes that know none.
#include "tetvdb/visualize/EntryMap.h"
#include "tetvdb/visualize/Renderer.h"
#include "tetvdb/visualize/VolumeLook.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <openvdb/tools/LevelSetSphere.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

struct ViewBox {
  Vec3d centre, reach; ///< reach along the view's axes
};

double along(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Where a ray enters a box that is parallel to the view's axes; infinity where it passes.
double entersBox(const ViewBox& box, const View& view, const Ray& ray) {
  double begin = 0, end = INFINITY;
  const Vec3d from{ray.origin[0] - box.centre[0], ray.origin[1] - box.centre[1],
                   ray.origin[2] - box.centre[2]};
  const std::array<Vec3d, 3> axes = {view.right, view.up, view.toEye};
  for (std::size_t a = 0; a < 3; ++a) {
    const double place = along(from, axes[a]), slope = along(ray.direction, axes[a]);
    const double one = (-box.reach[a] - place) / slope, other = (box.reach[a] - place) / slope;
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  }
  return begin <= end ? begin : INFINITY;
}

TEST(EntryMap, isNoLaterThanAnyBoxOnAnyRay) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> part(0, 1);
  for (const bool perspective : {false, true}) {
    const View view = viewFrom({1, -2, 0.7});
    const Lens lens{perspective, 50};
    const Camera camera(view, lens, {{3, 1, -2}, 10, 30}, 48, 36);
    EntryMap map(camera);
    std::vector<ViewBox> boxes;
    for (int n = 0; n < 60; ++n) {
      ViewBox box;
      for (std::size_t a = 0; a < 3; ++a)
        box.centre[a] = Vec3d{3, 1, -2}[a] + 14 * (part(random) - 0.5);
      for (double& r : box.reach)
        r = 0.6 * part(random) * part(random);
      boxes.push_back(box);
      map.add(box.centre, box.reach);
    }
    int met = 0, near = 0, nothing = 0;
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 48; ++x) {
        nothing += std::isinf(map.at(x, y));
        for (int n = 0; n < 40; ++n) {
          const Ray ray = camera.ray(x + part(random), y + part(random));
          double first = INFINITY;
          for (const ViewBox& box : boxes)
            first = std::min(first, entersBox(box, view, ray));
          if (std::isinf(first))
            continue;
          ++met;
          ASSERT_LE(double(map.at(x, y)), first) << x << " " << y;
          near += first < 1.15 * double(map.at(x, y)); // a slant of at most 1.14
        }
      }
    EXPECT_GT(met, 1000);
    EXPECT_GT(near, met / 2); // no bound that says nothing
    EXPECT_GT(nothing, 300);
  }
}

TEST(EntryMap, aBoxAroundTheEyeIsInEveryPixel) {
  const View view = viewFrom({0, -1, 0});
  const Camera camera(view, {true, 40}, {{0, 0, 0}, 2, 5}, 8, 6);
  EntryMap map(camera);
  const Vec3d eye = camera.ray(4, 3).origin;
  map.add({eye[0] + 0.5, eye[1], eye[2]}, {1, 1, 1});
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(map.at(x, y), 0);
}

TEST(EntryMap, ofParallelRaysIsThePixelsOfTheBox) {
  const View view = viewFrom({0, -1, 0}); // right x, up z, a pixel is a unit
  const Camera camera(view, {}, {{0, 0, 0}, 6, 5}, 8, 6);
  EntryMap map(camera);
  map.add({-1.5, 1, 0.5}, {0.4, 1.4, 2});
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) {
      if (x == 2 && y >= 1 && y <= 3)
        EXPECT_NEAR(map.at(x, y), 5 + 1 - 2, 1e-4);
      else
        EXPECT_TRUE(std::isinf(map.at(x, y))) << x << " " << y;
    }
}

/// What it draws, without a word of where it is.
class Unmarked : public Drawable {
public:
  explicit Unmarked(std::unique_ptr<Drawable> what) : what_(std::move(what)) {}
  Box bounds() const override { return what_->bounds(); }
  bool firstHit(const Ray& ray, RayHit& hit) const override { return what_->firstHit(ray, hit); }
  bool blocks(const Ray& ray) const override { return what_->blocks(ray); }
  double skin() const override { return what_->skin(); }

private:
  std::unique_ptr<Drawable> what_;
};

class UnmarkedMedium : public Medium {
public:
  explicit UnmarkedMedium(std::unique_ptr<Medium> what) : what_(std::move(what)) {}
  Box bounds() const override { return what_->bounds(); }
  void gather(const Ray& ray, double jitter, Rgb& light, float& through) const override {
    what_->gather(ray, jitter, light, through);
  }

private:
  std::unique_ptr<Medium> what_;
};

openvdb::FloatGrid::Ptr ball(double voxel, bool levelSet) {
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      2.0f, openvdb::Vec3f(0.3f, -0.2f, 0.1f), float(voxel));
  if (levelSet)
    return grid;
  auto mask = openvdb::FloatGrid::create();
  mask->setTransform(grid->transform().copy());
  mask->setName("density");
  auto accessor = mask->getAccessor();
  for (auto value = grid->cbeginValueOn(); value; ++value)
    if (*value < 0)
      accessor.setValueOn(value.getCoord(), 0.5f);
  return mask;
}

TEST(EntryMap, picturesAreThoseWithoutIt) {
  initializeOpenVDB();
  VolumeLook cut;
  cut.cut = CutPlane{{0, -1, 0}, 0.4};
  using Make = std::unique_ptr<Drawable> (*)(openvdb::GridBase::ConstPtr, const VolumeLook&);
  for (const bool perspective : {false, true})
    for (const double voxel : {0.5, 0.06, 0.02}) // larger and smaller than a pixel
      for (const bool levelSet : {false, true})
        for (const Make make : {Make(drawVoxels), Make(drawSurface)})
          for (const VolumeLook& look : {VolumeLook(), cut}) {
            const auto grid = ball(voxel, levelSet);
            Scene plain, marked;
            plain.drawables = {std::make_shared<Unmarked>(make(grid, look))};
            marked.drawables = {std::shared_ptr<const Drawable>(make(grid, look))};
            const View view = viewFrom({1, -2, 0.7});
            const Lens lens{perspective, 30};
            const Framing framing = frame(view, lens, 64, 48, marked.support());
            const Camera camera(view, lens, framing, 64, 48);
            Progress progress;
            const Image a = render(plain, camera, {}, progress);
            const Image b = render(marked, camera, {}, progress);
            EXPECT_EQ(a.pixels, b.pixels) << perspective << voxel << levelSet;
          }
}

TEST(EntryMap, fogIsThatWithoutIt) {
  initializeOpenVDB();
  Progress progress;
  for (const bool perspective : {false, true}) {
    const auto grid = ball(0.1, false);
    Scene plain, marked;
    plain.media = {std::make_shared<UnmarkedMedium>(drawFog(grid, {}, progress))};
    marked.media = {std::shared_ptr<const Medium>(drawFog(grid, {}, progress))};
    const View view = viewFrom({1, -2, 0.7});
    const Lens lens{perspective, 30};
    const Camera camera(view, lens, frame(view, lens, 64, 48, marked.support()), 64, 48);
    const Image a = render(plain, camera, {}, progress), b = render(marked, camera, {}, progress);
    EXPECT_EQ(a.pixels, b.pixels);
    EXPECT_GT(a.at(32, 24).alpha, 0.5F);
  }
}

} // namespace
} // namespace tetvdb
