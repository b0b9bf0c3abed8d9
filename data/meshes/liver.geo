// liver.geo: a closed shape like a liver, a wide right lobe and a thin left one (two ellipsoids), 110 mm long, between
// flats 30 mm apart; y is the direction of compression. Graded towards the rims of the flats.
SetFactory("OpenCASCADE");
If (!Exists(size)) size = 8; EndIf
If (!Exists(rim)) rim = 0.5 * size; EndIf
R = 100; H = 30; reach = 8;
Sphere(1) = {0, 0, 0, 1};
Dilate {{0, 0, 0}, {34, 20, 26}} { Volume{1}; }
Sphere(2) = {0, 0, 0, 1};
Dilate {{0, 0, 0}, {36, 15, 16}} { Volume{2}; }
Rotate {{0, 0, 1}, {0, 0, 0}, 0.12} { Volume{2}; }
Translate {26, 1, 5} { Volume{2}; }
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Box(4) = {-R, -H/2, -R, 2*R, H, 2*R};
BooleanIntersection(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
Include "body.geo";
