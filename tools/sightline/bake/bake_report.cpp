#include "tools/sightline/bake/bake_report.h"

#include <fmt/format.h>

#include <algorithm>

namespace sightline::tool {
namespace {

double mib(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (1 << 20);
}

}  // namespace

Json bakeJson(const BakeReport& report, const SightFile& file, const SightFacts& facts) {
  const BakeEffort& effort = report.effort;
  Json json = {{"plan", fmt::format("{:016x}", report.plan)},
               {"parts", report.parts},
               {"parts_before", effort.parts_before},
               {"occluders", report.occluders},
               {"processes", effort.processes},
               {"threads", effort.threads},
               {"samples", effort.stats.samples},
               {"shadows", effort.stats.shadows},
               {"samples_forgotten", effort.stats.forgotten},
               {"sample_bytes", effort.stats.max_sample_bytes},
               {"questions", effort.stats.questions},
               {"questions_asked", effort.stats.asked},
               {"peak_bytes", effort.peak_bytes},
               {"all_peak_bytes", effort.all_peak_bytes},
               {"load_us", report.times.load},
               {"plan_us", report.times.plan},
               {"bake_us", report.times.bake},
               {"databases_us", report.times.databases},
               {"write_us", report.times.write}};
  if (report.update) {
    json["update"] = {{"difference", report.update->difference},
                      {"objects_same", report.update->same},
                      {"objects_gone", report.update->gone},
                      {"objects_come", report.update->come}};
  }
  json.update(sightJson(file, facts));
  return json;
}

std::string bakeText(const BakeReport& report, const std::string& name, const SightFile& file,
                     const SightFacts& facts) {
  const BakeEffort& effort = report.effort;
  const BakeTimes& times = report.times;
  std::string text = fmt::format("{}: {} bytes\n", name, file.fileBytes());
  text += fmt::format("budget        {} triangles a cell{}\n", file.record().triangle_budget,
                      report.budget_chosen ? " (chosen; --triangle-budget sets it)" : "");
  text += fmt::format("depth         {} levels{}\n", file.record().max_depth,
                      report.depth_chosen ? " (chosen; --depth sets it)" : "");
  text += cracksText(file);
  text += fmt::format("occluders     {} convex ones\n", report.occluders);
  text += fmt::format("parts         {}, {} of them from the checkpoint; {} processes of {} threads\n",
                      report.parts, effort.parts_before, effort.processes, effort.threads);
  if (report.update && report.update->difference.empty()) {
    const double questions = static_cast<double>(std::max(effort.stats.questions, std::uint64_t{1}));
    text += fmt::format(
        "update        {} objects are the same, {} gone, {} new; {} of {} questions asked again, {:.2f} %\n",
        report.update->same, report.update->gone, report.update->come, effort.stats.asked,
        effort.stats.questions, 100.0 * static_cast<double>(effort.stats.asked) / questions);
  }
  text += factsText(facts);
  text += fmt::format("sets          {} different ones\n", file.setCount());
  text += doorsText(file);
  text += fmt::format(
      "time          load {:.2f} s, plan {:.2f} s, bake {:.2f} s, databases {:.2f} s, write {:.2f} s\n",
      times.load * 1e-6, times.plan * 1e-6, times.bake * 1e-6, times.databases * 1e-6, times.write * 1e-6);
  text += fmt::format(
      "viewpoints    {} sampled, {} of them forgotten for want of memory ({:.1f} MiB kept); {} shadows of "
      "occluders\n",
      effort.stats.samples, effort.stats.forgotten, mib(effort.stats.max_sample_bytes), effort.stats.shadows);
  text += fmt::format("memory        {:.1f} MiB at most in a process, {:.1f} MiB in all\n",
                      mib(effort.peak_bytes), mib(effort.all_peak_bytes));
  return text;
}

}  // namespace sightline::tool
