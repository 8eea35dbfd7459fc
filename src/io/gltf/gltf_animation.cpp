#include "src/io/gltf/gltf_animation.h"

#include <algorithm>
#include <cmath>

namespace sightline::io {
namespace {

using Value = std::array<double, 4>;

Value mix(const Value& a, const Value& b, double weight_a, double weight_b) {
  Value result;
  for (std::size_t i = 0; i < 4; ++i) {
    result[i] = a[i] * weight_a + b[i] * weight_b;
  }
  return result;
}

// Spherical interpolation along the shorter arc.
Value slerp(const Value& a, Value b, double fraction) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (cosine < 0.0) {
    b = mix(b, b, -1.0, 0.0);
    cosine = -cosine;
  }
  if (cosine > 0.9995) {
    return mix(a, b, 1.0 - fraction, fraction);
  }
  const double angle = std::acos(cosine);
  return mix(a, b, std::sin((1.0 - fraction) * angle) / std::sin(angle),
             std::sin(fraction * angle) / std::sin(angle));
}

Status checkTimes(const AccessorView& times, const std::string& where) {
  double before = -1.0;
  for (std::uint64_t i = 0; i < times.count(); ++i) {
    const double time = times.number(i, 0);
    if (!(time > before) || !std::isfinite(time)) {
      return failure("{}: time {} of key {} is negative, not finite or not after the one before", where, time,
                     i);
    }
    before = time;
  }
  return Success{};
}

}  // namespace

Value Track::element(std::uint64_t element) const {
  Value value{};
  for (int i = 0; i < (rotation_ ? 4 : 3); ++i) {
    value[static_cast<std::size_t>(i)] = values_->number(element, i);
  }
  return value;
}

Value Track::value(std::uint64_t key) const {
  return element(interpolation_ == Interpolation::kCubic ? 3 * key + 1 : key);
}

// Hermite spline; an element triple is in-tangent, value, out-tangent.
Value Track::cubic(std::uint64_t key, double t, double duration) const {
  const double t2 = t * t;
  const double t3 = t2 * t;
  const Value ends = mix(value(key), value(key + 1), 2 * t3 - 3 * t2 + 1, 3 * t2 - 2 * t3);
  const Value tangents =
      mix(element(3 * key + 2), element(3 * key + 3), duration * (t3 - 2 * t2 + t), duration * (t3 - t2));
  return mix(ends, tangents, 1.0, 1.0);
}

Value Track::sample(double time) const {
  if (time <= firstTime()) {
    return value(0);
  }
  if (time >= lastTime()) {
    return value(keyCount() - 1);
  }
  std::uint64_t low = 0;  // time of low <= time < time of high
  std::uint64_t high = keyCount() - 1;
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (times_->number(middle, 0) <= time ? low : high) = middle;
  }
  const double start = times_->number(low, 0);
  const double duration = times_->number(high, 0) - start;
  const double fraction = (time - start) / duration;
  switch (interpolation_) {
    case Interpolation::kStep:
      return value(low);
    case Interpolation::kCubic:
      return cubic(low, fraction, duration);
    case Interpolation::kLinear:
      break;
  }
  return rotation_ ? slerp(value(low), value(high), fraction)
                   : mix(value(low), value(high), 1.0 - fraction, fraction);
}

Result<Track> openTrack(const Document& document, std::size_t animation, const GltfFile::Channel& channel,
                        Accessors& accessors) {
  const auto& samplers = document.file.animations[animation].samplers;
  const std::string user = fmt::format("animation {} sampler {}", animation, channel.sampler);
  const std::string where = document.name + ": " + user;
  if (!isIndexInto(channel.sampler, samplers.size())) {
    return failure("{}: does not exist (the animation has {})", where, samplers.size());
  }
  const GltfFile::Sampler& sampler = samplers[static_cast<std::size_t>(channel.sampler)];
  Track track;
  track.rotation_ = channel.path == "rotation";
  if (sampler.interpolation == "STEP" || sampler.interpolation == "CUBICSPLINE") {
    track.interpolation_ =
        sampler.interpolation == "STEP" ? Track::Interpolation::kStep : Track::Interpolation::kCubic;
  } else if (sampler.interpolation != "LINEAR") {
    return failure("{}: interpolation \"{}\" is not LINEAR, STEP or CUBICSPLINE", where,
                   sampler.interpolation);
  }
  const Result<const AccessorView*> times = accessors.view(sampler.input, user);
  if (!times) {
    return times.error();
  }
  const Result<const AccessorView*> values = accessors.view(sampler.output, user);
  if (!values) {
    return values.error();
  }
  if ((*times)->type() != ElementType::kScalar || (*times)->componentType() != ComponentType::kFloat ||
      (*values)->type() != (track.rotation_ ? ElementType::kVec4 : ElementType::kVec3)) {
    return failure("{}: times must be SCALAR of floats, and values VEC4 for a rotation, else VEC3", where);
  }
  const std::uint64_t values_per_key = track.interpolation_ == Track::Interpolation::kCubic ? 3 : 1;
  if ((*times)->count() == 0 || (*times)->count() * values_per_key != (*values)->count()) {
    return failure("{}: {} values do not go with {} keys", where, (*values)->count(), (*times)->count());
  }
  const Status ascending = checkTimes(**times, where);
  if (!ascending) {
    return ascending.error();
  }
  track.times_ = *times;
  track.values_ = *values;
  return track;
}

Result<ChannelMap> channelsOf(const Document& document) {
  ChannelMap channels;
  const GltfFile& file = document.file;
  for (std::size_t animation = 0; animation < file.animations.size(); ++animation) {
    const auto& list = file.animations[animation].channels;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const GltfFile::Channel& channel = list[i];
      if (channel.node < 0) {
        continue;  // it moves something of an extension
      }
      if (!isIndexInto(channel.node, file.nodes.size())) {
        return failure("{}: animation {} channel {}: node {} does not exist (the file has {})", document.name,
                       animation, i, channel.node, file.nodes.size());
      }
      NodeChannels& of_node = channels[channel.node][animation];
      if (channel.path == "translation") {
        of_node.translation = &channel;
      } else if (channel.path == "rotation") {
        of_node.rotation = &channel;
      } else if (channel.path == "scale") {
        of_node.scale = &channel;
      }
    }
  }
  return channels;
}

}  // namespace sightline::io
