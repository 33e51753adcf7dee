// The back shell of phone.step, which drawing.py made. Millimetres, as in the drawing. "edges" are the parts of its outside that a
// plane can touch: without the back, over which the frame of the camera stands, and without the sides of the rim.
DefineConstant[ size = {11, Name "size"} ];   // of elements, at most
SetFactory("OpenCASCADE");
Merge "phone.step";
Physical Volume("shell") = Volume{:};
Physical Surface("edges") = {1, 2, 3, 5, 6, 8, 10, 11, 15, 17:22, 28, 33:35, 39, 46};
Mesh.MeshSizeMax = size;
