// A solid disk in the x-y plane, its middle plane at z = 0.
// The rim is cut into elements of 11.25° or a whole fraction of it, so that the 17 positions of a half rim are mesh lines.
DefineConstant[
  radius = {0.05, Name "radius"},
  thickness = {5e-3, Name "thickness"},
  size = {5e-3, Name "size"}
];
SetFactory("Built-in");
quarter = 8 * Ceil(radius * Pi / 2 / 8 / size - 1e-6);
z = -thickness / 2;
Point(1) = {0, 0, z, size};
Point(2) = {radius, 0, z, size};
Point(3) = {0, radius, z, size};
Point(4) = {-radius, 0, z, size};
Point(5) = {0, -radius, z, size};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Transfinite Curve{1, 2, 3, 4} = quarter + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
disk[] = Extrude {0, 0, thickness} { Surface{1}; Layers{1}; };
Physical Volume("disk") = {disk[1]};
Physical Surface("upper rim") = {disk[2], disk[3]};
Physical Surface("lower rim") = {disk[4], disk[5]};
