// A glass marble of 16 mm.
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 8e-3};
Mesh.MeshSizeMin = 3e-3;
Mesh.MeshSizeMax = 3e-3;
Physical Volume("marble") = {1};
