#pragma once

// The results of `bench` as text: a table for the terminal, CSV, JSON.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sightline/bench/bench_record.h"

namespace sightline::tool {

// 1234.5 -> "1.234": microseconds as milliseconds, with four digits.
std::string milliseconds(double us);
// "1.43" where both ends are the same when rounded, otherwise "1.43-1.45"; "-" for none.
std::string intervalText(const std::optional<Interval>& interval);
std::string answersText(const SettingRecord& run);  // 16 hexadecimal digits

// The time of a statistic divided by that of the baseline; 1 for the baseline.
double timesBaseline(const RoundSpread& time, const RoundSpread& baseline);

std::string benchTable(const BenchRecord& record);
// Lines about how the scene was measured and what the columns of the table mean.
std::string benchNotes(const BenchRecord& record);

std::vector<std::string> benchCsvColumns();
// A line of column names, then a line for each scene and setting. Without the last line break.
std::string benchCsv(const std::vector<BenchRecord>& records);

std::string benchJson(const std::vector<BenchRecord>& records);

}  // namespace sightline::tool
