# value r g b a      opacity per voxel length: skin half transparent, bones within
range 0 1
0.00 0.05 0.20 0.10 0.0
0.35 0.10 0.50 0.30 0.0
0.44 0.25 0.85 0.50 0.050
0.50 0.50 0.60 0.40 0.004
0.58 0.95 0.80 0.55 0.10
0.75 1.00 0.92 0.76 0.60
1.00 1.00 0.98 0.92 0.90
