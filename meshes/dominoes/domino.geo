// A domino of 48 x 24 x 7.5 mm that stands on its end, in few elements, because every node is a contact candidate.
SetFactory("OpenCASCADE");
Box(1) = {-3.75e-3, -12e-3, 0, 7.5e-3, 24e-3, 48e-3};
Transfinite Curve{:} = 2;
Transfinite Curve{2, 4, 6, 8} = 3;
Transfinite Curve{1, 3, 5, 7} = 5;
Transfinite Surface{:};
Recombine Surface{:};
Transfinite Volume{:};
Physical Volume("domino") = {1};
