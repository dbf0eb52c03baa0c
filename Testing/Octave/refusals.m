% SPDX-License-Identifier: Apache-2.0
% What mammoray_project refuses, in one line that says what was expected.
vertices = [0 0 0; 1 0 0; 0 1 0; 0 0 1];
faces = [1 3 2; 1 2 4; 1 4 3; 2 3 4];
regions = ones (4, 1);
detector = struct ('origin', [0 0 -5], 'column_step', [1 0 0], 'row_step', [0 1 0], 'columns', 2, ...
                   'rows', 2);
source = [0 0 500];

function refuses (text, varargin)
  try
    mammoray_project (varargin{:});
  catch failure
    assert (failure.identifier, 'mammoray:input');
    assert (! isempty (strfind (failure.message, text)), '%s', failure.message);
    assert (isempty (strfind (failure.message, "\n")));
    return;
  end
  error ('not refused: %s', text);
end

refuses ('6 to 8 arguments', vertices, faces);
refuses ('n x 3 vertices', vertices(:, 1:2), faces, regions, 0.1, source, detector);
refuses ('vertices: expected a matrix of numbers, found char', 'abc', faces, regions, 0.1, source, detector);
refuses ('vertices: expected a full real matrix, found a complex one', 1i * vertices, faces, regions, 0.1, source, detector);
refuses ('faces: expected a full real matrix, found a sparse one', vertices, sparse (faces), regions, 0.1, source, detector);
refuses ('faces(2, :): expected a whole number from 1 to 4, found 9', vertices, ...
         [1 3 2; 1 2 9; 1 4 3; 2 3 4], regions, 0.1, source, detector);
refuses ('found 0', vertices, faces - 1, regions, 0.1, source, detector);
refuses ('regions(1, :)', vertices, faces, 2 * regions, 0.1, source, detector);
refuses ('regions: expected 4 x 2', vertices, faces, ones (3, 1), 0.1, source, detector);
refuses ('positive coefficients', vertices, faces, regions, 0, source, detector);
refuses ('source: expected three numbers', vertices, faces, regions, 0.1, [0 0], detector);
refuses ("source: no field 'diretion'; did you mean direction?", vertices, faces, regions, 0.1, struct ('diretion', [0 0 1]), detector);
refuses ('source.direction', vertices, faces, regions, 0.1, struct ('direction', 1), detector);
refuses ('source: expected one struct, found 0', vertices, faces, regions, 0.1, struct ('direction', {}), detector);
refuses ('detector: expected one struct, found 2', vertices, faces, regions, 0.1, source, [detector, detector]);
refuses ("detector: no field 'colums'; did you mean columns", vertices, faces, regions, 0.1, source, setfield (detector, 'colums', 2));
refuses ("detector: no field 'sample'; did you mean samples?", vertices, faces, regions, 0.1, source, setfield (detector, 'sample', 2));
refuses ('detector: expected a struct', vertices, faces, regions, 0.1, source, 5);
refuses ('detector.row_step', vertices, faces, regions, 0.1, source, rmfield (detector, 'row_step'));
refuses ('detector.rows: expected a whole number', vertices, faces, regions, 0.1, source, ...
         setfield (detector, 'rows', 2.5));
refuses ('weights: expected one', vertices, faces, regions, 0.1, source, detector, [1 2]);
refuses ('velocities: expected 4 x 3 x parameters, found 3 x 3', vertices, faces, regions, 0.1, source, detector, [], ones (3, 3));
try
  [a, b, c, d] = mammoray_project (vertices, faces, regions, 0.1, source, detector);
  error ('not refused: derivatives without velocities');
catch failure
  assert (! isempty (strfind (failure.message, 'expected them as argument 8')), '%s', failure.message);
end
vertices(2, 1) = NaN;
refuses ('finite', vertices, faces, regions, 0.1, source, detector);
assert (! isempty (strfind (help ('mammoray_project'), 'LENGTHS')));
