% SPDX-License-Identifier: Apache-2.0
1; % a script
% The scene of TestSameScene.cxx, whose arrays lie in this folder, by mammoray_project.
function values = numbers (name, columns)
  file = fopen (name, 'r');
  values = reshape (fread (file, Inf, 'double'), columns, [])';
  fclose (file);
end

function put (name, pictures)
  file = fopen (name, 'w');
  fwrite (file, permute (pictures, [2 1 3]), 'single'); % row by row
  fclose (file);
end

if any (strcmp (argv (), 'file'))
  [image, lengths] = mammoray_project ('scene.json');
  put ('transmission', image);
  put ('lengths', lengths);
  return
end
place = numbers ('place', 1);
detector = struct ('origin', place(4:6)', 'column_step', place(7:9)', 'row_step', place(10:12)', ...
                   'columns', place(13), 'rows', place(14), 'samples', place(15));
[image, lengths] = mammoray_project (numbers ('points', 3), numbers ('triangles', 3) + 1, ...
                                     numbers ('sides', 2), numbers ('mu', 2)', place(1:3)', ...
                                     detector, numbers ('weights', 1)');
put ('transmission', image);
put ('lengths', lengths);
