# SPDX-License-Identifier: Apache-2.0
"""Exceptions of this package. The text is one line: what was expected, what was found and where."""


class Error(RuntimeError):
    """Base of the others, and what a computation raises that cannot reach its end."""


class InputError(Error, ValueError):
    """A value, file or array that was handed in is not usable."""


class DeviceError(Error):
    """No Vulkan device, or one that failed."""
