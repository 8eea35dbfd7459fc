#pragma once

// Which setting to use for a scene.

#include "tools/sightline/bench/bench_record.h"

namespace sightline::tool {

// Sets SettingRecord::on_front. On the front are the settings that no other one beats: none keeps as few
// objects in less processor time, or fewer objects in the same time. Settings that may cull visible objects
// (Setting::approximate) are not considered.
void markFront(BenchRecord& record);

// Chooses one of the front, and says why in one sentence. Where drawing was measured, it is the setting with
// the smallest mean time of culling and drawing. Otherwise, if some setting hides at least a tenth of the
// objects that frustum culling keeps, it is the knee of the front: on the way from the fastest setting to the
// tightest one, the greatest gain of tightness over the loss of time, both logarithmic. Otherwise it is the
// fastest one. Precondition: markFront() was called.
Advice adviceFor(const BenchRecord& record);

}  // namespace sightline::tool
