# value r g b a      density 0 to 1, opacity per voxel length: filaments half transparent
0.00 0.00 0.00 0.00 0.0
0.12 0.20 0.12 0.85 0.0
0.30 0.35 0.25 0.90 0.015
0.50 0.85 0.35 0.55 0.04
0.70 1.00 0.70 0.35 0.10
1.00 1.00 0.95 0.85 0.25
