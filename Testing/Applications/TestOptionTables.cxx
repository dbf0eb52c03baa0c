// SPDX-License-Identifier: Apache-2.0
#include "OptionList.h"
#include "OptionTables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

using namespace mammoray;

namespace
{
struct TabledArguments
{
  double ThicknessMm = 50;
  std::vector<double> PixelSizesMm{ 3, 1.5 };
  std::optional<std::array<double, 3>> Point;
  std::string Side = "left";
  unsigned Seed = 1;
  bool Overwrite = false;
};

void DeclareTabled(const OptionList& add, TabledArguments& arguments)
{
  add("--thickness", arguments.ThicknessMm, Positive("mm"), "distance of the plates");
  add("--pixel-sizes", arguments.PixelSizesMm, Positive("mm"), "coarse to fine");
  add.Expert().Numbers("--point", arguments.Point, "X Y Z", "a place");
  add.Expert().Word("--side", arguments.Side, { "left", "right" }, "the patient's own");
  add.CaseFile()("--seed", arguments.Seed, "of the noise");
  add.Flag("--overwrite", arguments.Overwrite, "replace");
}

void DeclareOverwrite(const OptionList& add, TabledArguments& arguments)
{
  add.Flag("--overwrite", arguments.Overwrite, "replace");
}

class OptionTablesTest : public testing::Test
{
protected:
  OptionTablesTest()
  {
    const auto run = [](TabledArguments&) {};
    AddCommand<TabledArguments>(this->Application, "press", "Presses", DeclareTabled, run);
    AddCommand<TabledArguments>(this->Application, "lift", "Lifts", DeclareOverwrite, run);
  }

  CLI::App Application;
};
}

TEST_F(OptionTablesTest, SchemaHasTypesRangesAndDefaults)
{
  const auto schema = nlohmann::json::parse(CaseFileSchema(this->Application));
  const nlohmann::json& press = schema["$defs"]["press"]["properties"];
  EXPECT_EQ(press["thickness"]["type"], "number");
  EXPECT_EQ(press["thickness"]["exclusiveMinimum"], 0);
  EXPECT_EQ(press["thickness"]["default"], 50);
  EXPECT_EQ(press["thickness"]["description"], "distance of the plates [mm]");
  EXPECT_EQ(press["pixel-sizes"]["default"], (nlohmann::json{ 3, 1.5 }));
  EXPECT_EQ(press["pixel-sizes"]["anyOf"][1]["items"]["type"], "number");
  EXPECT_EQ(press["point"]["minItems"], 3);
  EXPECT_EQ(press["point"]["maxItems"], 3);
  EXPECT_EQ(press["side"]["enum"], (nlohmann::json{ "left", "right" }));
  EXPECT_EQ(press["seed"]["type"], "integer");
  EXPECT_EQ(press["overwrite"]["type"], "boolean");
  EXPECT_FALSE(press.contains("config"));
}

TEST_F(OptionTablesTest, TablesTellSharedOptionsOnce)
{
  const std::string tables = OptionTables(this->Application);
  // --config and --print-config are shared, too.
  EXPECT_THAT(tables,
    testing::HasSubstr("8 options; counted for each command that takes them, 11."));
  EXPECT_THAT(tables,
    testing::HasSubstr("| `--overwrite` |  |  | replace | `--help` | press, lift |\n"));
  EXPECT_THAT(tables,
    testing::HasSubstr("| `--thickness` | mm, greater than 0 | 50 | distance of the plates | "
                       "`--help` |\n"));
  EXPECT_THAT(tables, testing::HasSubstr("| `seed` | UINT | 1 | of the noise | case file |\n"));
}
