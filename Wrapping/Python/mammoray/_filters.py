# SPDX-License-Identifier: Apache-2.0
"""The VTK algorithms, whose errors are raised, whose warnings are Python's and whose properties are keywords, too."""
from __future__ import annotations

import re
import signal
import sys
import threading
import warnings
from typing import Any, Callable

import vtkmodules.vtkCommonExecutionModel  # noqa: F401  before the wrapped classes, whose bases it holds

from . import mammorayFilters as _wrapped
from ._errors import Error, InputError
from ._values import suggestion


class _Heard(threading.local):
    """Collects the messages of a running filter of this package."""
    depth = 0

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        self.errors: list[str] = []
        self.of_executives: list[str] = []
        self.warnings: list[str] = []
        self.interrupted = False


_heard = _Heard()


def _message(text: str) -> str:
    """A message of VTK without the source line and the address before it, in one line."""
    return " ".join(re.sub(r"\A(?:.*\n)?\w+ \(0x[0-9a-f]+\): |\(0x[0-9a-f]+\)", "", text).split())


def _on_error(caller: Any, event: str, text: str = "") -> None:
    if _heard.depth:
        _heard.errors.append(_message(text))
    else:  # a filter of others updates us: an exception cannot pass it
        print(f"{caller.GetClassName()}: {_message(text)}", file=sys.stderr)


def _on_executive_error(caller: Any, event: str, text: str = "") -> None:
    # Beside the filter's own error it says only that there was one.
    if _heard.depth:
        _heard.of_executives.append(_message(text))


def _on_warning(caller: Any, event: str, text: str = "") -> None:
    if _heard.depth:
        _heard.warnings.append(_message(text))
    else:
        print(f"{caller.GetClassName()}: {_message(text)}", file=sys.stderr)


def _on_progress(caller: Any, event: str) -> None:
    if _heard.interrupted:
        caller.AbortExecuteOn()


for _listener in (_on_error, _on_executive_error, _on_warning):
    _listener.CallDataType = "string0"  # type: ignore[attr-defined]


def _interrupt(number: int, frame: Any) -> None:
    _heard.interrupted = True


def _raising(call: Callable[..., Any], algorithm: Any, *arguments: Any) -> Any:
    """Calls and raises what filters of ours complain of meanwhile. Ctrl-C stops them."""
    if _heard.depth:
        return call(*arguments)
    catches = (threading.current_thread() is threading.main_thread()
               and signal.getsignal(signal.SIGINT) is signal.default_int_handler)
    heard = _heard
    heard.forget()
    heard.depth += 1
    if catches:
        signal.signal(signal.SIGINT, _interrupt)
    try:
        result = call(*arguments)
    finally:
        heard.depth -= 1
        if catches:
            signal.signal(signal.SIGINT, signal.default_int_handler)
    for text in heard.warnings:
        warnings.warn(text, RuntimeWarning, stacklevel=3)
    if heard.interrupted:
        algorithm.Modified()  # what was cut short is to be made again
        raise KeyboardInterrupt
    if heard.errors:
        raise Error(heard.errors[0])
    if heard.of_executives:
        raise Error(heard.of_executives[0])
    return result


class _Algorithm:
    """Adds keywords, exceptions and Ctrl-C to the wrapped classes."""
    __slots__ = ()

    def __new__(cls, **properties: Any) -> Any:  # VTK's own takes no keywords
        return super().__new__(cls)

    def __init__(self, **properties: Any) -> None:
        algorithm: Any = self
        algorithm.AddObserver("ErrorEvent", _on_error)
        algorithm.AddObserver("WarningEvent", _on_warning)
        algorithm.AddObserver("ProgressEvent", _on_progress)
        algorithm.GetExecutive().AddObserver("ErrorEvent", _on_executive_error)
        for name, value in properties.items():
            if not hasattr(self, "Set" + name) or not hasattr(self, "Get" + name):
                own = [method for kind in type(self).__mro__ if kind.__module__.startswith("mammoray") for method in vars(kind)]
                known = sorted(method[3:] for method in own if method.startswith("Set") and "Get" + method[3:] in own)
                raise InputError(f"{type(self).__name__}: no property '{name}'; {suggestion(name, known)}")
            try:
                getattr(self, "Set" + name)(value)
            except TypeError as error:
                raise InputError(f"{type(self).__name__}: {name}={value!r}: {error}") from None

    def Update(self, *arguments: Any) -> None:
        """Works as VTK's. Raises Error if this filter or one of this package before it fails, KeyboardInterrupt on Ctrl-C."""
        _raising(super().Update, self, *arguments)  # type: ignore[misc]

    def UpdateTimeStep(self, *arguments: Any) -> int:
        """Works as VTK's; raises as Update does."""
        return _raising(super().UpdateTimeStep, self, *arguments)  # type: ignore[misc]

    def UpdateWholeExtent(self, *arguments: Any) -> int:
        """Works as VTK's; raises as Update does."""
        return _raising(super().UpdateWholeExtent, self, *arguments)  # type: ignore[misc]

    def UpdateInformation(self, *arguments: Any) -> None:
        """Works as VTK's; raises as Update does."""
        _raising(super().UpdateInformation, self, *arguments)  # type: ignore[misc]


class vtkBreastMesher(_Algorithm, _wrapped.vtkBreastMesher):
    __doc__ = _wrapped.vtkBreastMesher.__doc__


class vtkBreastCompression(_Algorithm, _wrapped.vtkBreastCompression):
    __doc__ = _wrapped.vtkBreastCompression.__doc__

    def SetMaterial(self, *arguments: Any) -> None:
        """Works as the wrapped one; raises Error."""
        _raising(super().SetMaterial, self, *arguments)

    def Backward(self, *arguments: Any) -> Any:
        """Calls the wrapped one, and raises Error."""
        return _raising(super().Backward, self, *arguments)


class vtkXRayProjector(_Algorithm, _wrapped.vtkXRayProjector):
    __doc__ = _wrapped.vtkXRayProjector.__doc__

    def SetKey(self, *arguments: Any) -> None:
        """Works as the wrapped one; raises Error."""
        _raising(super().SetKey, self, *arguments)


class vtkBreastRegistration(_Algorithm, _wrapped.vtkBreastRegistration):
    __doc__ = _wrapped.vtkBreastRegistration.__doc__


class vtkMammogramReader(_Algorithm, _wrapped.vtkMammogramReader):
    __doc__ = _wrapped.vtkMammogramReader.__doc__
