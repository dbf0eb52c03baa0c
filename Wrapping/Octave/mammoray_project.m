% MAMMORAY_PROJECT  Synthetic X-ray of a triangle mesh.
%
%   IMAGE = mammoray_project (VERTICES, FACES, REGIONS, ATTENUATION, SOURCE, DETECTOR)
%   [IMAGE, LENGTHS, CONSISTENCY] = mammoray_project (..., WEIGHTS)
%   [IMAGE, LENGTHS, CONSISTENCY] = mammoray_project (SCENE)
%   [..., DLENGTHS, DIMAGE] = mammoray_project (..., WEIGHTS, VELOCITIES)
%
%   Sends an X-ray from the source to every pixel, sums its length in each region between the
%   triangles and applies the Beer-Lambert law. The first Vulkan device of 'mammoray devices' works.
%
%   SCENE        path of a scene file (.json) with samples or a mesh, source and detector, as of
%                'mammoray project --scene'; K is its number of materials but air.
%   VERTICES     n x 3, positions, mm.
%   FACES        m x 3, rows of VERTICES, from 1. A triangle's front is where its normal
%                (p2 - p1) x (p3 - p1) points to.
%   REGIONS      m x 2, the regions in front of and behind each triangle, or m x 1, the region
%                behind it with air in front. 0 is air, which absorbs nothing; others are from 1.
%                The surfaces around each region must close.
%   ATTENUATION  K x E, linear attenuation of region k at energy e, 1/mm, positive.
%   SOURCE       1 x 3, position of the source, mm; or a struct with the field 'direction', 1 x 3, in
%                which parallel X-rays travel.
%   DETECTOR     struct with the fields
%                  origin      1 x 3, centre of the first pixel, IMAGE(1, 1), mm
%                  column_step 1 x 3, from a pixel to that of the next column, mm
%                  row_step    1 x 3, from a pixel to that of the next row, mm
%                  columns, rows        number of pixels, 1 to 65535
%                  samples     (optional) samples x samples rays per pixel, 1 to 16, default 1
%   WEIGHTS      1 x E, what the detector counts of each energy without the object, any common
%                factor, not negative; default, also of []: all energies the same.
%   VELOCITIES   n x 3 x P, how the vertices move with each of P parameters, mm per unit of it.
%
%   Numbers may be double, single or of any whole type.
%
%   IMAGE        rows x columns, transmission I / I0, 0 to 1.
%   LENGTHS      rows x columns x K, length of each X-ray in each region, mm.
%   CONSISTENCY  rows x columns, true where the rays of the pixel crossed closed surfaces; elsewhere
%                the mesh leaks, which is warned of (mammoray:open), and values are estimated.
%   DLENGTHS     rows x columns x K x P, how LENGTHS change with each parameter, mm per unit of it.
%   DIMAGE       rows x columns x P, how IMAGE changes, per unit of it; with several samples per
%                pixel that of the mean path lengths.
%
%   Errors have the identifiers mammoray:input (unusable arguments) and mammoray:device (no Vulkan
%   device, or one that failed).
%
%   Example: a plate of 10 mm, 0.05 / mm, before a detector of 3 x 5 pixels
%     [x, y, z] = ndgrid ([-50 50], [-50 50], [20 30]);
%     faces = [1 3 4; 1 4 2; 1 2 6; 1 6 5; 2 4 6; 8 6 4; 1 7 3; 1 5 7; 3 7 4; 8 4 7; 5 6 7; 8 7 6];
%     detector = struct ('origin', [-2 -1 0], 'column_step', [1 0 0], 'row_step', [0 1 0], ...
%                        'columns', 5, 'rows', 3);
%     image = mammoray_project ([x(:) y(:) z(:)], faces, ones (12, 1), 0.05, [0 0 600], ...
%                               detector)
function varargout = mammoray_project (varargin) %#ok
  error ('mammoray:install', ...
         'mammoray_project: expected its MEX file beside this help text, found none');
end
