# value r g b a      opacity per voxel length: skin half transparent, bones within
range 0 1
0.00 0.05 0.20 0.10 0.0
0.34 0.10 0.50 0.30 0.0
0.42 0.22 0.80 0.45 0.060
0.48 0.70 0.90 0.40 0.020
0.56 0.95 0.70 0.40 0.10
0.70 1.00 0.88 0.68 0.70
1.00 1.00 0.98 0.92 0.95
