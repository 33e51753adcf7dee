// One half of a clothes peg, 72 mm long and 10 mm wide: the jaw is at x = 0, the handle at the other end. Lengths in metres.
DefineConstant[
  width = {0.010, Name "width"},
  size = {0.010, Name "size"}
];
SetFactory("Built-in");
x[] = {0, 30, 72, 72, 50, 20, 6};
z[] = {0, 0, 0.005, 0.009, 0.011, 0.011, 0.006};
For k In {0:6}
  Point(1 + k) = {x[k] / 1000, 0, z[k], size};
EndFor
For k In {0:6}
  Line(1 + k) = {1 + k, 1 + (k + 1) % 7};
EndFor
Curve Loop(1) = {1:7};
Plane Surface(1) = {1};
peg[] = Extrude {0, width, 0} { Surface{1}; };
Physical Volume("peg") = {peg[1]};
