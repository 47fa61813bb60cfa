// 20 mm x 10 mm, left half steel, right half glass, a crack from the lower edge, a hole in the glass
h = 4;
Point(1) = {0, 0, 0, h}; Point(2) = {5, 0, 0, h}; Point(3) = {10, 0, 0, h}; Point(4) = {20, 0, 0, h};
Point(5) = {20, 10, 0, h}; Point(6) = {10, 10, 0, h}; Point(7) = {0, 10, 0, h}; Point(8) = {5, 5, 0, h};
Point(9) = {15, 5, 0, h}; Point(10) = {17, 5, 0, h}; Point(11) = {13, 5, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 1};
Line(8) = {3, 6}; Line(9) = {2, 8};
Circle(10) = {10, 9, 11}; Circle(11) = {11, 9, 10};
Curve Loop(1) = {1, 2, 8, 6, 7}; Plane Surface(1) = {1}; Curve{9} In Surface{1};
Curve Loop(2) = {3, 4, 5, -8}; Curve Loop(3) = {10, 11}; Plane Surface(2) = {2, 3};
Physical Surface("steel", 21) = {1}; Physical Surface("glass", 22) = {2};
Physical Curve("left side", 11) = {7}; Physical Curve("Rand unten ü", 12) = {1, 2, 3}; Physical Curve("right", 13) = {4};
Physical Curve("crack", 14) = {9}; Physical Curve("hole", 15) = {10, -11}; Physical Curve("joint", 16) = {8};
