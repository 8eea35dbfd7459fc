#include "tools/sightline/layers/layer_recorder.h"

#include <fmt/format.h>

#include <span>
#include <utility>

#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/signals.h"

namespace sightline::tool {
namespace {

FileLayer fileLayer(std::string name, const LayerImage& image) {
  const std::span colors(reinterpret_cast<const float*>(image.pixels.data()), 4 * image.pixels.size());
  return croppedLayer(std::move(name), image.width, image.height, colors, image.depths);
}

Json viewJson(const View& view) {
  return {{"eye", io::pointJson(view.eye)},
          {"forward", io::pointJson(view.forward)},
          {"up", io::pointJson(view.up)},
          {"orthographic", view.orthographic}};
}

}  // namespace

void LayerRecorder::beginFrame() {
  layers_.clear();
  described_ = program_ = Json::array();
}

void LayerRecorder::add(const CompositedGroup& group, const SortedFrame& frame,
                        const std::vector<MovingPart>& parts) {
  const auto first_image = static_cast<std::uint32_t>(layers_.size());
  const auto per_image = group.images.size() == 1 ? group.end_layer - group.first_layer : 1u;
  for (std::uint32_t i = 0; i < group.images.size(); ++i) {
    Json numbers = Json::array();
    for (std::uint32_t l = 0; l < per_image; ++l) {
      for (const PartId part : frame.layers.partsOf(LayerId(group.first_layer + i + l))) {
        numbers.push_back(frame.wholeOf(part).value);
      }
    }
    LayerImage none;
    const std::string& name = parts[numbers.front().get<std::uint32_t>()].name;
    addImage(name, group.images[i] != nullptr ? *group.images[i] : none, std::move(numbers));
  }
  addSteps(group.steps, first_image);
}

void LayerRecorder::addSky(const LayerImage& sky) {
  const auto image = static_cast<std::uint32_t>(layers_.size());
  const CompositingStep step{CompositingOp::kStartImage, LayerId(0u)};
  addImage("sky", sky, Json::array());
  addSteps({&step, 1}, image);
}

void LayerRecorder::addImage(const std::string& name, const LayerImage& image, Json parts) {
  FileLayer layer = fileLayer(fmt::format("{:04} {}", layers_.size(), name), image);
  described_.push_back({{"name", layer.name}, {"parts", std::move(parts)}});
  layers_.push_back(std::move(layer));
}

// A group's image is started anew, but in the whole program it goes under the groups before it.
void LayerRecorder::addSteps(std::span<const CompositingStep> steps, std::uint32_t first_image) {
  for (CompositingStep step : steps) {
    if (step.op == CompositingOp::kStartImage && !program_.empty()) {
      step.op = CompositingOp::kOver;
    }
    if (step.layer.valid()) {
      step.layer.value += first_image;
    }
    program_.push_back(describe(step));
  }
}

Status LayerRecorder::write(const std::string& file, const SortedFrame& frame,
                            const LayerImage& picture) const {
  std::vector<FileLayer> layers{fileLayer("picture", picture)};
  layers.insert(layers.end(), layers_.begin(), layers_.end());
  const Json description = {
      {"frame", frame.number}, {"view", viewJson(frame.view)}, {"layers", described_}, {"program", program_}};
  Status written = Success{};
  {
    const SignalGuard guard;
    written = writeLayerFile(file, picture.width, picture.height, layers, dump(description));
  }
  endIfTold();
  return written;
}

}  // namespace sightline::tool
