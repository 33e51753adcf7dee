// The head of the mallet, a rod along x that strikes with its left end. A sleeve guides its shaft. Millimetres.
DefineConstant[ length = {40, Name "length"}, radius = {8, Name "radius"}, size = {7, Name "size"} ];  // size: of elements
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, length, 0, 0, radius};
r = radius + 0.1;
Physical Volume("head") = {1};
Physical Surface("tip") = Surface In BoundingBox {-0.1, -r, -r, 0.1, r, r};
Physical Surface("shaft") = Surface In BoundingBox {-0.1, -r, -r, length + 0.1, r, r};
Physical Surface("shaft") -= Surface In BoundingBox {-0.1, -r, -r, 0.1, r, r};
Physical Surface("shaft") -= Surface In BoundingBox {length - 0.1, -r, -r, length + 0.1, r, r};
Mesh.MeshSizeMax = size;
