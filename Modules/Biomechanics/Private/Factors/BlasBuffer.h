// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BlasBuffer_h
#define mammoray_BlasBuffer_h

#include "mammorayBiomechanicsModule.h"

namespace mammoray
{
/**
 * Makes OpenBLAS take the buffer of a thread that calls it, which it then keeps for the process:
 * where the 128 MiB of addresses are not to be had (ulimit -v) it asks for them for ever. Once;
 * throws std::bad_alloc where there is no room. Does nothing with another BLAS.
 */
MAMMORAYBIOMECHANICS_EXPORT void ReserveBlasBuffer();
}

#endif
