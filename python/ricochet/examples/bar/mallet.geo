// The head of the mallet, a rod along x that strikes with a square of 6 mm in its left end. A sleeve guides its shaft. Millimetres.
DefineConstant[ length = {40, Name "length"}, radius = {8, Name "radius"}, size = {9, Name "size"} ];  // size: of elements
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, length, 0, 0, radius};
Rectangle(100) = {-3, -3, 0, 6, 6};
Rotate { {0, 1, 0}, {0, 0, 0}, Pi / 2 } { Surface{100}; }
BooleanFragments { Volume{1}; Delete; } { Surface{100}; Delete; }
r = radius + 0.1;
Physical Volume("head") = Volume{:};
Physical Surface("tip") = Surface In BoundingBox {-0.1, -3.1, -3.1, 0.1, 3.1, 3.1};
Physical Surface("shaft") = Surface In BoundingBox {-0.1, -r, -r, length + 0.1, r, r};
Physical Surface("shaft") -= Surface In BoundingBox {-0.1, -r, -r, 0.1, r, r};
Physical Surface("shaft") -= Surface In BoundingBox {length - 0.1, -r, -r, length + 0.1, r, r};
Mesh.MeshSizeMax = size;
