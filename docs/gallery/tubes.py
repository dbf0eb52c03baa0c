# SPDX-License-Identifier: Apache-2.0
"""Spectra of tubes, and their half-value layers."""
import sys

import mammoray as mr
from matplotlib import pyplot

beams = {"Mo, 28 kV, 0.03 mm Mo": mr.Beam(tube="Mo", kvp=28, filters=["Mo:0.03"]),
         "W, 28 kV, 0.05 mm Rh": mr.Beam(tube="W", kvp=28, filters=["Rh:0.05"]),
         "W, 120 kV, 2 mm Al": mr.Beam(tube="W", kvp=120, filters=["Al:2"])}
for name, beam in beams.items():
    energies, photons = beam.weights()
    pyplot.plot(energies, photons / photons.max(), label=f"{name}: {beam.half_value_layer:.2f} mm Al")
pyplot.xlabel("energy, keV")
pyplot.ylabel("photons, scaled")
pyplot.legend()
pyplot.savefig(f"{sys.argv[1]}/tubes.png", dpi=70)
assert 0.2 < beams["Mo, 28 kV, 0.03 mm Mo"].half_value_layer < 0.4
