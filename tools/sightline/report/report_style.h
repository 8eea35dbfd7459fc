#pragma once

namespace sightline::tool {

// The style sheet of the report: system fonts, light and dark, from a phone's width to a desktop's.
inline constexpr const char* kReportStyle = R"css(
:root { color-scheme: light dark; --page: #ffffff; --card: #f5f6f8; --text: #1b1f24; --dim: #5c6570; --line: #d9dde2;
  --accent: #2b6fc2; --bar: #cfe0f5; --good: #16794f; --bad: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --page: #14171b; --card: #1e2227; --text: #e7eaee; --dim: #a3acb7;
  --line: #353b43; --accent: #7db4f5; --bar: #23405f; --good: #5ccb98; --bad: #ff8a80; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text); line-height: 1.5; overflow-wrap: anywhere;
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, Helvetica, Arial, sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 32px 24px 64px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 6px; }
h2 { font-size: 20px; margin: 44px 0 12px; }
h3 { font-size: 15px; margin: 24px 0 8px; color: var(--dim); font-weight: 600; }
p { margin: 0 0 12px; max-width: 75ch; }
.summary { color: var(--dim); font-size: 18px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(200px, 1fr)); gap: 12px; margin: 24px 0 0; }
.tile { background: var(--card); border-radius: 10px; padding: 14px 18px; }
.tile b { display: block; font-size: 28px; line-height: 1.25; font-variant-numeric: tabular-nums; }
.tile > span { color: var(--dim); font-size: 14px; }
dl.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(230px, 1fr)); gap: 10px 24px; margin: 0; }
dl.facts div { border-top: 1px solid var(--line); padding-top: 6px; }
dt { color: var(--dim); font-size: 13px; } dd { margin: 0; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px; font-variant-numeric: tabular-nums; }
th, td { padding: 7px 10px; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th { color: var(--dim); font-weight: 600; vertical-align: bottom; border-bottom-color: var(--dim); }
th:first-child, td:first-child { text-align: left; padding-left: 0; white-space: normal; min-width: 150px; }
td small { display: block; color: var(--dim); font-size: 12.5px; }
td.share { min-width: 140px;
  background: linear-gradient(to right, var(--bar) var(--share), transparent 0) no-repeat left center / calc(100% - 68px) 60%; }
.good { color: var(--good); } .bad { color: var(--bad); font-weight: 600; }
.hint { color: var(--dim); font-size: 14px; margin-top: 10px; }
.plot { margin: 0 0 20px; } .plot svg { display: block; width: 100%; height: auto; }
.frame { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(320px, 100%), 1fr)); gap: 16px;
  align-items: start; }
figure { margin: 0; } figure img { display: block; width: 100%; height: auto; border-radius: 8px; background: var(--card); }
figcaption { color: var(--dim); font-size: 14px; padding-top: 6px; }
.legend { display: flex; flex-wrap: wrap; gap: 4px 18px; list-style: none; padding: 0; margin: 0 0 4px; font-size: 14px; }
.legend i { display: inline-block; width: 14px; height: 14px; border-radius: 3px; margin-right: 7px;
  vertical-align: -2px; border: 1px solid rgba(128, 128, 128, 0.5); }
.legend i.wide { width: 48px; }
pre { background: var(--card); border-radius: 8px; padding: 12px 16px; margin: 0; white-space: pre-wrap;
  font: 14px/1.5 ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
li { margin-bottom: 4px; max-width: 75ch; }
@media (max-width: 640px) { main { padding: 20px 16px 48px; } h1 { font-size: 24px; } .plot { overflow-x: auto; }
  .plot svg { width: 640px; max-width: none; } }
)css";

}  // namespace sightline::tool
