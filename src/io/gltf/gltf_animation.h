#pragma once

#include <map>
#include <optional>
#include <vector>

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {

// One animated value of a node over time.
class Track {
 public:
  double firstTime() const { return times_->number(0, 0); }
  double lastTime() const { return times_->number(times_->count() - 1, 0); }
  std::uint64_t keyCount() const { return times_->count(); }
  // Components of the value; before the first and after the last key the nearest key's. rotation: 4, along
  // the sphere.
  std::array<double, 4> sample(double time) const;

 private:
  friend Result<Track> openTrack(const Document&, std::size_t, const GltfFile::Channel&, Accessors&);
  enum class Interpolation { kLinear, kStep, kCubic };

  std::array<double, 4> value(std::uint64_t key) const;
  std::array<double, 4> element(std::uint64_t element) const;
  std::array<double, 4> cubic(std::uint64_t key, double fraction, double duration) const;

  const AccessorView* times_ = nullptr;
  const AccessorView* values_ = nullptr;
  Interpolation interpolation_ = Interpolation::kLinear;
  bool rotation_ = false;
};

// Checks a channel's sampler: types, counts, finite ascending times.
Result<Track> openTrack(const Document& document, std::size_t animation, const GltfFile::Channel& channel,
                        Accessors& accessors);

// The channels of all animations by animation and node; of several for the same property the last.
struct NodeChannels {
  const GltfFile::Channel* translation = nullptr;
  const GltfFile::Channel* rotation = nullptr;
  const GltfFile::Channel* scale = nullptr;
};
using ChannelMap = std::map<int, std::map<std::size_t, NodeChannels>>;  // node, animation
Result<ChannelMap> channelsOf(const Document& document);

}  // namespace sightline::io
