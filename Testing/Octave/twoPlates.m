% SPDX-License-Identifier: Apache-2.0
% Two plates on each other, as thick as fat and gland of a compressed breast, before a detector: the
% image is exp (-(mu1 d1 + mu2 d2) / cos (angle)) in closed form.
%
%   octave --path lib/mammoray/octave twoPlates.m

% Corners of the plates' faces at three heights, counter-clockwise seen from above, mm.
thickness = [20 30];
heights = 10 + cumsum ([0 thickness]);
corners = [-80 -80; 80 -80; 80 80; -80 80];
vertices = [kron(ones (3, 1), corners), kron(heights', ones (4, 1))];

% Triangles whose normals point up, and outwards at the sides; regions in front and behind.
level = @(k) 4 * (k - 1) + [1 2 3; 1 3 4];
faces = [level(1); level(2); level(3)];
regions = [1 0; 1 0; 2 1; 2 1; 0 2; 0 2];
for plate = 1:2
  for side = 1:4
    a = 4 * (plate - 1) + side;
    b = 4 * (plate - 1) + mod (side, 4) + 1;
    faces = [faces; a b b+4; a b+4 a+4];
    regions = [regions; 0 plate; 0 plate];
  end
end

% Attenuation of fat and gland at 18 and 22 keV, 1/mm, and the detected photons of each.
attenuation = [0.0633 0.0425; 0.0997 0.0637];
weights = [2 1];
source = [5 -3 650];
detector = struct ('origin', [-45 -30 0], 'column_step', [1.5 0 0], 'row_step', [0 2 0], ...
                   'columns', 61, 'rows', 31);
try
  [image, lengths] = mammoray_project (vertices, faces, regions, attenuation, source, detector, ...
                                       weights);
catch failure
  if strcmp (failure.identifier, 'mammoray:device')
    disp (failure.message);
    exit (125);
  end
  rethrow (failure);
end

x = detector.origin(1) + 1.5 * (0:60);
y = detector.origin(2) + 2 * (0:30)';
secant = sqrt ((x - source(1)) .^ 2 + (y - source(2)) .^ 2 + source(3) ^ 2) / source(3);
expected = (2 * exp (-secant * (thickness * attenuation(:, 1))) ...
            + exp (-secant * (thickness * attenuation(:, 2)))) / 3;

% Results are floats: six digits.
assert (size (image), [31 61]);
assert (size (lengths), [31 61 2]);
assert (lengths(:, :, 1), 20 * secant, 1e-5);
assert (lengths(:, :, 2), 30 * secant, 1e-5);
assert (max (max (abs (image ./ expected - 1))) < 1e-5);

% One energy, and parallel X-rays, whose path is the plates' thickness over the slant's cosine.
parallel = mammoray_project (vertices, faces, regions, [0.05; 0.08], ...
                             struct ('direction', [0 -3 -4]), detector);
assert (parallel, exp (-(20 * 0.05 + 30 * 0.08) / 0.8) * ones (31, 61), 1e-6);

% Plates apart, one region id per triangle: what is behind it.
apart = mammoray_project (vertices(5:12, :), [fliplr(level (1)); faces(5:6, :) - 4; ...
                          faces(15:22, :) - 4], ones (12, 1), 0.08, source, detector);
assert (apart, exp (-30 * 0.08 * secant), 1e-6);
printf ('%d pixels as expected, largest relative difference %.1e\n', numel (image), ...
        max (max (abs (image ./ expected - 1))));
