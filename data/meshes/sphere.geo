// sphere.geo: a sphere of radius 12 mm between flats 18 mm apart, where the plates hold it; y is the direction of
// compression. Graded towards the rims of the flats, where the stress is singular.
SetFactory("OpenCASCADE");
If (!Exists(size)) size = 4; EndIf
If (!Exists(rim)) rim = 0.4 * size; EndIf
R = 12; H = 18; reach = 5;
Sphere(1) = {0, 0, 0, R};
Box(2) = {-R, -H/2, -R, 2*R, H, 2*R};
BooleanIntersection(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Include "body.geo";
