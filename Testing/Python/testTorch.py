# SPDX-License-Identifier: Apache-2.0
"""Pictures within PyTorch: gradients against Exposure.backward and differences, and a pose that is found by them. Exit 125: no torch or
no device."""
import sys

import mammoray as mr
import numpy

try:
    import torch
except ImportError as error:
    print(error)
    sys.exit(125)
import mammoray.torch

# A crooked pyramid, and a tetrahedron.
CORNERS = numpy.array([(-8, -5, -6), (12, -5, -6), (-8, 7, -6), (-8, -5, 9), (3, 6, 8), (-4, 2, 12)], dtype=float)
FACES = [(2, 1, 0), (1, 2, 4), (4, 5, 1), (2, 5, 4), (0, 1, 3), (1, 5, 3), (3, 2, 0), (3, 5, 2)]
SMALL = numpy.array([(14, 0, 0), (19, 1, 0), (15, 6, 1), (15, 2, 7)], dtype=float)


def scene_of():
    meshes = (mr.Mesh(CORNERS, FACES), mr.Mesh(SMALL, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]))
    return mr.Scene([mr.Sample(mesh, mu) for mesh, mu in zip(meshes, (0.03, 0.05))], source=mr.Source((0, -300, 0)), beam=mr.Beam(kev=60),
                    detector=mr.Detector((-31.5, 100, 31.5), (1, 0, 0), (0, 0, -1), 64, 64, 1))


if not mr.devices():
    print("no Vulkan device")
    sys.exit(125)
scene = scene_of()
points = [torch.tensor(mesh, requires_grad=True) for mesh in (CORNERS, SMALL)]
places = {"translation": [(1, 2, 3), (0, 0, 0)], "rotation": [(0.1, -0.2, 0.3), (0, 0, 0)], "source": (3, -300, 1), "origin": (-31, 100, 31)}
others = {name: torch.tensor(values, dtype=torch.float32, requires_grad=True) for name, values in places.items()}
picture = mammoray.torch.expose(scene, points=points, **others)
plain = scene.expose()
assert scene.samples[0].translation == (1, 2, 3) and numpy.array_equal(picture.transmission.detach().numpy(), plain.transmission)
weights = torch.from_numpy(numpy.random.default_rng(3).normal(size=(64, 64)).astype(numpy.float32))
(weights * picture.transmission).sum().backward()
expected = plain.backward(transmission=weights.numpy())
for found, wanted in [*zip(points, expected.points), *((tensor, getattr(expected, name)) for name, tensor in others.items())]:
    # Those in single precision are rounded.
    assert found.grad.dtype == found.dtype and abs(wanted).max() > 0
    assert numpy.allclose(found.grad.numpy(), wanted, rtol=1e-6, atol=1e-6 * abs(wanted).max())

# An attenuation of one's own, by path lengths: the same gradient, and the attenuation's as well.
fresh = [torch.tensor(mesh, requires_grad=True) for mesh in (CORNERS, SMALL)]
mu = torch.tensor([0.0, 0.03, 0.05], requires_grad=True)
lengths = mammoray.torch.expose(scene, points=fresh).path_lengths
(weights * torch.exp(-(mu[:, None, None] * lengths).sum(dim=0))).sum().backward()
for one, other in zip(points, fresh):
    assert numpy.allclose(one.grad.numpy(), other.grad.numpy(), rtol=0, atol=1e-4 * abs(one.grad).max().item())
assert numpy.allclose((mu.grad * mu.detach())[1:].numpy(), list(expected.attenuation.values())[1:], rtol=1e-3)

# Where a part was, by an optimiser of torch that knows nothing of X-rays.
scene = scene_of()
scene.samples = scene.samples[:1]
hidden = torch.tensor([[2.0, -3.0, 1.5]]), torch.tensor([[0.10, -0.16, 0.07]])
with torch.no_grad():
    wanted = mammoray.torch.expose(scene, translation=hidden[0], rotation=hidden[1]).transmission
place = [torch.zeros((1, 3), dtype=torch.float64, requires_grad=True) for _ in range(2)]
optimizer = torch.optim.LBFGS(place, max_iter=100, line_search_fn="strong_wolfe", tolerance_change=1e-12)


def loss():
    optimizer.zero_grad()
    # A radian moves the part's corners by some 10 mm.
    misfit = ((mammoray.torch.expose(scene, translation=place[0], rotation=place[1] / 10).transmission.double() - wanted) ** 2).sum()
    misfit.backward()
    return misfit


optimizer.step(loss)
errors = [abs(place[0].detach() - hidden[0]).max().item(), abs(place[1].detach() / 10 - hidden[1]).max().item()]
assert errors[0] < 0.02 and errors[1] < 0.002, errors

for message, arguments in (("points: expected those of 1 samples, found 2", {"points": points}),
                           ("source: expected a tensor, found tuple", {"source": (0, 0, 1)}),
                           ("translation: expected 1 x 3 values", {"translation": torch.zeros((2, 3))})):
    try:
        mammoray.torch.expose(scene, **arguments)
        raise AssertionError(f"not refused: {message}")
    except mr.InputError as error:
        assert message in str(error), error
print(f"torch {torch.__version__}: {errors[0]:.4f} mm, {errors[1]:.5f} rad")
