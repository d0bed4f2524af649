# value r g b a      density 0 to 1, opacity per voxel length: grey matter, then white
0.00 0.00 0.00 0.00 0.0
0.12 0.45 0.16 0.16 0.0
0.30 0.74 0.40 0.36 0.05
0.50 0.90 0.62 0.54 0.30
0.70 0.96 0.82 0.72 0.60
1.00 1.00 0.94 0.88 1.0
