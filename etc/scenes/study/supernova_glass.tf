# value r g b a      density 0 to 1, opacity per voxel length: mostly transparent
0.00 0.00 0.00 0.00 0.0
0.05 0.10 0.25 0.90 0.0
0.25 0.20 0.55 1.00 0.0035
0.50 0.35 0.90 0.90 0.008
0.75 1.00 0.75 0.40 0.020
1.00 1.00 0.95 0.85 0.05
