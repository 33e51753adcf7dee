// A solid ball of tetrahedra, for the cost of bodies whose factors fill in more than those of plates.
DefineConstant[
  radius = {0.05, Name "radius"},
  size = {5e-3, Name "size"}
];
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, radius};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
Physical Volume("ball") = {1};
Physical Surface("skin") = {1};
