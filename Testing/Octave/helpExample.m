% SPDX-License-Identifier: Apache-2.0
% The example of the help text, run as it stands there.
text = help ('mammoray_project');
try
  eval (text(strfind (text, '[x, y, z]')(1):end));
catch failure
  if strcmp (failure.identifier, 'mammoray:device')
    disp (failure.message);
    exit (125);
  end
  rethrow (failure);
end
% 10 mm of 0.05 / mm, straight up in the middle.
assert (size (image), [3 5]);
assert (image(2, 3), exp (-0.5), 1e-6); % a float
