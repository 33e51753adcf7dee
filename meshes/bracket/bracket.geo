// An angle bracket of 60 x 40 x 40 mm, 6 mm thick, in the axes of the drawing: the foot lies on z = 0, the wall stands at x = 0. One corner
// of the foot is worn to a sphere. It strikes a floor if the bracket is turned by `roll` about x and then by `pitch` about y, both between
// 30 and 40 degrees. Elements are `size` wide within `reach` of the point that is then the lowest, and grow from there. Lengths in
// metres.
DefineConstant[
  length = {0.06, Name "length"},
  width = {0.04, Name "width"},
  height = {0.04, Name "height"},
  thickness = {0.006, Name "thickness"},
  radius = {0.0058, Name "radius"},  // of the corner
  roll = {35, Name "roll"},          // degrees
  pitch = {35, Name "pitch"},        // degrees
  reach = {3e-4, Name "reach"},
  size = {1e-4, Name "size"},
  largest = {8e-3, Name "largest"}
];
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, length, width, thickness};
Box(2) = {0, 0, 0, thickness, width, height};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
// What is beyond the sphere in a cube about the corner is worn away. The sphere leaves the cube through its edges.
s = radius / 1.45;
Box(4) = {length - s, 0, 0, s, s, s};
Sphere(5) = {length - s, s, s, radius};
BooleanDifference(6) = { Volume{4}; Delete; }{ Volume{5}; Delete; };
bracket[] = BooleanDifference{ Volume{3}; Delete; }{ Volume{6}; Delete; };
Physical Volume("bracket") = {bracket[0]};
Physical Surface("corner") = Surface In BoundingBox{length - s, -s, -s, length + s, s, s};  // the box of a sphere is loose
// The point of the sphere in the direction that is down after the two rotations.
a = roll * Pi / 180;
b = pitch * Pi / 180;
x0 = length - s + radius * Sin(b);
y0 = s - radius * Sin(a) * Cos(b);
z0 = s - radius * Cos(a) * Cos(b);
Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.75 * (Sqrt((x - %g)^2 + (y - %g)^2 + (z - %g)^2) - %g)", size, x0, y0, z0, reach);
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = largest;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
