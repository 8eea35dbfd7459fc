#include "src/render/layers/depth_peeling.h"

#include <fmt/format.h>

#include "src/render/scene/scene_programs.h"

namespace sightline::render {

Result<DepthPeeler> DepthPeeler::create(const LayerTarget& target) {
  DepthPeeler peeler;
  glGenQueries(1, &peeler.query_);
  glGenFramebuffers(2, peeler.framebuffers_);
  for (int i = 0; i < 2; ++i) {
    peeler.depths_[i] = makeTexture(GL_DEPTH_COMPONENT32F, target.sampleWidth(), target.sampleHeight());
    glBindFramebuffer(GL_FRAMEBUFFER, peeler.framebuffers_[i]);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, target.color(), 0);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, peeler.depths_[i], 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
        glGetError() == GL_OUT_OF_MEMORY) {
      return Error{fmt::format("the driver has no room for peeling {} x {} samples", target.sampleWidth(),
                               target.sampleHeight())};
    }
  }
  return peeler;
}

// Finds, for each sample, the farthest depth that is nearer than the one of the last peel. False if no sample
// has one. A sample without one gets the nearest possible depth, so that later peels find nothing there.
bool DepthPeeler::findNext(GLuint framebuffer, const std::function<void(Stage)>& draw) const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  glBeginQuery(GL_ANY_SAMPLES_PASSED, query_);
  draw(Stage::kDepth);
  glEndQuery(GL_ANY_SAMPLES_PASSED);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  GLuint any = 0;
  glGetQueryObjectuiv(query_, GL_QUERY_RESULT, &any);
  return any != 0;
}

std::uint32_t DepthPeeler::peel(const LayerTarget& target, std::uint64_t max_peels,
                                const std::function<void(Stage)>& draw) {
  GLuint behind = target.depth();
  std::uint32_t peels = 0;
  while (peels < max_peels) {
    const std::uint32_t next = peels % 2;
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(kBehindUnit));
    glBindTexture(GL_TEXTURE_2D, behind);
    glActiveTexture(GL_TEXTURE0);
    if (!findNext(framebuffers_[next], draw)) {
      break;
    }
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_EQUAL);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw(Stage::kColor);
    glDisable(GL_BLEND);
    behind = depths_[next];
    ++peels;
  }
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
  return peels;
}

}  // namespace sightline::render
