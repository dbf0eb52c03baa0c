// SPDX-License-Identifier: Apache-2.0
// The sub-commands of the program, each in a source of its own. They parse and call.
#ifndef mammoray_Commands_h
#define mammoray_Commands_h

#include <string>

namespace CLI
{
class App;
}

namespace mammoray
{
/// Where this program lies.
std::string ProgramFolder();
/// Starts the desktop application; says what is missing where it was not built.
void AddAppCommand(CLI::App& application);
void AddCompressCommand(CLI::App& application);
void AddDemoCommand(CLI::App& application);
void AddDevicesCommand(CLI::App& application);
void AddDicomCommand(CLI::App& application);
void AddDisplacementCommand(CLI::App& application);
void AddEvaluateCommand(CLI::App& application);
void AddExampleCommand(CLI::App& application);
void AddFetchCommand(CLI::App& application);
void AddFuseCommand(CLI::App& application);
void AddIntakeCommand(CLI::App& application);
void AddLocateCommand(CLI::App& application);
/// Says that it is not there where there is no Meshing module.
void AddMeshCommand(CLI::App& application);
void AddProjectCommand(CLI::App& application);
void AddRegisterCommand(CLI::App& application);
/// Says that it is not there where there is no Segmentation module.
void AddSegmentCommand(CLI::App& application);
void AddSendCommand(CLI::App& application);
/// Only where there is the App module.
void AddViewCommand(CLI::App& application);
}

#endif
