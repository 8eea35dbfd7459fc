#include "tools/sightline/bench/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/sightline/bench/bench_text.h"

namespace sightline::tool {
namespace {

bool beats(const SettingRecord& a, const SettingRecord& b) {
  const double time_a = a.cullingUs(), time_b = b.cullingUs();
  return a.kept <= b.kept && time_a <= time_b && (a.kept < b.kept || time_a < time_b);
}

// The front's extent: the fastest setting is the loosest one, and the tightest one the slowest.
struct FrontEnds {
  double fastest = 0.0, slowest = 0.0;   // logarithms of culling times
  double loosest = 0.0, tightest = 0.0;  // logarithms of numbers of kept objects

  // How far a setting is on the way from the fastest one to the tightest one, 0 to 1: in tightness, in time.
  double gainOf(const SettingRecord& run) const { return share(loosest - logKept(run), loosest - tightest); }
  double costOf(const SettingRecord& run) const { return share(logTime(run) - fastest, slowest - fastest); }

  static double logTime(const SettingRecord& run) { return std::log(std::max(run.cullingUs(), 1e-3)); }
  static double logKept(const SettingRecord& run) {
    return std::log(std::max(static_cast<double>(run.kept), 1.0));
  }
  static double share(double part, double all) { return all > 0.0 ? part / all : 0.0; }
};

FrontEnds endsOf(const BenchRecord& record) {
  FrontEnds ends;
  bool first = true;
  for (const SettingRecord& run : record.runs) {
    if (run.on_front) {
      const double time = FrontEnds::logTime(run), kept = FrontEnds::logKept(run);
      ends.fastest = first ? time : std::min(ends.fastest, time);
      ends.slowest = first ? time : std::max(ends.slowest, time);
      ends.loosest = first ? kept : std::max(ends.loosest, kept);
      ends.tightest = first ? kept : std::min(ends.tightest, kept);
      first = false;
    }
  }
  return ends;
}

std::string nameOf(const SettingRecord& run) {
  return fmt::format("{} ({})", methodName(run.setting), optionsText(run.setting));
}

// Why the setting with the least time of culling and drawing was chosen.
std::string whyByDrawing(const BenchRecord& record, const SettingRecord& chosen) {
  const SettingRecord& baseline = record.baseline();
  return fmt::format(
      "culling ({} ms) and drawing ({} ms, by {}) of a mean frame take {} ms together, the least of all "
      "settings on the front; with frustum culling alone {} ms",
      milliseconds(chosen.cullingUs()), milliseconds(chosen.draw->mean.value), record.device,
      milliseconds(chosen.frameUs()), milliseconds(baseline.frameUs()));
}

// What the setting keeps and costs, beside frustum culling.
std::string keptAndTime(const BenchRecord& record, const SettingRecord& chosen) {
  const SettingRecord& baseline = record.baseline();
  const std::string kept = record.witnessed > 0
                               ? fmt::format("{} objects for each visible one (frustum culling {})",
                                             intervalText(record.overestimate(chosen)),
                                             intervalText(record.overestimate(baseline)))
                               : fmt::format("{} objects, none of which is visible (frustum culling {})",
                                             chosen.kept, baseline.kept);
  return fmt::format("it keeps {} in {} ms a frame (frustum culling {} ms)", kept,
                     milliseconds(chosen.cullingUs()), milliseconds(baseline.cullingUs()));
}

std::string whyByKnee(const BenchRecord& record, const SettingRecord& chosen) {
  const FrontEnds ends = endsOf(record);
  const std::string bargain =
      ends.gainOf(chosen) < 1.0
          ? fmt::format(
                "of the way from the fastest setting to the tightest one it has gone {:.0f} % in tightness "
                "for {:.0f} % in time, on logarithmic scales, which is the best bargain",
                100.0 * ends.gainOf(chosen), 100.0 * ends.costOf(chosen))
          : "it is the tightest setting, and no faster one is a better bargain";
  return fmt::format("{}; {}; --draw weighs this against drawing", keptAndTime(record, chosen), bargain);
}

std::string whyNone(const BenchRecord& record, const SettingRecord& chosen) {
  return fmt::format("{}; no setting hides a tenth of the objects that frustum culling keeps",
                     keptAndTime(record, chosen));
}

// What the choice is based on.
enum class Ground : std::uint8_t { kDrawing, kKnee, kNothingHidden };

Ground groundOf(const BenchRecord& record) {
  const auto hides_much = [&record](const SettingRecord& run) {
    return run.on_front && 10 * run.kept <= 9 * record.baseline().kept;
  };
  return record.baseline().draw                                            ? Ground::kDrawing
         : std::any_of(record.runs.begin(), record.runs.end(), hides_much) ? Ground::kKnee
                                                                           : Ground::kNothingHidden;
}

std::string whyOn(Ground ground, const BenchRecord& record, const SettingRecord& chosen) {
  return ground == Ground::kDrawing ? whyByDrawing(record, chosen)
         : ground == Ground::kKnee  ? whyByKnee(record, chosen)
                                    : whyNone(record, chosen);
}

// The larger, the better the setting.
double meritOf(const SettingRecord& run, Ground ground, const FrontEnds& ends) {
  return ground == Ground::kKnee ? ends.gainOf(run) - ends.costOf(run) : -run.frameUs();
}

}  // namespace

void markFront(BenchRecord& record) {
  for (SettingRecord& run : record.runs) {
    run.on_front = !run.setting.approximate() &&
                   std::none_of(record.runs.begin(), record.runs.end(), [&run](const SettingRecord& other) {
                     return !other.setting.approximate() && beats(other, run);
                   });
  }
}

Advice adviceFor(const BenchRecord& record) {
  const FrontEnds ends = endsOf(record);
  const Ground ground = groundOf(record);
  std::size_t best = 0;
  for (std::size_t r = 0; r < record.runs.size(); ++r) {
    const SettingRecord &run = record.runs[r], &known = record.runs[best];
    const double merit = meritOf(run, ground, ends), most = meritOf(known, ground, ends);
    // The tighter one wins where two are equally good, as the two ends of a front are.
    const bool better = merit > most || (merit == most && run.kept < known.kept);
    if (run.on_front && (!known.on_front || better)) {
      best = r;
    }
  }
  const SettingRecord& chosen = record.runs[best];
  const std::string why =
      record.runs.size() == 1 ? "no other method was measured" : whyOn(ground, record, chosen);
  return {best, fmt::format("for {} use {}: {}.", record.scene_name, nameOf(chosen), why)};
}

}  // namespace sightline::tool
