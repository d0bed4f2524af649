# value r g b a      1 inside the water, opacity per voxel length: its surface lies at 0.6
range 0 1
0.00 0.25 0.55 0.85 0.0
0.45 0.25 0.55 0.85 0.0
0.75 0.30 0.60 0.90 0.35
1.00 0.35 0.65 0.95 0.5
