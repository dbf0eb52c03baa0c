// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "OptionList.h"
#include "OutputFiles.h"
#include "ProgramOptions.h"
#include "mammoray/Foundation/Error.h"

#include <CLI/CLI.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

using namespace mammoray;
namespace fs = std::filesystem;

namespace
{
class OutputFiles : public testing::Test
{
protected:
  void SetUp() override { Program().Overwrite = true; }
  void TearDown() override { Program().Overwrite = false; }

  /// As a command does before it runs.
  static void Give(const std::vector<std::string>& values, const std::string& type = InputTypeName)
  {
    CLI::App command;
    std::vector<std::string> taken;
    command.add_option("--given", taken)->type_name(type);
    std::vector<std::string> words{ "--given" };
    words.insert(words.end(), values.begin(), values.end());
    std::reverse(words.begin(), words.end()); // CLI11 takes them from the end
    command.parse(words);
    NoteInputs(command);
  }

  test::TemporaryFolder Folder;
};
}

TEST_F(OutputFiles, FilesAreCheckedBeforeTheWork)
{
  const std::string path = this->Folder.Write("mesh.vtu", "a mesh");
  EXPECT_NO_THROW(CheckInputFile(path));
  EXPECT_THROW(CheckInputFile(this->Folder.File("none.vtu")), InputError);
  EXPECT_THROW(CheckInputFile(this->Folder.File("")), InputError); // a folder
  Program().Overwrite = false;
  EXPECT_THROW(CheckOutputFile(path), InputError);
  Program().Overwrite = true;
  EXPECT_NO_THROW(CheckOutputFile(path));
  EXPECT_THROW(CheckOutputFile(""), InputError);
  EXPECT_THROW(CheckOutputFile("/nowhere/mesh.vtu"), InputError);
  EXPECT_THROW(CheckOutputFile(this->Folder.File("mesh.stl"), ".vtu", "a volume mesh"), InputError);
  EXPECT_NO_THROW(CheckPictureFile(""));
  EXPECT_THROW(CheckPictureFile(this->Folder.File("picture.jpg")), InputError);
  // Two outputs of one name.
  EXPECT_NO_THROW(CheckOutputFile(this->Folder.File("new.vtu")));
  EXPECT_THROW(CheckOutputFile(this->Folder.File("./new.vtu")), InputError);
  EXPECT_THROW(CheckOutputFile("/dev/null"), InputError);
}

TEST_F(OutputFiles, AnInputIsNeverAnOutput)
{
  const std::string image = this->Folder.Write("m.dcm", "a mammogram");
  fs::create_directory(this->Folder.File("result"));
  const std::string table = this->Folder.Write("result/curve.csv", "1");
  const std::string result = this->Folder.Write("result/result.json", "{}");
  fs::create_hard_link(image, this->Folder.File("linked.dcm"));
  fs::create_symlink(image, this->Folder.File("symbolic.dcm"));
  this->Give({ image }, "TEXT");
  EXPECT_NO_THROW(CheckOutputPlace(image)); // the option of an output
  this->Give({ image, this->Folder.File("result") });
  EXPECT_THROW(CheckOutputPlace(image), InputError);
  EXPECT_NO_THROW(CheckOutputPlace(table));
  EXPECT_THROW(CheckOutputPlace(result), InputError);
  EXPECT_NO_THROW(CheckOutputPlace(this->Folder.File("result/report.html"))); // is not there
  for (const char* name : { "m.dcm", "linked.dcm", "symbolic.dcm" })
  {
    this->Give({ image, this->Folder.File(name) });
    EXPECT_THROW(CheckOutputPlace(this->Folder.File(name)), InputError) << name;
  }
  this->Give({ this->Folder.File("") });
  EXPECT_THROW(CheckOutputPlace(image), InputError); // one of a series, perhaps
  this->Give({ this->Folder.File("result"), table });
  EXPECT_THROW(CheckNoInputWithin(this->Folder.File("result")), InputError);
  this->Give({ this->Folder.File("result"), image, "not a file" });
  EXPECT_NO_THROW(CheckNoInputWithin(this->Folder.File("result/")));
  // A name that is too long is refused as one, where it is written to.
  EXPECT_NO_THROW(CheckNoInputWithin(this->Folder.File(std::string(300, 'a'))));
}
