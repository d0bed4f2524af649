# value r g b a      density 0 to 1, opacity per voxel length: filaments opaque
0.00 0.00 0.00 0.00 0.0
0.10 0.25 0.08 0.40 0.0
0.20 0.50 0.12 0.55 0.10
0.40 0.92 0.35 0.25 0.40
0.65 1.00 0.75 0.30 0.80
1.00 1.00 0.98 0.90 1.0
