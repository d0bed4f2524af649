# value r g b a      density 0 to 1, opacity per voxel length: dentine, then enamel
0.00 0.00 0.00 0.00 0.0
0.38 0.72 0.55 0.38 0.0
0.46 0.86 0.70 0.50 0.60
0.62 0.90 0.78 0.60 0.80
0.74 0.97 0.94 0.88 0.95
1.00 1.00 0.99 0.96 1.00
