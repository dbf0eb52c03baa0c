// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportParts.h"
#include "mammoray/IO/Sha256.h"

#include "vtkBase64Utilities.h"

#include <cstddef>

namespace mammoray
{
namespace
{
constexpr const char* Style = R"css(
:root { color-scheme: light; --ink: #1f2937; --quiet: #5b6472; --line: #e5e7eb; --paper: #fff; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f4f6; color: var(--ink); overflow-wrap: break-word;
  font: 15px/1.5 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 28px 24px 48px; }
header p { color: var(--quiet); margin: 4px 0 0; }
h1 { font-size: 26px; line-height: 1.25; margin: 0; letter-spacing: -.01em; }
h1.view { margin: 34px 0 0; }
h2 { font-size: 17px; margin: 0 0 12px; }
h2 small { font-weight: 400; font-size: 14px; color: var(--quiet); }
section { background: var(--paper); border: 1px solid var(--line); border-radius: 10px;
  padding: 18px 20px; margin-top: 16px; min-width: 0; }
.verdict { border-left: 6px solid; }
.verdict h2 { margin-bottom: 6px; } .verdict p { margin: 6px 0 0; }
.verdict ul, .notes ul { margin: 6px 0 0; padding-left: 20px; }
.good { border-left-color: #059669; } .doubtful { border-left-color: #d97706; background: #fffbeb; }
.none { border-left-color: #dc2626; background: #fef2f2; }
.answer p { margin: 0 0 6px; } .answer h2 { font-size: 20px; } .answer h2:not(:first-child) { margin-top: 14px; }
.answer-pictures { display: flex; flex-wrap: wrap; gap: 16px; margin: 12px 0 0; align-items: flex-start; }
.answer-mammograms { display: flex; flex-wrap: wrap; gap: 16px; flex: 1 1 300px; max-width: 620px; }
.answer-mammograms figure { flex: 1 1 200px; max-width: 360px; }
.answer-slices { display: grid; gap: 14px; flex: 2 1 340px; min-width: 0; }
.answer-slices .layers { background: #fff; }
.warning { color: #b45309; }
.figures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 12px; margin-top: 16px; }
.figure { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 12px 16px; }
.figure b { display: block; font-size: 24px; font-weight: 600; line-height: 1.2;
  font-variant-numeric: tabular-nums; }
.figure b small { font-size: 14px; font-weight: 400; color: var(--quiet); }
.figure span { color: var(--quiet); font-size: 13px; }
.pictures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 16px; }
.pictures.wide { grid-template-columns: repeat(2, 1fr); }
figure { margin: 0; min-width: 0; }
.scene figure { max-width: 720px; }
.layers { position: relative; border: 1px solid var(--line); border-radius: 6px; overflow: hidden; }
.layers img { display: block; width: 100%; height: auto; }
.layers svg { position: absolute; inset: 0; width: 100%; height: 100%; }
.no-lines .lines { display: none; }
figcaption, .hint { font-size: 13px; color: var(--quiet); margin: 6px 0 0; }
.hint { margin-top: 10px; }
figcaption b { color: var(--ink); display: block; font-size: 14px; }
.key { display: inline-block; width: 12px; height: 12px; border-radius: 3px; vertical-align: -1px;
  margin: 0 3px 0 2px; border: 1px solid #0002; }
.key.real { background: #ff8c1a; } .key.synthetic { background: #1aa6ff; }
.key.excluded { background: #9e6bab; } .key.more { background: #b2182b; } .key.less { background: #2166ac; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 6px 12px 6px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
tr:last-child td { border-bottom: 0; }
th { font-weight: 600; font-size: 13px; color: var(--quiet); }
td.value { text-align: right; padding-right: 0; }
td.number, th.number { text-align: right; white-space: nowrap; }
th.number { white-space: normal; }
.found { display: grid; grid-template-columns: minmax(0, 2fr) minmax(0, 3fr); gap: 16px; align-items: start; }
.found section:only-child { grid-column: 1 / -1; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 16px; }
.stage { position: relative; max-width: 560px; margin-top: 12px; --blend: 50%; }
.stage img { display: block; width: 100%; border-radius: 6px; }
.stage img + img { position: absolute; inset: 0; opacity: var(--blend); }
.stage.checkerboard img + img { opacity: 1; -webkit-mask: repeating-conic-gradient(#000 0 25%, #0000 0 50%)
  0 0 / 90px 90px; mask: repeating-conic-gradient(#000 0 25%, #0000 0 50%) 0 0 / 90px 90px; }
.stage.flicker img + img { opacity: 1; animation: flicker 1.2s step-end infinite; }
@keyframes flicker { 50% { opacity: 0; } }
.controls label { margin-right: 18px; display: inline-block; }
.controls input[type=range] { width: 200px; max-width: 50%; vertical-align: middle; }
code { font: 12px ui-monospace, Menlo, Consolas, monospace; color: var(--quiet); overflow-wrap: anywhere; }
.flag { background: #fef3c7; border-radius: 4px; padding: 1px 6px; font-size: 12px; }
section > svg { width: 100%; height: auto; display: block; }
footer { color: var(--quiet); font-size: 13px; margin-top: 22px; }
[hidden] { display: none !important; }
.zoomable { cursor: zoom-in; }
dialog { border: 0; padding: 0; background: #0b0d12; width: 96vw; height: 94vh; max-width: none;
  max-height: none; overflow: hidden; border-radius: 8px; }
dialog::backdrop { background: #000b; }
dialog .layers { position: absolute; border: 0; border-radius: 0; overflow: visible; cursor: grab;
  transform-origin: 0 0; touch-action: none; }
dialog .layers img { width: 100%; height: 100%; }
dialog button { position: absolute; top: 8px; right: 8px; font: 14px system-ui, sans-serif; padding: 5px 12px; }
dialog p { position: absolute; left: 12px; bottom: 6px; margin: 0; color: #d9dee6; font-size: 13px;
  pointer-events: none; text-shadow: 0 0 4px #000; }
@media (max-width: 820px) { .pictures, .figures { grid-template-columns: 1fr 1fr; }
  .columns, .found { grid-template-columns: minmax(0, 1fr); } .wide { display: none; } .pictures.wide { display: grid; } }
@media (max-width: 480px) { main { padding: 16px 10px 30px; } section { padding: 14px 12px; }
  h1 { font-size: 22px; } .figure { padding: 10px 12px; } .figure b { font-size: 20px; }
  .pictures.wide { grid-template-columns: 1fr; } th, td { padding-right: 8px; font-size: 14px; }
  td.value { overflow-wrap: anywhere; } }
@page { size: A4; margin: 10mm 11mm; }
@media print {
  body { background: #fff; font-size: 7.5pt; line-height: 1.25; print-color-adjust: exact;
    -webkit-print-color-adjust: exact; }
  main { padding: 0; max-width: none; }
  section, .figure, figure, tr { break-inside: avoid; }
  section { padding: 4px 8px; margin-top: 4px; border-radius: 4px; }
  h1 { font-size: 13pt; } h1.view { font-size: 11pt; margin-top: 6px; break-after: avoid; }
  h2 { font-size: 9pt; margin-bottom: 2px; } .answer h2 { font-size: 10.5pt; } h2 small { font-size: 8pt; }
  .figures { margin-top: 4px; gap: 5px; grid-template-columns: repeat(4, 1fr); }
  .figure { padding: 3px 8px; border-radius: 4px; } .figure b { font-size: 10pt; }
  .figure span, figcaption, .hint, th, .flag, footer { font-size: 6.5pt; }
  .figure b small, figcaption b { font-size: 7pt; }
  figcaption, .hint { margin-top: 1px; } footer { margin-top: 4px; }
  th, td { padding: 0 6px 0 0; }
  .pictures, .pictures.wide { display: grid; grid-template-columns: repeat(4, 1fr); gap: 6px; }
  .answer p { margin-bottom: 2px; }
  .answer-pictures { gap: 8px; margin: 3px 0 0; flex-wrap: nowrap; }
  .answer-mammograms { gap: 6px; flex-wrap: nowrap; } .answer-slices { gap: 4px; }
  .layers { width: fit-content; max-width: 100%; }
  .pictures img { width: auto; max-width: 100%; max-height: 42mm; }
  .answer-mammograms img { width: auto; max-width: 100%; max-height: 55mm; }
  .answer-slices img { width: auto; max-width: 100%; max-height: 38mm; }
  .found, .columns { gap: 4px; grid-template-columns: minmax(0, 1fr) minmax(0, 2fr); }
  .scene img { max-height: 36mm; width: auto; max-width: 100%; }
  .further img { width: auto; max-width: 100%; max-height: 42mm; }
  .pictures figcaption span, .scene figcaption span, .sources code, .sources br, .further table,
  .found .hint, .pictures + .hint, .control, .compare, .screen, .wide, dialog { display: none !important; }
  .sources table, .sources tbody { display: block; } .sources tr { display: inline; }
  .sources td { display: inline; border: 0; padding: 0 4px 0 0; } .sources td:last-child { padding-right: 14px; }
  .sources td:first-child { color: var(--quiet); }
}
)css";

/// Outlines to hide, pictures to look at closely and to compare. Without it the page shows all the
/// rest and no control.
constexpr const char* Script = R"js(
"use strict";
const lines = document.querySelector("#lines");
lines.onchange = () => document.body.classList.toggle("no-lines", !lines.checked);
document.querySelectorAll(".control").forEach(control => { control.hidden = false; });

document.querySelectorAll(".compare").forEach((section, number) => {
  const pictures = section.previousElementSibling;
  const stage = section.querySelector(".stage");
  const range = section.querySelector("[type=range]");
  stage.querySelectorAll("img").forEach(image => {
    image.src = pictures.querySelector(`img[alt="${image.alt}"]`).src; });
  section.querySelectorAll("[name=mode]").forEach(button => {
    button.name = "mode" + number;
    button.onchange = () => { stage.className = "stage " + button.value; }; });
  range.oninput = () => {
    section.querySelector("[value=blend]").click();
    stage.style.setProperty("--blend", range.value + "%"); };
  section.hidden = false;
});

const dialog = document.querySelector("dialog");
let shown = null, scale = 1, x = 0, y = 0, held = null;
const place = () => { shown.style.transform = `translate(${x}px, ${y}px) scale(${scale})`; };
const zoomAt = (px, py, factor) => {
  const next = Math.min(Math.max(scale * factor, 0.2), 40);
  x = px - (px - x) * next / scale;
  y = py - (py - y) * next / scale;
  scale = next;
  place();
};
document.querySelectorAll(".layers").forEach(layers => {
  layers.classList.add("zoomable");
  layers.onclick = () => {
    const image = layers.querySelector("img");
    shown = layers.cloneNode(true);
    shown.classList.remove("zoomable");
    dialog.querySelectorAll(".layers").forEach(old => old.remove());
    dialog.prepend(shown);
    dialog.showModal();
    shown.style.width = image.naturalWidth + "px";
    shown.style.height = image.naturalHeight + "px";
    scale = Math.min(dialog.clientWidth / image.naturalWidth, dialog.clientHeight / image.naturalHeight);
    x = (dialog.clientWidth - scale * image.naturalWidth) / 2;
    y = (dialog.clientHeight - scale * image.naturalHeight) / 2;
    place();
  };
});
dialog.addEventListener("wheel", event => {
  event.preventDefault();
  const box = dialog.getBoundingClientRect();
  zoomAt(event.clientX - box.left, event.clientY - box.top, Math.exp(-event.deltaY / 400));
}, { passive: false });
dialog.onpointerdown = event => { held = [event.clientX - x, event.clientY - y]; };
dialog.onpointermove = event => {
  if (held && event.buttons) { x = event.clientX - held[0]; y = event.clientY - held[1]; place(); } };
dialog.onpointerup = () => { held = null; };
dialog.ondblclick = event => {
  const box = dialog.getBoundingClientRect();
  zoomAt(event.clientX - box.left, event.clientY - box.top, 2); };
dialog.querySelector("button").onclick = () => dialog.close();
)js";

/// Bytes as base64.
std::string Base64(const std::string& bytes)
{
  std::vector<unsigned char> encoded(bytes.size() / 3 * 4 + 8);
  const unsigned long length =
    vtkBase64Utilities::Encode(reinterpret_cast<const unsigned char*>(bytes.data()),
      static_cast<unsigned long>(bytes.size()), encoded.data());
  return { encoded.begin(), encoded.begin() + static_cast<std::ptrdiff_t>(length) };
}

/// A source expression of a Content-Security-Policy that allows this very text.
std::string AllowedHash(const std::string& text)
{
  const std::string digits = Sha256OfText(text);
  std::string bytes;
  for (std::size_t digit = 0; digit < digits.size(); digit += 2)
  {
    bytes += static_cast<char>(std::stoi(digits.substr(digit, 2), nullptr, 16));
  }
  return "'sha256-" + Base64(bytes) + "'";
}
}

std::string PageHtml(const std::string& title, const std::string& subtitle,
  const std::vector<std::pair<std::string, std::string>>& examination, const std::string& body)
{
  std::string examined;
  for (const auto& [name, text] : examination)
  {
    examined += (examined.empty() ? "" : " · ") + Escape(name) + " " + Escape(text);
  }
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "img-src data:; style-src " +
    AllowedHash(Style) + "; script-src " + AllowedHash(Script) +
    "; base-uri 'none'; form-action 'none'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<title>" +
    Escape(title) + "</title>\n<style>" + Style + "</style>\n</head>\n<body>\n<main>\n" +
    "<header>\n<h1>" + Escape(title) + "</h1>\n<p>" + Escape(subtitle) +
    " · MammoRay " MAMMORAY_VERSION "</p>\n" +
    (examined.empty() ? "" : "<p>" + examined + "</p>\n") +
    "<p class=\"control\" hidden><label><input type=\"checkbox\" id=\"lines\" checked> show "
    "outlines "
    "and marks</label></p>\n</header>\n" +
    body +
    "<footer>Research software, not a medical device: no finding or its absence "
    "may be concluded from this report. The limits by which the match is judged are rules of thumb "
    "and have not been validated on patients.</footer>\n</main>\n"
    "<dialog aria-label=\"picture\"><p>wheel: zoom; drag: move; Esc: back</p>"
    "<button type=\"button\">close</button></dialog>\n<script>" +
    Script + "</script>\n</body>\n</html>\n";
}

std::string Escape(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    escaped += c == '&' ? "&amp;"
      : c == '<'        ? "&lt;"
      : c == '>'        ? "&gt;"
      : c == '"'        ? "&quot;"
                        : std::string(1, c);
  }
  return escaped;
}

std::string FigureHtml(const LayeredPicture& picture, const std::string& alt,
  const std::string& title, const std::string& caption)
{
  const std::string size =
    std::to_string(picture.Width) + "\" height=\"" + std::to_string(picture.Height) + "\"";
  std::string html = "<figure><div class=\"layers\"><img alt=\"" + Escape(alt) + "\" width=\"" +
    size + " src=\"data:image/png;base64," + Base64(picture.Png) + "\">";
  if (!picture.Lines.empty())
  {
    html += "<svg class=\"lines\" viewBox=\"0 0 " + std::to_string(picture.Width) + ' ' +
      std::to_string(picture.Height) + "\">\n" + picture.Lines + "</svg>";
  }
  return html + "</div>\n<figcaption>" + (title.empty() ? "" : "<b>" + title + "</b>") + "<span>" +
    caption + "</span></figcaption></figure>\n";
}
}
