#pragma once

// Chooses the frames of a walk that the report shows, and draws their pictures.

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

// Writes the picture, the coverage map (if the method has a depth buffer) and the plan view of every chosen
// frame into the folder and says where they are. renderer: null writes the coverage map alone.
Result<std::vector<ReportPicture>> drawPictures(const WalkRecord& record, const Scene& scene,
                                                const OccluderSet& occluders, Renderer* renderer,
                                                const std::string& folder);

}  // namespace sightline::tool
