// SPDX-License-Identifier: Apache-2.0
#include "OptionList.h"
#include "Schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

using namespace mammoray;

namespace
{
struct SchemaArguments
{
  double ThicknessMm = 50;
  std::vector<double> PixelSizesMm{ 3, 1.5 };
  std::optional<std::array<double, 3>> Point;
  std::string Side = "left";
  unsigned Seed = 1;
  bool Quick = false;
  std::string Mesh;
};

void DeclareAll(const OptionList& add, SchemaArguments& arguments)
{
  add("--thickness", arguments.ThicknessMm, Positive("mm"), "distance of the plates");
  add("--pixel-sizes", arguments.PixelSizesMm, Positive("mm"), "coarse to fine");
  add.Expert().Numbers("--point", arguments.Point, "X Y Z", "a place");
  add.Group("Patient").Expert().Word("-s,--side", arguments.Side, { "left", "right" },
    "the patient's own");
  add.CaseFile()("--seed", arguments.Seed, "of the noise");
  add.Flag("--quick", arguments.Quick, "coarsely");
  add.Input("--mesh", arguments.Mesh, "to press")->required();
}

void DeclareQuick(const OptionList& add, SchemaArguments& arguments)
{
  add.Flag("--quick", arguments.Quick, "coarsely");
}

class SchemaTest : public testing::Test
{
protected:
  SchemaTest()
  {
    const auto run = [](SchemaArguments&) {};
    AddCommand<SchemaArguments>(this->Application, "press", "Presses", "press", DeclareAll, run);
    AddCommand<SchemaArguments>(this->Application, "lift", "Lifts", "lift", DeclareQuick, run);
  }

  CLI::App Application;
};
}

TEST_F(SchemaTest, SchemaHasTypesRangesAndDefaults)
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
  EXPECT_EQ(press["quick"]["type"], "boolean");
}

TEST_F(SchemaTest, OptionsOfEveryCommandStandOnce)
{
  const auto definitions = nlohmann::json::parse(CaseFileSchema(this->Application))["$defs"];
  const nlohmann::json& program = definitions["program"]["properties"];
  for (const char* name : { "config", "print-config", "overwrite", "device", "projector" })
  {
    EXPECT_TRUE(program.contains(name)) << name;
  }
  for (const char* command : { "press", "lift" })
  {
    const nlohmann::json& properties = definitions[command]["properties"];
    EXPECT_EQ(properties["overwrite"]["$ref"], "#/$defs/program/properties/overwrite");
    EXPECT_FALSE(properties.contains("config"));
  }
}

TEST_F(SchemaTest, TellsWhatHelpTells)
{
  const auto schema = nlohmann::json::parse(CaseFileSchema(this->Application));
  const nlohmann::json& press = schema["$defs"]["press"]["properties"];
  EXPECT_EQ(press["thickness"]["value"], "mm");
  EXPECT_EQ(press["thickness"]["shown"], "--help");
  EXPECT_EQ(press["point"]["value"], "X Y Z");
  EXPECT_EQ(press["side"]["short"], "s");
  EXPECT_EQ(press["side"]["group"], "Patient");
  EXPECT_EQ(press["side"]["shown"], "--help-all");
  EXPECT_EQ(press["seed"]["shown"], "case file");
  EXPECT_EQ(press["mesh"]["mandatory"], true);
}
