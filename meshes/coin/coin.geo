// A coin of one euro, without its pattern: its axis is z.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, -1.165e-3, 0, 0, 2.33e-3, 11.625e-3};
Mesh.MeshSizeMin = 3e-3;
Mesh.MeshSizeMax = 3e-3;
Physical Volume("coin") = {1};
