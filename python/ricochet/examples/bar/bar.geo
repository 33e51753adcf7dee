// A bar of 200 mm x 32 mm x 10 mm about the origin, which is struck in the middle of its upper side. Millimetres.
DefineConstant[ size = {14, Name "size"} ];  // of elements, at most
SetFactory("OpenCASCADE");
Box(1) = {-100, -16, -5, 200, 32, 10};
Rectangle(100) = {-5, -5, 5, 10, 10};
BooleanFragments { Volume{1}; Delete; } { Surface{100}; Delete; }
Physical Volume("bar") = Volume{:};
Physical Surface("middle") = Surface In BoundingBox {-5.1, -5.1, 4.9, 5.1, 5.1, 5.1};
Mesh.MeshSizeMax = size;
