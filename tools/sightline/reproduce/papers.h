#pragma once

// The papers that can be reproduced, one function each. A new paper is a file of its own, its function here
// and its row in paper_table.cpp.

#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

// inputs has one entry for each scene on which the paper is reproduced.

// Based on: Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998,
// section 7.
Result<Reproduction> reproduceBittner(const ReproduceOptions& options,
                                      const std::vector<SceneAndWalk>& inputs);
// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 6.
Result<Reproduction> reproduceCoorgTeller(const ReproduceOptions& options,
                                          const std::vector<SceneAndWalk>& inputs);
// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, section 6.
Result<Reproduction> reproducePoonWang(const ReproduceOptions& options,
                                       const std::vector<SceneAndWalk>& inputs);
// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree: A Data Structure for 3D Navigation.
// Computers & Graphics 1999, section 4.
Result<Reproduction> reproduceSaonaVazquez(const ReproduceOptions& options,
                                           const std::vector<SceneAndWalk>& inputs);
// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, section 12. Makes its own scenes; takes no inputs.
Result<Reproduction> reproduceSnyderLengyel(const ReproduceOptions& options,
                                            const std::vector<SceneAndWalk>& inputs);

}  // namespace sightline::tool
