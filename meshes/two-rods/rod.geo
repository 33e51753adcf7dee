// A rod along x in equal line elements.
DefineConstant[
  length = {10, Name "length"},
  elements = {100, Name "elements"}
];
Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Line(1) = {1, 2};
Transfinite Curve{1} = elements + 1;
Physical Curve("rod") = {1};
Physical Point("left") = {1};
Physical Point("right") = {2};
