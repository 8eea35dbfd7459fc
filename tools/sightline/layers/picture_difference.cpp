#include "tools/sightline/layers/picture_difference.h"

#include <fmt/format.h>

#include "sightline/io/image.h"
#include "sightline/render/compare.h"
#include "tools/sightline/command_line/output_files.h"

namespace sightline::tool {

Json differenceJson(const PictureDifference& difference) {
  return {{"mean", difference.mean},
          {"rms", difference.rms},
          {"largest", difference.largest},
          {"tolerance", kDifferenceTolerance},
          {"share_beyond", difference.share_beyond}};
}

std::string differenceText(const PictureDifference& difference) {
  return fmt::format(
      "{:.4f} of 255 (root mean square {:.4f}, largest {:.0f}, {:.3f} % of the pixels beyond {:.0f})",
      difference.mean, difference.rms, difference.largest, 100.0 * difference.share_beyond,
      kDifferenceTolerance);
}

Status writeComparison(const LayerImage& ours, const LayerImage& theirs, const std::string& file) {
  const Image left = toImage(ours), right = toImage(theirs);
  return savePicture(sideBySide(sideBySide(left, right), differenceImage(left, right)), file);
}

}  // namespace sightline::tool
