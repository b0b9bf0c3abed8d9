/* indentation_tables.h: factors of the forces of CalculiX; data/tips/make_tables.py writes it. Internal. */
#ifndef INDENTATION_TABLES_H
#define INDENTATION_TABLES_H

enum { TABLE_NU = 5, TABLE_RATIO = 4, TABLE_DEPTH = 4, TABLE_AROUND = 5, TABLE_SLENDER = 5 };
static const double table_nu[TABLE_NU] = {0.3, 0.4, 0.45, 0.49, 0.5};
static const double table_ratio[TABLE_RATIO] = {0.2, 0.5, 1, 2}; /* punch over thickness */
static const double table_around[TABLE_AROUND] = {1, 1.25, 1.5, 2, 3}; /* specimen over punch */
static const double table_slender[TABLE_SLENDER] = {0.2, 0.5, 1, 2, 4}; /* radius over height */

/* Flat punch, neo-Hookean, at a quarter, a half, three quarters and all of a depth of 0.2 thicknesses or 0.4 radii. */
static const double table_large[TABLE_NU][TABLE_RATIO][TABLE_DEPTH] = {
    {{0.98542, 0.96879, 0.95441, 0.94110}, {0.99398, 0.98936, 0.98746, 0.97694}, {1.01272, 1.02597, 1.04148, 1.05918}, {1.02074, 1.04269, 1.06681, 1.09351}},
    {{0.99016, 0.97761, 0.96777, 0.95845}, {1.00458, 1.01243, 1.02290, 1.02439}, {1.02607, 1.05479, 1.08780, 1.12366}, {1.03389, 1.06977, 1.10814, 1.14804}},
    {{0.99392, 0.98378, 0.97765, 0.97257}, {1.01323, 1.03238, 1.05611, 1.07882}, {1.03976, 1.08642, 1.14175, 1.20395}, {1.05327, 1.11280, 1.17888, 1.24965}},
    {{0.99447, 0.98934, 0.98502, 0.98120}, {1.02286, 1.05244, 1.08643, 1.12348}, {1.05810, 1.12953, 1.21370, 1.31067}, {1.08864, 1.19569, 1.32079, 1.46716}},
    {{0.99625, 0.98921, 0.98254, 0.97720}, {1.02590, 1.05247, 1.08543, 1.12341}, {1.06644, 1.13908, 1.22603, 1.33094}, {1.10393, 1.22514, 1.37358, 1.55584}},
};

/* Flat punch on a cylinder. */
static const double table_wide[TABLE_NU][TABLE_RATIO][TABLE_AROUND] = {
    {{0.23567, 0.35754, 0.47638, 0.67257, 0.87928}, {0.44246, 0.64407, 0.78231, 0.91938, 0.98797}, {0.59136, 0.82632, 0.92948, 0.98844, 0.99888}, {0.72472, 0.94879, 0.99042, 0.99886, 1.00000}},
    {{0.21535, 0.32802, 0.44033, 0.63185, 0.84599}, {0.39473, 0.58049, 0.71676, 0.86994, 0.96968}, {0.51047, 0.73406, 0.85993, 0.95956, 0.99295}, {0.61731, 0.87224, 0.95727, 0.99192, 1.00000}},
    {{0.20262, 0.30942, 0.41737, 0.60517, 0.82292}, {0.36351, 0.53829, 0.67164, 0.83244, 0.95261}, {0.45339, 0.66492, 0.80106, 0.92882, 0.98535}, {0.52791, 0.79350, 0.91422, 0.98119, 1.00000}},
    {{0.19102, 0.29243, 0.39628, 0.58023, 0.80052}, {0.33404, 0.49820, 0.62769, 0.79370, 0.93288}, {0.39630, 0.59297, 0.73479, 0.88923, 0.97419}, {0.42526, 0.68730, 0.84575, 0.96129, 1.00000}},
    {{0.18687, 0.28716, 0.38977, 0.57219, 0.79308}, {0.32433, 0.48497, 0.61321, 0.78056, 0.92542}, {0.37856, 0.56902, 0.71175, 0.87534, 0.96964}, {0.39364, 0.64938, 0.81984, 0.95260, 1.00000}},
};

/* Flat punch that sticks. */
static const double table_stick[TABLE_NU][TABLE_RATIO] = {
    {1.03423, 1.02510, 1.01179, 1.00615},
    {1.01152, 1.00481, 1.00584, 1.02188},
    {1.00406, 1.00257, 1.02519, 1.08098},
    {1.00414, 1.01388, 1.08530, 1.27689},
    {1.00686, 1.02325, 1.12862, 1.42540},
};

/* Cylinder glued to both plates. */
static const double table_glue[TABLE_NU][TABLE_SLENDER] = {
    {1.02240, 1.05576, 1.11999, 1.21189, 1.27750},
    {1.04244, 1.10984, 1.25767, 1.54302, 1.81355},
    {1.05656, 1.14953, 1.37374, 1.93529, 2.67558},
    {1.07170, 1.19261, 1.51339, 2.65030, 5.67309},
    {1.07844, 1.21450, 1.58028, 3.01140, 8.82253},
};

/* Sphere and cone, neo-Hookean: coefficients of the terms of large_curved(); the sizes and depths that they hold for, over the thickness h: radius,
 * half angle's tangent, and the deepest, 0.16 R h / (R + 0.1 h) and 0.15 h. */
enum { LARGE_TERMS = 9 };
static const double large_sphere[LARGE_TERMS] = {0.00467, -0.02494, -0.01393, -0.00363, 0.01115, 0.03253, -0.02491, 0.01215, -0.00113};
static const double large_cone[LARGE_TERMS] = {0.01952, -0.00569, -0.00826, 0.01265, -0.00938, -0.10367, -0.02871, 0.08584, -0.05213};
static const double SPHERE_DEPTH = 0.16, SPHERE_SHARE = 0.1, SPHERE_LEAST = 0.3, SPHERE_MOST = 4.0;
static const double CONE_DEPTH = 0.15, CONE_LEAST = 2.747477, CONE_MOST = 5.671282;

#endif
