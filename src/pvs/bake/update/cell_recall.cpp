#include "src/pvs/bake/update/cell_recall.h"

#include <algorithm>

#include "src/pvs/bake/box_search.h"
#include "src/pvs/bake/segment.h"
#include "src/pvs/bake/surfaces/fused_occlusion.h"

namespace sightline::pvs {
namespace {

// If more boxes differ, the earlier answers help little.
constexpr std::size_t kMostDiffering = 256;

// False only if no line from the point to somewhere in `to` meets the box.
bool mayPass(const Vec3d& from, const Box& to, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::min(from[axis], double{to.min[axis]}),
                 high = std::max(from[axis], double{to.max[axis]});
    if (low > double{box.max[axis]} || high < double{box.min[axis]}) {
      return false;
    }
  }
  return true;
}

}  // namespace

CellRecall::CellRecall(const BakeScene& scene, const Recall* recall)
    : scene_(scene), recall_(recall), occludes_(scene.boxes.objects.size()) {
  if (recall_ != nullptr) {
    answers_before_.emplace(*recall_);
  }
  for (std::uint32_t i = 0; i < scene.occluders.size(); ++i) {
    occludes_[scene.position_of_occluder[i]] = !scene.doors.isDoor(scene.occluders[i].object);
  }
}

const Answer* CellRecall::find(const Answer& question) {
  return answers_before_ ? answers_before_->find(cell_, question.kind, question.question) : nullptr;
}

void CellRecall::keep(Answer answer) {
  if (scene_.settings.answers) {
    answers_[cell_].push_back(std::move(answer));
  }
}

// An answer of the earlier bake holds unless the object has changed, was not asked about, or may be hidden by
// an occluder that counts in one of the bakes only: one of a changed object, or of one that only one of the
// bakes asked about. What that hides lies behind its object's box, as seen from each corner.
bool CellRecall::compareObjects(const Answer& before, std::span<const Vec3d> corners,
                                const ObjectMask& hidden) {
  const auto count = static_cast<std::uint32_t>(scene_.boxes.objects.size());
  objects_before_.assign(count, Known::kNothing);
  const auto set = [this](const Runs& runs, Known state) {
    for (const ObjectRun& run : runs) {
      for (std::uint32_t i = run.begin; i < run.end; ++i) {
        if (const std::uint32_t now = recall_->placeNow(i); now != Recall::kNone) {
          objects_before_[now] = state;
        }
      }
    }
  };
  set(before.asked, Known::kHidden);
  set(before.seen, Known::kSeen);
  const std::span<const Box> changed = recall_->changedOccluders();
  differing_.assign(changed.begin(), changed.end());
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool asked_before = objects_before_[i] != Known::kNothing;
    if (asked_before == hidden.contains(i) && occludes_[i] && recall_->placeBefore(i) != Recall::kNone) {
      differing_.push_back(scene_.leafOf(i).bounds);
    }
  }
  if (differing_.size() > kMostDiffering) {
    return false;
  }
  findBehind(corners, differing_);
  return true;
}

void CellRecall::findBehind(std::span<const Vec3d> corners, std::span<const Box> boxes) {
  const BoxTreeView tree = scene_.boxes.view();
  behind_.reset(static_cast<std::uint32_t>(tree.objects.size()));
  for (const Box& given : boxes) {
    const Box box = widened(given, scene_.lineMargin());
    const auto misses = [&](const Box& bounds) {
      return !mayPass(corners.front(), bounds, box) || !mayPass(corners.back(), bounds, box);
    };
    forEachLeaf(tree, misses, [&](const BoxNode& leaf) {
      const auto passes = [&, to = center(leaf.bounds)](const Vec3d& corner) {
        return !SegmentTest(corner, to, scene_.lineMargin()).misses(box);
      };
      if (std::all_of(corners.begin(), corners.end(), passes)) {
        const ObjectRun object{leaf.first_object, leaf.first_object + 1};
        behind_.add(std::span(&object, 1));
      }
    });
  }
}

void CellRecall::compareNodes(const Answer* before) {
  nodes_before_.clear();
  if (before == nullptr) {
    return;
  }
  const std::vector<BoxNode>& nodes = recall_->earlier().marks.nodes;
  nodes_before_.assign(nodes.size(), Known::kNothing);
  for (const std::uint32_t node : before->hidden_nodes) {
    nodes_before_[node] = Known::kHidden;
  }
  // What is seen was asked about, and so was all above that.
  std::size_t run = before->seen.size();
  for (std::size_t n = nodes.size(); n-- > 0;) {
    const BoxNode& node = nodes[n];
    if (nodes_before_[n] == Known::kHidden) {
      continue;
    }
    bool asked = false;
    if (node.end == n + 1) {
      while (run > 0 && before->seen[run - 1].begin > node.first_object) {
        --run;
      }
      asked = run > 0 && node.first_object < before->seen[run - 1].end;
    }
    for (std::size_t child = n + 1; child < node.end && !asked; child = nodes[child].end) {
      asked = nodes_before_[child] != Known::kNothing;
    }
    nodes_before_[n] = asked ? Known::kSeen : Known::kNothing;
  }
  followed_before_.assign(nodes.size(), kWholeFrame);
  std::size_t asked = 0;
  for (std::size_t n = 0; n < nodes.size() && asked < before->followed.size(); ++n) {
    if (nodes_before_[n] != Known::kNothing) {
      followed_before_[n] = before->followed[asked++];
    }
  }
}

std::optional<CellRecall::NodeAnswer> CellRecall::node(std::uint32_t number, const CellBox& region) const {
  const std::uint32_t same = nodes_before_.empty() ? Recall::kNone : recall_->nodeBefore(number);
  if (same == Recall::kNone || nodes_before_[same] == Known::kNothing) {
    return std::nullopt;
  }
  const Box& frame = recall_->earlier().marks.frame;
  const CoarseBox& followed = followed_before_[same];
  const Box decided_in = boxOf(followed, frame);
  if (!holds(number, region, decided_in)) {
    return std::nullopt;
  }
  return NodeAnswer{nodes_before_[same] == Known::kHidden,
                    frame == scene_.frame ? followed : coarse(decided_in, scene_.frame)};
}

// An answer depends on the panels that the lines of sight of the question meet, and on those that were
// followed from there: these decided it. What has changed elsewhere in the shaft is joined with none of them.
// The order in which they are followed, and with it which objects are left out, depends on their content, on
// their steps to a border (PanelRank) and on the order of their edges, which are compared with them. Where
// narrowing or dividing decided, that may be anywhere in the shaft, and decided_in is all of space.
bool CellRecall::holds(std::uint32_t number, const CellBox& region, const Box& decided_in) const {
  const Box& box = scene_.boxes.nodes[number].bounds;
  const Vec3d start = FusedOcclusion::startOf(region);
  return (!recall_->panelsDiffer(decided_in) && !recall_->panelsDiffer({start, start}, box)) ||
         !recall_->panelsDiffer(region, box);
}

// Only what lies behind the box of a changed object, as seen from the point, may be seen now and not before,
// or the other way around. Mostly its triangles do not matter.
bool CellRecall::boundTriangles(const Vec3d& eye, Answer& answer) {
  const Answer* before = find(answer);
  if (before == nullptr || recall_->changedOccluders().size() > kMostDiffering) {
    return false;
  }
  findBehind(std::span(&eye, 1), recall_->changedOccluders());
  std::uint64_t behind = 0;
  for (std::uint32_t i = 0; i < scene_.boxes.objects.size(); ++i) {
    behind += behind_.contains(i) ? scene_.leafOf(i).triangles : 0;
  }
  answer.least = before->least - std::min(before->least, behind + recall_->trianglesGone());
  answer.most = before->most + behind + recall_->trianglesCome();
  return true;
}

}  // namespace sightline::pvs
