// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/Desktop.h"

int main(int argc, char* argv[])
{
  return mammoray::RunDesktop(argc, argv);
}
