#include "sightline/pvs/bake/write_sight.h"

#include "src/pvs/bake/file/encode_sight.h"
#include "src/pvs/bake/file/unfinished_file.h"

namespace sightline {

Status writeSight(const std::string& file, const BakedVisibility& baked) {
  const Result<pvs::SightBytes> bytes = pvs::encodeSight(baked);
  if (!bytes) {
    return Error{file + " cannot be written: " + bytes.error().message};
  }
  pvs::UnfinishedFile unfinished(file);
  unfinished.write(bytes->structure);
  unfinished.write(bytes->payload);
  unfinished.finish();
  return unfinished.status();
}

}  // namespace sightline
