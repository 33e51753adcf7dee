// The bell of bell.step, which drawing.py made, with names for its parts. Millimetres, as in the drawing.
DefineConstant[
  size = {30, Name "size"},       // of elements, at most
  struck = {6, Name "struck"},    // of elements where the clapper strikes
  around = {12, Name "around"}    // elements around a full circle, so that curved ones keep their shape
];
SetFactory("OpenCASCADE");
Merge "bell.step";
Physical Volume("bell") = Volume{:};
Physical Surface("crown") = {2};
Physical Surface("inside") = {5};
Mesh.MeshSizeMax = size;
Mesh.MeshSizeFromCurvature = around;
Field[1] = Ball;
Field[1].XCenter = 149;
Field[1].ZCenter = 40;
Field[1].Radius = 8;
Field[1].Thickness = 40;
Field[1].VIn = struck;
Field[1].VOut = size;
Background Field = 1;
