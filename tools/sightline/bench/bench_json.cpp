#include <fmt/format.h>

#include "tools/sightline/bench/bench_text.h"
#include "tools/sightline/command_line/json_output.h"

namespace sightline::tool {
namespace {

Json spreadJson(const RoundSpread& spread) {
  return {{"value", spread.value}, {"low", spread.low}, {"high", spread.high}};
}

Json timesJson(const FrameTimes& times) {
  return {
      {"median", spreadJson(times.median)}, {"mean", spreadJson(times.mean)}, {"p99", spreadJson(times.p99)}};
}

Json partJson(const PartCost& part) {
  return {{"us", part.us}, {"bytes", part.bytes ? Json(*part.bytes) : Json()}};
}

Json intervalJson(const std::optional<Interval>& interval) {
  return interval ? Json{interval->low, interval->high} : Json();
}

Json runJson(const SettingRecord& run, const BenchRecord& record) {
  const FrameTimes& baseline = record.baseline().cull;
  return {{"method", methodName(run.setting)},
          {"options", optionsJson(run.setting)},
          {"kept", run.kept},
          {"missed", run.missed},
          {"overestimate", intervalJson(record.overestimate(run))},
          {"answers", answersText(run)},
          {"cull_us", timesJson(run.cull)},
          {"times_frustum",
           {{"median", timesBaseline(run.cull.median, baseline.median)},
            {"mean", timesBaseline(run.cull.mean, baseline.mean)},
            {"p99", timesBaseline(run.cull.p99, baseline.p99)}}},
          {"cpu_us", timesJson(run.cpu)},
          {"draw_us", run.draw ? timesJson(*run.draw) : Json()},
          {"preparation",
           {{"hierarchy", partJson(run.preparation.hierarchy)},
            {"occluders", partJson(run.preparation.occluders)},
            {"databases", partJson(run.preparation.databases)},
            {"method", partJson(run.preparation.method)}}},
          {"front", run.on_front}};
}

std::string recordJson(const BenchRecord& record) {
  Json scene = {{"objects", record.scene.objects},
                {"triangles", record.scene.triangles},
                {"hash", fmt::format("{:016x}", record.scene.hash)}};
  addCracks(scene, record.cracks);
  const Json head = {{"name", record.scene_name},
                     {"scene", scene},
                     {"path", record.path_name},
                     {"views", fmt::format("{:016x}", record.views)},
                     {"frames", record.frames},
                     {"rounds", record.rounds},
                     {"core", record.core ? Json(*record.core) : Json()},
                     {"device", record.device},
                     {"load_us", record.load_us},
                     {"witnessed", record.witnessed},
                     {"undecided", record.undecided},
                     {"boxes", record.boxes},
                     {"undecided_boxes", record.undecided_boxes},
                     {"boxes_overestimate", intervalJson(record.leastOfBoxes())},
                     {"several_boxes", record.several_boxes},
                     {"undecided_several_boxes", record.undecided_several_boxes},
                     {"several_boxes_overestimate", intervalJson(record.leastOfSeveralBoxes())},
                     {"frames_from_cache", record.frames_from_cache},
                     {"advised", record.advice.run},
                     {"advice", record.advice.sentence}};
  std::vector<std::string> runs;
  for (const SettingRecord& run : record.runs) {
    runs.push_back(dump(runJson(run, record)));
  }
  return dumpWithList(head, "runs", runs);
}

}  // namespace

std::string benchJson(const std::vector<BenchRecord>& records) {
  std::vector<std::string> scenes;
  for (const BenchRecord& record : records) {
    scenes.push_back(recordJson(record));
  }
  return dumpWithList(Json::object(), "scenes", scenes);
}

}  // namespace sightline::tool
