% SPDX-License-Identifier: Apache-2.0
% Consistency, derivatives and types of mammoray_project, against closed forms.
[x, y, z] = ndgrid ([-50 50], [-50 50], [20 30]);
vertices = [x(:) y(:) z(:)];
faces = [1 3 4; 1 4 2; 1 2 6; 1 6 5; 2 4 6; 8 6 4; 1 7 3; 1 5 7; 3 7 4; 8 4 7; 5 6 7; 8 7 6];
detector = struct ('origin', [-2 -1 0], 'column_step', [1 0 0], 'row_step', [0 1 0], 'columns', 5, ...
                   'rows', 3);
source = [0 0 600];
[column, row] = meshgrid (-2:2, -1:1);
oblique = sqrt (column .^ 2 + row .^ 2 + 600 ^ 2) / 600; % of a ray in a millimetre of depth

% The top rises with the first parameter, all moves aside with the second.
velocities = zeros (8, 3, 2);
velocities(vertices(:, 3) > 25, 3, 1) = 1;
velocities(:, 1, 2) = 1;
try
  [image, lengths, consistency, dlengths, dimage] = ...
    mammoray_project (vertices, faces, ones (12, 1), [0.04 0.06; 1 1], source, detector, [3 1], velocities);
catch failure
  if (strcmp (failure.identifier, 'mammoray:device'))
    disp (failure.message);
    exit (125);
  end
  rethrow (failure);
end
assert (class (consistency), 'logical');
assert (size (consistency), [3 5]);
assert (all (consistency(:)));
assert (size (dlengths), [3 5 2 2]);
assert (size (dimage), [3 5 2]);
% Floats of 10 mm and of 1.
assert (lengths(:, :, 1), 10 * oblique, 1e-5);
assert (dlengths(:, :, 1, 1), oblique, 1e-5);
assert (dlengths(:, :, 2, 1), zeros (3, 5));
assert (dlengths(:, :, 1, 2), zeros (3, 5), 1e-5);
% I = (3 exp (-0.04 L) + exp (-0.06 L)) / 4
l = 10 * oblique;
assert (image, (3 * exp (-0.04 * l) + exp (-0.06 * l)) / 4, 1e-6);
assert (dimage(:, :, 1), -oblique .* (0.12 * exp (-0.04 * l) + 0.06 * exp (-0.06 * l)) / 4, 1e-6);
assert (dimage(:, :, 2), zeros (3, 5), 1e-6);

% One parameter is a matrix; without weights all energies are the same.
[~, ~, ~, one] = mammoray_project (vertices, faces, ones (12, 1), 0.05, source, detector, [], velocities(:, :, 1));
assert (size (one), [3 5]);
assert (one, oblique, 1e-5);

% Types: the same numbers, the same image. 20 and 50 are whole in single, too.
plain = mammoray_project (vertices, faces, ones (12, 1), 0.05, source, detector);
assert (mammoray_project (single (vertices), int32 (faces), uint8 (ones (12, 1)), 0.05, int16 (source), detector), plain);
assert (mammoray_project (int64 (vertices), uint64 (faces), int8 (ones (12, 1)), 0.05, single (source), ...
                          setfield (detector, 'columns', uint16 (5))), plain);

% Without its top the plate leaks everywhere: it is warned of and told by each pixel.
lastwarn ('');
[~, ~, leaks] = mammoray_project (vertices, faces([1:10], :), ones (10, 1), 0.05, source, detector);
[text, identifier] = lastwarn ();
assert (identifier, 'mammoray:open');
assert (! any (leaks(:)));
printf ('%d pixels as expected\n', numel (image));
