// ball.geo: a sphere of radius 12 mm, for plates that touch it.
SetFactory("OpenCASCADE");
If (!Exists(size)) size = 4; EndIf
Sphere(1) = {0, 0, 0, 12};
Physical Volume("specimen") = {1};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
Mesh.MeshSizeFromPoints = 0;
Mesh.MshFileVersion = 4.1;
