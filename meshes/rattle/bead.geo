// A wooden bead of 12 mm.
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 6e-3};
Mesh.MeshSizeMin = 3e-3;
Mesh.MeshSizeMax = 3e-3;
Physical Volume("bead") = {1};
