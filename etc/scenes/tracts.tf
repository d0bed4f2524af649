# value r g b a      density 0 to 1, opacity per voxel length: a veil of grey matter
0.00 0.00 0.00 0.00 0.0
0.25 0.35 0.45 0.60 0.0
0.40 0.55 0.65 0.80 0.006
0.60 0.75 0.82 0.90 0.010
1.00 1.00 1.00 1.00 0.020
