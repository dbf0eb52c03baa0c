# SPDX-License-Identifier: Apache-2.0
"""Pictures as a differentiable function of PyTorch (Debian: python3-torch):

    import mammoray.torch
    points = torch.tensor(mesh.points, requires_grad=True)
    picture = mammoray.torch.expose(scene, points=points)
    loss = ((picture.transmission - wanted) ** 2).sum()
    loss.backward()                        # points.grad

Spectra and attenuations of one's own are differentiable, too, where they act on picture.path_lengths by torch's own functions.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy
import torch
from torch.autograd.function import once_differentiable

from ._errors import InputError
from ._scene import Exposure, Gradient, Projector, Scene
from ._values import array_of


class Picture(NamedTuple):
    """Pictures as of an Exposure: rows x columns, and materials x rows x columns."""
    transmission: torch.Tensor
    path_lengths: torch.Tensor


def _place(scene: Scene, name: str, values: Any) -> None:
    count = len(scene.samples)
    if name == "source":
        field = "position" if scene.source.beam_direction is None else "beam_direction"
        setattr(scene.source, field, array_of(values, name, (3,)))
    elif name == "origin":
        scene.detector.origin = array_of(values, name, (3,))
    elif name == "translation":
        for sample, place in zip(scene.samples, array_of(values, name, (count, 3))):
            sample.translation = place
    else:
        for sample, vector in zip(scene.samples, array_of(values, name, (count, 3))):
            length = float(numpy.linalg.norm(vector))
            sample.axis, sample.angle = (vector, numpy.degrees(length)) if length > 0 else ((0, 0, 1), 0.0)


def _part(gradient: Gradient, name: Union[int, str]) -> Any:
    return gradient.points[name] if isinstance(name, int) else getattr(gradient, name)


class _Expose(torch.autograd.Function):
    """names: for each tensor the index of the sample whose points it holds, or a field of Gradient."""

    @staticmethod
    def forward(context: Any, scene: Scene, projector: Optional[Projector], names: Sequence[Union[int, str]], *tensors: torch.Tensor) -> Any:
        for name, tensor in zip(names, tensors):
            values = tensor.detach().cpu().numpy()
            if isinstance(name, int):
                scene.samples[name].mesh.points = values
            else:
                _place(scene, name, values)
        exposure: Exposure = scene.expose(projector)
        context.exposure, context.names = exposure, names
        context.kinds = [(tensor.dtype, tensor.device) for tensor in tensors]
        context.set_materialize_grads(False)
        return torch.from_numpy(exposure.transmission.copy()), torch.from_numpy(exposure.path_lengths.copy())

    @staticmethod
    @once_differentiable  # type: ignore[misc]
    def backward(context: Any, transmission: Optional[torch.Tensor], path_lengths: Optional[torch.Tensor]) -> Any:
        if transmission is None and path_lengths is None:
            return (None,) * (3 + len(context.names))
        gradient = context.exposure.backward(*(None if loss is None else loss.cpu().numpy() for loss in (transmission, path_lengths)))
        return (None, None, None, *(torch.as_tensor(_part(gradient, name), dtype=dtype, device=device)
                                    for name, (dtype, device) in zip(context.names, context.kinds)))


def expose(scene: Scene, *, points: Union[torch.Tensor, Sequence[torch.Tensor], None] = None, translation: Optional[torch.Tensor] = None,
           rotation: Optional[torch.Tensor] = None, source: Optional[torch.Tensor] = None, origin: Optional[torch.Tensor] = None,
           projector: Optional[Projector] = None) -> Picture:
    """A picture that torch differentiates with respect to the tensors that are given here. The scene takes their values.

    points: of the mesh, n x 3, mm; of several samples a tensor each
    translation: samples x 3, mm
    rotation: samples x 3, along the axes about which samples turn, as long as the angle, rad
    source: its position, or the direction of parallel rays
    origin: of the detector
    projector: as Scene.expose

    Raises InputError as Exposure.backward: pictures with noise, scatter or refraction have no gradient."""
    if isinstance(points, torch.Tensor):
        points = [points]
    if points is not None and len(points) != len(scene.samples):
        raise InputError(f"points: expected those of {len(scene.samples)} samples, found {len(points)}")
    given: dict[Union[int, str], Any] = dict(enumerate(points or ()))
    given.update({name: tensor for name, tensor in (("translation", translation), ("rotation", rotation), ("source", source),
                                                    ("origin", origin)) if tensor is not None})
    for name, tensor in given.items():
        if not isinstance(tensor, torch.Tensor):
            raise InputError(f"{'points' if isinstance(name, int) else name}: expected a tensor, found {type(tensor).__name__}")
    transmission, path_lengths = _Expose.apply(scene, projector, tuple(given), *given.values())
    return Picture(transmission, path_lengths)
