// The hollow ball of a rattle: 50 mm, with a wall of 3 mm.
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 25e-3};
Sphere(2) = {0, 0, 0, 22e-3};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.MeshSizeMin = 8e-3;
Mesh.MeshSizeMax = 8e-3;
Physical Volume("shell") = {3};
