#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/io/gltf/gltf_animation.h"
#include "src/io/gltf/gltf_model.h"

namespace sightline::io {
namespace {

constexpr double kFramesPerSecond = 30.0;
constexpr std::uint32_t kHeight = 720;

// A node between the camera and its root, with what moves it.
struct Link {
  Mat4 parent_from_node;  // unless animated
  bool animated = false;
  NodePose pose;
  std::optional<Track> translation, rotation, scale;

  Mat4 at(double time) const {
    if (!animated) {
      return parent_from_node;
    }
    NodePose moved = pose;
    if (translation) {
      const auto value = translation->sample(time);
      moved.translation = {value[0], value[1], value[2]};
    }
    if (rotation) {
      moved.rotation = rotation->sample(time);
    }
    if (scale) {
      const auto value = scale->sample(time);
      moved.scale = {value[0], value[1], value[2]};
    }
    return matrixOf(moved);
  }
};

class CameraAdder {
 public:
  CameraAdder(const Document& document, const NodeTree& tree, const ChannelMap& channels,
              Accessors& accessors)
      : document_(document),
        tree_(tree),
        channels_(channels),
        accessors_(accessors),
        work_left_(document.limits.camera_work) {}

  Result<CameraPath> pathOf(std::size_t node_number) {
    const GltfFile::Node& node = document_.file.nodes[node_number];
    where_ = fmt::format("{}: node {}: camera {}", document_.name, node_number, node.camera);
    if (!isIndexInto(node.camera, document_.file.cameras.size())) {
      return failure("{} does not exist (the file has {})", where_, document_.file.cameras.size());
    }
    const GltfFile::Camera& camera = document_.file.cameras[static_cast<std::size_t>(node.camera)];
    CameraPath path;
    path.name = !node.name.empty()     ? node.name
                : !camera.name.empty() ? camera.name
                                       : fmt::format("camera{}", node.camera);
    double step_back = 0.0;
    Status status = camera.type == "orthographic" ? orthographic(*camera.orthographic, path, step_back)
                                                  : perspective(*camera.perspective, path);
    if (status) {
      status = addFrames(node_number, step_back, path);
    }
    if (!status) {
      return status.error();
    }
    return path;
  }

 private:
  Status perspective(const GltfFile::Perspective& camera, CameraPath& path) const {
    if (!(camera.yfov > 0.0 && camera.yfov < std::numbers::pi)) {
      return failure("{}: yfov {} is not between 0 and pi", where_, camera.yfov);
    }
    if (!(camera.znear > 0.0) || (camera.zfar != 0.0 && !(camera.zfar > camera.znear))) {
      return failure("{}: znear {} and zfar {} are not 0 < znear < zfar", where_, camera.znear, camera.zfar);
    }
    path.fovy_deg = camera.yfov * 180.0 / std::numbers::pi;
    path.z_near = camera.znear;
    path.z_far = camera.zfar;
    return setSize(camera.aspect_ratio == 0.0 ? 16.0 / 9.0 : camera.aspect_ratio, path);
  }

  // Sets how far behind its node the eye stands, in metres.
  Status orthographic(const GltfFile::Orthographic& camera, CameraPath& path, double& step_back) const {
    if (!(camera.xmag > 0.0 && camera.ymag > 0.0)) {
      return failure("{}: xmag {} and ymag {} are not positive", where_, camera.xmag, camera.ymag);
    }
    if (!(camera.znear >= 0.0 && camera.zfar > camera.znear)) {
      return failure("{}: znear {} and zfar {} are not 0 <= znear < zfar", where_, camera.znear, camera.zfar);
    }
    path.ortho_height = 2.0 * camera.ymag;
    // Ours needs near > 0: the eye steps back, which changes nothing of an orthographic picture.
    step_back = camera.znear > 0.0 ? 0.0 : 0.1;
    path.z_near = camera.znear + step_back;
    path.z_far = camera.zfar + step_back;
    return setSize(camera.xmag / camera.ymag, path);
  }

  Status setSize(double aspect, CameraPath& path) const {
    const double width = std::round(aspect * kHeight);
    if (!(width >= 1.0 && width <= 16384.0)) {
      return failure("{}: a width of {} times the height is not usable", where_, aspect);
    }
    path.width = static_cast<std::uint32_t>(width);
    path.height = kHeight;
    return Success{};
  }

  Status addFrames(std::size_t node, double step_back, CameraPath& path) {
    if (channels_.empty()) {
      return addFrame(tree_.world_from_node[node], step_back, path);
    }
    Result<std::vector<Link>> chain = chainOf(static_cast<int>(node));
    if (!chain) {
      return chain.error();
    }
    double start = HUGE_VAL;
    double end = 0.0;
    std::uint64_t animated = 0;
    for (const Link& link : *chain) {
      for (const std::optional<Track>* track : {&link.translation, &link.rotation, &link.scale}) {
        if (*track) {
          start = std::min(start, (*track)->firstTime());
          end = std::max(end, (*track)->lastTime());
          ++animated;
        }
      }
    }
    if (animated == 0) {
      return addFrame(tree_.world_from_node[node], step_back, path);
    }
    const double count = std::floor((end - start) * kFramesPerSecond + 1e-3) + 1.0;
    if (!(count * static_cast<double>(chain->size()) < 1e15) ||
        !spend(static_cast<std::uint64_t>(count) * chain->size())) {
      return tooMuch();
    }
    for (double i = 0.0; i < count; i += 1.0) {
      Mat4 world_from_node;
      for (auto link = chain->rbegin(); link != chain->rend(); ++link) {
        world_from_node = world_from_node * link->at(start + i / kFramesPerSecond);
      }
      const Status status = addFrame(world_from_node, step_back, path);
      if (!status) {
        return status;
      }
    }
    return Success{};
  }

  // Lists the camera's node and those above it, with the tracks of the first animation that moves any of
  // them.
  Result<std::vector<Link>> chainOf(int node) {
    std::vector<int> nodes;
    std::size_t animation = document_.file.animations.size();
    for (int at = node; at >= 0; at = tree_.parent[static_cast<std::size_t>(at)]) {
      nodes.push_back(at);
      const auto found = channels_.find(at);
      if (found != channels_.end()) {
        animation = std::min(animation, found->second.begin()->first);
      }
      if (!spend(1)) {
        return tooMuch();
      }
    }
    std::vector<Link> chain;
    for (const int at : nodes) {
      Link& link = chain.emplace_back();
      link.parent_from_node = tree_.parent_from_node[static_cast<std::size_t>(at)];
      const auto found = channels_.find(at);
      const Status status = found == channels_.end() || found->second.count(animation) == 0
                                ? Status(Success{})
                                : animate(at, animation, found->second.at(animation), link);
      if (!status) {
        return status.error();
      }
    }
    return chain;
  }

  Status animate(int node, std::size_t animation, const NodeChannels& channels, Link& link) {
    const GltfFile::Node& source = document_.file.nodes[static_cast<std::size_t>(node)];
    if (source.matrix) {
      return failure("{}: animation {}: moves node {}, which has a matrix", document_.name, animation, node);
    }
    link.animated = true;
    link.pose = source.pose;
    for (const auto& [channel, track] :
         {std::pair(channels.translation, &link.translation), std::pair(channels.rotation, &link.rotation),
          std::pair(channels.scale, &link.scale)}) {
      if (channel == nullptr) {
        continue;
      }
      Result<Track> opened = openTrack(document_, animation, *channel, accessors_);
      if (!opened) {
        return opened.error();
      }
      if (!spend(opened->keyCount())) {
        return tooMuch();
      }
      *track = *opened;
    }
    return Success{};
  }

  Status addFrame(const Mat4& world_from_node, double step_back, CameraPath& path) const {
    CameraFrame frame;
    frame.forward = normalized(-Vec3d(world_from_node(0, 2), world_from_node(1, 2), world_from_node(2, 2)));
    frame.up = normalized(Vec3d(world_from_node(0, 1), world_from_node(1, 1), world_from_node(2, 1)));
    frame.eye = Vec3d(world_from_node(0, 3), world_from_node(1, 3), world_from_node(2, 3)) -
                frame.forward * step_back;
    if (!SceneBuilder::inRange(frame.eye) || !isFinite(frame.up) ||
        !(std::abs(length(frame.forward) - 1.0) < 1e-6)) {
      return failure("{}: frame {}: its position or direction is not usable", where_, path.frames.size());
    }
    path.frames.push_back(frame);
    return Success{};
  }

  bool spend(std::uint64_t work) {
    const bool enough = work <= work_left_;
    work_left_ -= enough ? work : work_left_;
    return enough;
  }
  Error tooMuch() const {
    return failure(
        "{}: the animations of the file's cameras need more than {} frames, keys and nodes together", where_,
        document_.limits.camera_work);
  }

  const Document& document_;
  const NodeTree& tree_;
  const ChannelMap& channels_;
  Accessors& accessors_;
  std::uint64_t work_left_;
  std::string where_;
};

}  // namespace

Status addCameras(const Document& document, const NodeTree& tree, Accessors& accessors,
                  SceneBuilder& builder) {
  const Result<ChannelMap> channels = channelsOf(document);
  if (!channels) {
    return channels.error();
  }
  CameraAdder adder(document, tree, *channels, accessors);
  for (const int node : tree.visited) {
    if (document.file.nodes[static_cast<std::size_t>(node)].camera < 0) {
      continue;
    }
    Result<CameraPath> path = adder.pathOf(static_cast<std::size_t>(node));
    if (!path) {
      return path.error();
    }
    builder.addPath(std::move(*path));
  }
  return Success{};
}

}  // namespace sightline::io
