// The mesh of hopkinson_time_piece.toml: gmsh -2 hopkinson_time_piece.geo
// A bar of 150 mm x 5 mm and a time piece of 50 mm, joined along a line; coordinates in mm.
h = 2;
Point(1) = {0, 0, 0, h}; Point(2) = {150, 0, 0, h}; Point(3) = {200, 0, 0, h};
Point(4) = {200, 5, 0, h}; Point(5) = {150, 5, 0, h}; Point(6) = {0, 5, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1}; Line(7) = {2, 5};
Curve Loop(1) = {1, 7, 5, 6}; Plane Surface(1) = {1};
Curve Loop(2) = {2, 3, 4, -7}; Plane Surface(2) = {2};
Physical Surface("steel") = {1, 2};
Physical Curve("struck end") = {6};
Physical Curve("free end") = {3};
Physical Curve("joint") = {7};
Mesh.MshFileVersion = 4.1;
