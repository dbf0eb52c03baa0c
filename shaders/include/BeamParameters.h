// SPDX-License-Identifier: Apache-2.0
// What the host hands to beam.comp; read by GLSL and by C++.
#ifndef BeamParameters_h
#define BeamParameters_h

#define MAMMORAY_BEAM_LENGTHS 0
#define MAMMORAY_BEAM_TABLE 1
#define MAMMORAY_BEAM_TRANSMISSION 2
#define MAMMORAY_BEAM_BINDING_COUNT 3

// Invocations per workgroup.
#define MAMMORAY_BEAM_GROUP 64
// Energies done at once.
#define MAMMORAY_BEAM_BLOCK 4u

#ifdef __cplusplus
#include <cstdint>
namespace mammoray
{
#define MAMMORAY_BEAM_UINT std::uint32_t
#else
#define MAMMORAY_BEAM_UINT uint
#endif
struct BeamParameters
{
  MAMMORAY_BEAM_UINT PixelCount;
  MAMMORAY_BEAM_UINT Materials; // air included
  MAMMORAY_BEAM_UINT Energies;
};
#ifdef __cplusplus
}
#endif
#endif
