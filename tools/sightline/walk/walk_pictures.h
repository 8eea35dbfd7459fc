#pragma once

// Chooses the frames of a walk that the report shows, and draws their pictures.

#include <functional>
#include <string>

#include "sightline/render/renderer.h"
#include "tools/sightline/report/report.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool {

// Keeps what the pictures need during the walk, for frames spread over it and for the frame with the best
// culling.
class PictureChooser {
 public:
  explicit PictureChooser(std::vector<std::uint32_t> frames);

  void offer(const KeptFrame& frame);
  std::vector<KeptFrame> chosen() const;  // ascending by frame, each once

 private:
  std::vector<std::uint32_t> spread_;
  std::vector<KeptFrame> kept_;
  std::optional<KeptFrame> best_;
};

// What is to be kept of the frame that the record's runs have culled last, for its pictures.
KeptFrame keptFrame(const WalkRecord& record, const CullingData& data, std::uint32_t frame, const View& view);

// The scene from above, around the frame's eye: what is kept, hidden and outside, and the occluders in use.
Image planPicture(const KeptFrame& frame, const Scene& scene, const OccluderSet& occluders,
                  Renderer& renderer);

// Draws the picture, the coverage map (if the method has a depth buffer) and the plan view of every chosen
// frame, hands each to `take` with its file's name, and says what they show. Ends at the first error of take.
// renderer: null draws the coverage map alone.
using TakePicture = std::function<Status(Image image, const std::string& file)>;
Result<std::vector<ReportPicture>> drawPictures(const WalkRecord& record, const Scene& scene,
                                                const OccluderSet& occluders, Renderer* renderer,
                                                const TakePicture& take);

}  // namespace sightline::tool
