// Half a hemisphere, y ≥ 0 and z ≤ 0, about the origin: one plane of symmetry, a flat base, contact about the pole
// z = -radius. Elements are `size` wide out to `reach` from the pole and grow from there. Lengths in metres.
DefineConstant[
  radius = {0.01, Name "radius"},
  reach = {6.4e-5, Name "reach"},
  size = {1.28e-5, Name "size"},
  largest = {3e-3, Name "largest"}
];
SetFactory("OpenCASCADE");
angle = 2 * Asin(reach / 2 / radius);
Point(1) = {0, 0, -radius};
Point(2) = {radius * Sin(angle), 0, -radius * Cos(angle)};
Point(3) = {radius, 0, 0};
Point(4) = {0, 0, 0};
Circle(1) = {1, 4, 2};
Circle(2) = {2, 4, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
dome[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi} { Surface{1}; };
d = 1e-3 * radius;  // OpenCASCADE's boxes are loose
Physical Volume("dome") = {dome[1]};
Physical Surface("y plane") = Surface In BoundingBox{-2 * radius, -d, -2 * radius, 2 * radius, d, 2 * radius};
Physical Surface("base") = Surface In BoundingBox{-2 * radius, -d, -d, 2 * radius, 2 * radius, d};
Physical Surface("cap") = Surface In BoundingBox{-reach - d, -d, -2 * radius, reach + d, reach + d, -radius * Cos(angle) + d};
Field[1] = Distance;
Field[1].PointsList = {1};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = size;
Field[2].SizeMax = largest;
Field[2].DistMin = reach;
Field[2].DistMax = reach + (largest - size) / 0.4;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
