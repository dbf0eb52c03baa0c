// SPDX-License-Identifier: Apache-2.0
#include "HardwareReport.h"

#include "ProjectionTables.h"

namespace mammoray::hardware
{
namespace
{
using benchmarks::Escaped;
using benchmarks::Html;
using benchmarks::Table;

/// The first line of a failure or of a reason to skip.
std::string FirstReason(const Json& entries, const char* key)
{
  return entries.empty() ? "" : entries[0].value(key, std::string());
}

Table ProofTable(const Json& report)
{
  Table table{ "The proofs", { "program", "hold", "fail", "skipped", "seconds" }, {} };
  for (const Json& proofs : report["proofs"])
  {
    if (proofs.contains("error"))
    {
      table.Rows.push_back({ proofs["program"], proofs["error"] });
      continue;
    }
    const auto count = [&](const char* key) { return std::to_string(proofs[key].get<int>()); };
    table.Rows.push_back(
      { proofs["program"], count("passed"), count("failed"), count("skipped"), count("seconds") });
  }
  return table;
}

Table ReasonTable(const Json& report, const char* caption, const char* key)
{
  Table table{ caption, { "test", "reason" }, {} };
  for (const Json& proofs : report["proofs"])
  {
    for (const Json& entry : proofs.value(key, Json::array()))
    {
      table.Rows.push_back({ entry["test"], entry["reason"] });
    }
  }
  return table;
}
}

Json SummariseProofs(const std::string& program, const Json& googleTest)
{
  Json summary{ { "program", program }, { "passed", 0 }, { "failed", 0 }, { "skipped", 0 },
    { "seconds", std::stod(googleTest.value("time", std::string("0s"))) },
    { "failures", Json::array() }, { "skips", Json::array() } };
  for (const Json& suite : googleTest["testsuites"])
  {
    for (const Json& test : suite["testsuite"])
    {
      const std::string name =
        suite["name"].get<std::string>() + "." + test["name"].get<std::string>();
      const auto add = [&](const char* count, const char* list, const std::string& reason)
      {
        summary[count] = summary[count].get<int>() + 1;
        summary[list].push_back({ { "test", name }, { "reason", reason } });
      };
      if (test.contains("failures"))
      {
        add("failed", "failures", FirstReason(test["failures"], "failure"));
      }
      else if (test.value("result", std::string()) == "SKIPPED")
      {
        add("skipped", "skips", FirstReason(test.value("skipped", Json::array()), "message"));
      }
      else
      {
        summary["passed"] = summary["passed"].get<int>() + 1;
      }
    }
  }
  return summary;
}

std::string Verdict(const Json& report)
{
  int passed = 0;
  int failed = 0;
  int skipped = 0;
  std::string broken;
  for (const Json& proofs : report["proofs"])
  {
    if (proofs.contains("error"))
    {
      broken +=
        "; " + proofs["program"].get<std::string>() + ": " + proofs["error"].get<std::string>();
      continue;
    }
    passed += proofs["passed"].get<int>();
    failed += proofs["failed"].get<int>();
    skipped += proofs["skipped"].get<int>();
  }
  const std::string left = " (" + std::to_string(skipped) + " skipped)";
  return (failed == 0 && broken.empty() ? "all " + std::to_string(passed) + " proofs hold" + left
                                        : std::to_string(passed) + " proofs hold, " +
               std::to_string(failed) + " do not" + left) +
    broken;
}

std::string HardwarePage(const Json& report)
{
  const Json& device = report["device"];
  std::string page =
    "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>\n<title>MammoRay on " +
    Escaped(device["name"]) +
    "</title>\n<style>body{font:15px/1.4 sans-serif;margin:2em auto;max-width:1200px;padding:0 1em}"
    "table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ccc;padding:3px 6px;"
    "text-align:right}td:first-child,th:first-child,td:nth-child(2){text-align:left}"
    "td{white-space:pre-line}</style></head><body>\n<h1>MammoRay " +
    Escaped(report["version"]) + " on " + Escaped(device["name"]) + "</h1>\n<p>" +
    Escaped(device["driver"]) + "; " + Escaped(device["type"]) +
    (device["rayTracing"].get<bool>() ? "; traces rays" : "; no ray tracing") +
    ". Host: " + Escaped(report["host"]) + ". " + Escaped(report["date"]) + ".</p>\n<p><b>" +
    Escaped(Verdict(report)) + ".</b></p>\n" + Html(ProofTable(report));
  const Table failures = ReasonTable(report, "What does not hold", "failures");
  page += failures.Rows.empty() ? "" : Html(failures);
  if (report["benchmark"].contains("error"))
  {
    page += "<p>benchmark: " + Escaped(report["benchmark"]["error"]) + "</p>\n";
  }
  else
  {
    page += Html(benchmarks::PublishedTable(report["benchmark"])) +
      Html(benchmarks::CaseTable(report["benchmark"])) +
      "<h2>Frames per second (the paper's figure 5)</h2>\n" +
      benchmarks::RatePicture(report["benchmark"]);
  }
  const Table skips = ReasonTable(report, "Skipped", "skips");
  return page + (skips.Rows.empty() ? "" : Html(skips)) + "</body></html>\n";
}
}
