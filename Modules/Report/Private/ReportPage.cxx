// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportPage.h"

#include "Private/ReportText.h"

namespace mammoray
{
namespace
{
constexpr const char* Style = R"css(
:root { color-scheme: light; --ink: #1f2937; --quiet: #6b7280; --line: #e5e7eb; --paper: #fff; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f4f6; color: var(--ink);
  font: 15px/1.55 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 32px 24px 48px; }
header p { color: var(--quiet); margin: 4px 0 0; }
h1 { font-size: 26px; line-height: 1.25; margin: 0; letter-spacing: -.01em; }
h1.view { margin: 34px 0 0; }
h2 { font-size: 17px; margin: 0 0 12px; }
section { background: var(--paper); border: 1px solid var(--line); border-radius: 10px;
  padding: 20px 22px; margin-top: 18px; }
.verdict { border-left: 6px solid; }
.verdict h2 { margin-bottom: 6px; }
.verdict ul, .notes ul { margin: 6px 0 0; padding-left: 20px; }
.good { border-left-color: #059669; } .doubtful { border-left-color: #d97706; background: #fffbeb; }
.none { border-left-color: #dc2626; background: #fef2f2; }
.figures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 12px; margin-top: 18px; }
.figure { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 14px 16px; }
.figure b { display: block; font-size: 24px; font-weight: 600; line-height: 1.2;
  font-variant-numeric: tabular-nums; }
.figure b small { font-size: 14px; font-weight: 400; color: var(--quiet); }
.figure span { color: var(--quiet); font-size: 13px; }
.pictures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 16px; }
.pictures.wide { grid-template-columns: repeat(2, 1fr); }
figure { margin: 0; }
figure img { display: block; width: 100%; height: auto; border-radius: 6px; border: 1px solid var(--line); }
figcaption { font-size: 13px; color: var(--quiet); margin-top: 6px; }
figcaption b { color: var(--ink); display: block; font-size: 14px; }
.key { display: inline-block; width: 12px; height: 12px; border-radius: 3px; vertical-align: -1px;
  margin: 0 3px 0 2px; border: 1px solid #0002; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 7px 12px 7px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
tr:last-child td { border-bottom: 0; }
th { font-weight: 600; font-size: 13px; color: var(--quiet); }
td.value { text-align: right; padding-right: 0; }
td.number, th.number { text-align: right; white-space: nowrap; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 18px; }
.columns section { min-width: 0; }
.stage { position: relative; max-width: 560px; margin-top: 12px; --blend: 50%; }
.stage img { display: block; width: 100%; border-radius: 6px; }
.stage img + img { position: absolute; inset: 0; opacity: var(--blend); }
.stage.checkerboard img + img { opacity: 1; -webkit-mask: repeating-conic-gradient(#000 0 25%, #0000 0 50%)
  0 0 / 90px 90px; mask: repeating-conic-gradient(#000 0 25%, #0000 0 50%) 0 0 / 90px 90px; }
.stage.flicker img + img { opacity: 1; animation: flicker 1.2s step-end infinite; }
@keyframes flicker { 50% { opacity: 0; } }
.controls label { margin-right: 18px; }
.controls input[type=range] { width: 240px; vertical-align: middle; }
code { font: 12px ui-monospace, Menlo, Consolas, monospace; color: var(--quiet); overflow-wrap: anywhere; }
.flag { background: #fef3c7; border-radius: 4px; padding: 1px 6px; font-size: 12px; }
section > svg { width: 100%; height: auto; display: block; }
footer { color: var(--quiet); font-size: 13px; margin-top: 22px; }
@media (max-width: 820px) { .pictures, .figures { grid-template-columns: 1fr 1fr; }
  .columns { grid-template-columns: 1fr; } }
@media print { body { background: #fff; } section, .figure { break-inside: avoid; } main { padding: 0; } }
)css";
}

std::string PageHtml(const std::string& title, const std::string& subtitle, const std::string& body)
{
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<title>" +
    Escape(title) + "</title>\n<style>" + Style + "</style>\n</head>\n<body>\n<main>\n" +
    "<header>\n<h1>" + Escape(title) + "</h1>\n<p>" + Escape(subtitle) +
    " · MammoRay " MAMMORAY_VERSION "</p>\n</header>\n" + body +
    "<footer>Research software, not a medical device: no finding or its absence "
    "may be concluded from this report. The limits by which the match is judged are rules of thumb "
    "and have not been validated on patients.</footer>\n</main>\n</body>\n</html>\n";
}

}
