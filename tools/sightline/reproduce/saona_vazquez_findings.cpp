// What the results of `reproduce saona-vazquez` say about the paper's statements, table by table.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "tools/sightline/reproduce/saona_vazquez.h"

namespace sightline::tool::saona_vazquez {
namespace {

// A statement that is judged scene by scene, and on each navigation if it is about these.
class Judged {
 public:
  explicit Judged(std::string claim) : finding_{std::move(claim), true, ""} {}

  void add(bool agrees, const std::string& text) {
    finding_.agrees = finding_.agrees && agrees;
    finding_.text += (finding_.text.empty() ? "" : "; ") + text;
  }
  // The finding, with the reason why.
  Finding because(const std::string& why) && {
    finding_.text += why;
    return std::move(finding_);
  }

 private:
  Finding finding_;
};

Finding worstLeaf(const std::vector<Measured>& scenes) {
  Judged judged("table 2: even from the worst leaf a significant part of the scene is culled");
  for (const Measured& measured : scenes) {
    const Spread triangles = measured.facts.sizes.triangles;
    const double percent = 100.0 / static_cast<double>(measured.scene.triangleCount());
    judged.add(percent * triangles.max < 90.0,
               fmt::format("{:.0f} % of {} may be seen from the worst leaf, {:.0f} % from a leaf in the mean",
                           percent * triangles.max, measured.name, percent * triangles.mean));
  }
  return std::move(judged).because(". Table 3 has the worst leaves of each level");
}

Finding levels(const std::vector<Measured>& scenes) {
  Judged judged(
      "table 3: leaves appear at several depths, and deep ones often miss the budget for want of "
      "occluders");
  for (const Measured& measured : scenes) {
    std::uint64_t depths = 0, deep = 0, missed = 0;
    for (const auto& reasons : measured.leaves.reasons) {
      std::uint64_t of_level = 0;
      for (const std::uint64_t count : reasons) {
        of_level += count;
      }
      depths += of_level > 0 ? 1 : 0;
      deep = of_level > 0 ? of_level : deep;
      missed = of_level > 0 ? of_level - reasons[static_cast<std::size_t>(StopReason::kBudgetMet)] : missed;
    }
    judged.add(depths > 1 && missed > 0,
               fmt::format("leaves at {} depths in {}, and {} of the {} deepest miss the budget", depths,
                           measured.name, missed, deep));
  }
  return std::move(judged).because("");
}

Finding histograms(const std::vector<Measured>& scenes) {
  Judged judged("histograms: most leaves are on one level");
  for (const Measured& measured : scenes) {
    std::uint64_t all = 0, most = 0;
    std::size_t level = 0;
    for (std::size_t i = 0; i < measured.facts.level_sizes.size(); ++i) {
      const std::uint64_t sets = measured.facts.level_sizes[i].triangles.count;
      all += sets;
      level = sets > most ? i : level;
      most = std::max(most, sets);
    }
    judged.add(2 * most > all,
               fmt::format("{} of {} sets are of level {} in {}", most, all, level, measured.name));
  }
  return std::move(judged).because(
      ". It is the deepest one, since few leaves meet the budget before; the paper's is the seventh of its "
      "levels");
}

Finding grid(const std::vector<Measured>& scenes) {
  Judged judged("the octree has far fewer leaves than a uniform grid of its resolution has voxels");
  for (const Measured& measured : scenes) {
    const auto leaves = static_cast<double>(measured.leaves.depths.size());
    const double voxels = voxelsInBox(measured);
    judged.add(2.0 * leaves < voxels, fmt::format("{:.0f} leaves where viewers are, {:.0f} voxels in the box "
                                                  "of {}",
                                                  leaves, voxels, measured.name));
  }
  return std::move(judged).because(
      ". Only leaves that meet the budget early save voxels, and this budget is met by few");
}

Finding budgets(const std::vector<Measured>& scenes) {
  Judged judged("leaves meet the budget, more of them the larger it is");
  for (const Measured& measured : scenes) {
    for (std::size_t i = 0; i < measured.budgets.size(); ++i) {
      const BudgetResult& result = measured.budgets[i];
      judged.add(result.met > 0 && (i == 0 || metPercent(result) >= metPercent(measured.budgets[i - 1])),
                 fmt::format("{:.0f} % of {} leaves with a budget of {:.0f} % of {}", metPercent(result),
                             result.depths.size(), result.percent, measured.name));
    }
  }
  return std::move(judged).because(
      ". A larger budget ends division earlier: there are fewer leaves, and of these a part meets it");
}

Finding sent(const std::vector<Measured>& scenes) {
  Judged judged("table 4: fewer triangles are sent in a frame than are weakly visible from a leaf");
  for (const Measured& measured : scenes) {
    const double visible = measured.facts.sizes.triangles.mean;
    for (const Navigation& navigation : measured.navigations) {
      const double triangles = navigation.record.runs[1].mean(
          [](const FrameRecord& frame) { return static_cast<double>(frame.triangles); });
      judged.add(triangles < visible, fmt::format("{:.0f} of {:.0f} on {} through {}", triangles, visible,
                                                  navigation.walk.path.name, measured.name));
    }
  }
  return std::move(judged).because(": the list of a leaf is culled by the view frustum as well");
}

Finding frameRate(const std::vector<Measured>& scenes) {
  Judged judged("table 5: the octree improves the frame rate by a factor");
  for (const Measured& measured : scenes) {
    for (const Navigation& navigation : measured.navigations) {
      const auto ms = [](const FrameRecord& frame) { return frame.frameUs(); };
      const double factor = navigation.record.baseline().mean(ms) / navigation.record.runs[1].mean(ms);
      judged.add(factor > 1.0,
                 fmt::format("by {:.2f} on {} through {}", factor, navigation.walk.path.name, measured.name));
    }
  }
  return std::move(judged).because(
      ". A software renderer spends much of a frame on pixels, which culling leaves the same");
}

Finding lookUp(const std::vector<Measured>& scenes) {
  Judged judged("navigation costs little");
  for (const Measured& measured : scenes) {
    for (const Navigation& navigation : measured.navigations) {
      const double look_up =
          navigation.record.runs[1].mean([](const FrameRecord& frame) { return frame.stats.look_up_us; });
      judged.add(
          look_up < 1000.0,
          fmt::format("a look-up takes {:.1f} us of a frame on {}; finding the set alone {:.1f} us while "
                      "sets are decoded for the first time, {:.0f} ns later",
                      look_up, navigation.walk.path.name, navigation.first_find_us, navigation.find_ns));
    }
  }
  return std::move(judged).because("");
}

Finding memory(const std::vector<Measured>& scenes) {
  Judged judged("samples are the larger part of a bake's memory; the finished octree is far smaller");
  for (const Measured& measured : scenes) {
    const auto samples = static_cast<double>(measured.baked.effort.stats.max_sample_bytes);
    const auto file = static_cast<double>(measured.baked.file.fileBytes());
    judged.add(samples > file, fmt::format("{:.1f} MiB of samples, {:.2f} MiB of file in {}",
                                           samples / kMebibyte, file / kMebibyte, measured.name));
  }
  return std::move(judged).because("");
}

Finding pieces(const std::vector<Measured>& scenes) {
  Judged judged("a bake in pieces needs less memory, and computes samples repeatedly");
  for (const Measured& measured : scenes) {
    const Effort& effort = measured.baked.effort;
    const double whole_mib = static_cast<double>(effort.stats.max_sample_bytes) / kMebibyte;
    judged.add(
        effort.part_mib.max <= whole_mib && effort.apart_samples > effort.stats.samples,
        fmt::format(
            "a piece takes {:.1f} ms in the mean (deviation {:.1f}, largest {:.1f}) and {:.2f} MiB of "
            "samples (deviation {:.2f}, largest {:.2f}; the whole {:.2f}), all pieces {:.2f} s against "
            "{:.2f} s, {} samples against {}, in {}",
            effort.part_ms.mean, effort.part_ms.deviation, effort.part_ms.max, effort.part_mib.mean,
            effort.part_mib.deviation, effort.part_mib.max, whole_mib, effort.apart_s, effort.whole_s,
            effort.apart_samples, effort.stats.samples, measured.name));
  }
  return std::move(judged).because(": neighbouring pieces share the samples at their corners");
}

}  // namespace

std::vector<Finding> findingsOf(const std::vector<Measured>& scenes) {
  std::vector<Finding> findings{worstLeaf(scenes), levels(scenes),  histograms(scenes),
                                grid(scenes),      budgets(scenes), sent(scenes),
                                lookUp(scenes),    memory(scenes),  pieces(scenes)};
  if (std::ranges::all_of(scenes, &Measured::drawn)) {
    findings.push_back(frameRate(scenes));
  }
  return findings;
}

}  // namespace sightline::tool::saona_vazquez
