#
#  28 kVp Tungsten, 0.050 mm Rhodium filtration + 1.0 mm Beryllium window
#
#     Mean energy: 19.0 keV
#     1st HVL:      0.486 mm Al
#     photon fluence transmission factor: 0.0795
#     photon fluence * mm^2: 4.586e+6
#
#  Spectrum generated using Siemens' online tool, based on data from:
#  J. Boone, T. Fewell, R. Jennings, "Molybdenum, rhodium, and tungsten anode spectral models using interpolating polynomials with application to mammography", Med Phys 24, pp. 1883-1874 (1997)
#  https://www.oem-xray-components.siemens.com/x-ray-spectra-simulation
#
-1 -1
