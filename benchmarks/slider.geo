// A steel box on its face, for steps in which a known number of points slides.
DefineConstant[
  along = {16, Name "along"},
  across = {17, Name "across"}
];
SetFactory("Built-in");
a = 0.04;
Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {a, a, 0}; Point(4) = {0, a, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = along + 1; Transfinite Curve{2, 4} = across + 1;
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1};
Transfinite Surface{1}; Recombine Surface{1};
box[] = Extrude {0, 0, a / 2} { Surface{1}; Layers{4}; Recombine; };
Physical Volume("box") = {box[1]};
Physical Surface("foot") = {1};
