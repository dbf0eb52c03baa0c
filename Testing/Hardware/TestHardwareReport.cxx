// SPDX-License-Identifier: Apache-2.0
#include "HardwareReport.h"
#include "ProjectionTables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray::benchmarks;
using namespace mammoray::hardware;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// As GoogleTest writes it: one test that holds, one that fails, one that is skipped.
Json GoogleTestReport()
{
  return Json::parse(R"({ "tests": 3, "failures": 1, "time": "2.5s", "testsuites": [
    { "name": "Beam", "testsuite": [
      { "name": "Holds", "status": "RUN", "result": "COMPLETED" },
      { "name": "Fails", "status": "RUN", "result": "COMPLETED",
        "failures": [ { "failure": "expected 1 < 0", "type": "" } ] },
      { "name": "Waits", "status": "RUN", "result": "SKIPPED",
        "skipped": [ { "message": "no device that traces rays" } ] } ] } ] })");
}

Json BenchmarkReport()
{
  return Json::parse(R"({ "results": [
      { "example": "test", "method": "ray-tracing", "triangles": 15626, "columns": 150,
        "rows": 200, "coldStartMs": 120.4, "frame": { "medianMs": 0.52 },
        "render": { "medianMs": 0.31 }, "picture": { "medianMs": 0.4 }, "inconsistent": 0 },
      { "example": "veins", "method": "rasterisation", "triangles": 215728, "columns": 1681,
        "rows": 2071, "error": "the device is lost" } ],
    "rates": [ { "method": "ray-tracing",
      "resolution": [
        { "triangles": 1000, "columns": 100, "rows": 100, "setUpAndFrameMs": 100,
          "frame": { "medianMs": 1 } },
        { "triangles": 1000, "columns": 1000, "rows": 1000, "setUpAndFrameMs": 200,
          "frame": { "medianMs": 10 } } ],
      "triangles": [
        { "triangles": 100000, "columns": 600, "rows": 600, "setUpAndFrameMs": 300,
          "frame": { "medianMs": 4 } } ] } ] })");
}

Json WholeReport()
{
  return { { "version", "0.1.0" }, { "date", "2026-11-23 15:00 UTC" }, { "host", "a <host>" },
    { "device",
      { { "name", "A&B 3000" }, { "driver", "1.2" }, { "type", "discrete GPU" },
        { "rayTracing", true } } },
    { "proofs", Json::array({ SummariseProofs("TestXRay", GoogleTestReport()) }) },
    { "benchmark", BenchmarkReport() } };
}
}

TEST(HardwareReport, CountsProofsAndKeepsReasons)
{
  const Json proofs = SummariseProofs("TestXRay", GoogleTestReport());
  EXPECT_EQ(proofs["passed"], 1);
  EXPECT_EQ(proofs["failed"], 1);
  EXPECT_EQ(proofs["skipped"], 1);
  EXPECT_EQ(proofs["seconds"], 2.5);
  EXPECT_EQ(proofs["failures"][0]["test"], "Beam.Fails");
  EXPECT_EQ(proofs["failures"][0]["reason"], "expected 1 < 0");
  EXPECT_EQ(proofs["skips"][0]["reason"], "no device that traces rays");
}

TEST(HardwareReport, VerdictCountsDeadProgramsToo)
{
  Json report = WholeReport();
  EXPECT_EQ(Verdict(report), "1 proofs hold, 1 do not (1 skipped)");
  report["proofs"][0]["failed"] = 0;
  EXPECT_EQ(Verdict(report), "all 1 proofs hold (1 skipped)");
  report["proofs"].push_back({ { "program", "TestXRayPeers" }, { "error", "signal 11" } });
  EXPECT_EQ(Verdict(report), "1 proofs hold, 0 do not (1 skipped); TestXRayPeers: signal 11");
}

TEST(HardwareReport, PageTellsAllAndLetsNoNameIn)
{
  const std::string page = HardwarePage(WholeReport());
  EXPECT_THAT(page, HasSubstr("A&amp;B 3000"));
  EXPECT_THAT(page, Not(HasSubstr("<host>")));
  EXPECT_THAT(page, HasSubstr("Beam.Fails"));
  EXPECT_THAT(page, HasSubstr("the device is lost"));
  EXPECT_THAT(page, HasSubstr("no device that traces rays"));
  EXPECT_THAT(page, HasSubstr("<svg"));
}

TEST(ProjectionTables, PublishedTimesStandBesideOurs)
{
  const Table table = PublishedTable(BenchmarkReport());
  ASSERT_EQ(table.Rows.size(), 1u); // none of the case that failed
  EXPECT_THAT(table.Rows[0],
    ElementsAre("test", "ray-tracing", "310", "120", "0.9", "0.3", "0.4", "0.5"));
}

TEST(ProjectionTables, FailedCaseSaysWhyInMarkdown)
{
  const std::string text = Markdown(CaseTable(BenchmarkReport()));
  EXPECT_THAT(text,
    HasSubstr("| veins | rasterisation | 215728 | 1681x2071 | the device is lost |"));
  // What was not measured is not a number.
  EXPECT_THAT(text, HasSubstr("| test | ray-tracing | 15626 | 150x200 | 0.5 | - | - | - | 120 |"));
}

TEST(ProjectionTables, RatesAreFramesPerSecond)
{
  const Table table = RateTable(BenchmarkReport());
  ASSERT_EQ(table.Rows.size(), 3u);
  EXPECT_THAT(table.Rows[1], ElementsAre("ray-tracing", "1000", "1000x1000", "5.0", "100.0"));
  const std::string picture = RatePicture(BenchmarkReport());
  // 100 to 1000 and 5 to 10 frames per second on axes from 1 to 1000: the best lies on top.
  EXPECT_THAT(picture, HasSubstr("cy='30.0'"));
  EXPECT_EQ(RatePicture({ { "rates", Json::array() } }), "");
}
