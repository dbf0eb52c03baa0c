# SPDX-License-Identifier: Apache-2.0
"""Runs a script with its arguments. Exit 125 without a Vulkan device: runScript.py SCRIPT ARGUMENT..."""
import runpy
import sys

import mammoray

if not mammoray.devices():
    print("no Vulkan device")
    sys.exit(125)
sys.argv.pop(0)
runpy.run_path(sys.argv[0], run_name="__main__")
