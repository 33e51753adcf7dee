// A hand bell of 120 mm across its mouth, as a body of revolution about z. Millimetres.
DefineConstant[ size = {12, Name "size"} ];  // of elements, at most
SetFactory("OpenCASCADE");
Point(1) = {60, 0, 0};    Point(2) = {51, 0, 14};  Point(3) = {45, 0, 36};   // the outside, from the lip to the shoulder
Point(4) = {40, 0, 62};   Point(5) = {30, 0, 78};  Point(6) = {12, 0, 84};
Point(7) = {12, 0, 78};   Point(8) = {27, 0, 73};  Point(9) = {36.4, 0, 60};  // the inside, from the crown to the lip
Point(10) = {41, 0, 36};  Point(11) = {46, 0, 15}; Point(12) = {57, 0, 0};
Spline(1) = {1, 2, 3, 4, 5, 6};
Line(2) = {6, 7};
Spline(3) = {7, 8, 9, 10, 11, 12};
Line(4) = {12, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
bell[] = Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; };
Recursive Delete { Surface{1}; }
Physical Volume("bell") = {bell[1]};
Physical Surface("outside") = {bell[2]};
Physical Surface("crown") = {bell[3]};  // the hole for the handle
Mesh.MeshSizeMax = size;
Mesh.MeshSizeFromCurvature = 12;
