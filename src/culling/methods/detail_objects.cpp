// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 5.

#include "sightline/culling/detail_objects.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

namespace sightline {
namespace {

class DetailObjects final : public CullingMethod {
 public:
  DetailObjects(std::unique_ptr<CullingMethod> method, const DetailObjectsSettings& settings)
      : method_(std::move(method)), settings_(settings) {
    collectStatistics();
  }

  MethodTraits traits() const override { return method_->traits(); }
  bool wantsOccluders() const override { return method_->wantsOccluders(); }
  bool drawsBodies() const override { return method_->drawsBodies(); }

  void prepare(const CullingScene& scene) override {
    method_->prepare(scene);
    scene_ = scene;
    planes_.emplace(settings_.planes);
  }
  void build(const CullingFrame& frame) override { method_->build(frame); }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    method_->traverse(frame, stats, visible);
    tested_ = culled_ = 0;
    if (scene_.near_objects != nullptr) {
      const auto start = std::chrono::steady_clock::now();
      test(frame.view, visible);
      stats.detail_us =
          std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    }
  }

  void finish(CullStats& stats) override {
    method_->finish(stats);
    collectStatistics();
  }
  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    method_->classify(boxes, states);
  }
  std::span<const OccluderId> occludersUsed() const override { return method_->occludersUsed(); }
  DepthBufferView depthBuffer() const override { return method_->depthBuffer(); }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  void collectStatistics() {
    const std::span<const MethodStatistic> of_method = method_->statistics();
    statistics_.assign(of_method.begin(), of_method.end());
    statistics_.push_back({"detail", "tested", "detail tested", tested_});
    statistics_.push_back({"detail", "culled", "detail culled", culled_});
  }

  // Is the eye hidden from the object by occluders near the object?
  void test(const View& view, std::vector<ObjectId>& visible) {
    SupportingPlanes* planes = method_->supportingPlanesOfFrame();
    if (planes == nullptr) {
      planes_->build(view, *scene_.occluders, {});
      planes = &*planes_;
    }
    const std::size_t nodes = scene_.hierarchy->nodes.size() + scene_.hierarchy->objects.size();
    const auto first_item = static_cast<SupportingPlanes::Item>(nodes);
    std::span<const OccluderId> last_near;
    OccluderList list;
    std::erase_if(visible, [&](ObjectId object) {
      const Box& box = scene_.object_bounds[object.value];
      if (!box.wellFormed()) {
        return false;
      }
      const std::span<const OccluderId> near = occludersNear(box, view);
      if (near.data() != last_near.data() || near.size() != last_near.size()) {
        last_near = near;
        list = planes->add(near);
      }
      OccluderList touching;
      const bool hidden =
          planes->classify(box, first_item + object.value, list, touching) == Visibility::kHidden;
      tested_ += 1;
      culled_ += hidden ? 1 : 0;
      return hidden;
    });
  }

  // Towards the eye: what stands in between faces the eye, and turns its back to the object.
  std::span<const OccluderId> occludersNear(const Box& box, const View& view) const {
    const Vec3d middle = center(box);
    const Vec3d to_eye = view.orthographic ? -view.forward : view.eye - middle;
    const std::span<const OccluderId> found = scene_.near_objects->find(middle, to_eye);
    return found.first(std::min<std::size_t>(found.size(), settings_.occluder_count));
  }

  std::unique_ptr<CullingMethod> method_;
  DetailObjectsSettings settings_;
  CullingScene scene_;
  std::optional<SupportingPlanes> planes_;  // where the method has none
  std::uint64_t tested_ = 0, culled_ = 0;   // objects of this frame
  std::vector<MethodStatistic> statistics_;
};

}  // namespace

std::unique_ptr<CullingMethod> detailObjects(std::unique_ptr<CullingMethod> method,
                                             const DetailObjectsSettings& settings) {
  return std::make_unique<DetailObjects>(std::move(method), settings);
}

}  // namespace sightline
