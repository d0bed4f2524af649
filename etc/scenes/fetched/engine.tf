# value r g b a      density 0 to 1, opacity per voxel length: aluminium, then steel
0.00 0.00 0.00 0.00 0.0
0.25 0.62 0.65 0.70 0.0
0.33 0.74 0.76 0.80 0.70
0.74 0.80 0.82 0.86 0.85
0.84 0.95 0.70 0.35 1.0
1.00 1.00 0.78 0.45 1.0
