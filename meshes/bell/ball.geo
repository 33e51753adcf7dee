// A ball about the origin, the head of the clapper, with finer elements where it meets the wall. Millimetres.
DefineConstant[ radius = {35, Name "radius"}, size = {15, Name "size"}, struck = {6, Name "struck"} ];
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, radius};
Physical Volume("ball") = {1};
Physical Surface("skin") = Surface{:};
Mesh.MeshSizeMax = size;
Field[1] = Ball;
Field[1].XCenter = 0.83 * radius;
Field[1].ZCenter = 0.55 * radius;
Field[1].Radius = 8;
Field[1].Thickness = 25;
Field[1].VIn = struck;
Field[1].VOut = size;
Background Field = 1;
