// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BlasBuffers_h
#define mammoray_BlasBuffers_h

#include "mammorayBiomechanicsModule.h"

namespace mammoray
{
/**
 * Makes OpenBLAS take its buffers, one for each of its threads, the calling one among them, which
 * it then keeps for the process: where the 128 MiB of addresses of one are not to be had
 * (ulimit -v) it asks for them for ever. Once; throws std::bad_alloc where there is no room. Does
 * nothing with another BLAS.
 */
MAMMORAYBIOMECHANICS_EXPORT void ReserveBlasBuffers();
}

#endif
